!> What the operating system knows and does of files. A call that fails returns the system's reason
!> ("No space left on device"); one that succeeds an empty text.
module file_calls
   use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_funptr, c_int, c_int32_t, &
         c_int64_t, c_intptr_t, c_associated, c_null_char, c_null_ptr, c_ptr, c_size_t
   use libc_files, only: statx_type, limit_type, c_access, c_close, c_copy_range, c_creat, c_dup, &
         c_errno, c_fallocate, c_fclose, c_fileno, c_flock, c_fopen, c_free, c_fsync, c_ftruncate, &
         c_getrlimit, c_mkdir, c_pread, c_realpath, c_rename, c_setenv, c_signal, c_statx, &
         c_strerror, c_strlen, c_unlink, c_write
   use kinds, only: int64
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: file_facts_type, look_at, look_at_open, is_same, is_regular, is_device, is_folder
   public :: true_path, folder_of, check_folder, make_folders
   public :: open_to_keep, open_to_read, close_open, try_lock, copy_open, sync_open, sync_folder
   public :: rename_file, remove_file, reserve_blocks, release_blocks, size_limit
   public :: ignore_signals, set_variable, last_reason

   !> A file as the system knows it; two names of one file have the same device and inode.
   type :: file_facts_type
      logical :: exists = .false.
      integer :: kind = 0                        !! one of the kinds below
      integer :: device(2) = 0
      integer(int64) :: inode = 0
      integer(int64) :: size = 0                 !! bytes
      integer :: n_links = 0                     !! names; 0: removed but still open
   end type file_facts_type

   integer, parameter :: kind_device = 2, kind_folder = 4, kind_regular = 8   ! mode/4096
   integer, parameter :: blocked = 11, unsupported(3) = [22, 38, 95]   ! EAGAIN; EINVAL ...
   integer, parameter :: block_length = 2**20

