!> The first impact in a span of smooth motion: looked for on quintics through the ends of the span,
!> then located on the path that is really taken, each trial a step solved anew, so that the state
!> at the impact has the order of the step and the gap is zero to round-off.
module fourth_order_hits
   use kinds, only: wp
   use errors, only: error_type
   use constraint_rows, only: row_gaps, row_rates, row_accelerations, may_hit
   use impact_scene, only: scene_type, contact_motion_type
   use impact_time, only: span_type, hits_type
   use fourth_order_step, only: smooth_step_type, step_smoothly
   use quintic_path, only: quintic_type, new_quintic, quintic_value, first_below, &
         interpolation_error
   implicit none
   private

   public :: find_first_impact

   !> Rows that may be hit, each with where the impact is looked for.
   type :: candidates_type
      real(wp), allocatable :: guess(:)          !! (n_rows) -1: is not hit
      real(wp), allocatable :: low(:)            !! (n_rows) the gap is open there
      real(wp), allocatable :: high(:)           !! (n_rows)
      logical, allocatable :: certain(:)         !! (n_rows) the row overlaps at `high`
      real(wp), allocatable :: threshold(:)      !! (n_rows) a smaller gap is an overlap
   end type candidates_type

   integer, parameter :: max_trials = 80
   !> An impact before this part of the span happens at once.
   real(wp), parameter :: at_once = 1.0e-13_wp
   !> A gap of this part of the limit of round-off is zero.
   real(wp), parameter :: found_part = 1.0e-2_wp
   !> The lowest point of a gap has been found when the next trial is nearer than this part of the
   !> span.
   real(wp), parameter :: dip_tolerance = 1.0e-3_wp
   !> Where a gap that starts at zero may open before it closes: parts of the time until then.
   integer, parameter :: n_looks = 8

