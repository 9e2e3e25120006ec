!> Rows of bodies that slide on each other, step by step: placed where the step is going to end, and
!> put right at its end, where nodes in contact are brought back onto the edge.
module row_following
   use kinds, only: wp
   use errors, only: error_type
   use motion_state, only: state_type
   use constraint_rows, only: rows_type, row_gaps, row_rates, row_curvature, rate_size, &
         law_closed, law_penalty, law_overlap
   use row_placement, only: place_rows
   use impact_scene, only: scene_type, contact_motion_type, event_type, record_event, &
         event_release, rate_tolerance
   use contact_impulses, only: project_touching, gaps_to_close, has_jumped
   use constrained_step, only: advance_smoothly
   implicit none
   private

   public :: rows_ahead, rows_at, rows_here, settle_rows

   !> A node looks for partners as far as this multiple of the largest motion in the step.
   real(wp), parameter :: reach_factor = 4.0_wp
   !> Gaps of rows in contact are closed to this part of the geometry's size.
   real(wp), parameter :: closed_tolerance = 1.0e-14_wp
   integer, parameter :: max_rounds = 5
   integer, parameter :: closed_trials = 3

contains

   !> Rows where the motion will be after dt: as its velocity goes, and with rows in contact where a
   !> trial step has taken it. (Accelerations of stiff elements swing from step to step and lead
   !> nowhere.)
   subroutine rows_ahead(scene, motion, dt, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      type(state_type) :: ahead
      type(contact_motion_type) :: trial
      integer :: n_trials, i

      if (.not. scene%rows%moving) return
      ahead = motion%motion
      ahead%t = ahead%t + dt
      ahead%d = ahead%d + dt*ahead%v
      call place_rows(scene%rows, scene%geometry, scene%system%structure%map, motion%motion, &
            ahead, reach(scene, motion, dt))
      scene%curvature = row_curvature(scene%rows, ahead)
      n_trials = 0
      if (any(motion%touching .or. motion%lambda > 0.0_wp)) n_trials = 1
      ! what has no mass to be moved by when rows are settled is placed by more trials
      if (any(scene%rows%law == law_closed .and. (motion%lambda > 0.0_wp .or. &
            row_gaps(scene%rows, ahead) < 0.0_wp))) n_trials = closed_trials
      do i = 1, n_trials
         call advance_smoothly(scene, motion, dt, scene%system%newmark%beta, trial, error)
         if (allocated(error)) return
         call rows_at(scene, motion, trial, dt)
      end do
   end subroutine rows_ahead

   !> Rows where a motion has led to.
   subroutine rows_at(scene, from, to, dt)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from, to
      real(wp), intent(in) :: dt                 !! of a step, for how far rows look for partners

      if (.not. scene%rows%moving) return
      call place_rows(scene%rows, scene%geometry, scene%system%structure%map, from%motion, &
            to%motion, reach(scene, from, dt))
      call find_curvature(scene, from, to%motion, dt)
   end subroutine rows_at

   !> The part of gap accelerations that comes from rows turning: in closed form for a node on an
   !> edge, by a difference along the motion for rows weighted over edges.
   subroutine find_curvature(scene, motion, ahead, dt)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(state_type), intent(in) :: ahead      !! where the rows have been placed
      real(wp), intent(in) :: dt
      real(wp), parameter :: part = 0.1_wp       !! of the step
      type(state_type) :: further
      type(rows_type) :: here
      real(wp) :: rates(scene%rows%n)
      logical :: weighted(scene%rows%n)

      scene%curvature = row_curvature(scene%rows, ahead)
      weighted = scene%rows%weight > 0.0_wp
      if (.not. any(weighted)) return
      rates = row_rates(scene%rows, ahead)
      here = scene%rows
      further = ahead
      further%d = ahead%d + part*dt*ahead%v
      call place_rows(scene%rows, scene%geometry, scene%system%structure%map, ahead, further, &
            reach(scene, motion, dt))
      where (weighted .and. scene%rows%facing) scene%curvature &
            = (row_rates(scene%rows, ahead) - rates)/(part*dt)
      scene%rows = here
   end subroutine find_curvature

   !> Rows where the motion is.
   subroutine rows_here(scene, motion, dt)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(in) :: dt

      if (.not. scene%rows%moving) return
      call place_rows(scene%rows, scene%geometry, scene%system%structure%map, motion%motion, &
            motion%motion, reach(scene, motion, dt))
   end subroutine rows_here

   !> How far rows look for partners: what may be gone in the step, how deep springs are in, and
   !> what fictitious forces of earlier steps, which may have been longer, have left.
   pure function reach(scene, motion, dt) result(distance)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(in) :: dt
      real(wp) :: distance
      real(wp), parameter :: least_share = 1.0e-6_wp

      distance = reach_factor*dt*(maxval(abs(motion%motion%v)) + dt*maxval(abs(motion%motion%a)))
      if (any(scene%rows%law == law_penalty)) distance = distance + maxval( &
            motion%lambda/scene%rows%stiffness, mask=scene%rows%law == law_penalty)
      if (any(scene%rows%law == law_overlap)) distance = distance + max(0.0_wp, &
            -minval(row_gaps(scene%rows, motion%motion), mask=scene%rows%law == law_overlap))
      distance = max(distance, least_share*scene%geometry%size)
   end function reach

   !> At the end of a step: rows at their exact places, those that touch closed to round-off in gap
   !> and gap rate; a row that has slid off its surface is released, as is one whose gap has jumped
   !> open.
   subroutine settle_rows(scene, motion, dt, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: gaps(scene%rows%n), limit
      integer :: i

      if (.not. scene%rows%moving) return
      limit = closed_tolerance*scene%geometry%size
      do i = 1, max_rounds
         call rows_here(scene, motion, dt)
         call release_lost(scene, motion)
         if (.not. any(motion%touching)) return
         gaps = gaps_to_close(scene, motion)
         if (i > 1 .and. maxval(abs(gaps)) <= limit) return
         call project_touching(scene, motion, limit, &
               rate_tolerance*rate_size(scene%rows, motion%motion), error)
         if (allocated(error)) return
      end do
   end subroutine settle_rows

   subroutine release_lost(scene, motion)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp) :: gaps(scene%rows%n)
      logical :: kept(scene%rows%n)
      integer :: i

      gaps = row_gaps(scene%rows, motion%motion)
      kept = scene%rows%facing .and. .not. (gaps > 0.0_wp .and. has_jumped(scene, gaps))
      do i = 1, scene%rows%n
         if (.not. motion%touching(i) .or. kept(i)) cycle
         motion%touching(i) = .false.
         call record_event(scene, event_type(motion%motion%t, event_release, i, 0.0_wp, 0.0_wp, &
               0.0_wp, scene%system%newmark%beta))
      end do
   end subroutine release_lost

end module row_following
