!> The processes of a parallel run (MPI): rank 0 reads, computes and writes, the others help it
!> with the linear algebra and wait for its messages between.
module parallel_ranks
   use mpi_f08, only: mpi_init, mpi_initialized, mpi_finalize, mpi_comm_rank, mpi_bcast, &
         mpi_comm_world, mpi_integer
   implicit none
   private

   public :: start_ranks, end_ranks, my_rank, world, tell_ranks, hear_rank_zero

contains

   !> Joins the processes, unless that has been done.
   subroutine start_ranks()
      logical :: started

      call mpi_initialized(started)
      if (.not. started) call mpi_init()
   end subroutine start_ranks

   !> Leaves the other processes; all of them have to.
   subroutine end_ranks()
      call mpi_finalize()
   end subroutine end_ranks

   !> Number of this process, from 0.
   integer function my_rank()
      call mpi_comm_rank(mpi_comm_world, my_rank)
   end function my_rank

   !> The communicator of all processes, as other libraries want it.
   integer function world()
      call start_ranks()
      world = mpi_comm_world%mpi_val
   end function world

   !> Rank 0 sends a message to all others.
   subroutine tell_ranks(message)
      integer, intent(in) :: message(2)
      integer :: copy(2)

      copy = message
      call mpi_bcast(copy, 2, mpi_integer, 0, mpi_comm_world)
   end subroutine tell_ranks

   !> The others wait for a message of rank 0.
   subroutine hear_rank_zero(message)
      integer, intent(out) :: message(2)

      message = 0
      call mpi_bcast(message, 2, mpi_integer, 0, mpi_comm_world)
   end subroutine hear_rank_zero

end module parallel_ranks
