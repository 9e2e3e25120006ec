!> An HDF5 file open for writing: its groups, and datasets of any kind by their addresses. hdf5_file
!> gives them types.
!>
!> Every failure (no permission, disk full, ...) comes back as an error of status_file that names the
!> file. A file that is reopened is made again by the same calls as a new one: groups and series that
!> are there stay, datasets and attributes are written anew, in their old place where they fit.
module hdf5_store
   use, intrinsic :: iso_c_binding, only: c_ptr
   use errors, only: error_type, new_error, status_file
   use hdf5_calls, only: close_file, create_file, flush_file, hid_t, hsize_t, make_group, &
         put_dataset, storage_type
   use hdf5_changes, only: cut_rows, has_object, open_to_change, overwrite_dataset, remove_object
   use kinds, only: int64
   use write_obstacles, only: write_obstacle
   implicit none
   private

   public :: hdf5_store_type

   !> A file open for writing. It must be closed: nothing closes it by itself.
   type :: hdf5_store_type
      integer(hid_t) :: id = -1
      character(len=:), allocatable :: path
      integer :: deflate = 0         !! compression of the series
      logical :: reopened = .false.
   contains
      procedure :: create
      procedure :: reopen
      procedure :: compress
      procedure :: is_open
      procedure :: flush => flush_to_disk
      procedure :: close => close_for_good
      procedure :: create_group
      procedure :: holds
      procedure :: remove
      procedure :: cut
      procedure :: put => put_values
      procedure :: renew => renew_values
      procedure :: fail => write_error
   end type hdf5_store_type

contains

   !> Creates the file; one that exists is replaced.
   subroutine create(self, path, error)
      class(hdf5_store_type), intent(out) :: self
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical :: failed

      self%path = path
      call create_file(path, self%id, failed)
      if (.not. failed) return
      self%id = -1
      call new_error(error, status_file, "cannot create '"//path//"': "//write_obstacle(path))
   end subroutine create

   !> Opens a file that exists, to go on writing it.
   subroutine reopen(self, path, error)
      class(hdf5_store_type), intent(out) :: self
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical :: failed

      self%path = path
      self%reopened = .true.
      call open_to_change(path, self%id, failed)
      if (.not. failed) return
      self%id = -1
      call new_error(error, status_file, "cannot open '"//path//"' to write it: not an HDF5 file, " &
            //'or no permission')
   end subroutine reopen

   !> Compresses all series made from here on.
   pure subroutine compress(self, level)
      class(hdf5_store_type), intent(inout) :: self
      integer, intent(in) :: level   !! 0, not at all, to 9

      self%deflate = level
   end subroutine compress

   !> Whether the file was created and not yet closed.
   pure logical function is_open(self)
      class(hdf5_store_type), intent(in) :: self

      is_open = self%id >= 0
   end function is_open

   !> Hands everything written so far to the operating system.
   subroutine flush_to_disk(self, error)
      class(hdf5_store_type), intent(in) :: self
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical :: failed

      call flush_file(self%id, failed)
      if (failed) call self%fail('everything', error)
   end subroutine flush_to_disk

   !> Closes the file; does nothing when it is not open.
   subroutine close_for_good(self, error)
      class(hdf5_store_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical :: failed

      if (.not. self%is_open()) return
      call close_file(self%id, failed)
      self%id = -1
      if (failed) call self%fail('everything', error)
   end subroutine close_for_good

   !> Makes a group; it must not exist yet unless the file was reopened.
   subroutine create_group(self, path, description, error)
      class(hdf5_store_type), intent(in) :: self
      character(len=*), intent(in) :: path, description
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical :: failed

      if (self%reopened) then
         if (self%holds(path)) return
      end if
      call make_group(self%id, path, description, failed)
      if (failed) call self%fail(path, error)
   end subroutine create_group

   !> Whether there is a group or dataset of this path.
   logical function holds(self, path)
      class(hdf5_store_type), intent(in) :: self
      character(len=*), intent(in) :: path

      holds = has_object(self%id, path)
   end function holds

   !> Takes a group or dataset away, if it is there.
   subroutine remove(self, path, error)
      class(hdf5_store_type), intent(in) :: self
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical :: failed

      call remove_object(self%id, path, failed)
      if (failed) call self%fail(path, error)
   end subroutine remove

   !> Cuts a series back to its first rows.
   subroutine cut(self, path, n_rows, short, error)
      class(hdf5_store_type), intent(in) :: self
      character(len=*), intent(in) :: path
      integer(int64), intent(in) :: n_rows
      logical, intent(out) :: short   !! it has fewer rows, or is not there
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer(hsize_t) :: n_missing
      logical :: failed

      short = .not. self%holds(path)
      if (short) return
      call cut_rows(self%id, path, int(n_rows, hsize_t), n_missing, failed)
      short = n_missing > 0
      if (failed) call self%fail(path, error)
   end subroutine cut

   !> Writes a dataset; one of this path is an error unless the file was reopened.
   subroutine put_values(self, path, description, storage, dims, address, error)
      class(hdf5_store_type), intent(in) :: self
      character(len=*), intent(in) :: path, description
      type(storage_type), intent(in) :: storage
      integer(hsize_t), intent(in) :: dims(:)
      type(c_ptr), intent(in) :: address
      type(error_type), allocatable, intent(out) :: error
      logical :: failed

      if (self%reopened) then
         call self%renew(path, description, storage, dims, address, error)
         return
      end if
      call put_dataset(self%id, path, description, storage, dims, address, failed)
      if (failed) call self%fail(path, error)
   end subroutine put_values

   !> Writes a dataset in the place of one of this path, if there is one.
   subroutine renew_values(self, path, description, storage, dims, address, error)
      class(hdf5_store_type), intent(in) :: self
      character(len=*), intent(in) :: path, description
      type(storage_type), intent(in) :: storage
      integer(hsize_t), intent(in) :: dims(:)
      type(c_ptr), intent(in) :: address
      type(error_type), allocatable, intent(out) :: error
      logical :: failed, done

      call overwrite_dataset(self%id, path, storage, dims, address, done)
      if (done) return
      call self%remove(path, error)
      if (allocated(error)) return
      call put_dataset(self%id, path, description, storage, dims, address, failed)
      if (failed) call self%fail(path, error)
   end subroutine renew_values

   !> The error that something could not be written.
   subroutine write_error(self, object, error)
      class(hdf5_store_type), intent(in) :: self
      character(len=*), intent(in) :: object
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: path

      path = '(no file)'
      if (allocated(self%path)) path = self%path
      call new_error(error, status_file, 'cannot write '//object//" to '"//path// &
            "': disk full, no access any more, or the file is not open")
   end subroutine write_error

end module hdf5_store
