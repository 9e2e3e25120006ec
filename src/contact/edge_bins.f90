!> Which edges are near a box: each edge stands in one square cell of a grid, that of the middle of
!> its box. Grids have cell sizes of powers of two, and an edge stands in the one whose cells are
!> just larger than the edge, so that short and long edges do not disturb each other. Cells are
!> found by hashing: storage and building grow with the number of edges alone, whatever the shape of
!> the surface.
module edge_bins
   use kinds, only: int64, wp
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: edge_bins_type, new_bins, find_in_box

   integer, parameter :: finest = 30             !! a box is at most 2**finest cells wide

   type :: edge_bins_type
      private
      real(wp) :: origin(2) = 0.0_wp
      integer :: n_grids = 0
      integer :: exponent(finest + 1) = 0         !! of the cell size 2**exponent of each grid
      integer(int64) :: mask = 0                 !! number of buckets, a power of two, less one
      integer, allocatable :: first(:)           !! (0:mask + 1) start of each bucket in `edge`
      integer, allocatable :: edge(:)
      integer, allocatable :: cell(:, :)         !! (3, n) place in the grid and number of the grid
   end type edge_bins_type

contains

   !> Sorts edges into their cells.
   pure subroutine new_bins(self, low, high, smallest)
      type(edge_bins_type), intent(inout) :: self
      real(wp), intent(in) :: low(:, :), high(:, :) !! (2, n) boxes of the edges
      real(wp), intent(in) :: smallest              !! cells need not be smaller than this
      integer, allocatable :: cell(:, :)
      integer :: n, e, k, grid, status
      real(wp) :: least

      n = size(low, 2)
      self%n_grids = 0
      self%origin = minval(low, 2)
      least = max(maxval(high) - minval(low), tiny(1.0_wp)*2.0_wp**finest)
      least = max(smallest, least*2.0_wp**(2 - finest))
      self%mask = 1
      do while (self%mask < 2*n)
         self%mask = 2*self%mask
      end do
      self%mask = self%mask - 1
      if (allocated(self%first)) deallocate (self%first, self%edge, self%cell)
      allocate (self%first(0:int(self%mask) + 1), source=0, stat=status)
      call check_allocation(status)
      allocate (cell(3, n), self%cell(3, n), self%edge(n), stat=status)
      call check_allocation(status)
      do e = 1, n
         call choose_grid(self, max(least, maxval(high(:, e) - low(:, e))), grid)
         cell(1:2, e) = cell_of(self, grid, (low(:, e) + high(:, e))/2.0_wp)
         cell(3, e) = grid
         k = bucket(self, cell(:, e))
         self%first(k) = self%first(k) + 1
      end do
      do k = 1, int(self%mask) + 1
         self%first(k) = self%first(k) + self%first(k - 1)
      end do
      do e = n, 1, -1
         k = bucket(self, cell(:, e))
         self%first(k) = self%first(k) - 1
         self%edge(self%first(k) + 1) = e
         self%cell(:, self%first(k) + 1) = cell(:, e)
      end do
   end subroutine new_bins

   !> Edges whose boxes may come closer to a box than a reach. Each is given once.
   pure subroutine find_in_box(self, low, high, reach, found, n_found)
      type(edge_bins_type), intent(in) :: self
      real(wp), intent(in) :: low(2), high(2)
      real(wp), intent(in) :: reach
      integer, intent(inout) :: found(:)         !! (number of edges) of which the first are set
      integer, intent(out) :: n_found
      integer :: grid, i, j, from(2), to(2)
      real(wp) :: margin, size_of_cell

      n_found = 0
      do grid = 1, self%n_grids
         size_of_cell = 2.0_wp**self%exponent(grid)
         margin = size_of_cell/2.0_wp + reach
         from = cell_of(self, grid, low - margin)
         to = cell_of(self, grid, high + margin)
         if (product(real(to, wp) - real(from, wp) + 1.0_wp) > real(size(self%edge), wp)) then
            call add_all(self, grid, from, to, found, n_found)
            cycle
         end if
         do j = from(2), to(2)
            do i = from(1), to(1)
               call add_cell(self, [i, j, grid], found, n_found)
            end do
         end do
      end do
   end subroutine find_in_box

   pure subroutine add_cell(self, cell, found, n_found)
      type(edge_bins_type), intent(in) :: self
      integer, intent(in) :: cell(3)
      integer, intent(inout) :: found(:)
      integer, intent(inout) :: n_found
      integer :: k, i

      k = bucket(self, cell)
      do i = self%first(k) + 1, self%first(k + 1)
         if (any(self%cell(:, i) /= cell)) cycle
         n_found = n_found + 1
         found(n_found) = self%edge(i)
      end do
   end subroutine add_cell

   !> For a box of more cells than there are edges.
   pure subroutine add_all(self, grid, from, to, found, n_found)
      type(edge_bins_type), intent(in) :: self
      integer, intent(in) :: grid, from(2), to(2)
      integer, intent(inout) :: found(:)
      integer, intent(inout) :: n_found
      integer :: i

      do i = 1, size(self%edge)
         if (self%cell(3, i) /= grid) cycle
         if (any(self%cell(:2, i) < from .or. self%cell(:2, i) > to)) cycle
         n_found = n_found + 1
         found(n_found) = self%edge(i)
      end do
   end subroutine add_all

   !> The grid for edges of a size; a new one if there is none yet.
   pure subroutine choose_grid(self, size_of_edge, grid)
      type(edge_bins_type), intent(inout) :: self
      real(wp), intent(in) :: size_of_edge
      integer, intent(out) :: grid

      do grid = 1, self%n_grids
         if (self%exponent(grid) == exponent(size_of_edge)) return
      end do
      self%n_grids = grid
      self%exponent(grid) = exponent(size_of_edge)
   end subroutine choose_grid

   pure function cell_of(self, grid, point) result(cell)
      type(edge_bins_type), intent(in) :: self
      integer, intent(in) :: grid
      real(wp), intent(in) :: point(2)
      integer :: cell(2)
      real(wp), parameter :: limit = 2.0_wp**finest

      cell = floor(min(max((point - self%origin)*2.0_wp**(-self%exponent(grid)), -limit), limit))
   end function cell_of

   pure function bucket(self, cell) result(k)
      type(edge_bins_type), intent(in) :: self
      integer, intent(in) :: cell(3)
      integer :: k
      integer(int64), parameter :: prime(3) = [73856093_int64, 19349663_int64, 83492791_int64]
      integer(int64) :: mixed

      mixed = ieor(ieor(cell(1)*prime(1), cell(2)*prime(2)), cell(3)*prime(3))
      mixed = ieor(mixed, ishft(mixed, -20))
      k = int(iand(mixed, self%mask))
   end function bucket

end module edge_bins
