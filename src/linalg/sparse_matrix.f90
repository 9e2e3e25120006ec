!> Symmetric sparse matrices: the places of the upper triangle, column by column, found once from
!> the sets of equations that elements couple; a matrix is then an array of values.
module sparse_matrix
   use kinds, only: wp, int64
   use memory_shortage, only: check_allocation
   use graph, only: vertex_cliques
   implicit none
   private

   public :: pattern_type, new_pattern, add_entry, pattern_entries, is_same, diagonal_places
   public :: sparse_report_type

   !> Entries of column j stand at first(j):first(j + 1) - 1 by ascending row, the diagonal last.
   type :: pattern_type
      integer :: n = 0
      integer(int64), allocatable :: first(:)    !! (n+1)
      integer, allocatable :: row(:)             !! (entries)
      integer, allocatable :: column(:)          !! (entries)
   end type pattern_type

   !> What a sparse factorization tells of itself.
   type :: sparse_report_type
      integer :: zero_pivot = 0                  !! an equation whose pivot vanished, 0 if none
      integer :: n_negative = 0                  !! negative pivots
      real(wp) :: entries = 0.0_wp               !! of the factor, as foreseen by the analysis
      real(wp) :: operations = 0.0_wp            !! of a factorization, as foreseen
   end type sparse_report_type

contains

   !> The pattern in which all members of each set are coupled, and every equation with itself.
   subroutine new_pattern(self, n, first, member)
      type(pattern_type), intent(out) :: self
      integer, intent(in) :: n
      integer, intent(in) :: first(:)            !! (n_sets+1) where a set starts
      integer, intent(in) :: member(:)           !! equations
      integer, allocatable :: set_first(:), sets(:), seen(:)
      integer(int64), allocatable :: next(:)
      integer :: pass, i, status

      call vertex_cliques(n, first, member, set_first, sets)
      self%n = n
      allocate (self%first(n + 1), next(n), seen(n), stat=status)
      call check_allocation(status)
      next = 0
      do pass = 1, 2
         seen = 0
         do i = 1, n
            call visit_row(i, pass == 2)
         end do
         if (pass == 2) return
         self%first(1) = 1
         do i = 1, n
            self%first(i + 1) = self%first(i) + next(i)
            next(i) = self%first(i)
         end do
         allocate (self%row(self%first(n + 1) - 1), self%column(self%first(n + 1) - 1), stat=status)
         call check_allocation(status)
      end do

   contains

      !> Enters row i into the columns that it meets at or right of the diagonal: rows that come in
      !> order leave every column in order.
      subroutine visit_row(i, placing)
         integer, intent(in) :: i
         logical, intent(in) :: placing
         integer :: k, m

         call enter(i, i, placing)
         do k = set_first(i), set_first(i + 1) - 1
            do m = first(sets(k)), first(sets(k) + 1) - 1
               if (member(m) > i) call enter(i, member(m), placing)
            end do
         end do
      end subroutine visit_row

      subroutine enter(i, j, placing)
         integer, intent(in) :: i, j
         logical, intent(in) :: placing

         if (seen(j) == i) return
         seen(j) = i
         if (placing) then
            self%row(next(j)) = i
            self%column(next(j)) = j
         end if
         next(j) = next(j) + 1
      end subroutine enter

   end subroutine new_pattern

   !> Stored entries, the diagonal included.
   pure integer(int64) function pattern_entries(self)
      type(pattern_type), intent(in) :: self

      pattern_entries = 0
      if (allocated(self%first)) pattern_entries = self%first(self%n + 1) - 1
   end function pattern_entries

   !> Whether two patterns have the same places.
   pure logical function is_same(a, b)
      type(pattern_type), intent(in) :: a, b

      is_same = allocated(a%first) .and. allocated(b%first) .and. a%n == b%n
      if (.not. is_same) return
      is_same = all(a%first == b%first)
      if (is_same) is_same = all(a%row == b%row)
   end function is_same

   !> Adds a value to entry (i, j) and, by symmetry, (j, i); the place must be in the pattern.
   pure subroutine add_entry(self, values, i, j, value)
      type(pattern_type), intent(in) :: self
      real(wp), intent(inout) :: values(:)       !! (entries)
      integer, intent(in) :: i, j
      real(wp), intent(in) :: value
      integer(int64) :: low, high, middle
      integer :: row

      row = min(i, j)
      low = self%first(max(i, j))
      high = self%first(max(i, j) + 1) - 1
      do while (low < high)
         middle = (low + high)/2
         if (self%row(middle) < row) then
            low = middle + 1
         else
            high = middle
         end if
      end do
      values(low) = values(low) + value
   end subroutine add_entry

   !> Where the diagonal entries stand.
   pure function diagonal_places(self) result(places)
      type(pattern_type), intent(in) :: self
      integer(int64) :: places(self%n)

      places = self%first(2:) - 1
   end function diagonal_places

end module sparse_matrix
