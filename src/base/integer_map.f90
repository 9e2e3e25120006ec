!> A map from integers to positive integers (open addressing), for ids that are neither dense
!> nor ordered.
module integer_map
   use kinds, only: int64
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: integer_map_type

   !> Keys with their values; `find` answers 0 for a key that is not there.
   type :: integer_map_type
      private
      integer :: n_keys = 0
      integer, allocatable :: keys(:), values(:)
   contains
      procedure :: find
      procedure :: insert
   end type integer_map_type

contains

   !> The value stored under a key, 0 if there is none.
   pure function find(self, key) result(value)
      class(integer_map_type), intent(in) :: self
      integer, intent(in) :: key
      integer :: value

      value = 0
      if (.not. allocated(self%keys)) return
      value = self%values(slot_of(self%keys, self%values, key))
   end function find

   !> Stores a value under a key; an earlier value is replaced.
   pure subroutine insert(self, key, value)
      class(integer_map_type), intent(inout) :: self
      integer, intent(in) :: key
      integer, intent(in) :: value   !! positive
      integer :: slot, status

      if (.not. allocated(self%keys)) then
         allocate (self%keys(16), self%values(16), stat=status)
         call check_allocation(status)
         self%keys = 0
         self%values = 0
      end if
      if (2*self%n_keys >= size(self%keys)) call grow(self)
      slot = slot_of(self%keys, self%values, key)
      if (self%values(slot) == 0) self%n_keys = self%n_keys + 1
      self%keys(slot) = key
      self%values(slot) = value
   end subroutine insert

   !> The slot that holds the key, or the free one where it belongs (value 0). Sixteen neighbouring
   !> keys stay neighbours, so that ids in order are found without a jump in memory each; their
   !> block is spread by its product with 2^32 over the golden ratio.
   pure function slot_of(keys, values, key) result(slot)
      integer, intent(in) :: keys(:), values(:), key
      integer :: slot
      integer(int64), parameter :: multiplier = 2654435769_int64, word = 2_int64**32 - 1
      integer, parameter :: block = 16
      integer(int64) :: place

      place = iand(shiftr(key, 4)*multiplier, word)
      place = shiftr(place*(size(keys)/block), 32)*block + iand(key, block - 1)
      slot = int(place) + 1
      do while (values(slot) /= 0 .and. keys(slot) /= key)
         slot = slot + 1
         if (slot > size(keys)) slot = 1
      end do
   end function slot_of

   pure subroutine grow(self)
      type(integer_map_type), intent(inout) :: self
      integer, allocatable :: keys(:), values(:)
      integer :: i, slot, length, status

      call move_alloc(self%keys, keys)
      call move_alloc(self%values, values)
      length = 2*size(keys)
      allocate (self%keys(length), self%values(length), stat=status)
      call check_allocation(status)
      self%keys = 0
      self%values = 0
      do i = 1, size(keys)
         if (values(i) == 0) cycle
         slot = slot_of(self%keys, self%values, keys(i))
         self%keys(slot) = keys(i)
         self%values(slot) = values(i)
      end do
   end subroutine grow

end module integer_map
