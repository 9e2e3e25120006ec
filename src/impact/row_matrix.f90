!> A sparse matrix of contact rows over the freedoms of a structure.
module row_matrix
   use kinds, only: wp
   use state_archive, only: archive_type
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: row_matrix_type, new_row_matrix, start_row, add_entry
   public :: multiply, multiply_absolute, add_transposed, full_row

   !> Entries by rows.
   type :: row_matrix_type
      integer :: n = 0                           !! rows
      integer, allocatable :: first(:)           !! (n+1) row pointers
      integer, allocatable :: freedom(:)         !! columns
      real(wp), allocatable :: coefficient(:)
   contains
      procedure :: pass_state
   end type row_matrix_type

contains

   !> The entries, without room beyond them.
   subroutine pass_state(self, archive)
      class(row_matrix_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive
      integer, allocatable :: freedom(:)
      real(wp), allocatable :: coefficient(:)
      integer :: n

      n = 0
      if (allocated(self%first)) n = self%first(self%n + 1) - 1
      freedom = self%freedom(:n)
      coefficient = self%coefficient(:n)
      call archive%pass('n', self%n)
      call archive%pass('first', self%first)
      call archive%pass('freedom', freedom)
      call archive%pass('coefficient', coefficient)
      if (.not. archive%reading) return
      call move_alloc(freedom, self%freedom)
      call move_alloc(coefficient, self%coefficient)
   end subroutine pass_state

   !> A matrix whose rows are filled one after the other by `start_row` and `add_entry`.
   pure subroutine new_row_matrix(self, n, n_entries)
      type(row_matrix_type), intent(inout) :: self
      integer, intent(in) :: n, n_entries        !! rows; entries to expect
      integer :: status

      if (allocated(self%first)) then
         if (self%n /= n) deallocate (self%first)
      end if
      if (allocated(self%freedom)) then
         if (size(self%freedom) < n_entries) deallocate (self%freedom, self%coefficient)
      end if
      self%n = n
      if (.not. allocated(self%first)) then
         allocate (self%first(n + 1), stat=status)
         call check_allocation(status)
      end if
      if (.not. allocated(self%freedom)) then
         allocate (self%freedom(n_entries), self%coefficient(n_entries), stat=status)
         call check_allocation(status)
      end if
      self%first = 1
   end subroutine new_row_matrix

   !> Row i begins where row i - 1 has ended.
   pure subroutine start_row(self, i)
      type(row_matrix_type), intent(inout) :: self
      integer, intent(in) :: i

      self%first(i + 1) = self%first(i)
   end subroutine start_row

   !> Appends an entry to row i, the last one started.
   pure subroutine add_entry(self, i, freedom, coefficient)
      type(row_matrix_type), intent(inout) :: self
      integer, intent(in) :: i, freedom
      real(wp), intent(in) :: coefficient

      self%freedom(self%first(i + 1)) = freedom
      self%coefficient(self%first(i + 1)) = coefficient
      self%first(i + 1) = self%first(i + 1) + 1
   end subroutine add_entry

   !> A u.
   pure function multiply(self, u) result(products)
      type(row_matrix_type), intent(in) :: self
      real(wp), intent(in) :: u(:)               !! (n_freedoms)
      real(wp) :: products(self%n)
      integer :: i

      do i = 1, self%n
         associate (from => self%first(i), to => self%first(i + 1) - 1)
            products(i) = dot_product(self%coefficient(from:to), u(self%freedom(from:to)))
         end associate
      end do
   end function multiply

   !> |A| |u|.
   pure function multiply_absolute(self, u) result(products)
      type(row_matrix_type), intent(in) :: self
      real(wp), intent(in) :: u(:)
      real(wp) :: products(self%n)
      integer :: i

      do i = 1, self%n
         associate (from => self%first(i), to => self%first(i + 1) - 1)
            products(i) = sum(abs(self%coefficient(from:to)*u(self%freedom(from:to))))
         end associate
      end do
   end function multiply_absolute

   !> Row i over all freedoms.
   pure function full_row(self, i, n_freedoms) result(row)
      type(row_matrix_type), intent(in) :: self
      integer, intent(in) :: i, n_freedoms
      real(wp) :: row(n_freedoms)

      row = 0.0_wp
      associate (from => self%first(i), to => self%first(i + 1) - 1)
         row(self%freedom(from:to)) = self%coefficient(from:to)
      end associate
   end function full_row

   !> Adds At x to a vector on freedoms.
   pure subroutine add_transposed(self, x, vector)
      type(row_matrix_type), intent(in) :: self
      real(wp), intent(in) :: x(:)               !! (n)
      real(wp), intent(inout) :: vector(:)       !! (n_freedoms)
      integer :: i, k

      do i = 1, self%n
         if (.not. abs(x(i)) > 0.0_wp) cycle
         do k = self%first(i), self%first(i + 1) - 1
            vector(self%freedom(k)) = vector(self%freedom(k)) + x(i)*self%coefficient(k)
         end do
      end do
   end subroutine add_transposed

end module row_matrix
