!> The impact transformation: a step with an impact at tau goes by Newmark to tau,
!> jumps in velocity, and goes on by Newmark, with a beta of its own; generalised to any number of
!> rows as a loop over events with sustained contact, capture and release.
module transformation
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use surfaces, only: beta_given
   use constraint_rows, only: row_gaps, row_rates
   use impact_scene, only: scene_type, contact_motion_type, accept_span, exchange_motions, &
         gap_tolerance, merge_gap_tolerance, merge_time_tolerance
   use impact_method, only: impact_method_type
   use constrained_step, only: advance_smoothly
   use contact_release, only: progress_type, smooth_span, release_rows, note_return
   use impact_time, only: span_type, hits_type, find_hits, locate_impact, add_missed_hits
   use impact_jump, only: impact_type, apply_impact
   use impact_choice, only: choose_rows
   use span_ends, only: settle_span
   use row_following, only: rows_ahead, rows_at, rows_here, settle_rows
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

   !> What is left of a step below this part of it is round-off.
   real(wp), parameter :: time_tolerance = 1.0e-13_wp

   !> Rows are placed so often at an impact until it stays where it is.
   integer, parameter :: max_refinements = 60
   !> A gap that jumps from open to an overlap of no more than this part of the size is a hit there.
   real(wp), parameter :: small_jump = 1.0e-4_wp

