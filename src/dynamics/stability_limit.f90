!> Up to which frequency times step Newmark's rule with the damping of Hilber, Hughes and Taylor is
!> stable.
module stability_limit
   use kinds, only: wp
   use motion_state, only: newmark_type
   implicit none
   private

   public :: stable_frequency

contains

   !> Largest omega h at which implicit motion without damping does not grow, huge if all are
   !> stable; damping never lowers it. With W = (omega h)^2, g = 2 gamma - 1, b = 4 beta - 2 gamma
   !> and s = 1 + 2 alpha an amplification (1 + z)/(1 - z) obeys
   !>     (4 + W b s) z^3 + (4 + W (b + g s)) z^2 + W (g + s) z + W = 0,
   !> which by Hurwitz has no growing root while none of these is negative:
   !>     4 + W b s,   4 + W (b + g s),   4 (g + 2 alpha) + W g (b + s (g + s)).
   pure function stable_frequency(newmark) result(limit)
      type(newmark_type), intent(in) :: newmark
      real(wp) :: limit
      real(wp) :: b, g, s, start(3), slope(3), square
      real(wp), parameter :: round_off = 1.0e-14_wp
      integer :: i

      g = 2.0_wp*newmark%gamma - 1.0_wp
      b = 4.0_wp*newmark%beta - 2.0_wp*newmark%gamma
      s = 1.0_wp + 2.0_wp*newmark%alpha
      start = 4.0_wp*[1.0_wp, 1.0_wp, g + 2.0_wp*newmark%alpha]
      slope = [b*s, b + g*s, g*(b + s*(g + s))]
      square = huge(square)
      if (start(3) < -round_off) square = 0.0_wp
      do i = 1, 3
         if (slope(i) < -round_off) square = min(square, max(start(i), 0.0_wp)/(-slope(i)))
      end do
      limit = huge(limit)
      if (square < huge(square)) limit = sqrt(square)
   end function stable_frequency

end module stability_limit