contains

   !> What is at a path; links are followed. What cannot be looked at does not exist.
   function look_at(path) result(facts)
      character(len=*), intent(in) :: path
      type(file_facts_type) :: facts
      integer(c_int), parameter :: here = -100   ! AT_FDCWD

      facts = facts_from(here, path, 0_c_int)
   end function look_at

   !> What is known of an open file.
   function look_at_open(descriptor) result(facts)
      integer, intent(in) :: descriptor
      type(file_facts_type) :: facts
      integer(c_int), parameter :: itself = 4096   ! AT_EMPTY_PATH

      facts = facts_from(int(descriptor, c_int), '', itself)
   end function look_at_open

   function facts_from(folder, path, flags) result(facts)
      integer(c_int), intent(in) :: folder, flags
      character(len=*), intent(in) :: path
      type(file_facts_type) :: facts
      type(statx_type) :: raw
      integer(c_int32_t), parameter :: basic = 2047   ! STATX_BASIC_STATS

      raw%n_links = 0
      facts%exists = c_statx(folder, path//c_null_char, flags, basic, raw) == 0
      if (.not. facts%exists) return
      facts%kind = ibits(int(raw%mode), 12, 4)
      facts%device = raw%device
      facts%inode = raw%inode
      facts%size = raw%size
      facts%n_links = raw%n_links
   end function facts_from

   !> Whether both are there and one file.
   pure logical function is_same(a, b)
      type(file_facts_type), intent(in) :: a, b

      is_same = a%exists .and. b%exists .and. a%inode == b%inode .and. all(a%device == b%device)
   end function is_same

   pure logical function is_regular(facts)
      type(file_facts_type), intent(in) :: facts

      is_regular = facts%exists .and. facts%kind == kind_regular
   end function is_regular

   !> A device that takes characters, as /dev/null.
   pure logical function is_device(facts)
      type(file_facts_type), intent(in) :: facts

      is_device = facts%exists .and. facts%kind == kind_device
   end function is_device

   pure logical function is_folder(facts)
      type(file_facts_type), intent(in) :: facts

      is_folder = facts%exists .and. facts%kind == kind_folder
   end function is_folder

   !> The path from the root without links; empty if nothing is there.
   function true_path(path)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: true_path
      type(c_ptr) :: text

      text = c_realpath(path//c_null_char, c_null_ptr)
      true_path = to_fortran(text)
      if (c_associated(text)) call c_free(text)
   end function true_path

   !> The folder part of a path: '.' where it has none.
   pure function folder_of(path) result(folder)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: folder
      integer :: slash

      slash = index(path, '/', back=.true.)
      folder = '.'
      if (slash > 0) folder = path(:max(1, slash - 1))
   end function folder_of

   !> Whether files can be made in a folder.
   subroutine check_folder(folder, reason)
      character(len=*), intent(in) :: folder
      character(len=:), allocatable, intent(out) :: reason
      integer(c_int), parameter :: to_write_and_search = 3

      reason = outcome(c_access(folder//'/.'//c_null_char, to_write_and_search))
   end subroutine check_folder

   !> Makes a folder and those above it where they are missing.
   recursive subroutine make_folders(folder)
      character(len=*), intent(in) :: folder
      integer(c_int) :: ignored

      if (len(folder) < 2 .or. is_folder(look_at(folder))) return
      call make_folders(folder_of(folder))
      ignored = c_mkdir(folder//c_null_char, int(o'777', c_int))
   end subroutine make_folders

   !> Opens a file for reading and writing; it is made where it is missing and not cut where it is
   !> not.
   subroutine open_to_keep(path, descriptor, reason)
      character(len=*), intent(in) :: path
      integer, intent(out) :: descriptor
      character(len=:), allocatable, intent(out) :: reason

      call open_by_mode(path, 'a+', descriptor, reason)
   end subroutine open_to_keep

   subroutine open_to_read(path, descriptor, reason)
      character(len=*), intent(in) :: path
      integer, intent(out) :: descriptor
      character(len=:), allocatable, intent(out) :: reason

      call open_by_mode(path, 'r', descriptor, reason)
   end subroutine open_to_read

   subroutine open_by_mode(path, mode, descriptor, reason)
      character(len=*), intent(in) :: path, mode   !! the mode as in fopen
      integer, intent(out) :: descriptor
      character(len=:), allocatable, intent(out) :: reason
      type(c_ptr) :: stream
      integer(c_int) :: ignored

      descriptor = -1
      stream = c_fopen(path//c_null_char, mode//c_null_char)
      if (.not. c_associated(stream)) then
         reason = last_reason()
         return
      end if
      descriptor = c_dup(c_fileno(stream))
      reason = outcome(int(min(descriptor, 0), c_int))
      ignored = c_fclose(stream)
   end subroutine open_by_mode

   subroutine close_open(descriptor)
      integer, intent(inout) :: descriptor   !! -1 afterwards
      integer(c_int) :: ignored

      if (descriptor >= 0) ignored = c_close(int(descriptor, c_int))
      descriptor = -1
   end subroutine close_open

   !> Takes the lock of an open file; `taken` says that another process has it. Where the file
   !> system has no locks the file counts as locked.
   subroutine try_lock(descriptor, taken)
      integer, intent(in) :: descriptor
      logical, intent(out) :: taken
      integer(c_int), parameter :: exclusive_at_once = 6

      taken = c_flock(int(descriptor, c_int), exclusive_at_once) /= 0
      if (taken) taken = last_number() == blocked
   end subroutine try_lock

   !> Copies an open file from its beginning to a new file, which is closed; with `to_disk` not
   !> before the disk has it.
   subroutine copy_open(descriptor, path, to_disk, reason)
      integer, intent(in) :: descriptor
      character(len=*), intent(in) :: path
      logical, intent(in) :: to_disk
      character(len=:), allocatable, intent(out) :: reason
      integer(c_int) :: from, to, closed

      from = int(descriptor, c_int)
      to = c_creat(path//c_null_char, int(o'666', c_int))
      reason = outcome(to)
      if (to < 0) return
      call copy_bytes(from, to, reason)
      if (to_disk .and. len(reason) == 0) reason = outcome(c_fsync(to))
      closed = c_close(to)
      if (len(reason) == 0) reason = outcome(closed)
   end subroutine copy_open

   !> The system copies by itself where it can; else in blocks.
   subroutine copy_bytes(from, to, reason)
      integer(c_int), intent(in) :: from, to
      character(len=:), allocatable, intent(out) :: reason
      integer(c_int64_t) :: from_place, to_place
      integer(c_size_t) :: n

      from_place = 0
      to_place = 0
      do
         n = c_copy_range(from, from_place, to, to_place, int(2**30, c_size_t), 0_c_int)
         if (n <= 0) exit
      end do
      ! some file systems copy nothing and call that a success
      if (n == 0 .and. from_place > 0) then
         reason = ''
      else if (from_place == 0) then
         call copy_blocks(from, to, reason)
      else
         reason = last_reason()
      end if
   end subroutine copy_bytes

   subroutine copy_blocks(from, to, reason)
      integer(c_int), intent(in) :: from, to
      character(len=:), allocatable, intent(out) :: reason
      character(kind=c_char), allocatable :: bytes(:)
      integer(c_int64_t) :: place
      integer(c_size_t) :: n, first, written
      integer :: status

      allocate (bytes(block_length), stat=status)
      call check_allocation(status)
      reason = ''
      place = 0
      do
         n = c_pread(from, bytes, int(block_length, c_size_t), place)
         if (n <= 0) exit
         place = place + n
         first = 1
         do while (first <= n)
            written = c_write(to, bytes(first:n), n - first + 1)
            if (written < 0) then
               reason = last_reason()
               return
            end if
            first = first + written
         end do
      end do
      if (n < 0) reason = last_reason()
   end subroutine copy_blocks

   !> Waits until the disk has all of an open file.
   subroutine sync_open(descriptor, reason)
      integer, intent(in) :: descriptor
      character(len=:), allocatable, intent(out) :: reason

      reason = outcome(c_fsync(int(descriptor, c_int)))
   end subroutine sync_open

   !> Waits until the disk has the names in a folder.
   subroutine sync_folder(folder)
      character(len=*), intent(in) :: folder
      type(c_ptr) :: stream
      integer(c_int) :: ignored

      stream = c_fopen(folder//c_null_char, 'r'//c_null_char)
      if (.not. c_associated(stream)) return
      ignored = c_fsync(c_fileno(stream))
      ignored = c_fclose(stream)
   end subroutine sync_folder

   !> Gives a file another name, at one instant; what had that name is gone.
   subroutine rename_file(old, new, reason)
      character(len=*), intent(in) :: old, new
      character(len=:), allocatable, intent(out) :: reason

      reason = outcome(c_rename(old//c_null_char, new//c_null_char))
   end subroutine rename_file

   !> Removes a file; one that is not there is no matter.
   subroutine remove_file(path)
      character(len=*), intent(in) :: path
      integer(c_int) :: ignored

      ignored = c_unlink(path//c_null_char)
   end subroutine remove_file

   !> Has the disk set aside the blocks of an open file between two places; its size stays. Where
   !> the file system cannot do so nothing is set aside, and that is no failure.
   subroutine reserve_blocks(descriptor, first, last, reason)
      integer, intent(in) :: descriptor
      integer(int64), intent(in) :: first, last   !! bytes before the first one and up to the last
      character(len=:), allocatable, intent(out) :: reason
      integer(c_int), parameter :: keep_size = 1

      reason = ''
      if (last <= first) return
      if (c_fallocate(int(descriptor, c_int), keep_size, first, last - first) == 0) return
      if (.not. any(last_number() == unsupported)) reason = last_reason()
   end subroutine reserve_blocks

   !> Gives back what was set aside behind the end of an open file.
   subroutine release_blocks(descriptor)
      integer, intent(in) :: descriptor
      type(file_facts_type) :: facts
      integer(c_int) :: ignored

      facts = look_at_open(descriptor)
      if (facts%exists) ignored = c_ftruncate(int(descriptor, c_int), facts%size)
   end subroutine release_blocks

   !> Bytes that a file of this process may have.
   function size_limit() result(limit)
      integer(int64) :: limit
      type(limit_type) :: raw
      integer(c_int), parameter :: file_size = 1   ! RLIMIT_FSIZE

      limit = huge(limit)
      if (c_getrlimit(file_size, raw) /= 0) return
      if (raw%now >= 0) limit = raw%now
   end function size_limit

   !> Has signals without effect: the calls that caused them fail instead.
   subroutine ignore_signals(numbers)
      integer, intent(in) :: numbers(:)
      integer(c_intptr_t), parameter :: ignore = 1   ! SIG_IGN
      type(c_funptr) :: before
      integer :: i

      do i = 1, size(numbers)
         before = c_signal(int(numbers(i), c_int), transfer(ignore, before))
      end do
   end subroutine ignore_signals

   !> Sets a variable of the environment.
   subroutine set_variable(name, text)
      character(len=*), intent(in) :: name, text
      integer(c_int) :: ignored

      ignored = c_setenv(name//c_null_char, text//c_null_char, 1_c_int)
   end subroutine set_variable

   !> Empty for a call that succeeded.
   function outcome(status) result(reason)
      integer(c_int), intent(in) :: status   !! negative: failed
      character(len=:), allocatable :: reason

      reason = ''
      if (status < 0) reason = last_reason()
   end function outcome

   !> The number of the failure last met.
   function last_number() result(number)
      integer :: number
      integer(c_int), pointer :: errno

      call c_f_pointer(c_errno(), errno)
      number = errno
   end function last_number

   !> The system's words for the failure of the last call.
   function last_reason() result(reason)
      character(len=:), allocatable :: reason

      reason = to_fortran(c_strerror(int(last_number(), c_int)))
   end function last_reason

   !> A text of C; empty for none.
   function to_fortran(from) result(text)
      type(c_ptr), intent(in) :: from
      character(len=:), allocatable :: text
      character(kind=c_char), pointer :: bytes(:)
      integer :: i, status

      if (.not. c_associated(from)) then
         text = ''
         return
      end if
      call c_f_pointer(from, bytes, [c_strlen(from)])
      allocate (character(len=size(bytes)) :: text, stat=status)
      call check_allocation(status)
      do i = 1, size(bytes)
         text(i:i) = bytes(i)
      end do
   end function to_fortran

end module file_calls
