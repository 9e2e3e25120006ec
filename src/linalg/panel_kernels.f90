!> Dense arithmetic on the panels of a skyline matrix. A panel is an array a(width, n_rows): first
!> its square block on the diagonal, whose entries a(i, j), i > j, mean nothing, then its tail, the
!> rows below its columns.
module panel_kernels
   use kinds, only: wp, int64
   use panel_layout, only: panel_layout_type
   use blas_interfaces, only: dgemm, dgemv
   implicit none
   private

   public :: multiply_panel, subtract_product, reduce_block, scale_tail
   public :: gather_tail, subtract_at_tail, tail_times, tail_transposed_times
   public :: solve_block, solve_block_transposed

   !> Products with fewer terms are not worth a call.
   integer, parameter :: worth_a_call = 256
   integer, parameter :: narrow = 8

contains

   !> Adds the product of a panel, its part above the diagonal too but not the diagonal, and x to y.
   pure subroutine multiply_panel(layout, p, values, x, y)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: p
      real(wp), intent(in) :: values(:), x(:)
      real(wp), intent(inout) :: y(:)
      integer :: r, i, c, w, j
      integer(int64) :: at

      w = layout%width(p)
      j = layout%column(p)
      do r = layout%first_run(p), layout%first_run(p + 1) - 2
         at = layout%at(p) + int(layout%run_place(r), int64)*w
         do i = layout%run_row(r), layout%run_row(r) + layout%run_place(r + 1) &
               - layout%run_place(r) - 1
            c = min(w, i - j)
            y(i) = y(i) + dot_product(values(at:at + c - 1), x(j:j + c - 1))
            y(j:j + c - 1) = y(j:j + c - 1) + x(i)*values(at:at + c - 1)
            at = at + w
         end do
      end do
   end subroutine multiply_panel

   !> C = C - Bt A.
   pure subroutine subtract_product(m, n, k, b, a, c, ldc)
      integer, intent(in) :: m, n, k, ldc
      real(wp), intent(in) :: b(k, m), a(k, n)
      real(wp), intent(inout) :: c(ldc, n)
      integer :: i, j

      if (m*n*k >= worth_a_call .or. n >= worth_a_call) then
         call dgemm('T', 'N', m, n, k, -1.0_wp, b, k, a, k, 1.0_wp, c, ldc)
         return
      end if
      do j = 1, n
         do i = 1, m
            c(i, j) = c(i, j) - dot_product(b(:, i), a(:, j))
         end do
      end do
   end subroutine subtract_product

   !> Factorizes the block on the diagonal: D on its diagonal, a(i, j) = L(j, i) for i < j. `failed`
   !> is the first column whose pivot vanishes against the diagonal entry it came from, or 0.
   pure subroutine reduce_block(w, a, original, tolerance, pivots, failed)
      integer, intent(in) :: w
      real(wp), intent(inout) :: a(w, w)
      real(wp), intent(in) :: original(w), tolerance
      real(wp), intent(out) :: pivots(w)
      integer, intent(out) :: failed
      real(wp) :: column(w)
      integer :: i, k

      failed = 0
      do k = 1, w
         pivots(k) = a(k, k)
         if (.not. abs(pivots(k)) > tolerance*abs(original(k)) .or. abs(pivots(k)) &
               > huge(1.0_wp)) then
            failed = k
            return
         end if
         column(k + 1:) = a(k, k + 1:)
         do i = k + 1, w
            a(k + 1:i, i) = a(k + 1:i, i) - column(i)/pivots(k)*column(k + 1:i)
            a(k, i) = column(i)/pivots(k)
         end do
      end do
   end subroutine reduce_block

   !> Divides the columns of a tail by their pivots: exactly in narrow panels, where a quotient of
   !> two equal numbers must be one for the pivot of a floating chain to vanish.
   pure subroutine scale_tail(w, n, a, pivots)
      integer, intent(in) :: w, n
      real(wp), intent(inout) :: a(w, n)
      real(wp), intent(in) :: pivots(w)
      real(wp) :: factor(w)
      integer :: i

      if (w <= narrow) then
         do i = 1, n
            a(:, i) = a(:, i)/pivots
         end do
         return
      end if
      factor = 1.0_wp/pivots
      do i = 1, n
         a(:, i) = a(:, i)*factor
      end do
   end subroutine scale_tail

   !> The rows of x that the tail of a panel has, from place `first` to place `last`.
   pure subroutine gather_tail(layout, p, first, last, x, z)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: p, first, last      !! the rows of a panel count from 0
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: z(first:)
      integer :: r, from, to

      do r = layout%first_run(p), layout%first_run(p + 1) - 2
         from = max(first, layout%run_place(r))
         to = min(last, layout%run_place(r + 1) - 1)
         if (from > last) exit
         associate (shift => layout%run_row(r) - layout%run_place(r))
            z(from:to) = x(from + shift:to + shift)
         end associate
      end do
   end subroutine gather_tail

   !> Subtracts z from the rows of x that the tail of a panel has.
   pure subroutine subtract_at_tail(layout, p, first, last, z, x)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: p, first, last
      real(wp), intent(in) :: z(first:)
      real(wp), intent(inout) :: x(:)
      integer :: r, from, to

      do r = layout%first_run(p), layout%first_run(p + 1) - 2
         from = max(first, layout%run_place(r))
         to = min(last, layout%run_place(r + 1) - 1)
         if (from > last) exit
         associate (shift => layout%run_row(r) - layout%run_place(r))
            x(from + shift:to + shift) = x(from + shift:to + shift) - z(from:to)
         end associate
      end do
   end subroutine subtract_at_tail

   !> y = At x.
   pure subroutine tail_times(w, n, a, x, y)
      integer, intent(in) :: w, n
      real(wp), intent(in) :: a(w, n), x(w)
      real(wp), intent(out) :: y(n)
      integer :: i

      if (w*n >= worth_a_call) then
         call dgemv('T', w, n, 1.0_wp, a, w, x, 1, 0.0_wp, y, 1)
         return
      end if
      do i = 1, n
         y(i) = dot_product(a(:, i), x)
      end do
   end subroutine tail_times

   !> y = y - A x.
   pure subroutine tail_transposed_times(w, n, a, x, y)
      integer, intent(in) :: w, n
      real(wp), intent(in) :: a(w, n), x(n)
      real(wp), intent(inout) :: y(w)
      integer :: i

      if (w*n >= worth_a_call) then
         call dgemv('N', w, n, -1.0_wp, a, w, x, 1, 1.0_wp, y, 1)
         return
      end if
      do i = 1, n
         y = y - x(i)*a(:, i)
      end do
   end subroutine tail_transposed_times

   !> L y = x for the block on the diagonal, in place.
   pure subroutine solve_block(w, a, x)
      integer, intent(in) :: w
      real(wp), intent(in) :: a(w, w)
      real(wp), intent(inout) :: x(w)
      integer :: i

      do i = 2, w
         x(i) = x(i) - dot_product(a(:i - 1, i), x(:i - 1))
      end do
   end subroutine solve_block

   !> Lt y = x for the block on the diagonal, in place.
   pure subroutine solve_block_transposed(w, a, x)
      integer, intent(in) :: w
      real(wp), intent(in) :: a(w, w)
      real(wp), intent(inout) :: x(w)
      integer :: i

      do i = w, 2, -1
         x(:i - 1) = x(:i - 1) - x(i)*a(:i - 1, i)
      end do
   end subroutine solve_block_transposed

end module panel_kernels
