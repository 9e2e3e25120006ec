!> What an allocate statement is followed by: without memory the program ends at once, with a
!> message and its own exit status. There is nothing to be gone back to, and the results published
!> until then are complete files.
module memory_shortage
   use, intrinsic :: iso_c_binding, only: c_size_t
   implicit none
   private

   public :: check_allocation

   interface
      !> In `memory_end`. Pure as seen from here, since it does not come back.
      pure subroutine end_without_memory(bytes) bind(c, name='carom_end_without_memory')
         import :: c_size_t
         implicit none
         integer(c_size_t), value :: bytes
      end subroutine end_without_memory
   end interface

contains

   !> Ends the program unless the status of an allocation is that of success.
   pure subroutine check_allocation(status)
      integer, intent(in) :: status

      if (status /= 0) call end_without_memory(0_c_size_t)
   end subroutine check_allocation

end module memory_shortage
