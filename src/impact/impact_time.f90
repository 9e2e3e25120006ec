!> When the next impact happens: hits found on the cubic gap paths of a step, and the earliest time
!> located on the path that is really taken, each trial a step solved anew.
module impact_time
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use constraint_rows, only: row_gaps, row_rates, row_accelerations, may_hit, far_gap
   use impact_scene, only: scene_type, contact_motion_type
   use constrained_step, only: advance_smoothly
   use gap_path, only: path_type, new_path, path_value, find_dip, find_rise
   implicit none
   private

   public :: span_type, hits_type, find_hits, locate_impact, add_missed_hits

   !> A step of smooth motion that an impact may cut short.
   type :: span_type
      real(wp) :: dt = 0.0_wp
      real(wp) :: beta = 0.25_wp
      logical, allocatable :: held(:)        !! (n_rows) rows held bilaterally in every trial
      real(wp), allocatable :: gaps(:)       !! (n_rows) at the start, by rows at their places there
      real(wp), allocatable :: rates(:)      !! (n_rows) gap rates there, likewise
      logical, allocatable :: ignored(:)     !! (n_rows) rows that are not hit in this step
      real(wp) :: gap_limit = 0.0_wp         !! smaller gaps are round-off
      real(wp) :: found_limit = 0.0_wp       !! smaller gaps are near enough to an impact
      real(wp) :: rate_limit = 0.0_wp        !! smaller gap rates are round-off
   end type span_type

   !> Rows that are hit, each with a bracket: gap positive at `low`, negative at `high`; both zero
   !> for
   !> a row that is hit at once.
   type :: hits_type
      integer :: n = 0
      integer, allocatable :: row(:)
      real(wp), allocatable :: low(:), high(:)
   end type hits_type

   !> Bracket of the search for the first root of the smallest gap.
   type :: bracket_type
      real(wp) :: low = 0.0_wp, high = 0.0_wp
      real(wp) :: gap_low = 0.0_wp, gap_high = 0.0_wp
      integer :: side = 0
   end type bracket_type

   integer, parameter :: max_trials = 100
   integer, parameter :: max_halvings = 40
   !> A bracket below this part of the span cannot be shrunk further.
   real(wp), parameter :: width_limit = 4.0e-16_wp

