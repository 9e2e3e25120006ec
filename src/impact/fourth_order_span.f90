!> The smooth motion between events with fourth order: over what remains of a step, up to a corner
!> of an amplitude, or up to where the first of the touching rows has lost its contact force.
module fourth_order_span
   use kinds, only: wp
   use errors, only: error_type
   use external_load, only: next_load_corner
   use prescribed_motion, only: next_motion_corner
   use constraint_rows, only: gap_size, rate_size
   use impact_scene, only: scene_type, contact_motion_type, gap_tolerance, rate_tolerance
   use contact_impulses, only: restart_acceleration
   use contact_release, only: progress_type, release_rows
   use impact_time, only: span_type
   use fourth_order_step, only: smooth_step_type, step_smoothly, stage_forces
   implicit none
   private

   public :: smooth_ahead

   !> Corners of amplitudes nearer than this part of a step to its ends need no step of their own.
   real(wp), parameter :: corner_tolerance = 1.0e-9_wp
   !> Contact forces below this part of the largest are round-off.
   real(wp), parameter :: force_tolerance = 1.0e-10_wp
   !> A contact force below this part of the largest has vanished. A row let go so much too late
   !> leaves with an error in velocity of the square of that.
   real(wp), parameter :: release_tolerance = 1.0e-7_wp
   !> A bracket below this part of the span is narrow enough whatever the force does in it.
   real(wp), parameter :: width_limit = 1.0e-12_wp
   integer, parameter :: max_trials = 60

   !> Between its ends the smallest contact force goes from positive to negative.
   type :: bracket_type
      real(wp) :: x(2) = 0.0_wp, f(2) = 0.0_wp
      integer :: moved = 0                       !! the end that moved last
   end type bracket_type

