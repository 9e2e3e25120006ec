!> Forward reduction and back-substitution with the factors of a skyline matrix by panels: L is read
!> once in each.
module panel_solution
   use omp_lib, only: omp_get_max_threads, omp_get_num_threads, omp_get_thread_num
   use kinds, only: wp, int64
   use memory_shortage, only: check_allocation
   use blas_interfaces, only: dgemm, dtrsm
   use panel_layout, only: panel_layout_type
   use panel_kernels, only: solve_block, solve_block_transposed, tail_times, &
         tail_transposed_times, gather_tail, subtract_at_tail
   use waiting, only: wait_for, report
   implicit none
   private

   public :: solve_panels, solve_panels_many

   !> Right-hand sides that are solved for together.
   integer, parameter :: together = 16
   !> Entries from which two threads share the work on one.
   integer(int64), parameter :: worth_threads = 2000000_int64

   !> Panels that the threads have done: forward, then backward.
   type :: progress_type
      integer :: leader = 0
      integer :: follower = 0
   end type progress_type

contains

   !> L D Lt x = b for the coupled equations, in place. Two threads share the rows of the panels:
   !> the leader takes the nearer ones, the follower those far off, whose part it collects apart. It
   !> does not matter to the sums whether there is one thread or two.
   subroutine solve_panels(layout, values, x)
      type(panel_layout_type), intent(in) :: layout
      real(wp), intent(in) :: values(layout%n_entries)
      real(wp), intent(inout) :: x(layout%n_coupled)
      real(wp) :: y(layout%n_coupled)            !! what the far rows contribute
      type(progress_type) :: progress
      integer :: p, n_threads

      y = 0.0_wp
      n_threads = 1
      if (layout%n_entries >= worth_threads) n_threads = min(2, omp_get_max_threads())
      !$omp parallel num_threads(n_threads) if (n_threads > 1) private(p)
      if (omp_get_num_threads() == 1) then
         do p = 1, layout%n_panels
            call reduce_near(layout, p, values, x, y)
            call reduce_far(layout, p, values, x, y)
         end do
         do p = layout%n_panels, 1, -1
            call substitute_far(layout, p, values, x, y)
            call substitute_near(layout, p, values, x, y)
         end do
      else if (omp_get_thread_num() == 0) then
         call lead(layout, values, x, y, progress)
      else
         call follow(layout, values, x, y, progress)
      end if
      !$omp end parallel
   end subroutine solve_panels

   !> Blocks on the diagonal and near rows.
   subroutine lead(layout, values, x, y, progress)
      type(panel_layout_type), intent(in) :: layout
      real(wp), intent(in) :: values(layout%n_entries)
      real(wp), intent(inout) :: x(layout%n_coupled), y(layout%n_coupled)
      type(progress_type), intent(inout) :: progress
      integer :: p, needed

      needed = 0
      do p = 1, layout%n_panels
         do while (needed < p - 1)
            if (layout%far_panel(needed + 1) > p) exit
            needed = needed + 1
         end do
         call wait_for(progress%follower, needed)
         call reduce_near(layout, p, values, x, y)
         call report(progress%leader, p)
      end do
      do p = layout%n_panels, 1, -1
         call wait_for(progress%follower, 2*layout%n_panels - p + 1)
         call substitute_near(layout, p, values, x, y)
         call report(progress%leader, 2*layout%n_panels - p + 1)
      end do
   end subroutine lead

   !> Far rows.
   subroutine follow(layout, values, x, y, progress)
      type(panel_layout_type), intent(in) :: layout
      real(wp), intent(in) :: values(layout%n_entries)
      real(wp), intent(inout) :: x(layout%n_coupled), y(layout%n_coupled)
      type(progress_type), intent(inout) :: progress
      integer :: p

      do p = 1, layout%n_panels
         call wait_for(progress%leader, p)
         call reduce_far(layout, p, values, x, y)
         call report(progress%follower, p)
      end do
      do p = layout%n_panels, 1, -1
         call wait_for(progress%leader, layout%n_panels + max(0, layout%n_panels &
               - layout%far_panel(p) + 1))
         call substitute_far(layout, p, values, x, y)
         call report(progress%follower, 2*layout%n_panels - p + 1)
      end do
   end subroutine follow

   !> Forward reduction by a panel, as far as the block on the diagonal and the near rows go.
   subroutine reduce_near(layout, p, values, x, y)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: p
      real(wp), intent(in) :: values(layout%n_entries), y(layout%n_coupled)
      real(wp), intent(inout) :: x(layout%n_coupled)
      real(wp) :: block(layout%width(p))
      integer :: w, first

      w = size(block)
      first = layout%column(p)
      block = x(first:first + w - 1) + y(first:first + w - 1)
      call solve_block(w, values(layout%at(p)), block)
      x(first:first + w - 1) = block
      call subtract_rows(layout, p, w, layout%far_place(p) - 1, values, block, x)
   end subroutine reduce_near

   !> Forward reduction of the far rows by a panel.
   subroutine reduce_far(layout, p, values, x, y)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: p
      real(wp), intent(in) :: values(layout%n_entries), x(layout%n_coupled)
      real(wp), intent(inout) :: y(layout%n_coupled)

      call subtract_rows(layout, p, layout%far_place(p), layout%n_rows(p) - 1, values, &
            x(layout%column(p):layout%column(p + 1) - 1), y)
   end subroutine reduce_far

   !> Subtracts the products of rows of a panel and x from those rows of y.
   subroutine subtract_rows(layout, p, from, to, values, x, y)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: p, from, to         !! places of the first and the last row
      real(wp), intent(in) :: values(layout%n_entries), x(:)
      real(wp), intent(inout) :: y(layout%n_coupled)
      real(wp) :: z(from:to)

      if (from > to) return
      call tail_times(size(x), to - from + 1, values(layout%at(p) + int(from, int64)*size(x)), x, z)
      call subtract_at_tail(layout, p, from, to, z, y)
   end subroutine subtract_rows

   !> Division by the pivots of a panel and back-substitution with the near rows and the block on
   !> the diagonal.
   subroutine substitute_near(layout, p, values, x, y)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: p
      real(wp), intent(in) :: values(layout%n_entries), y(layout%n_coupled)
      real(wp), intent(inout) :: x(layout%n_coupled)
      real(wp) :: block(layout%width(p))
      integer :: w, first, i

      w = size(block)
      first = layout%column(p)
      do i = 1, w
         block(i) = x(first + i - 1)/values(layout%at(p) + (i - 1)*(w + 1)) + y(first + i - 1)
      end do
      call subtract_products(layout, p, w, layout%far_place(p) - 1, values, x, block)
      call solve_block_transposed(w, values(layout%at(p)), block)
      x(first:first + w - 1) = block
   end subroutine substitute_near

   !> Back-substitution with the far rows of a panel.
   subroutine substitute_far(layout, p, values, x, y)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: p
      real(wp), intent(in) :: values(layout%n_entries), x(layout%n_coupled)
      real(wp), intent(inout) :: y(layout%n_coupled)

      associate (columns => y(layout%column(p):layout%column(p + 1) - 1))
         columns = 0.0_wp
         call subtract_products(layout, p, layout%far_place(p), layout%n_rows(p) - 1, values, x, &
               columns)
      end associate
   end subroutine substitute_far

   !> Subtracts the products of the columns of a panel, some rows of them, and x from y.
   subroutine subtract_products(layout, p, from, to, values, x, y)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: p, from, to
      real(wp), intent(in) :: values(layout%n_entries), x(layout%n_coupled)
      real(wp), intent(inout) :: y(:)
      real(wp) :: z(from:to)

      if (from > to) return
      call gather_tail(layout, p, from, to, x, z)
      call tail_transposed_times(size(y), to - from + 1, &
            values(layout%at(p) + int(from, int64)*size(y)), z, y)
   end subroutine subtract_products

   !> The same for several right-hand sides.
   subroutine solve_panels_many(layout, values, n_sides, x)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: n_sides
      real(wp), intent(in) :: values(layout%n_entries)
      real(wp), intent(inout) :: x(layout%n_coupled, n_sides)
      real(wp), allocatable :: z(:)
      integer :: k, p, most_rows, n_here, status

      if (layout%n_panels == 0) return
      most_rows = maxval([(layout%n_rows(p), p=1, layout%n_panels)])
      !$omp parallel if (n_sides > together) private(z, p, n_here, status)
      allocate (z(most_rows*min(together, n_sides)), stat=status)
      call check_allocation(status)
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
