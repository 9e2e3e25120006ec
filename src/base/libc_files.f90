!> Calls of the C library (glibc or musl on Linux) for files, programs among them; file_calls gives
!> them Fortran's texts.
!>
!> Functions with a variable number of arguments are not among them, nor structures whose layout
!> depends on the machine: `statx` was made so that its own does not.
module libc_files
   use, intrinsic :: iso_c_binding, only: c_char, c_funptr, c_int, c_int16_t, c_int32_t, &
         c_int64_t, c_long, c_ptr, c_size_t
   implicit none
   private

   public :: statx_type, limit_type
   public :: c_access, c_close, c_copy_range, c_creat, c_dup, c_errno, c_execv, c_fallocate, &
         c_fclose, c_ferror, c_fflush, c_fileno, c_flock, c_fopen, c_free, c_fsync, c_ftruncate, &
         c_fwrite, c_getrlimit, c_mkdir
   public :: c_pread, c_realpath, c_rename, c_setenv, c_signal, c_statx, c_strerror, c_strlen, &
         c_unlink, c_write

   !> What Linux says of a file, the same on all machines.
   type, bind(c) :: statx_type
      integer(c_int32_t) :: mask, block_size
      integer(c_int64_t) :: attributes
      integer(c_int32_t) :: n_links, user, group
      integer(c_int16_t) :: mode, unused
      integer(c_int64_t) :: inode, size, n_blocks, attributes_mask
      integer(c_int64_t) :: times(8)
      integer(c_int32_t) :: of_device(2), device(2)
      integer(c_int64_t) :: spare(14)
   end type statx_type

   !> A limit of the process: bytes, negative (as a signed number) for none.
   type, bind(c) :: limit_type
      integer(c_long) :: now, most
   end type limit_type

   interface
      function c_errno() bind(c, name='__errno_location') result(place)
         import :: c_ptr
         implicit none
         type(c_ptr) :: place
      end function c_errno

      function c_strerror(number) bind(c, name='strerror') result(text)
         import :: c_int, c_ptr
         implicit none
         integer(c_int), value :: number
         type(c_ptr) :: text
      end function c_strerror

      function c_strlen(text) bind(c, name='strlen') result(length)
         import :: c_ptr, c_size_t
         implicit none
         type(c_ptr), value :: text
         integer(c_size_t) :: length
      end function c_strlen

      subroutine c_free(memory) bind(c, name='free')
         import :: c_ptr
         implicit none
         type(c_ptr), value :: memory
      end subroutine c_free

      function c_statx(folder, path, flags, mask, facts) bind(c, name='statx') result(status)
         import :: c_char, c_int, c_int32_t, statx_type
         implicit none
         integer(c_int), value :: folder, flags
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int32_t), value :: mask
         type(statx_type), intent(inout) :: facts
         integer(c_int) :: status
      end function c_statx

      function c_access(path, mode) bind(c, name='access') result(status)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
         integer(c_int) :: status
      end function c_access

      function c_realpath(path, room) bind(c, name='realpath') result(text)
         import :: c_char, c_ptr
         implicit none
         character(kind=c_char), intent(in) :: path(*)
         type(c_ptr), value :: room
         type(c_ptr) :: text
      end function c_realpath

      function c_fopen(path, mode) bind(c, name='fopen') result(stream)
         import :: c_char, c_ptr
         implicit none
         character(kind=c_char), intent(in) :: path(*), mode(*)
         type(c_ptr) :: stream
      end function c_fopen

      function c_fileno(stream) bind(c, name='fileno') result(descriptor)
         import :: c_int, c_ptr
         implicit none
         type(c_ptr), value :: stream
         integer(c_int) :: descriptor
      end function c_fileno

      function c_fclose(stream) bind(c, name='fclose') result(status)
         import :: c_int, c_ptr
         implicit none
         type(c_ptr), value :: stream
         integer(c_int) :: status
      end function c_fclose

      function c_fwrite(bytes, size, n, stream) bind(c, name='fwrite') result(n_written)
         import :: c_char, c_ptr, c_size_t
         implicit none
         character(kind=c_char), intent(in) :: bytes(*)
         integer(c_size_t), value :: size, n
         type(c_ptr), value :: stream
         integer(c_size_t) :: n_written
      end function c_fwrite

      function c_fflush(stream) bind(c, name='fflush') result(status)
         import :: c_int, c_ptr
         implicit none
         type(c_ptr), value :: stream
         integer(c_int) :: status
      end function c_fflush

      function c_ferror(stream) bind(c, name='ferror') result(status)
         import :: c_int, c_ptr
         implicit none
         type(c_ptr), value :: stream
         integer(c_int) :: status
      end function c_ferror

      function c_dup(descriptor) bind(c, name='dup') result(copy)
         import :: c_int
         implicit none
         integer(c_int), value :: descriptor
         integer(c_int) :: copy
      end function c_dup

      function c_creat(path, mode) bind(c, name='creat') result(descriptor)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
         integer(c_int) :: descriptor
      end function c_creat

      function c_close(descriptor) bind(c, name='close') result(status)
         import :: c_int
         implicit none
         integer(c_int), value :: descriptor
         integer(c_int) :: status
      end function c_close

      function c_flock(descriptor, operation) bind(c, name='flock') result(status)
         import :: c_int
         implicit none
         integer(c_int), value :: descriptor, operation
         integer(c_int) :: status
      end function c_flock

      function c_fsync(descriptor) bind(c, name='fsync') result(status)
         import :: c_int
         implicit none
         integer(c_int), value :: descriptor
         integer(c_int) :: status
      end function c_fsync

      function c_ftruncate(descriptor, length) bind(c, name='ftruncate') result(status)
         import :: c_int, c_int64_t
         implicit none
         integer(c_int), value :: descriptor
         integer(c_int64_t), value :: length
         integer(c_int) :: status
      end function c_ftruncate

      function c_fallocate(descriptor, mode, first, length) bind(c, name='fallocate') &
            result(status)
         import :: c_int, c_int64_t
         implicit none
         integer(c_int), value :: descriptor, mode
         integer(c_int64_t), value :: first, length
         integer(c_int) :: status
      end function c_fallocate

      function c_getrlimit(resource, limit) bind(c, name='getrlimit') result(status)
         import :: c_int, limit_type
         implicit none
         integer(c_int), value :: resource
         type(limit_type), intent(out) :: limit
         integer(c_int) :: status
      end function c_getrlimit

      function c_copy_range(from, from_place, to, to_place, length, flags) &
            bind(c, name='copy_file_range') result(n)
         import :: c_int, c_int64_t, c_size_t
         implicit none
         integer(c_int), value :: from, to, flags
         integer(c_int64_t), intent(inout) :: from_place, to_place
         integer(c_size_t), value :: length
         integer(c_size_t) :: n   ! negative: failed
      end function c_copy_range

      function c_pread(descriptor, bytes, length, place) bind(c, name='pread') result(n)
         import :: c_char, c_int, c_int64_t, c_size_t
         implicit none
         integer(c_int), value :: descriptor
         character(kind=c_char), intent(inout) :: bytes(*)
         integer(c_size_t), value :: length
         integer(c_int64_t), value :: place
         integer(c_size_t) :: n   ! negative: failed
      end function c_pread

      function c_write(descriptor, bytes, length) bind(c, name='write') result(n)
         import :: c_char, c_int, c_size_t
         implicit none
         integer(c_int), value :: descriptor
         character(kind=c_char), intent(in) :: bytes(*)
         integer(c_size_t), value :: length
         integer(c_size_t) :: n   ! negative: failed
      end function c_write

      function c_rename(old, new) bind(c, name='rename') result(status)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: old(*), new(*)
         integer(c_int) :: status
      end function c_rename

      function c_unlink(path) bind(c, name='unlink') result(status)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: status
      end function c_unlink

      function c_execv(path, words) bind(c, name='execv') result(status)
         import :: c_char, c_int, c_ptr
         implicit none
         character(kind=c_char), intent(in) :: path(*)
         type(c_ptr), intent(in) :: words(*)   ! null behind the last
         integer(c_int) :: status
      end function c_execv

      function c_mkdir(path, mode) bind(c, name='mkdir') result(status)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
         integer(c_int) :: status
      end function c_mkdir

      function c_setenv(name, text, overwrite) bind(c, name='setenv') result(status)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: name(*), text(*)
         integer(c_int), value :: overwrite
         integer(c_int) :: status
      end function c_setenv

      function c_signal(number, handler) bind(c, name='signal') result(before)
         import :: c_funptr, c_int
         implicit none
         integer(c_int), value :: number
         type(c_funptr), value :: handler
         type(c_funptr) :: before
      end function c_signal
   end interface

end module libc_files
