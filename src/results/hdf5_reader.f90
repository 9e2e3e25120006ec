!> An HDF5 file open for reading: whole datasets by path.
module hdf5_reader
   use, intrinsic :: iso_c_binding, only: c_char, c_loc
   use errors, only: error_type, new_error, status_file
   use hdf5_calls, only: close_storage, get_dataset, get_dims, hid_t, hsize_t, integer_storage, &
         long_storage, real_storage, text_storage
   use hdf5_opening, only: close_file, open_file
   use hdf5_changes, only: has_object, text_length
   use kinds, only: int64, wp
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: hdf5_reader_type

   !> A file open for reading. It must be closed: nothing closes it by itself.
   type :: hdf5_reader_type
      private
      integer(hid_t) :: id = -1
      character(len=:), allocatable :: path
   contains
      procedure :: open => open_for_reading
      procedure :: close => close_for_good
      procedure :: holds
      procedure :: get_shape
      procedure :: read_text
      procedure :: read_texts
      generic :: read_dataset => read_reals, read_integers, read_longs
      procedure, private :: read_reals, read_integers, read_longs
   end type hdf5_reader_type

contains

   subroutine open_for_reading(self, path, error)
      class(hdf5_reader_type), intent(out) :: self
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical :: failed, exists

      self%path = path
      call open_file(path, self%id, failed)
      if (.not. failed) return
      self%id = -1
      inquire (file=path, exist=exists)
      if (exists) then
         call new_error(error, status_file, "cannot read '"//path// &
               "': no HDF5 file, cut short or damaged, or no permission")
      else
         call new_error(error, status_file, "cannot read '"//path//"': no such file")
      end if
   end subroutine open_for_reading

   !> Closes the file; does nothing when it is not open.
   subroutine close_for_good(self)
      class(hdf5_reader_type), intent(inout) :: self
      logical :: failed

      if (self%id < 0) return
      call close_file(self%id, failed)
      self%id = -1
   end subroutine close_for_good

   !> Whether there is a group or dataset of this path.
   logical function holds(self, path)
      class(hdf5_reader_type), intent(in) :: self
      character(len=*), intent(in) :: path

      holds = has_object(self%id, path)
   end function holds

   !> The shape of a dataset as Fortran sees it (rows last); no dimension for a scalar.
   subroutine get_shape(self, path, extents, error)
      class(hdf5_reader_type), intent(in) :: self
      character(len=*), intent(in) :: path
      integer, allocatable, intent(out) :: extents(:)
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer(hsize_t), allocatable :: dims(:)
      logical :: failed

      call get_dims(self%id, path, dims, failed)
      if (failed) then
         call read_error(self, path, error)
      else
         extents = int(dims)
      end if
   end subroutine get_shape

   !> All values of a dataset of any shape, in the order they lie in the file.
   subroutine read_reals(self, path, values, error)
      class(hdf5_reader_type), intent(in) :: self
      character(len=*), intent(in) :: path
      real(wp), allocatable, target, intent(out) :: values(:)
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer, allocatable :: extents(:)
      logical :: failed
      integer :: status

      call self%get_shape(path, extents, error)
      if (allocated(error)) return
      allocate (values(product(extents)), stat=status)
      call check_allocation(status)
      if (size(values) == 0) return
      call get_dataset(self%id, path, real_storage(), c_loc(values), failed)
      if (failed) call read_error(self, path, error)
   end subroutine read_reals

   subroutine read_integers(self, path, values, error)
      class(hdf5_reader_type), intent(in) :: self
      character(len=*), intent(in) :: path
      integer, allocatable, target, intent(out) :: values(:)
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer, allocatable :: extents(:)
      logical :: failed
      integer :: status

      call self%get_shape(path, extents, error)
      if (allocated(error)) return
      allocate (values(product(extents)), stat=status)
      call check_allocation(status)
      if (size(values) == 0) return
      call get_dataset(self%id, path, integer_storage(), c_loc(values), failed)
      if (failed) call read_error(self, path, error)
   end subroutine read_integers

   subroutine read_longs(self, path, values, error)
      class(hdf5_reader_type), intent(in) :: self
      character(len=*), intent(in) :: path
      integer(int64), allocatable, target, intent(out) :: values(:)
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer, allocatable :: extents(:)
      logical :: failed
      integer :: status

      call self%get_shape(path, extents, error)
      if (allocated(error)) return
      allocate (values(product(extents)), stat=status)
      call check_allocation(status)
      if (size(values) == 0) return
      call get_dataset(self%id, path, long_storage(), c_loc(values), failed)
      if (failed) call read_error(self, path, error)
   end subroutine read_longs

   !> The one text of a scalar dataset, whole.
   subroutine read_text(self, path, text, error)
      class(hdf5_reader_type), intent(in) :: self
      character(len=*), intent(in) :: path
      character(len=:), allocatable, intent(out) :: text
      type(error_type), allocatable, intent(out) :: error   !! status_file
      character(kind=c_char), allocatable, target :: bytes(:)
      integer :: length, i, status
      logical :: failed

      length = text_length(self%id, path)
      failed = length == 0
      allocate (bytes(length), stat=status)
      call check_allocation(status)
      if (.not. failed) call get_texts(self%id, path, length, bytes, failed)
      allocate (character(len=length) :: text, stat=status)
      call check_allocation(status)
      do i = 1, length
         text(i:i) = bytes(i)
      end do
      if (failed) call read_error(self, path, error)
   end subroutine read_text

   !> All texts of a list, or the one of a scalar, cut or padded to the given length.
   subroutine read_texts(self, path, length, values, error)
      class(hdf5_reader_type), intent(in) :: self
      character(len=*), intent(in) :: path
      integer, intent(in) :: length
      character(len=length), allocatable, intent(out) :: values(:)
      type(error_type), allocatable, intent(out) :: error   !! status_file
      character(kind=c_char), allocatable, target :: bytes(:)
      integer, allocatable :: extents(:)
      logical :: failed
      integer :: status

      call self%get_shape(path, extents, error)
      if (allocated(error)) return
      allocate (values(product(extents)), bytes(product(extents)*length), stat=status)
      call check_allocation(status)
      if (size(values) == 0) return
      call get_texts(self%id, path, length, bytes, failed)
      values = transfer(bytes, values)
      if (failed) call read_error(self, path, error)
   end subroutine read_texts

   subroutine get_texts(file, path, length, bytes, failed)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: path
      integer, intent(in) :: length
      character(kind=c_char), contiguous, target, intent(inout) :: bytes(:)
      logical, intent(out) :: failed

      bytes = ' '
      associate (storage => text_storage(length))
         call get_dataset(file, path, storage, c_loc(bytes), failed)
         call close_storage(storage)
      end associate
   end subroutine get_texts

   subroutine read_error(self, object, error)
      class(hdf5_reader_type), intent(in) :: self
      character(len=*), intent(in) :: object
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: path

      path = '(no file)'
      if (allocated(self%path)) path = self%path
      call new_error(error, status_file, 'cannot read '//object//" from '"//path//"'")
   end subroutine read_error

end module hdf5_reader
