!> Order in which the elements of a group are worked on: blocks of like elements that one loop
!> takes at once, and chunks of blocks that one thread takes at once. The order depends on the
!> group alone, never on the number of threads.
module element_blocks
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: blocks_type, new_blocks, block_size

   !> Most elements of a block.
   integer, parameter :: block_size = 64

   !> Elements of a chunk: enough to be worth a thread, and few enough for its cache.
   integer, parameter :: most_in_chunk = 8192, fewest_in_chunk = 512, wanted_chunks = 16

   !> Block b is order(first(b):first(b + 1) - 1), chunk c blocks chunk_first(c):chunk_first(c + 1)
   !> - 1. Without classes a block starts at an element one after a multiple of block_size.
   type :: blocks_type
      integer :: n_chunks = 0
      integer, allocatable :: order(:)          !! (n_elements)
      integer, allocatable :: first(:)          !! (n_blocks + 1)
      integer, allocatable :: chunk_first(:)    !! (n_chunks + 1)
   end type blocks_type

contains

   !> Blocks of elements of one class each.
   pure subroutine new_blocks(self, class)
      type(blocks_type), intent(out) :: self
      integer, intent(in) :: class(:)           !! (n_elements) from 1
      integer, allocatable :: first(:)
      integer :: n, in_chunk, c, from, to, n_blocks, e, status

      n = size(class)
      in_chunk = min(max(n/wanted_chunks, fewest_in_chunk), most_in_chunk)
      in_chunk = (in_chunk/block_size)*block_size
      self%n_chunks = (n + in_chunk - 1)/in_chunk
      allocate (self%order(n), self%chunk_first(self%n_chunks + 1), first(n + 1), stat=status)
      call check_allocation(status)
      n_blocks = 0
      do c = 1, self%n_chunks
         self%chunk_first(c) = n_blocks + 1
         from = (c - 1)*in_chunk + 1
         to = min(n, c*in_chunk)
         call sort_by_class(class(from:to), from - 1, self%order(from:to))
         do e = from, to
            if (e > from) then
               if (e - first(n_blocks) < block_size .and. &
                     class(self%order(e)) == class(self%order(e - 1))) cycle
            end if
            n_blocks = n_blocks + 1
            first(n_blocks) = e
         end do
      end do
      self%chunk_first(self%n_chunks + 1) = n_blocks + 1
      first(n_blocks + 1) = n + 1
      self%first = first(:n_blocks + 1)
   end subroutine new_blocks

   !> Stable order by class.
   pure subroutine sort_by_class(class, offset, order)
      integer, intent(in) :: class(:)
      integer, intent(in) :: offset             !! index of the element before the first
      integer, intent(out) :: order(:)
      integer, allocatable :: place(:)
      integer :: e, low, status

      if (all(class == class(1))) then
         order = [(offset + e, e=1, size(class))]
         return
      end if
      low = minval(class)
      allocate (place(low:maxval(class) + 1), stat=status)
      call check_allocation(status)
      place = 0
      do e = 1, size(class)
         place(class(e) + 1) = place(class(e) + 1) + 1
      end do
      place(low) = 1
      do e = low + 1, ubound(place, 1)
         place(e) = place(e) + place(e - 1)
      end do
      do e = 1, size(class)
         order(place(class(e))) = offset + e
         place(class(e)) = place(class(e)) + 1
      end do
   end subroutine sort_by_class

end module element_blocks
