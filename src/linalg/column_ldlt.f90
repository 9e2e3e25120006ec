!> Factors L D Lt, solution and product of a skyline matrix that is stored by columns, by Crout's
!> method: for columns so short that panels do not pay.
module column_ldlt
   use kinds, only: wp, int64
   use blas_interfaces, only: ddot, daxpy
   use panel_layout, only: panel_layout_type
   implicit none
   private

   public :: reduce_columns, solve_columns, multiply_columns

contains

   !> Overwrites the matrix by its factors: L above the diagonal, D on it. Stops at the first
   !> vanishing (or not finite) pivot and names its equation.
   pure subroutine reduce_columns(layout, values, tolerance, zero_pivot)
      type(panel_layout_type), intent(in) :: layout
      real(wp), intent(inout) :: values(layout%n_entries)
      real(wp), intent(in) :: tolerance          !! of the pivots as a part of the diagonal
      integer, intent(out) :: zero_pivot
      integer :: j
      real(wp) :: original, pivot

      zero_pivot = 0
      do j = 1, layout%n
         original = abs(values(layout%diagonal_at(j)))
         if (layout%top(j) < j) call reduce_column(layout, values, j)
         pivot = values(layout%diagonal_at(j))
         if (abs(pivot) > tolerance*original .and. abs(pivot) <= huge(pivot)) cycle
         zero_pivot = j
         return
      end do
   end subroutine reduce_columns

   !> Turns column j into its part of Lt and its pivot.
   pure subroutine reduce_column(layout, values, j)
      type(panel_layout_type), intent(in) :: layout
      real(wp), intent(inout) :: values(layout%n_entries)
      integer, intent(in) :: j
      integer :: i, top, common
      integer(int64) :: base_i, base_j
      real(wp) :: u, l

      top = layout%top(j)
      base_j = layout%diagonal_at(j) - j
      do i = top + 1, j - 1
         common = max(top, layout%top(i))
         if (common >= i) cycle
         base_i = layout%diagonal_at(i) - i
         values(base_j + i) = values(base_j + i) &
               - ddot(i - common, values(base_i + common), 1, values(base_j + common), 1)
      end do
      do i = top, j - 1
         u = values(base_j + i)
         l = u/values(layout%diagonal_at(i))
         values(base_j + i) = l
         values(base_j + j) = values(base_j + j) - l*u
      end do
   end subroutine reduce_column

   !> Solves A x = b with the factors; b is overwritten by x.
   pure subroutine solve_columns(layout, values, b)
      type(panel_layout_type), intent(in) :: layout
      real(wp), intent(in) :: values(layout%n_entries)
      real(wp), intent(inout) :: b(layout%n)
      integer :: j, top
      integer(int64) :: address

      do j = 1, layout%n
         top = layout%top(j)
         if (top == j) cycle
         address = layout%diagonal_at(j) - (j - top)
         b(j) = b(j) - ddot(j - top, values(address), 1, b(top), 1)
      end do
      do j = 1, layout%n
         b(j) = b(j)/values(layout%diagonal_at(j))
      end do
      do j = layout%n, 1, -1
         top = layout%top(j)
         if (top == j) cycle
         address = layout%diagonal_at(j) - (j - top)
         call daxpy(j - top, -b(j), values(address), 1, b(top), 1)
      end do
   end subroutine solve_columns

   !> A x.
   pure subroutine multiply_columns(layout, values, x, y)
      type(panel_layout_type), intent(in) :: layout
      real(wp), intent(in) :: values(layout%n_entries), x(layout%n)
      real(wp), intent(out) :: y(layout%n)
      integer :: j, top
      integer(int64) :: address

      do j = 1, layout%n
         top = layout%top(j)
         address = layout%diagonal_at(j) - (j - top)
         y(j) = values(layout%diagonal_at(j))*x(j)
         if (top == j) cycle
         y(j) = y(j) + ddot(j - top, values(address), 1, x(top), 1)
         call daxpy(j - top, x(j), values(address), 1, y(top), 1)
      end do
   end subroutine multiply_columns

end module column_ldlt
