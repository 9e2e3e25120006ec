!> What stands in the way of a result file.
module write_obstacles
   implicit none
   private

   public :: write_obstacle

contains

   !> Why a file cannot be written, as the Fortran library sees it.
   function write_obstacle(path) result(message)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: message
      character(len=256) :: io_message
      integer :: unit, status, first

      open (newunit=unit, file=path, action='readwrite', status='unknown', iostat=status, &
            iomsg=io_message)
      if (status == 0) then
         close (unit)
         message = 'another program has it open, or the disk is full'
      else
         first = index(io_message, ': ', back=.true.)
         message = trim(io_message(merge(first + 2, 1, first > 0):))
      end if
   end function write_obstacle

end module write_obstacles
