!> The lines of a status file that an earlier run has written up to a place.
module status_lines
   use file_calls, only: is_regular, look_at
   implicit none
   private

   public :: read_status_lines, line_length

   !> Of an increment: a line that is shorter was cut off when the run was killed.
   integer, parameter :: line_length = 82
   integer, parameter :: longest = 200

contains

   !> All lines up to an increment, comments among them, each with its new line; none if the file
   !> cannot be read.
   subroutine read_status_lines(path, step, increment, with_last, lines)
      character(len=*), intent(in) :: path
      integer, intent(in) :: step, increment     !! the place
      logical, intent(in) :: with_last           !! the increment of the place too
      character(len=:), allocatable, intent(out) :: lines
      character(len=:), allocatable :: longer
      character(len=longest) :: line
      integer :: unit, status, n

      n = 0
      lines = ''
      ! a pipe would wait for ever
      if (.not. is_regular(look_at(path))) return
      open (newunit=unit, file=path, status='old', action='read', iostat=status)
      if (status /= 0) return
      lines = repeat(' ', 65536)
      do
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         if (.not. is_wanted(line, step, increment, with_last)) cycle
         if (n + longest + 1 > len(lines)) then
            longer = lines//repeat(' ', len(lines))
            call move_alloc(longer, lines)
         end if
         lines(n + 1:n + len_trim(line) + 1) = trim(line)//new_line('a')
         n = n + len_trim(line) + 1
      end do
      close (unit)
      lines = lines(:n)
   end subroutine read_status_lines

   !> A comment, or the line of an increment up to the place.
   function is_wanted(line, step, increment, with_last) result(wanted)
      character(len=*), intent(in) :: line
      integer, intent(in) :: step, increment
      logical, intent(in) :: with_last
      logical :: wanted
      integer :: place(2), status

      wanted = line(1:1) == '#'
      if (wanted .or. len_trim(line) /= line_length) return
      read (line, *, iostat=status) place
      if (status /= 0) return
      wanted = place(1) < step .or. (place(1) == step .and. place(2) < increment)
      wanted = wanted .or. (with_last .and. all(place == [step, increment]))
   end function is_wanted

end module status_lines
