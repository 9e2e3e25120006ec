!> A map from names to positive integers (open addressing), so that lists of very many named things
!> are searched in constant time.
module name_map
   use memory_shortage, only: check_allocation
   use kinds, only: int64
   implicit none
   private

   public :: name_map_type, name_length

   !> Longest name of a set, material, surface, amplitude.
   integer, parameter :: name_length = 80

   !> Names with their values; `find` answers 0 for a name that is not there.
   type :: name_map_type
      private
      integer :: n_names = 0
      character(len=name_length), allocatable :: names(:)
      integer, allocatable :: values(:)
   contains
      procedure :: find
      procedure :: insert
   end type name_map_type

contains

   !> The value stored under a name, 0 if there is none.
   pure function find(self, name) result(value)
      class(name_map_type), intent(in) :: self
      character(len=*), intent(in) :: name       !! blanks at its end do not count
      integer :: value

      value = 0
      if (.not. allocated(self%values) .or. len_trim(name) > name_length) return
      value = self%values(slot_of(self%names, self%values, name))
   end function find

   !> Stores a value under a name; an earlier value is replaced.
   pure subroutine insert(self, name, value)
      class(name_map_type), intent(inout) :: self
      character(len=*), intent(in) :: name       !! name_length characters at most
      integer, intent(in) :: value               !! positive
      integer :: slot, status

      if (.not. allocated(self%values)) then
         allocate (self%names(16), stat=status)
         call check_allocation(status)
         allocate (self%values(16), source=0, stat=status)
         call check_allocation(status)
      end if
      if (2*self%n_names >= size(self%values)) call grow(self)
      slot = slot_of(self%names, self%values, name)
      if (self%values(slot) == 0) self%n_names = self%n_names + 1
      self%names(slot) = name
      self%values(slot) = value
   end subroutine insert

   !> The slot that holds the name, or the free one where it belongs (value 0).
   pure function slot_of(names, values, name) result(slot)
      character(len=*), intent(in) :: names(:), name
      integer, intent(in) :: values(:)
      integer :: slot

      slot = int(modulo(hash(name), int(size(values), int64))) + 1
      do while (values(slot) /= 0)
         if (names(slot) == name) return
         slot = slot + 1
         if (slot > size(values)) slot = 1
      end do
   end function slot_of

   !> FNV-1a of 32 bits, its halves mixed.
   pure function hash(name) result(key)
      character(len=*), intent(in) :: name
      integer(int64) :: key
      integer(int64), parameter :: start = 2166136261_int64, prime = 16777619_int64
      integer(int64), parameter :: word = 2_int64**32 - 1
      integer :: i

      key = start
      do i = 1, len_trim(name)
         key = iand(ieor(key, int(iachar(name(i:i)), int64))*prime, word)
      end do
      key = ieor(key, shiftr(key, 15))
   end function hash

   pure subroutine grow(self)
      type(name_map_type), intent(inout) :: self
      character(len=name_length), allocatable :: names(:)
      integer, allocatable :: values(:)
      integer :: i, slot, status

      call move_alloc(self%names, names)
      call move_alloc(self%values, values)
      allocate (self%names(2*size(values)), stat=status)
      call check_allocation(status)
      allocate (self%values(2*size(values)), source=0, stat=status)
      call check_allocation(status)
      do i = 1, size(values)
         if (values(i) == 0) cycle
         slot = slot_of(self%names, self%values, names(i))
         self%names(slot) = names(i)
         self%values(slot) = values(i)
      end do
   end subroutine grow

end module name_map
