!> The impact transformation on steps of one size: the state at an impact comes from the cubic of
!> Hermite through the ends of the step, the velocity jumps there, and the next step begins there.
!> So the matrix of a step never changes; at the deck's times the motion is interpolated. Rows let
!> go at the ends of steps: a step that began there would cost fast waves some of their energy,
!> which the cubic does not follow.
module anchored_impacts
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use constraint_rows, only: gap_size, rate_size
   use impact_scene, only: scene_type, contact_motion_type, accept_span, opening_rows, &
         gap_tolerance, rate_tolerance
   use impact_method, only: impact_method_type
   use constrained_step, only: advance_smoothly
   use contact_release, only: progress_type, release_rows
   use contact_impulses, only: restart_acceleration
   use impact_time, only: span_type, hits_type
   use impact_jump, only: impact_type, apply_impact
   use impact_choice, only: choose_rows
   use span_ends, only: settle_span
   use step_interpolant, only: interpolate_motion, find_hits_between
   use first_contacts, only: find_first_contacts
   implicit none
   private

   public :: anchored_type, lift_anchor

   !> Impacts and releases between steps of one size.
   type, extends(impact_method_type) :: anchored_type
   contains
      procedure :: start
      procedure :: advance
   end type anchored_type

   !> Times closer than this part of a step are one.
   real(wp), parameter :: time_tolerance = 1.0e-9_wp

