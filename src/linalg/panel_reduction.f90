!> The factorization A = L D Lt of a skyline matrix by panels: each takes the products of the panels
!> before it, in their order, then reduces its own columns. Threads take the panels in turn, so that
!> the result does not depend on their number.
module panel_reduction
   use kinds, only: wp, int64
   use memory_shortage, only: check_allocation
   use blas_interfaces, only: dtrsm
   use panel_layout, only: panel_layout_type
   use panel_kernels, only: subtract_product, reduce_block, scale_tail
   use waiting, only: pass_turn, report
   implicit none
   private

   public :: reduce_panels

   !> Products from which threads share the work.
   real(wp), parameter :: worth_threads = 3.0e8_wp
   !> Most panels that a thread reduces together.
   integer, parameter :: most_together = 4
   !> Mean length of the runs of rows from which products go straight to their place.
   integer, parameter :: long_run = 16

   !> How far the panels are.
   type :: progress_type
      integer :: next = 0                        !! groups of panels that threads have taken
      integer :: failed                          !! panel with a vanishing pivot, or past the last
      integer, allocatable :: done(:)            !! (n_panels) 1 when reduced
      real(wp), allocatable :: original(:)       !! (n_coupled) diagonal of A
      real(wp), allocatable :: pivots(:)         !! (n_coupled)
   end type progress_type

