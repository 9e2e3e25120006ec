!> Factorization A = L D Lt of a skyline matrix in place, by Crout's active columns, and the
!> solution by forward reduction and back-substitution.
module skyline_ldlt
   use kinds, only: wp, int64
   use skyline_matrix, only: skyline_type
   use blas_interfaces, only: ddot, daxpy
   implicit none
   private

   public :: factorize, solve, ldlt_report_type

   !> A pivot smaller than this part of the diagonal entry it came from counts as zero.
   real(wp), parameter :: pivot_tolerance = 1.0e-13_wp

   !> What the pivots tell.
   type :: ldlt_report_type
      integer :: zero_pivot = 0        !! first equation whose pivot vanished, 0 if none
      integer :: n_negative = 0        !! negative pivots: 0 for a positive definite matrix
   end type ldlt_report_type

contains

   !> Overwrites the matrix by its factors: L above the diagonal, D on it. Stops at the first
   !> vanishing (or not finite) pivot and names its equation.
   pure subroutine factorize(matrix, report)
      type(skyline_type), intent(inout) :: matrix
      type(ldlt_report_type), intent(out) :: report
      integer :: j
      real(wp) :: original, pivot

      do j = 1, matrix%n
         original = abs(matrix%values(matrix%last(j)))
         call reduce_column(matrix, j)
         pivot = matrix%values(matrix%last(j))
         if (.not. abs(pivot) > pivot_tolerance*original .or. abs(pivot) > huge(pivot)) then
            report%zero_pivot = j
            return
         end if
         if (pivot < 0.0_wp) report%n_negative = report%n_negative + 1
      end do
   end subroutine factorize

   !> Turns column j into its part of Lt and its pivot.
   pure subroutine reduce_column(matrix, j)
      type(skyline_type), intent(inout) :: matrix
      integer, intent(in) :: j
      integer :: i, top, common
      integer(int64) :: base_i, base_j
      real(wp) :: u, l

      top = matrix%first_row(j)
      base_j = matrix%last(j) - j
      do i = top + 1, j - 1
         common = max(top, matrix%first_row(i))
         if (common >= i) cycle
         base_i = matrix%last(i) - i
         matrix%values(base_j + i) = matrix%values(base_j + i) &
               - ddot(i - common, matrix%values(base_i + common), 1, matrix%values(base_j &
               + common), 1)
      end do
      do i = top, j - 1
         u = matrix%values(base_j + i)
         l = u/matrix%values(matrix%last(i))
         matrix%values(base_j + i) = l
         matrix%values(base_j + j) = matrix%values(base_j + j) - l*u
      end do
   end subroutine reduce_column

   !> Solves A x = b with the factors; b is overwritten by x.
   pure subroutine solve(factors, b)
      type(skyline_type), intent(in) :: factors   !! as `factorize` left it
      real(wp), intent(inout) :: b(factors%n)     !! right-hand side, then solution
      integer :: j, top
      integer(int64) :: address

      do j = 1, factors%n
         top = factors%first_row(j)
         if (top == j) cycle
         address = factors%last(j) - (j - top)
         b(j) = b(j) - ddot(j - top, factors%values(address), 1, b(top), 1)
      end do
      do j = 1, factors%n
         b(j) = b(j)/factors%values(factors%last(j))
      end do
      do j = factors%n, 1, -1
         top = factors%first_row(j)
         if (top == j) cycle
         address = factors%last(j) - (j - top)
         call daxpy(j - top, -b(j), factors%values(address), 1, b(top), 1)
      end do
   end subroutine solve

end module skyline_ldlt
