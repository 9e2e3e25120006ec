!> Detection of hits: the gap along a step, g0 + r0 x + b x^2 + c x^3. A Newmark step of length x
!> from a given state has d(x) = d + x v + x^2/2 a0 + beta x^2 (a1(x) - a0) with a1(x) - a0 nearly
!> proportional to x, so this cubic follows the re-solved path and is exact at both ends.
module gap_path
   use kinds, only: wp
   implicit none
   private

   public :: path_type, new_path, new_hermite_path, path_value, find_dip, find_rise, find_root

   !> Gap of one row over a step of length s.
   type :: path_type
      real(wp) :: s = 0.0_wp
      real(wp) :: g0 = 0.0_wp, r0 = 0.0_wp, b = 0.0_wp, c = 0.0_wp
   end type path_type

contains

   !> The cubic through gap, rate and acceleration at the start and the gap at the end.
   pure function new_path(s, g0, r0, a0, g1) result(path)
      real(wp), intent(in) :: s              !! length of the step
      real(wp), intent(in) :: g0, r0, a0     !! gap, its rate and acceleration at the start
      real(wp), intent(in) :: g1             !! gap at the end
      type(path_type) :: path

      path%s = s
      path%g0 = g0
      path%r0 = r0
      path%b = a0/2.0_wp
      path%c = (g1 - g0 - r0*s - path%b*s**2)/s**3
   end function new_path

   !> The cubic through gap and rate at both ends.
   pure function new_hermite_path(s, g, r) result(path)
      real(wp), intent(in) :: s              !! length of the step
      real(wp), intent(in) :: g(2), r(2)     !! gap and its rate at start and end
      type(path_type) :: path
      real(wp) :: mean

      mean = (g(2) - g(1))/s
      path%s = s
      path%g0 = g(1)
      path%r0 = r(1)
      path%b = (3.0_wp*mean - 2.0_wp*r(1) - r(2))/s
      path%c = (r(1) + r(2) - 2.0_wp*mean)/s**2
   end function new_hermite_path

   !> Where between low, with the gap open, and high, with an overlap, the gap is zero, to
   !> round-off: Newton's method, halving where it leaves the bracket.
   pure function find_root(path, low, high) result(x)
      type(path_type), intent(in) :: path
      real(wp), intent(in) :: low, high
      real(wp) :: x
      integer, parameter :: max_trials = 200
      real(wp) :: bracket(2), g, slope
      integer :: i

      bracket = [low, high]
      x = (low + high)/2.0_wp
      do i = 1, max_trials
         g = path_value(path, x)
         if (g > 0.0_wp) then
            bracket(1) = x
         else
            bracket(2) = x
         end if
         slope = path%r0 + x*(2.0_wp*path%b + 3.0_wp*x*path%c)
         if (abs(g) <= spacing(path%s)*abs(slope)) return
         x = (bracket(1) + bracket(2))/2.0_wp
         if (bracket(2) - bracket(1) <= spacing(path%s)) return
         if (.not. slope < 0.0_wp) cycle
         slope = (merge(bracket(1), bracket(2), g > 0.0_wp) - g/slope)
         if (slope > bracket(1) .and. slope < bracket(2)) x = slope
      end do
   end function find_root

   !> Gap at x.
   pure function path_value(path, x) result(g)
      type(path_type), intent(in) :: path
      real(wp), intent(in) :: x
      real(wp) :: g

      g = path%g0 + x*(path%r0 + x*(path%b + x*path%c))
   end function path_value

   !> Where inside the step the gap has a minimum; negative if nowhere.
   pure function find_dip(path) result(x)
      type(path_type), intent(in) :: path
      real(wp) :: x

      x = stationary_point(path, 1.0_wp)
   end function find_dip

   !> Where inside the step the gap has a maximum; negative if nowhere.
   pure function find_rise(path) result(x)
      type(path_type), intent(in) :: path
      real(wp) :: x

      x = stationary_point(path, -1.0_wp)
   end function find_rise

   !> The stationary point of the given sign of curvature inside the step, else -1. A cubic has at
   !> most one of each.
   pure function stationary_point(path, curvature_sign) result(x)
      type(path_type), intent(in) :: path
      real(wp), intent(in) :: curvature_sign
      real(wp) :: x
      real(wp) :: discriminant, w, candidate(2)
      integer :: i

      x = -1.0_wp
      discriminant = path%b**2 - 3.0_wp*path%c*path%r0
      if (.not. discriminant > 0.0_wp) return
      w = -(path%b + sign(sqrt(discriminant), path%b))
      candidate = -1.0_wp
      if (abs(path%r0) < abs(w)*path%s) candidate(1) = path%r0/w
      if (abs(w) < abs(3.0_wp*path%c)*path%s) candidate(2) = w/(3.0_wp*path%c)
      do i = 1, 2
         if (.not. (candidate(i) > 0.0_wp .and. candidate(i) < path%s)) cycle
         if (curvature_sign*(path%b + 3.0_wp*path%c*candidate(i)) > 0.0_wp) x = candidate(i)
      end do
   end function stationary_point

end module gap_path
