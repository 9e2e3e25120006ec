!> Surfaces in the plane for the tests: closed ones, walked counterclockwise, and waves.
module surface_shapes
   use kinds, only: wp
   implicit none
   private

   public :: closed_polygon, curved_body, wave

   real(wp), parameter :: pi = acos(-1.0_wp)

contains

   !> The straight edges between corners, the last one back to the first.
   pure subroutine closed_polygon(corner, x, edges)
      real(wp), intent(in) :: corner(:, :)       !! (2, n) counterclockwise
      real(wp), allocatable, intent(out) :: x(:, :)
      integer, allocatable, intent(out) :: edges(:, :)
      integer :: e, n

      n = size(corner, 2)
      allocate (x(3, n), source=0.0_wp)
      allocate (edges(3, n))
      x(1:2, :) = corner
      do e = 1, n
         edges(:, e) = [e, modulo(e, n) + 1, 0]
      end do
   end subroutine closed_polygon

   !> n three-node edges on a circle of radius 1, dented: r = 1 + depth cos(3 angle).
   pure subroutine curved_body(n, depth, x, edges)
      integer, intent(in) :: n
      real(wp), intent(in) :: depth
      real(wp), allocatable, intent(out) :: x(:, :)
      integer, allocatable, intent(out) :: edges(:, :)
      integer :: i
      real(wp) :: angle

      allocate (x(3, 2*n), source=0.0_wp)
      allocate (edges(3, n))
      do i = 1, 2*n
         angle = pi*real(i - 1, wp)/real(n, wp)
         x(1:2, i) = (1.0_wp + depth*cos(3.0_wp*angle))*[cos(angle), sin(angle)]
      end do
      do i = 1, n
         edges(:, i) = [2*i - 1, modulo(2*i, 2*n) + 1, 2*i]
      end do
   end subroutine curved_body

   !> n nodes of y = height + 0.05 sin(2 pi x) along x from 0 to length; the body is below.
   pure subroutine wave(n, length, height, x)
      integer, intent(in) :: n
      real(wp), intent(in) :: length, height
      real(wp), intent(out) :: x(3, n)
      integer :: i

      do i = 1, n
         x(1, i) = length*real(i - 1, wp)/real(n - 1, wp)
         x(2, i) = height + 0.05_wp*sin(2.0_wp*pi*x(1, i))
         x(3, i) = 0.0_wp
      end do
   end subroutine wave

end module surface_shapes
