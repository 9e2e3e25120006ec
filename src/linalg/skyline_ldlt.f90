!> Factorization A = L D Lt of a skyline matrix in place, and the solution by forward reduction and
!> back-substitution.
module skyline_ldlt
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use skyline_matrix, only: skyline_type, diagonal
   use column_ldlt, only: reduce_columns, solve_columns
   use panel_reduction, only: reduce_panels
   use panel_solution, only: solve_panels, solve_panels_many
   implicit none
   private

   public :: factorize, solve, solve_many, ldlt_report_type

   !> A pivot smaller than this part of the diagonal entry it came from counts as zero.
   real(wp), parameter :: pivot_tolerance = 1.0e-13_wp

   !> What the pivots tell.
   type :: ldlt_report_type
      integer :: zero_pivot = 0        !! first equation whose pivot vanished, 0 if none
      integer :: n_negative = 0        !! negative pivots: 0 for a positive definite matrix
   end type ldlt_report_type

contains

   !> Overwrites the matrix by its factors, L and D. Stops at a vanishing (or not finite) pivot and
   !> names the first equation that has one.
   subroutine factorize(matrix, report)
      type(skyline_type), intent(inout) :: matrix
      type(ldlt_report_type), intent(out) :: report
      real(wp), allocatable :: pivots(:)
      real(wp) :: alone
      integer :: j, zero_coupled

      if (matrix%layout%by_columns) then
         call reduce_columns(matrix%layout, matrix%values, pivot_tolerance, report%zero_pivot)
         if (report%zero_pivot == 0) report%n_negative = count(diagonal(matrix) < 0.0_wp)
         return
      end if
      call reduce_panels(matrix%layout, matrix%values, pivot_tolerance, pivots, zero_coupled)
      do j = 1, matrix%n
         if (matrix%layout%number(j) == 0) then
            alone = matrix%values(matrix%layout%diagonal_at(j))
            if (abs(alone) > 0.0_wp .and. abs(alone) <= huge(alone)) cycle
         else
            if (matrix%layout%number(j) /= zero_coupled) cycle
         end if
         report%zero_pivot = j
         return
      end do
      report%n_negative = count(diagonal(matrix) < 0.0_wp)
   end subroutine factorize

   !> Solves A x = b with the factors; b is overwritten by x.
   subroutine solve(factors, b)
      type(skyline_type), intent(in) :: factors   !! as `factorize` left it
      real(wp), intent(inout) :: b(factors%n)     !! right-hand side, then solution
      real(wp) :: x(factors%layout%n_coupled)

      associate (layout => factors%layout)
         if (layout%by_columns) then
            call solve_columns(layout, factors%values, b)
            return
         end if
         if (layout%n_coupled > 0) then
            x = pack(b, layout%number > 0)
            call solve_panels(layout, factors%values, x)
         end if
         b = b/factors%values(layout%diagonal_at)
         if (layout%n_coupled > 0) b = unpack(x, layout%number > 0, b)
      end associate
   end subroutine solve

   !> Solves A x = b for several right-hand sides at once.
   subroutine solve_many(factors, b)
      type(skyline_type), intent(in) :: factors   !! as `factorize` left it
      real(wp), intent(inout) :: b(:, :)          !! (n, n_sides)
      real(wp), allocatable :: x(:, :)
      integer :: k, status

      if (factors%layout%by_columns) then
         do k = 1, size(b, 2)
            call solve_columns(factors%layout, factors%values, b(:, k))
         end do
         return
      end if
      associate (layout => factors%layout)
         allocate (x(layout%n_coupled, size(b, 2)), stat=status)
         call check_allocation(status)
         do k = 1, size(b, 2)
            if (layout%n_coupled > 0) x(:, k) = pack(b(:, k), layout%number > 0)
         end do
         call solve_panels_many(layout, factors%values, size(b, 2), x)
         do k = 1, size(b, 2)
            b(:, k) = b(:, k)/factors%values(layout%diagonal_at)
            b(:, k) = unpack(x(:, k), layout%number > 0, b(:, k))
         end do
      end associate
   end subroutine solve_many

end module skyline_ldlt
