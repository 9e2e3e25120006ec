!> Where the entries of a symmetric skyline matrix stand: in panels of neighbouring columns of the
!> lower triangle. A panel holds the rows from its first column on that reach one of its columns,
!> each row with all columns of the panel, one row after the other; in a skyline such a row is also
!> in every later panel up to its own. Equations that nothing couples stand behind the panels with
!> one entry each, and the others are numbered without them. Where the columns are short, the matrix
!> is stored by columns instead, each from its first row to the diagonal, one after the other.
module panel_layout
   use kinds, only: wp, int64
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: panel_layout_type, new_panel_layout

   !> Mean height of a column's entries from which there are panels.
   real(wp), parameter :: tall = 100.0_wp
   !> Most columns of a panel.
   integer, parameter :: max_width = 32
   !> A panel has this part of its rows as columns, so that little is stored in vain.
   integer, parameter :: rows_a_column = 6
   !> Part of the rows below a panel that count as near, and the entries from which it matters.
   real(wp), parameter :: near_part = 0.45_wp
   integer(int64), parameter :: worth_dividing = 2000000_int64

   !> Rows come in runs of consecutive ones. Row i of run r in panel p, with column j, stands at
   !> at(p) + (run_place(r) + i - run_row(r))*width + j - column(p).
   type :: panel_layout_type
      integer :: n = 0
      integer :: n_coupled = 0
      integer :: n_panels = 0
      logical :: by_columns = .false.            !! without panels
      integer, allocatable :: top(:)             !! (n) first row of each column, if by columns
      integer(int64) :: n_entries = 0            !! stored, with those that are always zero
      integer, allocatable :: number(:)          !! (n) among the coupled equations, or 0
      integer(int64), allocatable :: diagonal_at(:)   !! (n) address of the diagonal entry
      integer, allocatable :: panel_of(:)        !! (n_coupled)
      integer, allocatable :: column(:)          !! (n_panels + 1) first column of each panel
      integer(int64), allocatable :: at(:)       !! (n_panels + 1) address of its first entry
      integer, allocatable :: source(:)          !! (n_panels) first panel with a row among its own
      integer, allocatable :: far_panel(:)       !! (n_panels) of the first row that is far off
      integer, allocatable :: far_place(:)       !! (n_panels) rows before that one
      integer, allocatable :: first_run(:)       !! (n_panels + 1), the last of each is an end mark
      integer, allocatable :: run_row(:)         !! first row of each run; end mark: n_coupled + 1
      integer, allocatable :: run_place(:)       !! rows of the panel before it; end mark: all
   contains
      procedure :: address
      procedure :: width
      procedure :: n_rows
      procedure :: rows_before
      procedure :: run_of
      procedure :: bytes
   end type panel_layout_type

