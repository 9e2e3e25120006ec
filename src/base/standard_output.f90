!> Standard output, by the stream of the C library: Fortran's own does not tell that lines were
!> lost. The stream remembers it, for those who ask at the end: `check_standard_output`.
module standard_output
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int, c_new_line, c_null_char, &
         c_null_ptr, c_ptr, c_size_t
   use errors, only: error_type, new_error, status_file
   use libc_files, only: c_ferror, c_fflush, c_find_variable, c_fwrite
   use file_calls, only: last_reason
   implicit none
   private

   public :: print_line, print_text, flush_standard_output, check_standard_output

contains

   !> The stream, which the C library holds; Fortran cannot name a variable of another library.
   function c_stdout() result(stream)
      type(c_ptr) :: stream
      type(c_ptr), pointer :: variable

      call c_f_pointer(c_find_variable(c_null_ptr, 'stdout'//c_null_char), variable)
      stream = variable
   end function c_stdout

   !> One line, or several parted by new lines.
   subroutine print_line(line)
      character(len=*), intent(in) :: line

      call print_text(line//c_new_line)
   end subroutine print_line

   !> A text that does not end its line.
   subroutine print_text(text)
      character(len=*), intent(in) :: text
      integer(c_size_t) :: ignored               ! the stream remembers a failure

      ignored = c_fwrite(text, 1_c_size_t, len(text, c_size_t), c_stdout())
   end subroutine print_text

   !> Hands all to the system; whoever needs to know asks `check_standard_output`.
   subroutine flush_standard_output()
      integer(c_int) :: ignored

      ignored = c_fflush(c_stdout())
   end subroutine flush_standard_output

   !> An error if anything printed so far was lost.
   subroutine check_standard_output(error)
      type(error_type), allocatable, intent(out) :: error   !! status_file
      character(len=:), allocatable :: reason

      if (c_fflush(c_stdout()) /= 0) then
         reason = last_reason()
      else if (c_ferror(c_stdout()) /= 0) then
         reason = 'lines are missing'
      else
         return
      end if
      call new_error(error, status_file, 'cannot write to standard output: '//reason &
            //new_line('a')//'  cure: make room where it is sent to, or send it elsewhere')
   end subroutine check_standard_output

end module standard_output
