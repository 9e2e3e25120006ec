!> The gap of one row along a step: the quintic of Hermite through gap, rate and acceleration at
!> both ends, as a Bezier curve, whose control points bound it: where it first falls below a
!> threshold is found by halving, and no dip is missed.
module quintic_path
   use kinds, only: wp
   implicit none
   private

   public :: quintic_type, new_quintic, quintic_value, first_below, interpolation_error

   integer, parameter :: max_halvings = 45

   !> The curve over a step of length s.
   type :: quintic_type
      real(wp) :: s = 0.0_wp
      real(wp) :: b(0:5) = 0.0_wp                !! control points
   end type quintic_type

contains

   pure function new_quintic(s, g, r, a) result(path)
      real(wp), intent(in) :: s                  !! length of the step
      real(wp), intent(in) :: g(2), r(2), a(2)   !! gap, rate, acceleration at start and end
      type(quintic_type) :: path

      path%s = s
      path%b(0) = g(1)
      path%b(1) = g(1) + s*r(1)/5.0_wp
      path%b(2) = g(1) + 2.0_wp*s*r(1)/5.0_wp + s**2*a(1)/20.0_wp
      path%b(3) = g(2) - 2.0_wp*s*r(2)/5.0_wp + s**2*a(2)/20.0_wp
      path%b(4) = g(2) - s*r(2)/5.0_wp
      path%b(5) = g(2)
   end function new_quintic

   !> Gap at x, by de Casteljau.
   pure real(wp) function quintic_value(path, x)
      type(quintic_type), intent(in) :: path
      real(wp), intent(in) :: x
      real(wp) :: b(0:5), u
      integer :: k

      u = x/path%s
      b = path%b
      do k = 4, 0, -1
         b(0:k) = (1.0_wp - u)*b(0:k) + u*b(1:k + 1)
      end do
      quintic_value = b(0)
   end function quintic_value

   !> How far the quintic may be off in the middle: a part of its distance there from the cubic that
   !> does without the accelerations.
   pure real(wp) function interpolation_error(path)
      type(quintic_type), intent(in) :: path
      real(wp), parameter :: part = 0.01_wp
      real(wp) :: rates(2), cubic

      rates = 5.0_wp*[path%b(1) - path%b(0), path%b(5) - path%b(4)]
      cubic = (path%b(0) + path%b(5))/2.0_wp + (rates(1) - rates(2))/8.0_wp
      interpolation_error = part*abs(quintic_value(path, path%s/2.0_wp) - cubic)
   end function interpolation_error

   !> The first x at which the path is below the threshold, -1 if it never is.
   pure real(wp) function first_below(path, threshold)
      type(quintic_type), intent(in) :: path
      real(wp), intent(in) :: threshold

      first_below = search(path%b, threshold, 0.0_wp, path%s, max_halvings)
   end function first_below

   !> The same on a part of the curve, by halving it where its control points leave it open.
   pure recursive function search(b, threshold, from, to, halvings) result(x)
      real(wp), intent(in) :: b(0:5)
      real(wp), intent(in) :: threshold, from, to
      integer, intent(in) :: halvings
      real(wp) :: x
      real(wp) :: left(0:5), right(0:5), middle
      integer :: k

      x = -1.0_wp
      if (all(b >= threshold)) return
      x = from
      if (b(0) < threshold .or. halvings == 0) return
      right = b
      do k = 0, 5
         left(k) = right(0)
         right(0:4 - k) = (right(0:4 - k) + right(1:5 - k))/2.0_wp
      end do
      middle = (from + to)/2.0_wp
      x = search(left, threshold, from, middle, halvings - 1)
      if (x < 0.0_wp) x = search(right, threshold, middle, to, halvings - 1)
   end function search

end module quintic_path
