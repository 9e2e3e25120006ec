!> A file of text lines that is only written. Lines are gathered and written in blocks; whether that
!> has failed, on a full disk say, is asked now and then: `check_text`.
module text_file
   use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_new_line, c_null_char, &
         c_int64_t, c_null_ptr, c_ptr, c_size_t
   use errors, only: error_type, new_error, status_file
   use libc_files, only: c_fclose, c_ferror, c_fflush, c_fileno, c_fopen, c_ftruncate, c_fwrite
   use file_calls, only: file_facts_type, is_regular, last_reason, look_at
   implicit none
   private

   public :: text_file_type, open_text, resume_text, write_line, check_text, close_text

   !> An open file, or none: then nothing is written.
   type :: text_file_type
      private
      character(len=:), allocatable :: path
      type(c_ptr) :: stream = c_null_ptr
      character(len=:), allocatable :: problem   ! the message of the first failure
   end type text_file_type

contains

   !> Makes the file, or goes on behind the lines of one.
   subroutine open_text(self, path, append, error)
      type(text_file_type), intent(out) :: self
      character(len=*), intent(in) :: path
      logical, intent(in) :: append              !! keep what is there
      type(error_type), allocatable, intent(out) :: error   !! status_file

      self%path = path
      self%stream = c_fopen(path//c_null_char, merge('a', 'w', append)//c_null_char)
      if (.not. c_associated(self%stream)) call text_error(self, error)
   end subroutine open_text

   !> Goes on behind the first lines of a file, and cuts off the rest. It is not emptied in between:
   !> whatever ends the run, they stay.
   subroutine resume_text(self, path, lines, error)
      type(text_file_type), intent(out) :: self
      character(len=*), intent(in) :: path
      character(len=*), intent(in) :: lines      !! what it is to begin with, and most often does
      type(error_type), allocatable, intent(out) :: error   !! status_file
      type(file_facts_type) :: before
      integer(c_size_t) :: ignored

      before = look_at(path)
      if (.not. before%exists) then
         call open_text(self, path, .false., error)
      else
         self%path = path
         self%stream = c_fopen(path//c_null_char, 'r+'//c_null_char)
         if (.not. c_associated(self%stream)) call text_error(self, error)
      end if
      if (allocated(error)) return
      ignored = c_fwrite(lines, 1_c_size_t, len(lines, c_size_t), self%stream)
      call check_text(self, error)
      if (allocated(error) .or. .not. is_regular(before)) return
      if (c_ftruncate(c_fileno(self%stream), len(lines, c_int64_t)) /= 0) call text_error(self, &
            error)
   end subroutine resume_text

   !> One line, or several parted by new lines.
   subroutine write_line(self, line)
      type(text_file_type), intent(in) :: self
      character(len=*), intent(in) :: line
      integer(c_size_t) :: ignored               ! the stream remembers a failure

      if (.not. c_associated(self%stream)) return
      ignored = c_fwrite(line//c_new_line, 1_c_size_t, len(line, c_size_t) + 1_c_size_t, &
            self%stream)
   end subroutine write_line

   !> Hands all lines to the system; an error if that, or any write before, has failed: the same one
   !> whenever it is asked for.
   subroutine check_text(self, error)
      type(text_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error   !! status_file

      if (.not. c_associated(self%stream)) return
      if (allocated(self%problem)) then
         call new_error(error, status_file, self%problem)
         return
      else if (c_fflush(self%stream) /= 0) then
         call text_error(self, error)
      else if (c_ferror(self%stream) /= 0) then
         call new_error(error, status_file, 'cannot write '''//self%path//''': lines are missing' &
               //new_line('a')//'  cure: make room on the disk')
      end if
      if (allocated(error)) self%problem = error%message
   end subroutine check_text

   !> Closes the file.
   subroutine close_text(self)
      type(text_file_type), intent(inout) :: self
      integer(c_int) :: ignored

      if (.not. c_associated(self%stream)) return
      ignored = c_fclose(self%stream)
      self%stream = c_null_ptr
   end subroutine close_text

   subroutine text_error(self, error)
      type(text_file_type), intent(in) :: self
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: reason

      reason = last_reason()
      call new_error(error, status_file, 'cannot write '''//self%path//''': '//reason &
            //new_line('a')//'  cure: make room, or give the results another place with -o')
   end subroutine text_error

end module text_file
