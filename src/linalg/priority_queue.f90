!> A binary heap of numbered items with priorities that grow; the highest comes out first, of equal
!> ones the lowest number.
module priority_queue
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: queue_type, new_queue

   !> Items 1..n, in the heap or not.
   type :: queue_type
      integer :: n_queued = 0
      integer, allocatable, private :: item(:)       !! (n) the heap
      integer, allocatable, private :: place(:)      !! (n) of an item in the heap, 0: not there
      integer, allocatable :: priority(:)            !! (n)
   contains
      procedure :: insert
      procedure :: raise
      procedure :: take
   end type queue_type

contains

   !> An empty queue for items with the given priorities.
   pure subroutine new_queue(self, priority)
      type(queue_type), intent(out) :: self
      integer, intent(in) :: priority(:)
      integer :: status

      self%priority = priority
      allocate (self%item(size(priority)), self%place(size(priority)), stat=status)
      call check_allocation(status)
      self%place = 0
   end subroutine new_queue

   !> Puts an item in.
   pure subroutine insert(self, item)
      class(queue_type), intent(inout) :: self
      integer, intent(in) :: item

      self%n_queued = self%n_queued + 1
      call lift(self, item, self%n_queued)
   end subroutine insert

   !> Adds to the priority of an item, whether it is in the queue or not.
   pure subroutine raise(self, item, amount)
      class(queue_type), intent(inout) :: self
      integer, intent(in) :: item
      integer, intent(in) :: amount                  !! not negative

      self%priority(item) = self%priority(item) + amount
      if (self%place(item) > 0) call lift(self, item, self%place(item))
   end subroutine raise

   !> Takes the first item out of a queue that is not empty.
   pure subroutine take(self, item)
      class(queue_type), intent(inout) :: self
      integer, intent(out) :: item
      integer :: moved, hole, child

      item = self%item(1)
      self%place(item) = 0
      moved = self%item(self%n_queued)
      self%n_queued = self%n_queued - 1
      if (self%n_queued == 0) return
      hole = 1
      do
         child = 2*hole
         if (child > self%n_queued) exit
         if (child < self%n_queued) then
            if (precedes(self, self%item(child + 1), self%item(child))) child = child + 1
         end if
         if (.not. precedes(self, self%item(child), moved)) exit
         call put(self, self%item(child), hole)
         hole = child
      end do
      call put(self, moved, hole)
   end subroutine take

   !> Moves an item up from an empty place as far as it belongs.
   pure subroutine lift(self, item, from)
      type(queue_type), intent(inout) :: self
      integer, intent(in) :: item, from
      integer :: hole

      hole = from
      do while (hole > 1)
         if (.not. precedes(self, item, self%item(hole/2))) exit
         call put(self, self%item(hole/2), hole)
         hole = hole/2
      end do
      call put(self, item, hole)
   end subroutine lift

   pure subroutine put(self, item, place)
      type(queue_type), intent(inout) :: self
      integer, intent(in) :: item, place

      self%item(place) = item
      self%place(item) = place
   end subroutine put

   pure logical function precedes(self, a, b)
      type(queue_type), intent(in) :: self
      integer, intent(in) :: a, b

      precedes = self%priority(a) > self%priority(b) .or. &
            (self%priority(a) == self%priority(b) .and. a < b)
   end function precedes

end module priority_queue
