!> The impact transformation (eqs. 4.1-4.29): a step with an impact at tau goes by Newmark to tau,
!> jumps in velocity, and goes on by Newmark, with a beta of its own; generalised to any number of
!> rows as a loop over events with sustained contact, capture and release.
module transformation
   use kinds, only: wp
   use errors, only: error_type
   use surfaces, only: beta_given
   use constraint_rows, only: row_gaps, row_rates, row_accelerations, row_curvature, gap_size, &
         rate_size, acceleration_size, may_hit
   use impact_scene, only: scene_type, contact_motion_type, event_type, record_event, accept_span, &
         event_release, gap_tolerance, merge_gap_tolerance, rate_tolerance, &
         acceleration_tolerance, merge_time_tolerance
   use impact_method, only: impact_method_type
   use constrained_step, only: advance_smoothly
   use impact_time, only: span_type, hits_type, find_hits, locate_impact, add_missed_hits
   use impact_jump, only: impact_type, apply_impact
   use contact_impulses, only: restart_acceleration, project_touching, follow_wall
   use row_following, only: rows_ahead, rows_here, settle_rows
   use first_contacts, only: find_first_contacts
   implicit none
   private

   public :: transformation_type, impact_beta

   !> Exact impact times and velocity jumps.
   type, extends(impact_method_type) :: transformation_type
   contains
      procedure :: start
      procedure :: advance
   end type transformation_type

   !> Where a step with events stands.
   type :: progress_type
      real(wp) :: dt = 0.0_wp                !! the whole step
      real(wp) :: t_end = 0.0_wp
      real(wp) :: remaining = 0.0_wp
      real(wp) :: beta = 0.25_wp
      integer :: n_events = 0
      logical :: at_limit = .false.          !! no more events are allowed
   end type progress_type

   !> A contact force below this part of its size at the start of the span has vanished.
   real(wp), parameter :: release_tolerance = 1.0e-3_wp
   integer, parameter :: max_release_trials = 8

   !> What is left of a step below this part of it is round-off.
   real(wp), parameter :: time_tolerance = 1.0e-13_wp

   !> beta of the impact step by the thesis.
   real(wp), parameter :: thesis_beta = 1.0_wp/6.0_wp
   !> Highest frequency times step up to which AUTO takes it.
   real(wp), parameter, public :: automatic_limit = 0.5_wp