contains

   !> The first impact, none (`hits%n` zero), or one at once (`hits%high` zero); the step up to it.
   subroutine find_first_impact(scene, motion, ahead, span, hits, step, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(smooth_step_type), intent(in) :: ahead   !! over the span
      type(span_type), intent(in) :: span
      type(hits_type), intent(out) :: hits
      type(smooth_step_type), intent(out) :: step
      type(error_type), allocatable, intent(out) :: error
      type(candidates_type) :: candidates
      integer :: row, i, n_located
      logical :: found, another

      call find_candidates(scene, motion, ahead, span, candidates)
      n_located = 0
      do
         if (.not. any(candidates%guess >= 0.0_wp)) exit
         row = minloc(candidates%guess, dim=1, mask=candidates%guess >= 0.0_wp)
         call locate(scene, motion, span, row, candidates, step, found, error)
         if (allocated(error)) return
         if (.not. found) then
            candidates%guess(row) = -1.0_wp
            cycle
         end if
         candidates%guess(row) = step%dt
         n_located = n_located + 1
         if (n_located > max_trials) exit
         call add_overlapped(scene, motion, span, row, step, candidates, another)
         if (.not. another) exit
      end do
      hits%row = pack([(i, i=1, scene%rows%n)], candidates%guess >= 0.0_wp .and. &
            candidates%guess <= step%dt)
      hits%n = size(hits%row)
      hits%high = candidates%guess(hits%row)
      hits%low = hits%high
   end subroutine find_first_impact

   !> Free rows that overlap at the end of the span or seem to dip under the wall inside it.
   subroutine find_candidates(scene, motion, ahead, span, candidates)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(smooth_step_type), intent(in) :: ahead
      type(span_type), intent(in) :: span
      type(candidates_type), intent(out) :: candidates
      real(wp), dimension(2, scene%rows%n) :: g, r, a
      type(quintic_type) :: path
      logical :: free(scene%rows%n)
      real(wp) :: one(scene%rows%n, 3)
      integer :: i

      call rows_of(scene, motion, one(:, 1), one(:, 2), one(:, 3))
      g(1, :) = one(:, 1)
      r(1, :) = one(:, 2)
      a(1, :) = one(:, 3)
      call rows_of(scene, ahead%to, one(:, 1), one(:, 2), one(:, 3))
      g(2, :) = one(:, 1)
      r(2, :) = one(:, 2)
      a(2, :) = one(:, 3)
      free = may_hit(scene%rows) .and. .not. motion%touching
      candidates%threshold = min(g(1, :), 0.0_wp) - span%gap_limit
      candidates%certain = g(2, :) < candidates%threshold
      candidates%guess = [(-1.0_wp, i=1, scene%rows%n)]
      candidates%low = 0.0_wp*g(1, :)
      candidates%high = candidates%low + span%dt
      do i = 1, scene%rows%n
         if (.not. free(i)) cycle
         path = new_quintic(span%dt, g(:, i), r(:, i), a(:, i))
         candidates%guess(i) = first_below(path, level_of(path, candidates%threshold(i)))
         if (candidates%guess(i) > 0.0_wp .and. g(1, i) <= span%gap_limit) then
            call start_open(path, span, candidates%guess(i), candidates%low(i))
         end if
      end do
   end subroutine find_candidates

   subroutine rows_of(scene, motion, g, r, a)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(out) :: g(:), r(:), a(:)  !! (n_rows) gaps, rates, accelerations

      g = row_gaps(scene%rows, motion%motion)
      r = row_rates(scene%rows, motion%motion)
      a = row_accelerations(scene%rows, motion%motion%a)
   end subroutine rows_of

   !> Where a path counts as an overlap to be looked at: a dip of an open gap so near to the wall as
   !> the quintic may be off is.
   pure real(wp) function level_of(path, threshold)
      type(quintic_type), intent(in) :: path
      real(wp), intent(in) :: threshold
      real(wp) :: margin

      level_of = threshold
      margin = interpolation_error(path)
      if (min(path%b(0), path%b(5)) > 2.0_wp*margin) level_of = threshold + margin
   end function level_of

   !> A row at the wall: where it is open before it closes; one that is never so is hit at once.
   pure subroutine start_open(path, span, guess, low)
      type(quintic_type), intent(in) :: path
      type(span_type), intent(in) :: span
      real(wp), intent(inout) :: guess
      real(wp), intent(out) :: low
      real(wp) :: gaps(n_looks), x(n_looks)
      integer :: i, best

      do i = 1, n_looks
         x(i) = guess*real(i, wp)/real(n_looks + 1, wp)
         gaps(i) = quintic_value(path, x(i))
      end do
      best = maxloc(gaps, dim=1)
      low = x(best)
      if (gaps(best) > span%gap_limit) return
      low = 0.0_wp
      if (path%b(1) - path%b(0) <= span%dt*span%rate_limit) guess = 0.0_wp
   end subroutine start_open

   !> The time at which a row is hit, near its guess: the first zero of the gap, of which rate and
   !> acceleration at the end of each trial are known, halving where that leads out of the bracket.
   !> A dip that stays above the wall is none.
   subroutine locate(scene, motion, span, row, candidates, step, found, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(span_type), intent(in) :: span
      integer, intent(in) :: row
      type(candidates_type), intent(inout) :: candidates
      type(smooth_step_type), intent(out) :: step
      logical, intent(out) :: found
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: at(3), x, next
      integer :: i

      x = candidates%guess(row)
      if (.not. x > 0.0_wp) then
         call look_at_once(scene, motion, span, row, candidates, step, found, error)
         return
      end if
      associate (low => candidates%low(row), high => candidates%high(row), &
            certain => candidates%certain(row))
         do i = 1, max_trials
            call try_row(scene, motion, x, row, step, at, error)
            if (allocated(error)) return
            next = x + time_to_wall(at(1), at(2), at(3))
            found = abs(at(1)) <= found_part*span%gap_limit .or. abs(next - x) <= spacing(span%dt)
            if (found) return
            if (at(1) < 0.0_wp) then
               high = x
               certain = .true.
            else
               low = x
            end if
            if (.not. certain) call look_for_dip(at, x, span, next)
            if (.not. (next > low .and. next < high)) then
               if (.not. certain) return
               ! where it was taken to be open it was not
               if (high - low <= spacing(span%dt)) low = 0.0_wp
               if (high <= at_once*span%dt) exit
               next = (low + high)/2.0_wp
            end if
            x = next
         end do
         found = certain
         if (.not. found) return
         if (high > at_once*span%dt) then
            call step_smoothly(scene, motion, high, step, error)
         else
            call stay(motion, step)
         end if
      end associate
   end subroutine locate

   !> A row at the wall that does not open: hit at once if it overlaps after a while, too.
   subroutine look_at_once(scene, motion, span, row, candidates, step, found, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(span_type), intent(in) :: span
      integer, intent(in) :: row
      type(candidates_type), intent(in) :: candidates
      type(smooth_step_type), intent(inout) :: step
      logical, intent(out) :: found
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: at(3)

      found = candidates%certain(row)
      if (.not. found) then
         call try_row(scene, motion, span%dt/2.0_wp, row, step, at, error)
         if (allocated(error)) return
         found = at(1) < candidates%threshold(row)
      end if
      call stay(motion, step)
   end subroutine look_at_once

   !> The step to an impact that happens at once.
   subroutine stay(motion, step)
      type(contact_motion_type), intent(in) :: motion
      type(smooth_step_type), intent(inout) :: step

      step%dt = 0.0_wp
      step%to = motion
   end subroutine stay

   !> Gap, rate and acceleration of a row after a part of the span.
   subroutine try_row(scene, motion, x, row, step, at, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(in) :: x
      integer, intent(in) :: row
      type(smooth_step_type), intent(out) :: step
      real(wp), intent(out) :: at(3)
      type(error_type), allocatable, intent(out) :: error
      real(wp), dimension(scene%rows%n) :: g, r, a

      at = 0.0_wp
      call step_smoothly(scene, motion, x, step, error)
      if (allocated(error)) return
      call rows_of(scene, step%to, g, r, a)
      at = [g(row), r(row), a(row)]
   end subroutine try_row

   !> When a gap g + r y + a y^2/2 goes through zero downwards; huge if it does not.
   pure real(wp) function time_to_wall(g, r, a)
      real(wp), intent(in) :: g, r, a
      real(wp) :: discriminant

      time_to_wall = huge(g)
      discriminant = r**2 - 2.0_wp*a*g
      if (discriminant < 0.0_wp) return
      if (r < 0.0_wp) then
         time_to_wall = 2.0_wp*g/(sqrt(discriminant) - r)
      else if (abs(a) > 0.0_wp) then
         time_to_wall = -(r + sqrt(discriminant))/a
      end if
   end function time_to_wall

   !> Where the gap stays open its lowest point is looked for; -1 once it has been found, or where
   !> the gap opens for good.
   pure subroutine look_for_dip(at, x, span, next)
      real(wp), intent(in) :: at(3)              !! gap, rate, acceleration at x
      real(wp), intent(in) :: x
      type(span_type), intent(in) :: span
      real(wp), intent(inout) :: next

      if (at(2)**2 - 2.0_wp*at(3)*at(1) >= 0.0_wp .and. at(3) > 0.0_wp) return
      if (at(2) < 0.0_wp .and. .not. at(3) > 0.0_wp) return
      next = -1.0_wp
      if (.not. at(3) > 0.0_wp) return
      if (abs(at(2)/at(3)) > dip_tolerance*span%dt) next = x - at(2)/at(3)
   end subroutine look_for_dip

   !> Other free rows that overlap at the impact located: they were hit before it.
   subroutine add_overlapped(scene, motion, span, row, step, candidates, another)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(span_type), intent(in) :: span
      integer, intent(in) :: row                 !! the one that is hit
      type(smooth_step_type), intent(in) :: step
      type(candidates_type), intent(inout) :: candidates
      logical, intent(out) :: another
      real(wp), dimension(scene%rows%n) :: g, r, a
      logical :: overlapped(scene%rows%n)
      integer :: i

      another = .false.
      if (.not. step%dt > 0.0_wp) return
      call rows_of(scene, step%to, g, r, a)
      overlapped = may_hit(scene%rows) .and. .not. motion%touching .and. &
            g < candidates%threshold - span%gap_limit
      overlapped(row) = .false.
      another = any(overlapped)
      do i = 1, scene%rows%n
         if (.not. overlapped(i)) cycle
         candidates%certain(i) = .true.
         candidates%high(i) = step%dt
         candidates%guess(i) = step%dt + time_to_wall(g(i), r(i), a(i))
         if (candidates%guess(i) > candidates%low(i) .and. candidates%guess(i) < step%dt) cycle
         candidates%guess(i) = (candidates%low(i) + step%dt)/2.0_wp
      end do
   end subroutine add_overlapped

end module fourth_order_hits