contains

   !> The smooth motion ahead, and the rows that let go at its end. Rows that open at once are let
   !> go here (`span%dt` zero: begin again).
   subroutine smooth_ahead(scene, motion, progress, span, step, release, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(progress_type), intent(inout) :: progress
      type(span_type), intent(out) :: span
      type(smooth_step_type), intent(out) :: step
      logical, intent(out) :: release(:)         !! (n_rows)
      type(error_type), allocatable, intent(out) :: error

      span%dt = until_corner(scene, motion%motion%t, progress)
      span%held = motion%touching
      span%gap_limit = gap_tolerance*gap_size(scene%rows, motion%motion, progress%dt)
      span%rate_limit = rate_tolerance*rate_size(scene%rows, motion%motion)
      release = .false.
      call step_smoothly(scene, motion, span%dt, step, error)
      if (allocated(error) .or. .not. any(motion%touching)) return
      call find_release(scene, motion, progress, span, step, release, error)
   end subroutine smooth_ahead

   !> What remains of the step, or the time to the next corner of a load or prescribed motion: the
   !> order holds between corners.
   pure function until_corner(scene, t, progress) result(dt)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: t
      type(progress_type), intent(in) :: progress
      real(wp) :: dt
      real(wp) :: near, corner

      near = corner_tolerance*progress%dt
      corner = min(next_load_corner(scene%system%loads, t + near), &
            next_motion_corner(scene%system%motions, t + near))
      dt = progress%remaining
      if (corner < t + dt - near) dt = corner - t
   end function until_corner

   !> Ends the span where the first contact force vanishes.
   subroutine find_release(scene, motion, progress, span, step, release, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(progress_type), intent(inout) :: progress
      type(span_type), intent(inout) :: span
      type(smooth_step_type), intent(inout) :: step
      logical, intent(inout) :: release(:)       !! (n_rows)
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: forces(scene%rows%n, 4), scale, limit
      integer :: i

      forces(:, 1) = motion%lambda
      forces(:, 2:3) = stage_forces(step)
      forces(:, 4) = step%to%lambda
      do i = 1, scene%rows%n
         if (.not. motion%touching(i)) forces(i, :) = 0.0_wp
      end do
      scale = maxval(abs(forces))
      limit = force_tolerance*scale
      if (.not. any(forces < -limit)) return
      release = forces(:, 4) < -limit
      if (progress%at_limit) return
      release = forces(:, 1) < -limit .or. (forces(:, 1) <= limit .and. forces(:, 2) < -limit)
      if (any(release)) then
         call release_rows(scene, motion, release, progress)
         call restart_acceleration(scene, motion, error)
         span%dt = 0.0_wp
         return
      end if
      call locate_release(scene, motion, forces, span, step, release, error)
   end subroutine find_release

   !> The time at which the smallest force vanishes, by regula falsi on steps solved anew; they end
   !> just beyond it. A force that vanishes between the Gauss points only is looked at there.
   subroutine locate_release(scene, motion, forces, span, step, release, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(in) :: forces(:, :)       !! (n_rows, 4) start, Gauss points, end
      type(span_type), intent(inout) :: span
      type(smooth_step_type), intent(inout) :: step
      logical, intent(out) :: release(:)         !! (n_rows)
      type(error_type), allocatable, intent(out) :: error
      type(bracket_type) :: bracket
      real(wp) :: tolerance, force, trial
      integer :: i

      release = .false.
      tolerance = release_tolerance*maxval(abs(forces))
      force = minval(forces(:, 4))
      if (force >= -tolerance) then
         trial = span%dt*merge(0.25_wp, 0.75_wp, minval(forces(:, 2)) < minval(forces(:, 3)))
         call take_part(scene, motion, trial, step, force, error)
         if (allocated(error)) return
         if (force >= -tolerance) then
            call take_part(scene, motion, span%dt, step, force, error)
            return
         end if
      end if
      bracket%x = [0.0_wp, step%dt]
      ! what is looked for is a force half the tolerance below zero
      bracket%f = [max(0.0_wp, minval(forces(:, 1), mask=motion%touching)), force]
      bracket%f = bracket%f + tolerance/2.0_wp
      do i = 1, max_trials
         trial = next_trial(bracket, i)
         if (bracket%x(2) - bracket%x(1) <= width_limit*span%dt) exit
         if (.not. (trial > bracket%x(1) .and. trial < bracket%x(2))) exit
         call take_part(scene, motion, trial, step, force, error)
         if (allocated(error)) return
         call narrow(bracket, trial, force + tolerance/2.0_wp)
         if (abs(force + tolerance/2.0_wp) <= tolerance/2.0_wp) exit
      end do
      if (force > 0.0_wp) call take_part(scene, motion, bracket%x(2), step, force, error)
      span%dt = step%dt
      release = motion%touching .and. step%to%lambda <= tolerance
   end subroutine locate_release

   !> Where the line through the weighted ends crosses zero; now and then the middle.
   pure real(wp) function next_trial(bracket, i)
      type(bracket_type), intent(in) :: bracket
      integer, intent(in) :: i

      associate (x => bracket%x, f => bracket%f)
         next_trial = x(1) + (x(2) - x(1))*f(1)/(f(1) - f(2))
         if (modulo(i, 8) == 0) next_trial = (x(1) + x(2))/2.0_wp
      end associate
   end function next_trial

   !> Moves one end of the bracket to x; an end that stays twice loses half its weight.
   pure subroutine narrow(bracket, x, f)
      type(bracket_type), intent(inout) :: bracket
      real(wp), intent(in) :: x, f
      integer :: moved

      moved = merge(1, 2, f > 0.0_wp)
      bracket%x(moved) = x
      bracket%f(moved) = f
      if (bracket%moved == moved) bracket%f(3 - moved) = bracket%f(3 - moved)/2.0_wp
      bracket%moved = moved
   end subroutine narrow

   !> A part of the span, and the smallest contact force at its end.
   subroutine take_part(scene, motion, dt, step, force, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(in) :: dt
      type(smooth_step_type), intent(out) :: step
      real(wp), intent(out) :: force
      type(error_type), allocatable, intent(out) :: error

      force = 0.0_wp
      call step_smoothly(scene, motion, dt, step, error)
      if (.not. allocated(error)) force = minval(step%to%lambda, mask=motion%touching)
   end subroutine take_part

end module fourth_order_span