contains

   !> Steps from event to event until the deck's time is reached or passed; the motion there.
   subroutine advance(self, scene, motion, dt, error)
      class(anchored_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      type(progress_type) :: progress
      type(contact_motion_type) :: before

      call start_progress(scene, motion, dt, progress)
      do
         if (scene%anchor%running) then
            if (scene%anchor%to%motion%t > progress%t_end + time_tolerance*scene%anchor%dt) exit
            call end_step(scene, motion, progress, error)
         else
            if (motion%motion%t >= progress%t_end - time_tolerance*scene%anchor%dt) exit
            call begin_step(scene, motion, progress, error)
         end if
         if (allocated(error)) return
      end do
      if (scene%anchor%running) then
         before = motion
         call interpolate_motion(scene, scene%anchor%from, scene%anchor%to, progress%t_end, motion)
         call accept_span(scene, before, motion)
      end if
      motion%motion%t = progress%t_end
   end subroutine advance

   !> Nothing has happened yet in an increment of the deck.
   subroutine start_progress(scene, motion, dt, progress)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(in) :: dt
      type(progress_type), intent(out) :: progress
      integer :: status

      ! the last increment of the deck's step may be shorter: that changes nothing
      if (.not. scene%anchor%dt > 0.0_wp) scene%anchor%dt = dt
      scene%dt = scene%anchor%dt
      progress%dt = scene%anchor%dt
      progress%t_end = motion%motion%t + dt
      progress%remaining = dt
      progress%beta = scene%system%newmark%beta
      allocate (progress%let_go(scene%rows%n), source=-dt, stat=status)
      call check_allocation(status)
      allocate (progress%stubborn(scene%rows%n), progress%ignored(scene%rows%n), source=.false., &
            stat=status)
      call check_allocation(status)
   end subroutine start_progress

   !> A whole step from where the motion is, and what happens first in it. What happens at once is
   !> done here, and no step begun.
   subroutine begin_step(scene, motion, progress, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(progress_type), intent(inout) :: progress
      type(error_type), allocatable, intent(out) :: error
      type(span_type) :: span
      type(hits_type) :: hits
      type(contact_motion_type) :: next

      progress%at_limit = progress%n_events >= scene%settings%max_events
      progress%remaining = progress%t_end - motion%motion%t
      call describe_span(scene, motion, span)
      call advance_smoothly(scene, motion, span%dt, span%beta, next, error)
      if (allocated(error)) return
      scene%anchor%release = opening_rows(scene, motion, next)
      span%held = motion%touching .and. .not. scene%anchor%release
      call find_hits_between(scene, motion, next, span, hits)
      if (hits%n > 0 .and. .not. minval(hits%high(:hits%n)) > 0.0_wp) then
         call jump(scene, motion, span, hits, progress, error)
      else
         call keep_step(scene, motion, next, span, hits)
      end if
   end subroutine begin_step

   !> The whole step as a span of smooth motion.
   subroutine describe_span(scene, motion, span)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(span_type), intent(out) :: span

      span%dt = scene%anchor%dt
      span%beta = scene%system%newmark%beta
      span%held = motion%touching
      span%gap_limit = gap_tolerance*gap_size(scene%rows, motion%motion, span%dt)
      span%found_limit = span%gap_limit
      span%rate_limit = rate_tolerance*rate_size(scene%rows, motion%motion)
   end subroutine describe_span

   !> Keeps a step as far as the first of the hits in it; rows that open let go at
   !> the end of what is kept.
   subroutine keep_step(scene, motion, next, span, hits)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion, next
      type(span_type), intent(in) :: span
      type(hits_type), intent(in) :: hits
      type(contact_motion_type) :: at
      integer :: status

      if (hits%n > 0) call interpolate_motion(scene, motion, next, &
            motion%motion%t + minval(hits%high(:hits%n)), at)
      associate (anchor => scene%anchor)
         anchor%running = .true.
         anchor%from = motion
         if (allocated(anchor%hit)) deallocate (anchor%hit)
         allocate (anchor%hit(scene%rows%n), source=.false., stat=status)
         call check_allocation(status)
         anchor%hit(hits%row(:hits%n)) = .true.
         if (hits%n > 0) then
            anchor%to = at
         else
            anchor%to = next
         end if
         anchor%held = span%held
      end associate
   end subroutine keep_step

   !> Goes to the end of the step at hand, and does what happens there.
   subroutine end_step(scene, motion, progress, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(progress_type), intent(inout) :: progress
      type(error_type), allocatable, intent(out) :: error
      type(contact_motion_type) :: before, from
      type(span_type) :: span
      type(hits_type) :: hits
      integer :: i

      scene%anchor%running = .false.
      from = scene%anchor%from
      call describe_span(scene, from, span)
      span%held = scene%anchor%held
      before = motion
      motion = scene%anchor%to
      progress%remaining = progress%t_end - motion%motion%t
      call accept_span(scene, before, motion)
      call settle_span(scene, from, motion, span, progress, error)
      if (allocated(error)) return
      if (any(scene%anchor%release)) call release_rows(scene, motion, scene%anchor%release, &
            progress)
      if (.not. any(scene%anchor%hit)) return
      hits%row = pack([(i, i=1, scene%rows%n)], scene%anchor%hit)
      hits%n = size(hits%row)
      hits%high = [(motion%motion%t - from%motion%t, i=1, hits%n)]
      hits%low = hits%high
      call jump(scene, motion, span, hits, progress, error)
   end subroutine end_step

   !> The velocity jumps where the motion is.
   subroutine jump(scene, motion, span, hits, progress, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(span_type), intent(in) :: span
      type(hits_type), intent(in) :: hits
      type(progress_type), intent(inout) :: progress
      type(error_type), allocatable, intent(out) :: error
      type(impact_type) :: impact

      progress%n_events = progress%n_events + 1
      call choose_rows(scene, motion, span, hits, minval(hits%high(:hits%n)), progress, impact)
      call apply_impact(scene, motion, impact, error)
      motion%fresh = .true.
   end subroutine jump

   !> The first state of a dynamic step.
   subroutine start(self, scene, motion, dt, error)
      class(anchored_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error

      call find_first_contacts(scene, motion, dt, scene%system%newmark%beta, error)
   end subroutine start

   !> Ends a step that reaches beyond the end of the deck's step: the next one begins at that end,
   !> from the motion interpolated there with the acceleration of equilibrium.
   subroutine lift_anchor(scene, motion, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(error_type), allocatable, intent(out) :: error
      logical :: was_running

      was_running = scene%anchor%running
      scene%anchor%running = .false.
      scene%anchor%dt = 0.0_wp
      if (.not. was_running .or. scene%system%static) return
      call restart_acceleration(scene, motion, error)
      motion%fresh = .true.
   end subroutine lift_anchor

end module anchored_impacts
