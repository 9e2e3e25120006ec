!> Impacts with fourth order: Gauss' two-stage step to the instant of the impact, found by stepping
!> there anew until the gap is zero, the jump of the velocity, and Gauss' step from there. Rows in
!> sustained contact are held in it, and let go where their force vanishes.
module fourth_order_impacts
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use impact_scene, only: scene_type, contact_motion_type
   use impact_method, only: impact_method_type
   use impact_time, only: span_type, hits_type
   use impact_choice, only: choose_rows
   use impact_jump, only: impact_type, apply_impact
   use contact_release, only: progress_type, release_rows
   use contact_impulses, only: project_touching, restart_acceleration
   use first_contacts, only: find_first_contacts
   use fourth_order_step, only: smooth_step_type, accept_step
   use fourth_order_span, only: smooth_ahead
   use fourth_order_hits, only: find_first_impact
   implicit none
   private

   public :: fourth_order_type

   !> Gauss' method between events, exact impact times and velocity jumps.
   type, extends(impact_method_type) :: fourth_order_type
   contains
      procedure :: start
      procedure :: advance
   end type fourth_order_type

   !> What is left of a step below this part of it is round-off.
   real(wp), parameter :: time_tolerance = 1.0e-13_wp

contains

   !> The event loop of one step.
   subroutine advance(self, scene, motion, dt, error)
      class(fourth_order_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      type(progress_type) :: progress
      type(smooth_step_type) :: ahead, up_to_impact
      type(span_type) :: span
      type(hits_type) :: hits
      logical :: release(scene%rows%n)

      call begin(scene, motion, dt, progress)
      do while (progress%remaining > time_tolerance*dt)
         progress%at_limit = progress%n_events >= scene%settings%max_events
         call smooth_ahead(scene, motion, progress, span, ahead, release, error)
         if (allocated(error)) return
         if (.not. span%dt > 0.0_wp) cycle
         call find_first_impact(scene, motion, ahead, span, hits, up_to_impact, error)
         if (allocated(error)) return
         if (hits%n == 0) then
            call take(scene, motion, ahead, span, progress, error)
            if (allocated(error)) return
            if (any(release)) call let_go(scene, motion, release, progress, error)
         else
            if (up_to_impact%dt > 0.0_wp) then
               call take(scene, motion, up_to_impact, span, progress, error)
               if (allocated(error)) return
            end if
            call jump(scene, motion, span, hits, up_to_impact%dt, progress, error)
         end if
         if (allocated(error)) return
      end do
      motion%motion%t = progress%t_end
   end subroutine advance

   !> Nothing has happened yet in the step.
   subroutine begin(scene, motion, dt, progress)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(in) :: dt
      type(progress_type), intent(out) :: progress
      integer :: status

      scene%whole_step = dt
      ! accelerations are those of equilibrium, damping forces of a jump included
      scene%dt = 0.0_wp
      progress%dt = dt
      progress%t_end = motion%motion%t + dt
      progress%remaining = dt
      progress%beta = 0.0_wp
      allocate (progress%let_go(scene%rows%n), source=-dt, stat=status)
      call check_allocation(status)
   end subroutine begin

   !> Takes a span of smooth motion; held rows stay on the wall to round-off.
   subroutine take(scene, motion, step, span, progress, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(smooth_step_type), intent(in) :: step
      type(span_type), intent(in) :: span
      type(progress_type), intent(inout) :: progress
      type(error_type), allocatable, intent(out) :: error

      call accept_step(scene, motion, step)
      motion = step%to
      progress%remaining = progress%remaining - step%dt
      call project_touching(scene, motion, span%gap_limit, span%rate_limit, error)
   end subroutine take

   !> Rows whose contact force has vanished touch no more.
   subroutine let_go(scene, motion, release, progress, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      logical, intent(in) :: release(:)          !! (n_rows)
      type(progress_type), intent(inout) :: progress
      type(error_type), allocatable, intent(out) :: error

      call release_rows(scene, motion, release, progress)
      call restart_acceleration(scene, motion, error)
   end subroutine let_go

   !> The velocity jumps where the motion is.
   subroutine jump(scene, motion, span, hits, tau, progress, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(span_type), intent(in) :: span
      type(hits_type), intent(in) :: hits
      real(wp), intent(in) :: tau                !! from the start of the span
      type(progress_type), intent(inout) :: progress
      type(error_type), allocatable, intent(out) :: error
      type(impact_type) :: impact

      progress%n_events = progress%n_events + 1
      call choose_rows(scene, motion, span, hits, tau, progress, impact)
      call apply_impact(scene, motion, impact, error)
   end subroutine jump

   !> The first state of a dynamic step.
   subroutine start(self, scene, motion, dt, error)
      class(fourth_order_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error

      scene%dt = 0.0_wp
      call find_first_contacts(scene, motion, dt, 0.0_wp, error)
   end subroutine start

end module fourth_order_impacts
