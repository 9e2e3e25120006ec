!> Forward reduction and back-substitution with the factors of a skyline matrix by panels: L is read
!> once in each.
module panel_solution
   use kinds, only: wp, int64
   use blas_interfaces, only: dgemm, dtrsm
   use panel_layout, only: panel_layout_type
   use panel_kernels, only: solve_block, solve_block_transposed, tail_times, &
         tail_transposed_times, gather_tail, subtract_at_tail
   implicit none
   private

   public :: solve_panels, solve_panels_many

   !> Right-hand sides that are solved for together.
   integer, parameter :: together = 16

contains

   !> L D Lt x = b for the coupled equations, in place.
   subroutine solve_panels(layout, values, x)
      type(panel_layout_type), intent(in) :: layout
      real(wp), intent(in) :: values(layout%n_entries)
      real(wp), intent(inout) :: x(layout%n_coupled)
      integer :: p

      do p = 1, layout%n_panels
         call reduce(layout, p, values, x)
      end do
      do p = layout%n_panels, 1, -1
         call substitute(layout, p, values, x)
      end do
   end subroutine solve_panels

   !> Forward reduction by a panel.
   subroutine reduce(layout, p, values, x)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: p
      real(wp), intent(in) :: values(layout%n_entries)
      real(wp), intent(inout) :: x(layout%n_coupled)
      real(wp) :: z(layout%n_rows(p))
      integer :: w, n, first

      w = layout%width(p)
      n = layout%n_rows(p)
      first = layout%column(p)
      call solve_block(w, values(layout%at(p)), x(first))
      if (n == w) return
      call tail_times(w, n - w, values(layout%at(p) + w*w), x(first), z)
      call subtract_at_tail(layout, p, w, n - 1, z, x)
   end subroutine reduce

   !> Division by the pivots of a panel and back-substitution.
   subroutine substitute(layout, p, values, x)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: p
      real(wp), intent(in) :: values(layout%n_entries)
      real(wp), intent(inout) :: x(layout%n_coupled)
      real(wp) :: z(layout%n_rows(p))
      integer :: w, n, first, i

      w = layout%width(p)
      n = layout%n_rows(p)
      first = layout%column(p)
      do i = 0, w - 1
         x(first + i) = x(first + i)/values(layout%at(p) + i*(w + 1))
      end do
      if (n > w) then
         call gather_tail(layout, p, w, n - 1, x, z)
         call tail_transposed_times(w, n - w, values(layout%at(p) + w*w), z, x(first))
      end if
      call solve_block_transposed(w, values(layout%at(p)), x(first))
   end subroutine substitute

   !> The same for several right-hand sides.
   subroutine solve_panels_many(layout, values, n_sides, x)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: n_sides
      real(wp), intent(in) :: values(layout%n_entries)
      real(wp), intent(inout) :: x(layout%n_coupled, n_sides)
      real(wp), allocatable :: z(:)
      integer :: k, p, most_rows, n_here

      if (layout%n_panels == 0) return
      most_rows = maxval([(layout%n_rows(p), p=1, layout%n_panels)])
      !$omp parallel if (n_sides > together) private(z, p, n_here)
      allocate (z(most_rows*min(together, n_sides)))
      !$omp do schedule(dynamic, 1)
      do k = 1, n_sides, together
         n_here = min(together, n_sides - k + 1)
         do p = 1, layout%n_panels
            call reduce_many(layout, p, values, n_here, most_rows, x(1, k), z)
         end do
         do p = layout%n_panels, 1, -1
            call substitute_many(layout, p, values, n_here, most_rows, x(1, k), z)
         end do
      end do
      !$omp end do
      !$omp end parallel
   end subroutine solve_panels_many

   subroutine reduce_many(layout, p, values, n_sides, n_z, x, z)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: p, n_sides, n_z
      real(wp), intent(in) :: values(layout%n_entries)
      real(wp), intent(inout) :: x(layout%n_coupled, n_sides), z(n_z, n_sides)
      integer :: w, n, first, k

      w = layout%width(p)
      n = layout%n_rows(p)
      first = layout%column(p)
      call dtrsm('L', 'U', 'T', 'U', w, n_sides, 1.0_wp, values(layout%at(p)), w, x(first, 1), &
            layout%n_coupled)
      if (n == w) return
      call dgemm('T', 'N', n - w, n_sides, w, 1.0_wp, values(layout%at(p) + w*w), w, &
            x(first, 1), layout%n_coupled, 0.0_wp, z, n_z)
      do k = 1, n_sides
         call subtract_at_tail(layout, p, w, n - 1, z(:, k), x(:, k))
      end do
   end subroutine reduce_many

   subroutine substitute_many(layout, p, values, n_sides, n_z, x, z)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: p, n_sides, n_z
      real(wp), intent(in) :: values(layout%n_entries)
      real(wp), intent(inout) :: x(layout%n_coupled, n_sides), z(n_z, n_sides)
      integer :: w, n, first, i, k

      w = layout%width(p)
      n = layout%n_rows(p)
      first = layout%column(p)
      do i = 0, w - 1
         x(first + i, :) = x(first + i, :)/values(layout%at(p) + i*(w + 1))
      end do
      if (n > w) then
         do k = 1, n_sides
            call gather_tail(layout, p, w, n - 1, x(:, k), z(:, k))
         end do
         call dgemm('N', 'N', w, n_sides, n - w, -1.0_wp, values(layout%at(p) + w*w), w, z, &
               n_z, 1.0_wp, x(first, 1), layout%n_coupled)
      end if
      call dtrsm('L', 'U', 'N', 'U', w, n_sides, 1.0_wp, values(layout%at(p)), w, x(first, 1), &
            layout%n_coupled)
   end subroutine substitute_many

end module panel_solution
