!> Values at the points of a solid carried to its nodes.
module point_fit
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use quadrature, only: rule_type
   use topology, only: quad8, count_nodes, node_coordinates, same_corners, shape_functions
   implicit none
   private

   public :: point_extrapolation

contains

   !> Least squares fit by the shape functions that the points can carry: constant through 1 point,
   !> linear through 3, bilinear through 4 (these pass through the points), those of the eight-node
   !> quadrilateral through 9.
   pure function point_extrapolation(topology, rule) result(matrix)
      integer, intent(in) :: topology
      type(rule_type), intent(in) :: rule
      real(wp) :: matrix(count_nodes(topology), rule%n)
      real(wp), allocatable :: at_points(:, :), at_nodes(:, :)
      real(wp) :: xi(2, count_nodes(topology))
      integer :: basis, i, status

      matrix = 1.0_wp
      if (rule%n == 1) return
      basis = merge(quad8, same_corners(topology), rule%n == 9)
      xi = node_coordinates(topology)
      allocate (at_points(rule%n, count_nodes(basis)), at_nodes(size(xi, 2), count_nodes(basis)), &
            stat=status)
      call check_allocation(status)
      do i = 1, rule%n
         at_points(i, :) = shape_functions(basis, rule%point(:, i))
      end do
      do i = 1, size(xi, 2)
         at_nodes(i, :) = shape_functions(basis, xi(:, i))
      end do
      matrix = matmul(at_nodes, solved(matmul(transpose(at_points), at_points), &
            transpose(at_points)))
   end function point_extrapolation

   !> a x = b for a small symmetric positive definite a, by elimination without exchanges.
   pure function solved(a, b) result(x)
      real(wp), intent(in) :: a(:, :)           !! (n, n)
      real(wp), intent(in) :: b(:, :)           !! (n, m)
      real(wp) :: x(size(b, 1), size(b, 2))
      real(wp) :: work(size(a, 1), size(a, 2)), factor
      integer :: i, j

      work = a
      x = b
      do j = 1, size(a, 1)
         x(j, :) = x(j, :)/work(j, j)
         work(j, :) = work(j, :)/work(j, j)
         do i = 1, size(a, 1)
            if (i == j) cycle
            factor = work(i, j)
            x(i, :) = x(i, :) - factor*x(j, :)
            work(i, :) = work(i, :) - factor*work(j, :)
         end do
      end do
   end function solved

end module point_fit
