!> The calls to the HDF5 library that open and close files; hdf5_calls has others.
module hdf5_opening
   use hdf5, only: h5dont_atexit_f, h5eset_auto_f, h5f_acc_rdonly_f, h5f_acc_rdwr_f, &
         h5f_acc_trunc_f, h5f_close_strong_f, h5f_scope_global_f, h5fclose_f, h5fcreate_f, &
         h5fflush_f, h5fget_filesize_f, h5fopen_f, h5open_f, h5p_file_access_f, h5pclose_f, &
         h5pcreate_f, h5pset_fclose_degree_f, hid_t, hsize_t
   use kinds, only: int64
   use file_calls, only: set_variable
   implicit none
   private

   public :: hid_t
   public :: create_file, modify_file, open_file, file_size, flush_file, close_file

contains

   !> Starts the library with its error printing off, and without its clean-up at the end of the
   !> program: after a disk that was full that ends in a segmentation fault (HDF5 1.10). Its locks
   !> are not used: part_file has one, which holds from before the file is made.
   subroutine start_library(silenced)
      integer, intent(out) :: silenced
      integer :: ignored   ! when the library runs already: fails, or is left undefined (1.10.10)

      call set_variable('HDF5_USE_FILE_LOCKING', 'FALSE')
      call h5dont_atexit_f(ignored)
      call h5open_f(ignored)
      call h5eset_auto_f(0, silenced)
   end subroutine start_library

   !> Creates the file or replaces it.
   subroutine create_file(path, file, failed)
      character(len=*), intent(in) :: path
      integer(hid_t), intent(out) :: file
      logical, intent(out) :: failed
      integer(hid_t) :: access
      integer :: status(4)

      file = -1
      call start_library(status(1))
      call h5pcreate_f(h5p_file_access_f, access, status(2))
      call h5pset_fclose_degree_f(access, h5f_close_strong_f, status(3))
      call h5fcreate_f(path, h5f_acc_trunc_f, file, status(4), access_prp=access)
      failed = any(status < 0)
      call h5pclose_f(access, status(1))
   end subroutine create_file

   !> Opens an existing file for changes.
   subroutine modify_file(path, file, failed)
      character(len=*), intent(in) :: path
      integer(hid_t), intent(out) :: file
      logical, intent(out) :: failed
      integer(hid_t) :: access
      integer :: status(4)

      file = -1
      call start_library(status(1))
      call h5pcreate_f(h5p_file_access_f, access, status(2))
      call h5pset_fclose_degree_f(access, h5f_close_strong_f, status(3))
      call h5fopen_f(path, h5f_acc_rdwr_f, file, status(4), access_prp=access)
      failed = any(status < 0)
      call h5pclose_f(access, status(1))
   end subroutine modify_file

   !> Bytes that the file takes with all that the library still holds of it.
   subroutine file_size(file, size, failed)
      integer(hid_t), intent(in) :: file
      integer(int64), intent(out) :: size
      logical, intent(out) :: failed
      integer(hsize_t) :: bytes
      integer :: status

      call h5fget_filesize_f(file, bytes, status)
      failed = status < 0
      size = int(bytes, int64)
   end subroutine file_size

   !> Opens an existing file for reading.
   subroutine open_file(path, file, failed)
      character(len=*), intent(in) :: path
      integer(hid_t), intent(out) :: file
      logical, intent(out) :: failed
      integer :: status(2)

      file = -1
      call start_library(status(1))
      call h5fopen_f(path, h5f_acc_rdonly_f, file, status(2))
      failed = any(status < 0)
   end subroutine open_file

   subroutine flush_file(file, failed)
      integer(hid_t), intent(in) :: file
      logical, intent(out) :: failed
      integer :: status

      call h5fflush_f(file, h5f_scope_global_f, status)
      failed = status < 0
   end subroutine flush_file

   subroutine close_file(file, failed)
      integer(hid_t), intent(in) :: file
      logical, intent(out) :: failed
      integer :: status

      call h5fclose_f(file, status)
      failed = status < 0
   end subroutine close_file

end module hdf5_opening