contains

   !> beta in a step with impacts: as given, or that of the steps without. Parts of a step are then
   !> stable where the whole is, and no bound on the frequency is needed. Each Newmark step with
   !> gamma = 1/2 keeps E + (beta - 1/4) h^2/2 a.M a, so that one of two parts h1, h2 with a beta of
   !> its own shifts the energy E by (1/4 - beta)/2 times the sum over both of h^2 times the growth
   !> of a.M a. Where impacts recur in step with it that does not average out: with 1/6 at impacts
   !> and 1/4 between, an oscillator at a wall in its rest position gains 5e-6 of its energy each
   !> at omega h = 0.3, 9e-5 at 0.5, 4e-3 at 1, 2e-2 at 1.5, and a bar with nodal restitution 1 any
   !> amount from one Courant step on; displacements were 1 % closer. 1/4 in all steps keeps the
   !> energy; 1/6 in all, not only at impacts, gained 2e-5 at most up to omega h = 1.7, 1/12 in all
   !> usually 3e-6 but 1e-2 at omega h = pi/3. With numerical damping, gamma over 1/2, even 1/4 at
   !> impacts let a bar gain without bound.
   pure function impact_beta(scene) result(beta)
      type(scene_type), intent(in) :: scene
      real(wp) :: beta

      beta = scene%system%newmark%beta
      if (scene%settings%beta_choice == beta_given) beta = scene%settings%beta
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
      logical :: release(scene%rows%n), aim
      real(wp), dimension(scene%rows%n) :: gaps, rates   ! where the motion is
      integer :: status

      progress%dt = dt
      progress%t_end = motion%motion%t + dt
      progress%remaining = dt
      progress%beta = scene%system%newmark%beta
      allocate (progress%let_go(scene%rows%n), source=-dt, stat=status)
      call check_allocation(status)
      allocate (progress%stubborn(scene%rows%n), progress%ignored(scene%rows%n), &
            progress%returned(scene%rows%n), source=.false., stat=status)
      call check_allocation(status)
      if (scene%rows%moving) progress%returned = .true.
      call look_here(scene, motion, gaps, rates)
      aim = .true.
      call exchange_motions(scene%spare, next)
      do while (progress%remaining > time_tolerance*dt)
         if (aim) call rows_ahead(scene, motion, progress%remaining, error)
         if (allocated(error)) return
         aim = .true.
         progress%at_limit = progress%n_events >= scene%settings%max_events
         call smooth_span(scene, motion, progress, span, next, release, error)
         if (allocated(error)) return
         if (span%dt <= 0.0_wp) cycle
         span%gaps = gaps
         if (scene%rows%moving) span%rates = rates
         span%ignored = progress%ignored
         call find_hits(scene, motion, next, span, hits, error)
         if (allocated(error)) return
         if (hits%n == 0) then
            call take_span(scene, motion, next, span%dt, span, progress, error)
            if (allocated(error)) return
            if (any(release)) call release_rows(scene, motion, release, progress)
            call look_here(scene, motion, gaps, rates)
         else if (abs(progress%beta - impact_beta(scene)) > 0.0_wp) then
            ! an impact step has its own beta: solve it again from where it stands
            progress%beta = impact_beta(scene)
            aim = .false.
         else
            call go_through_impact(scene, motion, next, span, hits, progress, error)
            if (allocated(error)) return
            call look_here(scene, motion, gaps, rates)
         end if
      end do
      call exchange_motions(scene%spare, next)
      motion%motion%t = progress%t_end
      call settle_rows(scene, motion, dt, error)
   end subroutine advance

   !> Gaps, and of bodies that slide their rates, by rows at their places.
   subroutine look_here(scene, motion, gaps, rates)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(inout) :: gaps(:), rates(:)   !! (n_rows)

      gaps = row_gaps(scene%rows, motion%motion)
      if (scene%rows%moving) rates = row_rates(scene%rows, motion%motion)
   end subroutine look_here

   !> Takes a span of smooth motion.
   subroutine take_span(scene, motion, next, dt, span, progress, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(contact_motion_type), intent(inout) :: next   !! then where the motion was before
      real(wp), intent(in) :: dt                 !! from motion to next
      type(span_type), intent(in) :: span
      type(progress_type), intent(inout) :: progress
      type(error_type), allocatable, intent(out) :: error

      progress%remaining = progress%remaining - dt
      call exchange_motions(motion, next)
      call accept_span(scene, next, motion)
      call settle_span(scene, next, motion, span, progress, error)
   end subroutine take_span

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
      logical :: lost, slow(scene%rows%n)

      all_hits = hits
      lost = .false.
      call find_impact(scene, motion, next, span, all_hits, tau, at, error)
      if (allocated(error)) return
      if (scene%rows%moving) call refine_impact(scene, motion, span, all_hits, tau, at, lost, error)
      if (allocated(error)) return
      ! a gap that jumps, as from partner to partner, is never zero: not to be looked for again
      if (lost .and. tau < (1.0_wp - merge_time_tolerance)*span%dt) then
         progress%ignored(all_hits%row(:all_hits%n)) = .true.
      end if
      if (tau > 0.0_wp) call take_span(scene, motion, at, tau, span, progress, error)
      if (allocated(error) .or. lost) return
      progress%n_events = progress%n_events + 1
      call choose_rows(scene, motion, span, all_hits, tau, progress, impact)
      slow = abs(row_rates(scene%rows, motion%motion)) <= impact%rate_limit
      call apply_impact(scene, motion, impact, error)
      call note_return(motion, slow .or. scene%rows%moving, progress)
      motion%fresh = .true.
   end subroutine go_through_impact

   !> The earliest impact of the span with the rows as they are.
   subroutine find_impact(scene, motion, next, span, hits, tau, at, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion, next
      type(span_type), intent(in) :: span
      type(hits_type), intent(inout) :: hits     !! gets what was missed
      real(wp), intent(out) :: tau               !! from the start of the span
      type(contact_motion_type), intent(out) :: at
      type(error_type), allocatable, intent(out) :: error
      integer :: n

      do
         n = hits%n
         call locate_impact(scene, motion, next, span, hits, tau, at, error)
         if (allocated(error) .or. .not. tau > 0.0_wp) return
         call add_missed_hits(scene, motion, at, tau, span, hits, error)
         if (allocated(error) .or. hits%n == n) return
      end do
   end subroutine find_impact

   !> Places sliding rows where the impact was found and looks for it again, until it stays:
   !> Newton's method on the true gap, bisection where the rows at hand lead out of the bracket.
   !> Lost is an impact that is none: the span then ends without one.
   subroutine refine_impact(scene, motion, span, hits, tau, at, lost, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(span_type), intent(in) :: span
      type(hits_type), intent(inout) :: hits
      real(wp), intent(inout) :: tau
      type(contact_motion_type), intent(inout) :: at
      logical, intent(out) :: lost
      type(error_type), allocatable, intent(out) :: error
      logical :: suspect(scene%rows%n)
      real(wp) :: low, high, gap, overlap
      integer :: i

      low = 0.0_wp
      high = span%dt
      overlap = huge(overlap)
      suspect = .false.
      do i = 1, max_refinements
         suspect(hits%row(:hits%n)) = .true.
         call rows_at(scene, motion, at, span%dt)
         gap = minval(row_gaps(scene%rows, at%motion), mask=suspect)
         if (abs(gap) <= span%found_limit .and. (tau > 0.0_wp .or. i > 1)) exit
         if (gap < 0.0_wp) high = tau
         if (gap < 0.0_wp) overlap = -gap
         if (gap > 0.0_wp) low = tau
         if (high - low <= time_tolerance*span%dt) exit
         call look_again(scene, motion, span, [low, high], hits, tau, at, error)
         if (allocated(error)) return
      end do
      lost = gap > span%gap_limit*(merge_gap_tolerance/gap_tolerance)
      if (lost .and. overlap <= small_jump*scene%geometry%size) then
         lost = .false.
         tau = high
      end if
      if (.not. tau > 0.0_wp) return
      call advance_smoothly(scene, motion, tau, span%beta, at, error, span%held)
      if (.not. allocated(error) .and. tau >= high) call rows_at(scene, motion, at, span%dt)
   end subroutine refine_impact

   !> The earliest impact by the rows as they have been placed now, in a bracket.
   subroutine look_again(scene, motion, span, bracket, hits, tau, at, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(span_type), intent(in) :: span
      real(wp), intent(in) :: bracket(2)
      type(hits_type), intent(inout) :: hits     !! as before where nothing is found
      real(wp), intent(inout) :: tau
      type(contact_motion_type), intent(inout) :: at
      type(error_type), allocatable, intent(out) :: error
      type(contact_motion_type) :: next
      type(hits_type) :: found
      real(wp) :: gaps(scene%rows%n)
      logical :: good

      call advance_smoothly(scene, motion, span%dt, span%beta, next, error, span%held)
      if (allocated(error)) return
      call find_hits(scene, motion, next, span, found, error)
      if (allocated(error)) return
      good = found%n > 0
      if (good) then
         hits = found
         call find_impact(scene, motion, next, span, hits, tau, at, error)
         if (allocated(error) .or. .not. tau > 0.0_wp) return
         gaps = row_gaps(scene%rows, at%motion)
         good = tau > bracket(1) .and. tau < bracket(2) .and. minval(abs(gaps(hits%row(:hits%n)))) &
               <= span%gap_limit*(merge_gap_tolerance/gap_tolerance)
      end if
      if (good) return
      tau = sum(bracket)/2.0_wp
      call advance_smoothly(scene, motion, tau, span%beta, at, error, span%held)
   end subroutine look_again

   !> The first state of a dynamic step.
   subroutine start(self, scene, motion, dt, error)
      class(transformation_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error

      call rows_here(scene, motion, dt)
      call find_first_contacts(scene, motion, dt, impact_beta(scene), error)
   end subroutine start

end module transformation
