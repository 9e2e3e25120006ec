!> The memory that the program has, as the operating system counts it.
module memory_use
   use kinds, only: wp
   implicit none
   private

   public :: resident_memory

contains

   !> Bytes now resident and the most there have been, from /proc/self/status; zero where there is
   !> no such file.
   subroutine resident_memory(now, most)
      real(wp), intent(out) :: now, most
      character(len=200) :: line
      integer :: unit, status

      now = 0.0_wp
      most = 0.0_wp
      open (newunit=unit, file='/proc/self/status', action='read', status='old', iostat=status)
      if (status /= 0) return
      do
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         if (index(line, 'VmHWM:') == 1) most = bytes_of(line)
         if (index(line, 'VmRSS:') == 1) now = bytes_of(line)
      end do
      close (unit)
   end subroutine resident_memory

   !> Of a line "name: number kB".
   pure function bytes_of(line) result(bytes)
      character(len=*), intent(in) :: line
      real(wp) :: bytes
      integer :: status

      read (line(index(line, ':') + 1:index(line, 'kB') - 1), *, iostat=status) bytes
      if (status /= 0) bytes = 0.0_wp
      bytes = 1024.0_wp*bytes
   end function bytes_of

end module memory_use
