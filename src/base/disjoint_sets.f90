!> Sets that grow together: things joined one after the other, as the nodes of elements to bodies.
!> Each thing has a parent, the top of a set is its own.
module disjoint_sets
   implicit none
   private

   public :: join, top_of

contains

   !> Makes the sets of two things one, whose top is the smaller of both tops.
   pure subroutine join(parent, a, b)
      integer, intent(inout) :: parent(:)        !! parent(i) = i at the start
      integer, intent(in) :: a, b
      integer :: i, next, top

      top = min(top_of(parent, a), top_of(parent, b))
      parent(top_of(parent, a)) = top
      parent(top_of(parent, b)) = top
      ! short ways for those to come
      i = b
      do while (parent(i) /= top)
         next = parent(i)
         parent(i) = top
         i = next
      end do
   end subroutine join

   !> The top of the set that a thing is in.
   pure function top_of(parent, thing) result(top)
      integer, intent(in) :: parent(:), thing
      integer :: top

      top = thing
      do while (parent(top) /= top)
         top = parent(top)
      end do
   end function top_of

end module disjoint_sets