contains

   !> beta in a step with impacts: as given; or 1/6 while the stiffest implicit frequency times the
   !> step is small, where it is the more accurate one, else 1/4, which conserves energy; a step
   !> without implicit elements keeps its own. (1/6 is stable up to sqrt(12), but a bar with nodal
   !> restitution 1 gained 8 % of its energy in one contact at 2, 0.02 % at 0.5.)
   pure function impact_beta(scene, dt) result(beta)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: dt
      real(wp) :: beta

      beta = scene%settings%beta
      if (scene%settings%beta_choice == beta_given) return
      beta = scene%system%newmark%beta
      if (.not. scene%system%omega_max(1) > 0.0_wp) return
      beta = 0.25_wp
      if (scene%system%omega_max(1)*dt <= automatic_limit) beta = thesis_beta
   end function impact_beta

   !> The event loop of one step.
   subroutine advance(self, scene, motion, dt, error)
      class(transformation_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      type(progress_type) :: progress
      type(contact_motion_type) :: next
      type(span_type) :: span
      type(hits_type) :: hits
      logical :: release(scene%rows%n)

      progress%dt = dt
      progress%t_end = motion%motion%t + dt
      progress%remaining = dt
      progress%beta = scene%system%newmark%beta
      call rows_ahead(scene, motion, dt, error)
      if (allocated(error)) return
      do while (progress%remaining > time_tolerance*dt)
         progress%at_limit = progress%n_events >= scene%settings%max_events
         call smooth_span(scene, motion, progress, span, next, release, error)
         if (allocated(error)) return
         if (span%dt <= 0.0_wp) cycle
         call find_hits(scene, motion, next, span, hits, error)
         if (allocated(error)) return
         if (hits%n == 0) then
            call take_span(scene, motion, next, span%dt, span, progress, error)
            if (allocated(error)) return
            if (any(release)) call release_rows(scene, motion, release, progress)
         else if (abs(progress%beta - impact_beta(scene, dt)) > 0.0_wp) then
            ! an impact step has its own beta: solve it again from where it stands
            progress%beta = impact_beta(scene, dt)
         else
            call go_through_impact(scene, motion, next, span, hits, progress, error)
            if (allocated(error)) return
         end if
      end do
      motion%motion%t = progress%t_end
      call settle_rows(scene, motion, dt, error)
   end subroutine advance

   !> Takes a span of smooth motion. Rows that opened in it touch no more; the others are put back
   !> on
   !> the wall where round-off or the wall's motion has moved them off.
   subroutine take_span(scene, motion, next, dt, span, progress, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(contact_motion_type), intent(in) :: next
      real(wp), intent(in) :: dt                 !! from motion to next
      type(span_type), intent(in) :: span
      type(progress_type), intent(inout) :: progress
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: span_impulse(scene%rows%n)
      logical, dimension(scene%rows%n) :: thrown, stuck
      type(contact_motion_type) :: reached

      progress%remaining = progress%remaining - dt
      span_impulse = dt*(motion%lambda + next%lambda)/2.0_wp
      reached = next
      call accept_span(scene, motion, reached)
      stuck = reached%sticking .and. .not. motion%sticking .and. may_hit(scene%rows)
      motion = reached
      motion%touching = next%touching .and. span%held
      motion%fresh = .false.
      call follow_wall(scene, motion, span_impulse, progress%dt, thrown, error)
      if (allocated(error)) return
      if (any(thrown)) call release_rows(scene, motion, thrown, progress)
      if (any(thrown .or. (stuck .and. motion%touching))) then
         ! a row that has come to stick has no slip acceleration any more
         call restart_acceleration(scene, motion, error)
         if (allocated(error)) return
         motion%fresh = .true.
      end if
      call project_touching(scene, motion, span%gap_limit, &
            rate_tolerance*rate_size(scene%rows, motion%motion), error)
   end subroutine take_span

   !> The smooth motion ahead: over all that remains, or up to the first release of a touching row.
   !> A row that opens at once is let go here (`span%dt` zero: begin again).
   subroutine smooth_span(scene, motion, progress, span, next, release, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(progress_type), intent(inout) :: progress
      type(span_type), intent(out) :: span
      type(contact_motion_type), intent(out) :: next
      logical, intent(out) :: release(:)         !! (n_rows) rows to let go at the end of the span
      type(error_type), allocatable, intent(out) :: error
      logical :: opening(size(release))

      span%dt = progress%remaining
      span%beta = progress%beta
      span%held = motion%touching
      span%gap_limit = gap_tolerance*gap_size(scene%rows, motion%motion, progress%dt)
      span%rate_limit = rate_tolerance*rate_size(scene%rows, motion%motion)
      release = .false.
      call advance_smoothly(scene, motion, span%dt, span%beta, next, error)
      if (allocated(error) .or. .not. any(motion%touching)) return
      opening = motion%touching .and. .not. next%lambda > 0.0_wp .and. &
            row_accelerations(scene%rows, next%motion%a) &
            + row_curvature(scene%rows, next%motion) > acceleration_tolerance &
            *acceleration_size(scene%rows, next%motion%a)
      span%held = motion%touching .and. .not. opening
      if (progress%at_limit) then
         release = opening
      else if (any(opening)) then
         call cut_at_release(scene, motion, opening, progress, span, next, release, error)
      end if
   end subroutine smooth_span

   !> Ends the span where the first of the opening rows lets go.
   subroutine cut_at_release(scene, motion, opening, progress, span, next, release, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      logical, intent(in) :: opening(:)          !! (n_rows)
      type(progress_type), intent(inout) :: progress
      type(span_type), intent(inout) :: span
      type(contact_motion_type), intent(inout) :: next
      logical, intent(inout) :: release(:)       !! (n_rows)
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: theta(size(release)), first

      call release_times(scene, motion, span, opening, theta, error)
      if (allocated(error)) return
      first = minval(theta, mask=opening)
      release = opening .and. theta <= first + merge_time_tolerance
      if (first <= merge_time_tolerance) then
         call release_rows(scene, motion, release, progress)
         ! with no time gone since the restart, the force in the acceleration is not a past one
         if (motion%fresh) call restart_acceleration(scene, motion, error)
         motion%fresh = .false.
         span%dt = 0.0_wp
      else if (first < 1.0_wp - merge_time_tolerance) then
         span%held = motion%touching
         call locate_release(scene, motion, release, first, span, next, error)
      end if
   end subroutine cut_at_release

   !> Cuts the span where the first of the releasing rows has lost its contact force: the linear
   !> guess, improved by regula falsi where the force is not linear (steps large for the structure).
   subroutine locate_release(scene, motion, release, first, span, next, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      logical, intent(in) :: release(:)          !! (n_rows)
      real(wp), intent(in) :: first              !! linear guess, in parts of the span
      type(span_type), intent(inout) :: span
      type(contact_motion_type), intent(inout) :: next
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: low, high, force_low, force_high, force, whole
      integer :: row, i

      row = findloc(release, .true., dim=1)
      whole = span%dt
      low = 0.0_wp
      high = whole
      force_low = motion%lambda(row)
      force_high = force_low*(1.0_wp - 1.0_wp/first)
      span%dt = first*whole
      do i = 1, max_release_trials
         call advance_smoothly(scene, motion, span%dt, span%beta, next, error, span%held)
         if (allocated(error)) return
         force = next%lambda(row)
         if (abs(force) <= release_tolerance*motion%lambda(row)) return
         if (force > 0.0_wp) then
            low = span%dt
            force_low = force
            force_high = force_high/2.0_wp
         else
            high = span%dt
            force_high = force
            force_low = force_low/2.0_wp
         end if
         span%dt = low + (high - low)*force_low/(force_low - force_high)
      end do
      call advance_smoothly(scene, motion, span%dt, span%beta, next, error, span%held)
   end subroutine locate_release

   !> When the opening rows let go, in parts of the span: contact forces go linearly over it.
   subroutine release_times(scene, motion, span, opening, theta, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(span_type), intent(in) :: span
      logical, intent(in) :: opening(:)
      real(wp), intent(out) :: theta(:)          !! (n_rows)
      type(error_type), allocatable, intent(out) :: error
      type(contact_motion_type) :: held

      theta = 1.0_wp
      where (opening .and. .not. motion%lambda > 0.0_wp) theta = 0.0_wp
      if (.not. scene%settings%locate_release) return
      call advance_smoothly(scene, motion, span%dt, span%beta, held, error, motion%touching)
      if (allocated(error)) return
      where (opening .and. motion%lambda > 0.0_wp .and. held%lambda < 0.0_wp)
         theta = motion%lambda/(motion%lambda - held%lambda)
      end where
   end subroutine release_times

   !> Lets rows go. The acceleration stays as it is, contact force included: restarted without it,
   !> the
   !> row would be thrown back.
   subroutine release_rows(scene, motion, release, progress)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      logical, intent(in) :: release(:)
      type(progress_type), intent(inout) :: progress
      type(event_type) :: event
      real(wp) :: rates(size(release))
      integer :: i

      rates = row_rates(scene%rows, motion%motion)
      motion%touching = motion%touching .and. .not. release
      progress%n_events = progress%n_events + 1
      do i = 1, size(release)
         if (.not. release(i)) cycle
         event = event_type(motion%motion%t, event_release, i, rates(i), rates(i), 0.0_wp, &
               progress%beta)
         call record_event(scene, event)
      end do
   end subroutine release_rows

   !> Goes to the earliest impact of the span and jumps there.
   subroutine go_through_impact(scene, motion, next, span, hits, progress, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(contact_motion_type), intent(in) :: next
      type(span_type), intent(in) :: span
      type(hits_type), intent(in) :: hits
      type(progress_type), intent(inout) :: progress
      type(error_type), allocatable, intent(out) :: error
      type(contact_motion_type) :: at
      type(impact_type) :: impact
      type(hits_type) :: all_hits
      real(wp) :: tau
      integer :: n

      all_hits = hits
      do
         n = all_hits%n
         call locate_impact(scene, motion, next, span, all_hits, tau, at, error)
         if (allocated(error)) return
         if (.not. tau > 0.0_wp) exit
         call add_missed_hits(scene, motion, at, tau, span, all_hits, error)
         if (allocated(error)) return
         if (all_hits%n == n) exit
      end do
      if (tau > 0.0_wp) call take_span(scene, motion, at, tau, span, progress, error)
      if (allocated(error)) return
      progress%n_events = progress%n_events + 1
      call choose_rows(scene, motion, span, all_hits, tau, progress, impact)
      call apply_impact(scene, motion, impact, error)
      motion%fresh = .true.
   end subroutine go_through_impact

   !> Which rows take part in the impact: all that close and are at the wall now, or will be within
   !> the merging time; rows at rest that are pressed against the wall are captured without impact.
   subroutine choose_rows(scene, motion, span, hits, tau, progress, impact)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(span_type), intent(in) :: span
      type(hits_type), intent(in) :: hits
      real(wp), intent(in) :: tau
      type(progress_type), intent(in) :: progress
      type(impact_type), intent(out) :: impact
      real(wp), dimension(scene%rows%n) :: gaps, rates
      integer :: i, row

      gaps = row_gaps(scene%rows, motion%motion)
      rates = row_rates(scene%rows, motion%motion)
      impact%dt = progress%dt
      impact%beta = progress%beta
      impact%plastic = progress%at_limit
      impact%rate_limit = rate_tolerance*rate_size(scene%rows, motion%motion)
      impact%new = may_hit(scene%rows) .and. .not. motion%touching .and. rates < -impact%rate_limit .and. &
            (gaps <= span%gap_limit*(merge_gap_tolerance/gap_tolerance) .or. &
            gaps <= -merge_time_tolerance*progress%dt*rates)
      ! an impact elsewhere may push a row at the wall; without a rebound of its own it answers at
      ! once
      impact%near = may_hit(scene%rows) .and. .not. motion%touching .and. .not. impact%new .and. &
            .not. scene%rows%restitution > 0.0_wp .and. &
            gaps <= span%gap_limit*(merge_gap_tolerance/gap_tolerance)
      allocate (impact%forced(scene%rows%n))
      impact%forced = .false.
      do i = 1, hits%n
         row = hits%row(i)
         impact%forced(row) = .not. hits%high(i) > 0.0_wp .and. .not. tau > 0.0_wp .and. &
               rates(row) >= -impact%rate_limit
      end do
      if (.not. any(impact%new) .and. .not. any(impact%forced)) then
         ! never go on with nothing: the row that is nearest then
         impact%forced(hits%row(minloc(gaps(hits%row(:hits%n)), dim=1))) = .true.
      end if
      impact%new = impact%new .or. impact%forced
      impact%near = impact%near .and. .not. impact%new
   end subroutine choose_rows

   !> The first state of a dynamic step.
   subroutine start(self, scene, motion, dt, error)
      class(transformation_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error

      call rows_here(scene, motion, dt)
      call find_first_contacts(scene, motion, dt, impact_beta(scene, dt), error)
   end subroutine start

end module transformation
