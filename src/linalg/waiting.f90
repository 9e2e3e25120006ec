!> Threads that wait for the work of others.
module waiting
   use, intrinsic :: iso_c_binding, only: c_int
   implicit none
   private

   public :: wait_for, report, pass_turn

   interface
      function yield() bind(c, name='sched_yield') result(status)
         import :: c_int
         implicit none
         integer(c_int) :: status
      end function yield
   end interface

contains

   !> Waits until another thread has reported a count.
   subroutine wait_for(count, wanted)
      integer, intent(inout) :: count            !! written by the other thread
      integer, intent(in) :: wanted
      integer :: now, n_looks

      n_looks = 0
      do
         !$omp atomic read
         now = count
         if (now >= wanted) exit
         call pass_turn(n_looks)
      end do
      !$omp flush
   end subroutine wait_for

   !> Lets other processes run now and then.
   subroutine pass_turn(n_looks)
      integer, intent(inout) :: n_looks          !! looks so far
      integer, parameter :: patience = 2000
      integer(c_int) :: status

      n_looks = n_looks + 1
      if (n_looks > patience) status = yield()
   end subroutine pass_turn

   !> Reports a count to threads that wait for it.
   subroutine report(count, done)
      integer, intent(inout) :: count
      integer, intent(in) :: done

      !$omp flush
      !$omp atomic write
      count = done
   end subroutine report

end module waiting