contains

   !> Free rows that overlap at the end of the span or dip under the wall inside it.
   subroutine find_hits(scene, from, to, span, hits, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from, to
      type(span_type), intent(in) :: span
      type(hits_type), intent(out) :: hits
      type(error_type), allocatable, intent(out) :: error
      real(wp), dimension(scene%rows%n) :: g0, r0, a0, g1
      logical :: free(scene%rows%n)
      type(path_type) :: path
      real(wp) :: bracket(2)
      integer :: i, status

      allocate (hits%row(scene%rows%n), hits%low(scene%rows%n), hits%high(scene%rows%n), &
            stat=status)
      call check_allocation(status)
      g0 = start_gaps(scene, from, span)
      r0 = row_rates(scene%rows, from%motion)
      a0 = row_accelerations(scene%rows, from%motion%a)
      g1 = row_gaps(scene%rows, to%motion)
      free = may_hit(scene%rows) .and. .not. from%touching
      if (allocated(span%ignored)) free = free .and. .not. span%ignored
      do i = 1, scene%rows%n
         if (.not. free(i)) cycle
         path = new_path(span%dt, g0(i), r0(i), a0(i), g1(i))
         call bracket_hit(scene, from, span, i, path, bracket, error)
         if (allocated(error)) return
         if (bracket(2) < 0.0_wp) cycle
         hits%n = hits%n + 1
         hits%row(hits%n) = i
         hits%low(hits%n) = bracket(1)
         hits%high(hits%n) = bracket(2)
      end do
   end subroutine find_hits

   !> Gaps at the start of the span; rows that are placed at its end see them on a tangent.
   function start_gaps(scene, from, span) result(gaps)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: from
      type(span_type), intent(in) :: span
      real(wp) :: gaps(scene%rows%n)

      gaps = row_gaps(scene%rows, from%motion)
      if (.not. scene%rows%moving) return
      where (span%gaps < far_gap/2.0_wp) gaps = span%gaps
   end function start_gaps

   !> Between which times a row is hit, negative if it is not. A row that starts slightly overlapped
   !> and opens is not.
   subroutine bracket_hit(scene, from, span, row, path, bracket, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      type(span_type), intent(in) :: span
      integer, intent(in) :: row
      type(path_type), intent(in) :: path
      real(wp), intent(out) :: bracket(2)
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: threshold, high, rise

      bracket = -1.0_wp
      high = span%dt
      threshold = min(path%g0, 0.0_wp) - span%gap_limit
      if (path_value(path, high) >= threshold) then
         high = find_dip(path)
         if (high < 0.0_wp) return
         if (path_value(path, high) >= threshold) return
         if (resolved_gap(scene, from, span, high, row, error) >= threshold) return
         if (allocated(error)) return
      end if
      bracket = [0.0_wp, high]
      if (path%g0 > span%gap_limit) return
      bracket = 0.0_wp
      if (path%r0 <= span%rate_limit .and. .not. leaves(scene, span, row)) return
      ! it leaves the wall first, and comes back
      rise = find_rise(path)
      if (rise < 0.0_wp .or. rise >= high) rise = high/2.0_wp
      bracket = [rise, high]
      call start_open(scene, from, span, row, bracket, error)
   end subroutine bracket_hit

   !> A row that opens where it is, though the row placed at the end of the span, maybe on the far
   !> side of a ring, says that it closes.
   pure function leaves(scene, span, row) result(opens)
      type(scene_type), intent(in) :: scene
      type(span_type), intent(in) :: span
      integer, intent(in) :: row
      logical :: opens

      opens = scene%rows%moving .and. allocated(span%rates)
      if (opens) opens = span%gaps(row) < far_gap/2.0_wp .and. span%rates(row) > span%rate_limit
   end function leaves

   !> The cubic only guesses where a row that leaves the wall turns back: halves the start of the
   !> bracket until the gap is open there on the path that is really taken. A row that is never
   !> open is at the wall at once.
   subroutine start_open(scene, from, span, row, bracket, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      type(span_type), intent(in) :: span
      integer, intent(in) :: row
      real(wp), intent(inout) :: bracket(2)
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, max_halvings
         if (resolved_gap(scene, from, span, bracket(1), row, error) > span%gap_limit) return
         if (allocated(error)) return
         bracket(1) = bracket(1)/2.0_wp
      end do
      bracket = 0.0_wp
   end subroutine start_open

   !> Gap of a row at the end of a step of length x.
   function resolved_gap(scene, from, span, x, row, error) result(gap)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      type(span_type), intent(in) :: span
      real(wp), intent(in) :: x
      integer, intent(in) :: row
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: gap
      type(contact_motion_type) :: trial
      real(wp) :: gaps(scene%rows%n)

      gap = 0.0_wp
      call advance_smoothly(scene, from, x, span%beta, trial, error, span%held)
      if (allocated(error)) return
      gaps = row_gaps(scene%rows, trial%motion)
      gap = gaps(row)
   end function resolved_gap

   !> Rows that overlap at the impact located: the cubic did not see them dip. They join the hits,
   !> to be located before it.
   subroutine add_missed_hits(scene, from, at, tau, span, hits, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      type(contact_motion_type), intent(in) :: at
      real(wp), intent(in) :: tau            !! time of `at` in the span
      type(span_type), intent(in) :: span
      type(hits_type), intent(inout) :: hits
      type(error_type), allocatable, intent(out) :: error
      real(wp), dimension(scene%rows%n) :: g0, gaps
      logical :: free(scene%rows%n)
      real(wp) :: bracket(2)
      integer :: i

      free = may_hit(scene%rows) .and. .not. from%touching
      if (allocated(span%ignored)) free = free .and. .not. span%ignored
      g0 = start_gaps(scene, from, span)
      gaps = row_gaps(scene%rows, at%motion)
      do i = 1, scene%rows%n
         if (.not. free(i) .or. any(hits%row(:hits%n) == i)) cycle
         if (gaps(i) >= min(g0(i), 0.0_wp) - 2.0_wp*span%gap_limit) cycle
         bracket = [0.0_wp, tau]
         if (g0(i) <= span%gap_limit) then
            bracket(1) = tau/2.0_wp
            call start_open(scene, from, span, i, bracket, error)
            if (allocated(error)) return
         end if
         hits%n = hits%n + 1
         hits%row(hits%n) = i
         hits%low(hits%n) = bracket(1)
         hits%high(hits%n) = bracket(2)
      end do
   end subroutine add_missed_hits

   !> The first time at which the smallest gap of the hit rows vanishes: regula falsi with the
   !> weights
   !> of Anderson and Bjorck, and a bisection whenever three trials have not shrunk the bracket to a
   !> quarter. The set of touching rows is frozen, so the path is continuous. `at` is the motion
   !> there, just before the jump.
   subroutine locate_impact(scene, from, to, span, hits, tau, at, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from, to
      type(span_type), intent(in) :: span
      type(hits_type), intent(in) :: hits
      real(wp), intent(out) :: tau           !! from the start of the span
      type(contact_motion_type), intent(out) :: at
      type(error_type), allocatable, intent(out) :: error
      type(contact_motion_type) :: trial
      type(bracket_type) :: bracket
      real(wp) :: x, gap, best, width
      integer :: i

      tau = 0.0_wp
      at = from
      if (any(.not. hits%high(:hits%n) > 0.0_wp)) return
      call open_bracket(scene, from, to, span, hits, bracket, at, error)
      if (allocated(error)) return
      tau = bracket%high
      best = abs(bracket%gap_high)
      width = bracket%high - bracket%low
      do i = 1, max_trials
         x = secant(bracket)
         if (modulo(i, 3) == 0) then
            if (bracket%high - bracket%low > width/4.0_wp) x = (bracket%low + bracket%high)/2.0_wp
            width = bracket%high - bracket%low
         end if
         call advance_smoothly(scene, from, x, span%beta, trial, error, span%held)
         if (allocated(error)) return
         gap = smallest_gap(scene, trial, span, hits, x)
         if (abs(gap) < best) then
            best = abs(gap)
            tau = x
            at = trial
         end if
         if (best <= span%found_limit) exit
         call tighten(bracket, x, gap)
         if (bracket%high - bracket%low <= width_limit*span%dt) exit
      end do
   end subroutine locate_impact

   !> The earliest end of the rows' brackets and their earliest start.
   subroutine open_bracket(scene, from, to, span, hits, bracket, at, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from, to
      type(span_type), intent(in) :: span
      type(hits_type), intent(in) :: hits
      type(bracket_type), intent(out) :: bracket
      type(contact_motion_type), intent(out) :: at     !! motion at the end of the bracket
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: g0(scene%rows%n)

      bracket%high = minval(hits%high(:hits%n))
      bracket%low = minval(hits%low(:hits%n))
      at = to
      if (bracket%high < span%dt) then
         call advance_smoothly(scene, from, bracket%high, span%beta, at, error, span%held)
         if (allocated(error)) return
      end if
      bracket%gap_high = smallest_gap(scene, at, span, hits, bracket%high)
      g0 = row_gaps(scene%rows, from%motion)
      bracket%gap_low = -bracket%gap_high
      if (.not. bracket%low > 0.0_wp) then
         bracket%gap_low = minval(g0(hits%row(:hits%n)), mask=.not. hits%low(:hits%n) > 0.0_wp)
      end if
   end subroutine open_bracket

   !> The smallest gap at x among the rows whose bracket has begun, or that overlap before it: their
   !> path dips more than once.
   function smallest_gap(scene, trial, span, hits, x) result(gap)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: trial
      type(span_type), intent(in) :: span
      type(hits_type), intent(in) :: hits
      real(wp), intent(in) :: x
      real(wp) :: gap
      real(wp) :: g(scene%rows%n)
      integer :: i

      g = row_gaps(scene%rows, trial%motion)
      gap = huge(gap)
      do i = 1, hits%n
         if (x >= hits%low(i) .or. g(hits%row(i)) < -span%gap_limit) gap = min(gap, g(hits%row(i)))
      end do
   end function smallest_gap

   !> Moves one end of the bracket to x; an end that stays loses weight by the rule of Anderson and
   !> Bjorck. No row in sight (a huge gap) counts as the far end's size.
   pure subroutine tighten(bracket, x, gap)
      type(bracket_type), intent(inout) :: bracket
      real(wp), intent(in) :: x, gap
      real(wp) :: seen

      seen = gap
      if (gap >= huge(gap)) seen = -bracket%gap_high
      if (seen > 0.0_wp) then
         if (bracket%side == 1) bracket%gap_high = bracket%gap_high*weight(seen, bracket%gap_low)
         bracket%low = x
         bracket%gap_low = seen
         bracket%side = 1
      else
         if (bracket%side == -1) bracket%gap_low = bracket%gap_low*weight(seen, bracket%gap_high)
         bracket%high = x
         bracket%gap_high = seen
         bracket%side = -1
      end if
   end subroutine tighten

   !> 1 - new/old where that is positive, else a half.
   pure function weight(new, old) result(factor)
      real(wp), intent(in) :: new, old
      real(wp) :: factor

      factor = 0.5_wp
      if (abs(new) < abs(old)) factor = 1.0_wp - new/old
      if (.not. factor > 0.0_wp) factor = 0.5_wp
   end function weight

   !> Where the straight line between the ends of the bracket crosses zero.
   pure function secant(bracket) result(x)
      type(bracket_type), intent(in) :: bracket
      real(wp) :: x

      x = (bracket%low + bracket%high)/2.0_wp
      if (.not. bracket%gap_low > bracket%gap_high) return
      x = bracket%low + (bracket%high - bracket%low)*bracket%gap_low &
            /(bracket%gap_low - bracket%gap_high)
      if (.not. (x > bracket%low .and. x < bracket%high)) x = (bracket%low + bracket%high)/2.0_wp
   end function secant

end module impact_time