contains

   !> The layout of a profile.
   pure subroutine new_panel_layout(self, first_row, coupled, panels_from)
      type(panel_layout_type), intent(out) :: self
      integer, intent(in) :: first_row(:)        !! (n) topmost row of each column
      logical, intent(in) :: coupled(:)          !! (n) whether it has entries off the diagonal
      real(wp), intent(in), optional :: panels_from   !! mean height, to force one or the other
      integer, allocatable :: top(:)
      real(wp) :: least

      self%n = size(first_row)
      least = tall
      if (present(panels_from)) least = panels_from
      if (mean_height(first_row) < least) then
         call place_columns(self, first_row)
         return
      end if
      call number_coupled(self, first_row, coupled, top)
      call choose_panels(self, top)
      call list_rows(self, top)
      call place_entries(self)
      call divide_tails(self)
   end subroutine new_panel_layout

   !> Height of the columns, as the mean of all entries.
   pure real(wp) function mean_height(first_row)
      integer, intent(in) :: first_row(:)
      integer :: j
      real(wp) :: entries, squares

      entries = 0.0_wp
      squares = 0.0_wp
      do j = 1, size(first_row)
         entries = entries + real(j - first_row(j) + 1, wp)
         squares = squares + real(j - first_row(j) + 1, wp)**2
      end do
      mean_height = squares/max(entries, 1.0_wp)
   end function mean_height

   !> A layout without panels.
   pure subroutine place_columns(self, first_row)
      type(panel_layout_type), intent(inout) :: self
      integer, intent(in) :: first_row(:)
      integer :: j, status

      self%by_columns = .true.
      self%top = first_row
      allocate (self%diagonal_at(self%n), stat=status)
      call check_allocation(status)
      do j = 1, self%n
         self%n_entries = self%n_entries + j - first_row(j) + 1
         self%diagonal_at(j) = self%n_entries
      end do
   end subroutine place_columns

   !> Numbers the coupled equations; `top` is the first row of each in these numbers.
   pure subroutine number_coupled(self, first_row, coupled, top)
      type(panel_layout_type), intent(inout) :: self
      integer, intent(in) :: first_row(:)
      logical, intent(in) :: coupled(:)
      integer, allocatable, intent(out) :: top(:)
      integer :: before(self%n), j, n
      integer :: status

      allocate (self%number(self%n), stat=status)
      call check_allocation(status)
      n = 0
      do j = 1, self%n
         before(j) = n
         if (coupled(j)) n = n + 1
         self%number(j) = merge(n, 0, coupled(j))
      end do
      self%n_coupled = n
      allocate (top(n), stat=status)
      call check_allocation(status)
      do j = 1, self%n
         if (coupled(j)) top(self%number(j)) = before(first_row(j)) + 1
      end do
   end subroutine number_coupled

   !> Panels as wide as the rows that cross them allow; none goes across a gap of the profile.
   pure subroutine choose_panels(self, top)
      type(panel_layout_type), intent(inout) :: self
      integer, intent(in) :: top(:)
      integer, dimension(self%n_coupled + 1) :: starting, first
      integer :: j, crossing, wanted, p, status

      starting = 0
      do j = 1, self%n_coupled
         starting(top(j)) = starting(top(j)) + 1
      end do
      allocate (self%panel_of(self%n_coupled), stat=status)
      call check_allocation(status)
      crossing = 0
      wanted = 0
      p = 0
      do j = 1, self%n_coupled
         ! crossing: rows below j - 1 that reach it or a column before it
         if (p == 0 .or. crossing == 0) wanted = 0
         if (wanted == 0) then
            wanted = max(crossing + starting(j), j - top(j) + 1)/rows_a_column
            wanted = min(max(wanted, 1), max_width)
            p = p + 1
            first(p) = j
         end if
         self%panel_of(j) = p
         wanted = wanted - 1
         crossing = crossing + starting(j) - 1
      end do
      self%n_panels = p
      first(p + 1) = self%n_coupled + 1
      self%column = first(:p + 1)
   end subroutine choose_panels

   !> The runs of rows of every panel: counted first, then listed.
   pure subroutine list_rows(self, top)
      type(panel_layout_type), intent(inout) :: self
      integer, intent(in) :: top(:)
      integer, dimension(self%n_panels) :: last_row, n_rows, n_runs
      integer :: i, p, pass, status

      allocate (self%first_run(self%n_panels + 1), self%source(self%n_panels), stat=status)
      call check_allocation(status)
      self%source = [(p, p=1, self%n_panels)]
      do pass = 1, 2
         last_row = -1
         n_rows = 0
         n_runs = 0
         do i = 1, self%n_coupled
            do p = self%panel_of(top(i)), self%panel_of(i)
               if (last_row(p) < i - 1) then
                  if (pass == 2) self%run_row(self%first_run(p) + n_runs(p)) = i
                  if (pass == 2) self%run_place(self%first_run(p) + n_runs(p)) = n_rows(p)
                  n_runs(p) = n_runs(p) + 1
               end if
               last_row(p) = i
               n_rows(p) = n_rows(p) + 1
            end do
            p = self%panel_of(i)
            self%source(p) = min(self%source(p), self%panel_of(top(i)))
         end do
         if (pass == 1) then
            self%first_run(1) = 1
            do p = 1, self%n_panels
               self%first_run(p + 1) = self%first_run(p) + n_runs(p) + 1
            end do
            allocate (self%run_row(self%first_run(self%n_panels + 1) - 1), stat=status)
            call check_allocation(status)
            allocate (self%run_place(size(self%run_row)), stat=status)
            call check_allocation(status)
         end if
      end do
      do p = 1, self%n_panels
         self%run_row(self%first_run(p + 1) - 1) = self%n_coupled + 1
         self%run_place(self%first_run(p + 1) - 1) = n_rows(p)
      end do
   end subroutine list_rows

   !> Cuts the rows below each panel in two, the nearer ones and those far off, so that two threads
   !> can share them: a later panel's far rows do not begin in an earlier panel.
   pure subroutine divide_tails(self)
      type(panel_layout_type), intent(inout) :: self
      integer :: p, near, run, row, panel, status

      allocate (self%far_panel(self%n_panels), self%far_place(self%n_panels), stat=status)
      call check_allocation(status)
      panel = 0
      do p = 1, self%n_panels
         near = self%n_rows(p) - 1
         if (self%n_entries >= worth_dividing) near = min(near, self%width(p) &
               + int(near_part*(self%n_rows(p) - self%width(p))))
         run = self%first_run(p)
         do while (self%run_place(run + 1) <= near)
            run = run + 1
         end do
         row = self%run_row(run) + near - self%run_place(run)
         panel = max(panel, self%panel_of(row) + 1)
         self%far_panel(p) = panel
         self%far_place(p) = self%rows_before(p, self%column(panel))
      end do
   end subroutine divide_tails

   !> Addresses of the panels, then of the equations that nothing couples.
   pure subroutine place_entries(self)
      type(panel_layout_type), intent(inout) :: self
      integer(int64) :: next
      integer :: i, p, j, status

      allocate (self%at(self%n_panels + 1), self%diagonal_at(self%n), stat=status)
      call check_allocation(status)
      self%at(1) = 1
      do p = 1, self%n_panels
         self%at(p + 1) = self%at(p) + int(self%width(p), int64)*self%n_rows(p)
      end do
      next = self%at(self%n_panels + 1)
      do i = 1, self%n
         j = self%number(i)
         if (j == 0) then
            self%diagonal_at(i) = next
            next = next + 1
         else
            p = self%panel_of(j)
            self%diagonal_at(i) = self%at(p) + int(self%width(p) + 1, int64)*(j - self%column(p))
         end if
      end do
      self%n_entries = next - 1
   end subroutine place_entries

   !> Columns of a panel.
   pure integer function width(self, p)
      class(panel_layout_type), intent(in) :: self
      integer, intent(in) :: p

      width = self%column(p + 1) - self%column(p)
   end function width

   !> Rows of a panel.
   pure integer function n_rows(self, p)
      class(panel_layout_type), intent(in) :: self
      integer, intent(in) :: p

      n_rows = self%run_place(self%first_run(p + 1) - 1)
   end function n_rows

   !> Rows of a panel before a row.
   pure integer function rows_before(self, p, row)
      class(panel_layout_type), intent(in) :: self
      integer, intent(in) :: p, row              !! row: not before the panel's first column
      integer :: run

      run = self%run_of(p, row)
      rows_before = min(self%run_place(run) + row - self%run_row(run), self%run_place(run + 1))
   end function rows_before

   !> The run with a row, or the last one before it.
   pure integer function run_of(self, p, row)
      class(panel_layout_type), intent(in) :: self
      integer, intent(in) :: p, row              !! row: not before the panel's first column
      integer :: high, middle

      run_of = self%first_run(p)
      high = self%first_run(p + 1) - 1
      do while (high - run_of > 1)
         middle = (run_of + high)/2
         if (self%run_row(middle) <= row) then
            run_of = middle
         else
            high = middle
         end if
      end do
   end function run_of

   !> Address of entry (i, j) or (j, i), 0 if it is not stored.
   pure integer(int64) function address(self, i, j)
      class(panel_layout_type), intent(in) :: self
      integer, intent(in) :: i, j                !! equations
      integer :: row, column, p, run, place

      if (i == j) then
         address = self%diagonal_at(i)
         return
      end if
      address = 0
      if (self%by_columns) then
         if (min(i, j) >= self%top(max(i, j))) address = self%diagonal_at(max(i, j)) - abs(i - j)
         return
      end if
      row = self%number(max(i, j))
      column = self%number(min(i, j))
      if (row == 0 .or. column == 0) return
      p = self%panel_of(column)
      run = self%run_of(p, row)
      place = self%run_place(run) + row - self%run_row(run)
      if (place >= self%run_place(run + 1)) return
      address = self%at(p) + int(self%width(p), int64)*place + column - self%column(p)
   end function address

   !> Memory of the layout itself.
   pure integer(int64) function bytes(self)
      class(panel_layout_type), intent(in) :: self

      if (self%by_columns) then
         bytes = (storage_size(self%top) + storage_size(self%diagonal_at))/8*int(self%n, int64)
         return
      end if
      bytes = (storage_size(self%number)*(size(self%number, kind=int64) + size(self%panel_of) &
            + size(self%column) + 3*size(self%source) + size(self%first_run) &
            + size(self%run_row) + size(self%run_place)) &
            + storage_size(self%at)*(size(self%at, kind=int64) + size(self%diagonal_at)))/8
   end function bytes

end module panel_layout
