!> The memory that the program has, and what the operating system tells of memory in its files.
module memory_use
   use kinds, only: wp
   implicit none
   private

   public :: resident_memory, number_in_file

contains

   !> Bytes now resident and the most there have been; zero where the system does not tell.
   subroutine resident_memory(now, most)
      real(wp), intent(out) :: now, most

      now = 1024.0_wp*max(0.0_wp, number_in_file('/proc/self/status', 'VmRSS:'))
      most = 1024.0_wp*max(0.0_wp, number_in_file('/proc/self/status', 'VmHWM:'))
   end subroutine resident_memory

   !> The number behind a word that begins a line; -1 where there is no such file, line or number.
   function number_in_file(path, word) result(number)
      character(len=*), intent(in) :: path
      character(len=*), intent(in) :: word       !! empty: the first number of the file
      real(wp) :: number
      character(len=200) :: line
      integer :: unit, status

      number = -1.0_wp
      open (newunit=unit, file=path, action='read', status='old', iostat=status)
      if (status /= 0) return
      do
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         if (index(line, word) /= 1) cycle
         read (line(len(word) + 1:), *, iostat=status) number
         if (status /= 0) number = -1.0_wp
         exit
      end do
      close (unit)
   end function number_in_file

end module memory_use
