!> Detection of hits: the gap along a step, g0 + r0 x + b x^2 + c x^3. A Newmark step of length x
!> from a given state has d(x) = d + x v + x^2/2 a0 + beta x^2 (a1(x) - a0) with a1(x) - a0 nearly
!> proportional to x, so this cubic follows the re-solved path and is exact at both ends.
module gap_path
   use kinds, only: wp
   implicit none
   private

   public :: path_type, new_path, path_value, find_dip, find_rise

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
