!> Which rows in contact slide, and what their friction has to do where they begin or cease to.
!> Measured is slip against the speed that friction at its limit stops in an increment.
module slip_state
   use kinds, only: wp
   use errors, only: error_type
   use constraint_rows, only: slip_rates, sticks, may_hit
   use impact_scene, only: scene_type, contact_motion_type
   use row_compliance, only: compliance_type, mass_compliance
   implicit none
   private

   public :: slip_senses, sliding_senses, mark_sticking, review_slip, review_sticking

   !> Slip below this part of the largest speed is round-off,
   real(wp), parameter :: rest_tolerance = 1.0e-12_wp
   !> as is what friction stops in this part of an increment, and what is left of the slip of a row
   !> that has come to rest.
   real(wp), parameter :: stop_tolerance = 1.0e-9_wp

contains

   !> Which way rows slide, 0 where they do not: rows that stick are taken to do so.
   function slip_senses(scene, motion) result(sense)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      integer :: sense(scene%rows%n)
      real(wp) :: slip(scene%rows%n)

      sense = 0
      if (.not. any(scene%rows%friction > 0.0_wp)) return
      slip = slip_rates(scene%rows, motion%motion)
      where (abs(slip) > round_off(motion) .and. .not. motion%sticking) &
            sense = nint(sign(1.0_wp, slip))
   end function slip_senses

   !> Which way rows slide that have stuck, 0 where they still do: a jump has given them more slip
   !> than friction takes back in the step to come, of which a mean of half its force is left.
   function sliding_senses(scene, motion, compliance) result(sense)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(compliance_type), intent(in) :: compliance   !! on the mass
      integer :: sense(scene%rows%n)
      real(wp) :: slip(scene%rows%n)

      sense = 0
      if (size(compliance%rough) == 0) return
      if (.not. any(motion%sticking)) return
      slip = slip_rates(scene%rows, motion%motion)
      where (motion%sticking .and. abs(slip) > max(round_off(motion), &
            stopped_speeds(scene, motion, compliance)/2.0_wp)) sense = nint(sign(1.0_wp, slip))
   end function sliding_senses

   !> Held rows stick whose friction is below its limit and whose slip is round-off.
   subroutine mark_sticking(scene, motion, held, compliance)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(inout) :: motion
      logical, intent(in) :: held(:)             !! (n_rows)
      type(compliance_type), intent(in) :: compliance   !! of the held rows on the mass

      motion%sticking = held .and. sticks(scene%rows, motion%lambda, motion%tau)
      if (.not. any(motion%sticking)) return
      motion%sticking = motion%sticking .and. abs(slip_rates(scene%rows, motion%motion)) <= &
            round_off(motion) + stop_tolerance*stopped_speeds(scene, motion, compliance)
   end subroutine mark_sticking

   !> The slip at the end of a span against the friction forces there. The acceleration is to be
   !> found anew where a row has come to rest, where one that stuck has got slip that friction does
   !> not stop in a step, or where what moves a partner has turned the slip. Less slip of a row that
   !> stuck is stopped in the next step.
   subroutine review_slip(scene, from, motion, anew, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from        !! the start of the span
      type(contact_motion_type), intent(inout) :: motion   !! its end
      logical, intent(out) :: anew
      type(error_type), allocatable, intent(out) :: error
      real(wp), dimension(scene%rows%n) :: slip, slip_before
      logical, dimension(scene%rows%n) :: rough, halted, turned

      anew = .false.
      rough = rough_rows_of(scene, motion)
      if (.not. any(rough)) return
      slip = slip_rates(scene%rows, motion%motion)
      slip_before = slip_rates(scene%rows, from%motion)
      halted = rough .and. .not. (motion%sticking .or. from%sticking) .and. motion%lambda > 0.0_wp &
            .and. abs(slip_before) > round_off(from) .and. &
            abs(slip) <= stop_tolerance*abs(slip_before)
      turned = rough .and. .not. (motion%sticking .or. halted) .and. motion%tau*slip > 0.0_wp &
            .and. partners_may_jump(scene)
      motion%sticking = motion%sticking .or. halted
      anew = any(rough .and. motion%sticking .and. .not. from%sticking) .or. any(turned)
      ! what has not changed has been looked at
      if (anew .or. .not. any(abs(slip - slip_before) > rest_tolerance*abs(slip))) return
      call review_sticking(scene, motion, anew, error)
   end subroutine review_slip

   !> The same of rows that stick, wherever their slip comes from.
   subroutine review_sticking(scene, motion, anew, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      logical, intent(out) :: anew
      type(error_type), allocatable, intent(out) :: error
      type(compliance_type) :: compliance
      real(wp), dimension(scene%rows%n) :: slip, stopped
      logical, dimension(scene%rows%n) :: rough, moved

      anew = .false.
      rough = rough_rows_of(scene, motion)
      if (.not. any(rough .and. motion%sticking)) return
      slip = abs(slip_rates(scene%rows, motion%motion))
      moved = rough .and. motion%sticking .and. slip > round_off(motion)
      if (.not. any(moved)) return
      call mass_compliance(scene, rough, compliance, error)
      if (allocated(error)) return
      stopped = stopped_speeds(scene, motion, compliance)
      anew = any(moved .and. slip > stopped/2.0_wp)
      if (.not. anew) motion%sticking = motion%sticking .and. .not. (moved .and. &
            slip > stop_tolerance*stopped)
   end subroutine review_sticking

   !> Rows in contact whose friction acts on the velocity.
   pure function rough_rows_of(scene, motion) result(rough)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      logical :: rough(scene%rows%n)

      rough = scene%rows%friction > 0.0_wp
      if (any(rough)) rough = rough .and. motion%touching .and. may_hit(scene%rows)
   end function rough_rows_of

   !> Rigid surfaces or supports have a motion of their own.
   pure logical function partners_may_jump(scene) result(may)
      type(scene_type), intent(in) :: scene

      may = size(scene%system%motions%motions) > 0 .or. any(scene%rows%amplitude > 0)
   end function partners_may_jump

   !> Slip below this is a difference of equal speeds.
   pure real(wp) function round_off(motion)
      type(contact_motion_type), intent(in) :: motion

      round_off = rest_tolerance*maxval(abs(motion%motion%v))
   end function round_off

   !> Slip rates that friction at its limit stops in an increment.
   pure function stopped_speeds(scene, motion, compliance) result(speeds)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(compliance_type), intent(in) :: compliance   !! on the mass
      real(wp) :: speeds(scene%rows%n)
      integer :: i, row, tangent

      speeds = 0.0_wp
      if (size(compliance%rough) == 0) return
      do i = 1, compliance%n
         if (.not. compliance%rough(i)) cycle
         row = compliance%rows(i)
         tangent = compliance%n + i
         speeds(row) = scene%dt*compliance%w(tangent, tangent)*scene%rows%friction(row) &
               *max(0.0_wp, motion%lambda(row))
      end do
   end function stopped_speeds

end module slip_state
