!> Stands in for the processes of a parallel run in a build without MPI: there is one, rank 0.
module parallel_ranks
   implicit none
   private

   public :: start_ranks, end_ranks, my_rank, world, tell_ranks, hear_rank_zero

contains

   !> Nothing to join.
   pure subroutine start_ranks()
   end subroutine start_ranks

   !> Nothing to leave.
   pure subroutine end_ranks()
   end subroutine end_ranks

   !> Number of this process.
   pure integer function my_rank()
      my_rank = 0
   end function my_rank

   !> A communicator that nobody looks at.
   pure integer function world()
      world = 0
   end function world

   !> Nobody to tell.
   pure subroutine tell_ranks(message)
      integer, intent(in) :: message(2)
   end subroutine tell_ranks

   !> Nobody to hear.
   pure subroutine hear_rank_zero(message)
      integer, intent(out) :: message(2)

      message = 0
   end subroutine hear_rank_zero

end module parallel_ranks
