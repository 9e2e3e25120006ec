!> Errors as values: whatever can fail returns one, and only the main program stops.
module errors
   use memory_shortage, only: check_allocation
   use display, only: displayed
   implicit none
   private

   public :: error_type, new_error
   public :: status_done, status_usage, status_deck, status_file, status_numerical
   public :: status_interrupted, status_internal, status_memory

   integer, parameter :: status_done = 0
   integer, parameter :: status_usage = 1
   integer, parameter :: status_deck = 2
   integer, parameter :: status_file = 3
   integer, parameter :: status_numerical = 4
   integer, parameter :: status_interrupted = 5
   integer, parameter :: status_internal = 6
   !> Computing ends for want of memory as it does for want of numbers.
   integer, parameter :: status_memory = status_numerical

   !> What went wrong, with the exit status of the program that follows from it.
   type :: error_type
      integer :: status = status_internal
      character(len=:), allocatable :: message
   end type error_type

contains

   !> Makes an error of the given exit status; what cannot be shown becomes an escape.
   pure subroutine new_error(error, status, message)
      type(error_type), allocatable, intent(out) :: error
      integer, intent(in) :: status             !! one of the status_ parameters
      character(len=*), intent(in) :: message   !! what is wrong and what is allowed
      integer :: failed

      allocate (error, stat=failed)
      call check_allocation(failed)
      error%status = status
      error%message = displayed(message)
   end subroutine new_error

end module errors
