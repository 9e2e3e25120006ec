!> The end of a program that gets no more memory: a message and the exit status. Nothing here takes
!> memory for itself.
module memory_end
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t, c_char
   use errors, only: status_memory
   implicit none
   private

   public :: end_without_memory

   !> Bytes that are a megabyte where memory is spoken of.
   integer(c_size_t), parameter :: megabyte = 1000000_c_size_t
   integer(c_int), parameter :: standard_output = 1_c_int, standard_error = 2_c_int

   interface
      function write_bytes(file, bytes, n) bind(c, name='write') result(written)
         import :: c_int, c_char, c_size_t
         implicit none
         integer(c_int), value :: file
         character(kind=c_char), intent(in) :: bytes(200)
         integer(c_size_t), value :: n   !! written of them
         integer(c_size_t) :: written
      end function write_bytes

      subroutine exit_process(status) bind(c, name='exit')
         import :: c_int
         implicit none
         integer(c_int), value :: status
      end subroutine exit_process
   end interface

contains

   !> Says that so many bytes are not to be had (0: not known how many) and ends the process. Open
   !> files are closed on the way out.
   subroutine end_without_memory(bytes) bind(c, name='carom_end_without_memory')
      integer(c_size_t), value :: bytes

      call put('error: out of memory: ')
      if (bytes > 0) then
         call put_number(max(1_c_size_t, bytes/megabyte))
         call put(' MB more are asked for, and the system refuses them')
      else
         call put('more is asked for than the system has')
      end if
      call put(new_line('a')//'  cure: a smaller model or fewer requests (carom check tells what ' &
            //'takes the memory), fewer threads, or a higher limit (ulimit -v)'//new_line('a'))
      if (wants_json()) then
         call put('{"program": "carom", "status": 4, "ending": "failed", "error": ' &
               //'{"message": "out of memory", "file": null, "line": null, '//new_line('a'), &
               standard_output)
         call put('"cause": "out of memory", "cure": "a smaller model, fewer requests or ' &
               //'threads, or a higher limit (ulimit -v)"}}'//new_line('a'), standard_output)
      end if
      call exit_process(int(status_memory, c_int))
   end subroutine end_without_memory

   !> Whether the command line asks for JSON.
   logical function wants_json()
      character(len=7) :: word
      integer :: i

      wants_json = .false.
      do i = 2, command_argument_count()
         call get_command_argument(i, word)
         if (word == '--json') wants_json = .true.
      end do
   end function wants_json

   subroutine put(text, file)
      character(len=*, kind=c_char), intent(in) :: text
      integer(c_int), intent(in), optional :: file   !! standard error when left out
      integer(c_int) :: target_file
      character(len=1, kind=c_char) :: letters(200)
      integer(c_size_t) :: n
      integer :: i

      target_file = standard_error
      if (present(file)) target_file = file
      do i = 1, min(len(text), size(letters))
         letters(i) = text(i:i)
      end do
      n = write_bytes(target_file, letters, int(min(len(text), size(letters)), c_size_t))
      if (n < 0) return
   end subroutine put

   subroutine put_number(number)
      integer(c_size_t), intent(in) :: number
      character(len=20) :: digits
      integer(c_size_t) :: rest
      integer :: first

      rest = number
      first = len(digits) + 1
      do
         first = first - 1
         digits(first:first) = achar(iachar('0') + int(mod(rest, 10_c_size_t)))
         rest = rest/10
         if (rest == 0 .or. first == 1) exit
      end do
      call put(digits(first:))
   end subroutine put_number

end module memory_end
