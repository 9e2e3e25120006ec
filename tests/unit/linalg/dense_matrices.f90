!> Dense counterparts of what the program does sparsely: skylines as full matrices, LAPACK's
!> solution and eigenvalues.
module dense_matrices
   use kinds, only: wp
   use blas_interfaces, only: dgesv, dsygv
   use skyline_matrix, only: skyline_type
   implicit none
   private

   public :: as_dense, factors_product, dense_solution, eigenvalues

contains

   !> A skyline matrix in full.
   function as_dense(matrix) result(a)
      type(skyline_type), intent(in) :: matrix
      real(wp) :: a(matrix%n, matrix%n)
      integer :: i, j

      do j = 1, matrix%n
         do i = 1, matrix%n
            a(i, j) = matrix%entry(i, j)
         end do
      end do
   end function as_dense

   !> L D Lt from the factors of a skyline matrix.
   function factors_product(factors) result(a)
      type(skyline_type), intent(in) :: factors
      real(wp) :: a(factors%n, factors%n)
      real(wp) :: l(factors%n, factors%n), scaled(factors%n, factors%n)
      integer :: i, j

      l = as_dense(factors)
      scaled = 0.0_wp
      do j = 1, factors%n
         do i = 1, j - 1
            l(i, j) = 0.0_wp
         end do
         scaled(j:, j) = l(j:, j)*l(j, j)
         scaled(j, j) = l(j, j)
         l(j, j) = 1.0_wp
      end do
      a = matmul(scaled, transpose(l))
   end function factors_product

   !> x of A x = b by LAPACK's pivoted LU.
   function dense_solution(a, b) result(x)
      real(wp), intent(in) :: a(:, :), b(:)
      real(wp) :: x(size(b))
      real(wp) :: lu(size(b), size(b)), columns(size(b), 1)
      integer :: pivots(size(b)), info

      lu = a
      columns(:, 1) = b
      call dgesv(size(b), 1, lu, size(b), pivots, columns, size(b), info)
      x = columns(:, 1)
      if (info /= 0) x = huge(x)
   end function dense_solution

   !> All lambda of K x = lambda M x, ascending.
   function eigenvalues(k, m) result(lambda)
      real(wp), intent(in) :: k(:, :), m(:, :)
      real(wp) :: lambda(size(k, 1))
      real(wp) :: a(size(k, 1), size(k, 1)), b(size(k, 1), size(k, 1)), work(8*size(k, 1) + 1)
      integer :: n, info

      n = size(k, 1)
      a = k
      b = m
      call dsygv(1, 'N', 'U', n, a, n, b, n, lambda, work, size(work), info)
      if (info /= 0) lambda = -huge(lambda)
   end function eigenvalues

end module dense_matrices
