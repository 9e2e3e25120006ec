!> What is put right at the end of a span of smooth motion.
module span_ends
   use kinds, only: wp
   use errors, only: error_type
   use constraint_rows, only: rate_size
   use impact_scene, only: scene_type, contact_motion_type, rate_tolerance
   use contact_release, only: progress_type, release_rows
   use contact_impulses, only: restart_acceleration, project_touching, follow_wall
   use impact_time, only: span_type
   use slip_state, only: review_slip
   implicit none
   private

   public :: settle_span

contains

   !> Rows that opened in the span touch no more; the others are put back on the wall where
   !> round-off or the wall's motion has moved them off.
   subroutine settle_span(scene, from, motion, span, progress, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from        !! the start of the span
      type(contact_motion_type), intent(inout) :: motion   !! its end
      type(span_type), intent(in) :: span
      type(progress_type), intent(inout) :: progress
      type(error_type), allocatable, intent(out) :: error

      motion%fresh = .false.
      motion%touching = motion%touching .and. span%held
      if (.not. any(motion%touching)) return
      call settle_touching(scene, from, motion, span, progress, error)
   end subroutine settle_span

   !> The same where rows touch.
   subroutine settle_touching(scene, from, motion, span, progress, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      type(contact_motion_type), intent(inout) :: motion
      type(span_type), intent(in) :: span
      type(progress_type), intent(inout) :: progress
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: span_impulse(scene%rows%n)
      logical :: thrown(scene%rows%n), anew

      span_impulse = (motion%motion%t - from%motion%t)*(from%lambda + motion%lambda)/2.0_wp
      call follow_wall(scene, motion, span_impulse, progress%dt, thrown, error)
      if (allocated(error)) return
      if (any(thrown)) call release_rows(scene, motion, thrown, progress)
      call review_slip(scene, from, motion, anew, error)
      if (allocated(error)) return
      if (anew .or. any(thrown)) then
         call restart_acceleration(scene, motion, error)
         if (allocated(error)) return
         motion%fresh = .true.
      end if
      call project_touching(scene, motion, span%gap_limit, &
            rate_tolerance*rate_size(scene%rows, motion%motion), error)
   end subroutine settle_touching

end module span_ends