contains

   !> Overwrites the panels by L and D. `zero_pivot` is the first of the coupled equations whose
   !> pivot vanishes, or 0.
   subroutine reduce_panels(layout, values, tolerance, pivots, zero_pivot)
      type(panel_layout_type), intent(in) :: layout
      real(wp), intent(inout) :: values(layout%n_entries)
      real(wp), intent(in) :: tolerance          !! of the pivots as a part of the diagonal
      real(wp), allocatable, intent(out) :: pivots(:)   !! (n_coupled)
      integer, intent(out) :: zero_pivot
      type(progress_type) :: progress
      integer :: p, n_together, status

      allocate (progress%done(layout%n_panels), progress%pivots(layout%n_coupled), stat=status)
      call check_allocation(status)
      progress%done = 0
      progress%pivots = 0.0_wp
      progress%failed = layout%n_panels + 1
      progress%original = pack(values(layout%diagonal_at), layout%number > 0)
      zero_pivot = 0
      n_together = panels_together(layout)
      !$omp parallel if (is_worth_threads(layout)) private(p)
      do
         !$omp atomic capture
         progress%next = progress%next + 1
         p = progress%next
         !$omp end atomic
         p = (p - 1)*n_together + 1
         if (p > layout%n_panels) exit
         call reduce_group(layout, p, min(p + n_together - 1, layout%n_panels), values, &
               tolerance, progress, zero_pivot)
      end do
      !$omp end parallel
      call move_alloc(progress%pivots, pivots)
   end subroutine reduce_panels

   !> Panels that a thread reduces together, so that those before are read less often: few enough
   !> for the panels between to keep the other threads busy.
   pure integer function panels_together(layout)
      type(panel_layout_type), intent(in) :: layout
      integer :: p
      real(wp) :: sources

      sources = sum([(real(p - layout%source(p), wp), p=1, layout%n_panels)])
      panels_together = max(1, min(most_together, int(sources/max(1, layout%n_panels)/8.0_wp)))
   end function panels_together

   !> Whether the work pays for starting threads.
   pure logical function is_worth_threads(layout)
      type(panel_layout_type), intent(in) :: layout
      real(wp) :: work
      integer :: p

      work = 0.0_wp
      do p = 1, layout%n_panels
         work = work + layout%width(p)*real(layout%n_rows(p), wp)**2
      end do
      is_worth_threads = work > worth_threads
   end function is_worth_threads

   !> Products of the panels before the group, then the reduction of its own panels.
   subroutine reduce_group(layout, first, last, values, tolerance, progress, zero_pivot)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: first, last
      real(wp), intent(inout) :: values(layout%n_entries)
      real(wp), intent(in) :: tolerance
      type(progress_type), intent(inout) :: progress
      integer, intent(inout) :: zero_pivot
      integer :: p, s

      do s = minval(layout%source(first:last)), first - 1
         if (.not. is_ready(progress, s, first)) return
         do p = first, last
            if (s >= layout%source(p)) call subtract_panel(layout, s, p, values, progress%pivots)
         end do
      end do
      do p = first, last
         do s = max(first, layout%source(p)), p - 1
            call subtract_panel(layout, s, p, values, progress%pivots)
         end do
         call reduce_panel(layout, p, values, tolerance, progress, zero_pivot)
         if (progress%done(p) == 0) return
      end do
   end subroutine reduce_group

   !> Reduces the columns of a panel from which the products of others have been taken.
   subroutine reduce_panel(layout, p, values, tolerance, progress, zero_pivot)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: p
      real(wp), intent(inout) :: values(layout%n_entries)
      real(wp), intent(in) :: tolerance
      type(progress_type), intent(inout) :: progress
      integer, intent(inout) :: zero_pivot
      integer :: w, n_tail, failed, first
      integer(int64) :: at

      w = layout%width(p)
      at = layout%at(p)
      first = layout%column(p)
      call reduce_block(w, values(at), progress%original(first), tolerance, &
            progress%pivots(first), failed)
      if (failed > 0) then
         !$omp critical (carom_zero_pivot)
         if (p < progress%failed) then
            zero_pivot = first + failed - 1
            !$omp atomic write
            progress%failed = p
         end if
         !$omp end critical (carom_zero_pivot)
         return
      end if
      n_tail = layout%n_rows(p) - w
      if (n_tail > 0) then
         call dtrsm('L', 'U', 'T', 'U', w, n_tail, 1.0_wp, values(at), w, &
               values(at + int(w, int64)*w), w)
         call scale_tail(w, n_tail, values(at + int(w, int64)*w), progress%pivots(first))
      end if
      call report(progress%done(p), 1)
   end subroutine reduce_panel

   !> Waits for panel s; false if a panel before p has failed.
   logical function is_ready(progress, s, p)
      type(progress_type), intent(inout) :: progress
      integer, intent(in) :: s, p
      integer :: state, failed, n

      n = 0
      do
         !$omp atomic read
         state = progress%done(s)
         !$omp atomic read
         failed = progress%failed
         if (state == 1 .or. failed < p) exit
         call pass_turn(n)
      end do
      !$omp flush
      is_ready = state == 1
   end function is_ready

   !> Subtracts the products of the rows of panel s that are columns of panel p with the rows from
   !> there on: straight into place where both are consecutive, else by way of a buffer.
   subroutine subtract_panel(layout, s, p, values, pivots)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: s, p
      real(wp), intent(inout) :: values(layout%n_entries)
      real(wp), intent(in) :: pivots(:)
      real(wp), allocatable :: scaled(:, :)
      integer :: run, w, start, n, n_all, i, end_mark, status
      integer(int64) :: at

      end_mark = layout%first_run(s + 1) - 1
      start = layout%rows_before(s, layout%column(p))
      n = layout%rows_before(s, layout%column(p + 1)) - start
      if (n == 0) return
      run = layout%run_of(s, layout%column(p))
      if (layout%run_place(run + 1) <= start) run = run + 1
      w = layout%width(s)
      n_all = layout%n_rows(s) - start
      at = layout%at(s) + int(start, int64)*w
      allocate (scaled(w, n), stat=status)
      call check_allocation(status)
      do i = 1, n
         scaled(:, i) = values(at + int(i - 1, int64)*w:at + int(i, int64)*w - 1) &
               *pivots(layout%column(s):layout%column(s + 1) - 1)
      end do
      if (start + n <= layout%run_place(run + 1) .and. &
            (end_mark == run + 1 .or. n_all >= long_run*(end_mark - run))) then
         call subtract_in_place(layout, s, p, run, start, scaled, values)
      else
         call subtract_scattered(layout, s, p, run, start, scaled, values)
      end if
   end subroutine subtract_panel

   !> One product a run of rows.
   subroutine subtract_in_place(layout, s, p, first_run, start, scaled, values)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: s, p, first_run, start
      real(wp), intent(in) :: scaled(:, :)
      real(wp), intent(inout) :: values(layout%n_entries)
      integer :: run, target_run, place, row, column, w, n
      integer(int64) :: from, to

      w = layout%width(p)
      place = start
      column = layout%run_row(first_run) + start - layout%run_place(first_run)
      target_run = layout%first_run(p)
      do run = first_run, layout%first_run(s + 1) - 2
         row = layout%run_row(run) + place - layout%run_place(run)
         n = layout%run_place(run + 1) - place
         do while (layout%run_row(target_run + 1) <= row)
            target_run = target_run + 1
         end do
         from = layout%at(s) + int(place, int64)*size(scaled, 1)
         to = layout%at(p) + int(layout%run_place(target_run) + row - layout%run_row(target_run), &
               int64)*w + column - layout%column(p)
         call subtract_product(size(scaled, 2), n, size(scaled, 1), scaled, values(from), &
               values(to), w)
         place = layout%run_place(run + 1)
      end do
   end subroutine subtract_in_place

   !> One product for all rows, whose rows and columns are then spread.
   subroutine subtract_scattered(layout, s, p, first_run, start, scaled, values)
      type(panel_layout_type), intent(in) :: layout
      integer, intent(in) :: s, p, first_run, start
      real(wp), intent(in) :: scaled(:, :)
      real(wp), intent(inout) :: values(layout%n_entries)
      real(wp), allocatable :: product(:, :)
      integer :: column(size(scaled, 2))
      integer :: run, target_run, place, row, w, i, n, status
      integer(int64) :: to

      w = layout%width(p)
      n = size(scaled, 2)
      allocate (product(n, start:layout%n_rows(s) - 1), stat=status)
      call check_allocation(status)
      product = 0.0_wp
      call subtract_product(n, size(product, 2), size(scaled, 1), scaled, &
            values(layout%at(s) + int(start, int64)*size(scaled, 1)), product, n)
      place = start
      target_run = layout%first_run(p)
      do run = first_run, layout%first_run(s + 1) - 2
         do place = place, layout%run_place(run + 1) - 1
            row = layout%run_row(run) + place - layout%run_place(run)
            if (place - start < n) column(place - start + 1) = row - layout%column(p)
            do while (layout%run_row(target_run + 1) <= row)
               target_run = target_run + 1
            end do
            to = layout%at(p) + int(layout%run_place(target_run) + row &
                  - layout%run_row(target_run), int64)*w
            do i = 1, min(n, place - start + 1)
               values(to + column(i)) = values(to + column(i)) + product(i, place)
            end do
         end do
      end do
   end subroutine subtract_scattered

end module panel_reduction
