!> An HDF5 file open for writing: datasets, attributes and growing datasets ("series") by path.
!>
!> Missing groups on the way to a new dataset are made. Integers are stored with 64 bits (and handed
!> over so: the library's own conversion clears a megabyte for each dataset), reals in
!> double precision. An array of shape (3, n) appears as n x 3 in the file.
module hdf5_file
   use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_ptr
   use errors, only: error_type
   use hdf5_calls, only: byte_storage, close_storage, hsize_t, integer_storage, long_storage, &
         put_attribute, real_storage, storage_type, text_storage
   use hdf5_series, only: append_block, chunks_type, get_last_block, make_series
   use hdf5_output, only: hdf5_output_type
   use, intrinsic :: iso_fortran_env, only: int8
   use kinds, only: int64, wp
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: hdf5_file_type, series_real, series_integer

   !> What a series of numbers holds.
   integer, parameter :: series_real = 1
   integer, parameter :: series_integer = 2

   !> A file open for writing. It must be closed: nothing closes it by itself.
   type, extends(hdf5_output_type) :: hdf5_file_type
   contains
      procedure :: write_bytes
      procedure :: create_series
      procedure :: create_text_series
      generic :: write_dataset => write_reals, write_real_table, write_integers, write_longs, &
            write_integer_table, write_text, write_texts
      generic :: overwrite => overwrite_reals, overwrite_longs
      generic :: set_attribute => set_integer, set_integers, set_real, set_text
      generic :: append => append_reals, append_real_table, append_integers, append_longs, &
            append_texts
      generic :: read_last => read_last_table, read_last_longs
      procedure, private :: read_last_table, read_last_longs
      procedure, private :: write_reals, write_real_table, write_integers, write_integer_table
      procedure, private :: write_text, write_texts, write_longs, overwrite_reals, overwrite_longs
      procedure, private :: set_integer, set_integers, set_real, set_text
      procedure, private :: append_reals, append_real_table, append_integers, append_longs
      procedure, private :: append_texts
   end type hdf5_file_type

contains

   subroutine write_reals(self, path, values, description, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path, description
      real(wp), intent(in), contiguous, target :: values(:)
      type(error_type), allocatable, intent(out) :: error

      call self%put(path, description, real_storage(), shape(values, hsize_t), c_loc(values), error)
   end subroutine write_reals

   subroutine write_real_table(self, path, values, description, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path, description
      real(wp), intent(in), contiguous, target :: values(:, :)
      type(error_type), allocatable, intent(out) :: error

      call self%put(path, description, real_storage(), shape(values, hsize_t), c_loc(values), error)
   end subroutine write_real_table

   subroutine write_integers(self, path, values, description, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path, description
      integer, intent(in) :: values(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int64), allocatable, target :: longs(:)

      longs = int(values, int64)
      call self%put(path, description, long_storage(), shape(longs, hsize_t), c_loc(longs), error)
   end subroutine write_integers

   subroutine write_integer_table(self, path, values, description, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path, description
      integer, intent(in) :: values(:, :)
      type(error_type), allocatable, intent(out) :: error
      integer(int64), allocatable, target :: longs(:, :)

      longs = int(values, int64)
      call self%put(path, description, long_storage(), shape(longs, hsize_t), c_loc(longs), error)
   end subroutine write_integer_table

   !> Integers 0 to 255, stored as unsigned 8 bit numbers.
   subroutine write_bytes(self, path, values, description, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path, description
      integer, intent(in) :: values(:)
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer(int8), allocatable, target :: bytes(:)

      bytes = int(modulo(values + 128, 256) - 128, int8)
      call self%put(path, description, byte_storage(), shape(bytes, hsize_t), c_loc(bytes), error)
   end subroutine write_bytes

   !> One text as a scalar of exactly its length.
   subroutine write_text(self, path, value, description, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path, value, description
      type(error_type), allocatable, intent(out) :: error
      character(kind=c_char), allocatable, target :: bytes(:)
      type(storage_type) :: storage

      call to_bytes([value], bytes)
      storage = text_storage(size(bytes))
      call self%put(path, description, storage, [integer(hsize_t) ::], c_loc(bytes), error)
      call close_storage(storage)
   end subroutine write_text

   subroutine write_texts(self, path, values, description, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path, values(:), description
      type(error_type), allocatable, intent(out) :: error
      character(kind=c_char), allocatable, target :: bytes(:)
      type(storage_type) :: storage

      call to_bytes(values, bytes)
      storage = text_storage(max(1, len(values)))
      call self%put(path, description, storage, shape(values, hsize_t), c_loc(bytes), error)
      call close_storage(storage)
   end subroutine write_texts

   subroutine write_longs(self, path, values, description, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path, description
      integer(int64), intent(in), contiguous, target :: values(:)
      type(error_type), allocatable, intent(out) :: error

      call self%put(path, description, long_storage(), shape(values, hsize_t), c_loc(values), error)
   end subroutine write_longs

   subroutine overwrite_reals(self, path, values, description, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path, description
      real(wp), intent(in), contiguous, target :: values(:)
      type(error_type), allocatable, intent(out) :: error

      call self%renew(path, description, real_storage(), shape(values, hsize_t), c_loc(values), &
            error)
   end subroutine overwrite_reals

   subroutine overwrite_longs(self, path, values, description, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path, description
      integer(int64), intent(in), contiguous, target :: values(:)
      type(error_type), allocatable, intent(out) :: error

      call self%renew(path, description, long_storage(), shape(values, hsize_t), c_loc(values), &
            error)
   end subroutine overwrite_longs

   subroutine set_integer(self, object, name, value, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: object, name
      integer, intent(in) :: value
      type(error_type), allocatable, intent(out) :: error
      integer, target :: number
      logical :: failed

      number = value
      call put_attribute(self%id, object, name, integer_storage(), [integer(hsize_t) ::], &
            c_loc(number), failed)
      if (failed) call self%write_failure(object//'@'//name, error)
   end subroutine set_integer

   subroutine set_integers(self, object, name, values, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: object, name
      integer, intent(in), contiguous, target :: values(:)
      type(error_type), allocatable, intent(out) :: error
      logical :: failed

      call put_attribute(self%id, object, name, integer_storage(), shape(values, hsize_t), &
            c_loc(values), failed)
      if (failed) call self%write_failure(object//'@'//name, error)
   end subroutine set_integers

   subroutine set_real(self, object, name, value, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: object, name
      real(wp), intent(in) :: value
      type(error_type), allocatable, intent(out) :: error
      real(wp), target :: number
      logical :: failed

      number = value
      call put_attribute(self%id, object, name, real_storage(), [integer(hsize_t) ::], &
            c_loc(number), failed)
      if (failed) call self%write_failure(object//'@'//name, error)
   end subroutine set_real

   !> A text of exactly its length: nothing padded, nothing trimmed.
   subroutine set_text(self, object, name, value, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: object, name, value
      type(error_type), allocatable, intent(out) :: error
      character(kind=c_char), allocatable, target :: bytes(:)
      type(storage_type) :: storage
      logical :: failed

      call to_bytes([value], bytes)
      storage = text_storage(size(bytes))
      call put_attribute(self%id, object, name, storage, [integer(hsize_t) ::], c_loc(bytes), &
            failed)
      call close_storage(storage)
      if (failed) call self%write_failure(object//'@'//name, error)
   end subroutine set_text

   !> Makes an empty dataset of numbers that grows by `append`.
   subroutine create_series(self, path, kind, n_components, chunk_rows, description, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path, description
      integer, intent(in) :: kind           !! series_real or series_integer
      integer, intent(in) :: n_components   !! 0: shape (N) in the file; n: shape N x n
      integer, intent(in) :: chunk_rows     !! rows that lie together in the file
      type(error_type), allocatable, intent(out) :: error   !! status_file
      type(storage_type) :: storage
      logical :: failed

      if (self%reopened) then
         if (self%holds(path)) return
      end if
      storage = real_storage()
      if (kind == series_integer) storage = integer_storage()
      call make_series(self%id, path, description, storage, n_components, &
            chunks_type(chunk_rows, self%deflate), failed)
      if (failed) call self%write_failure(path, error)
   end subroutine create_series

   !> Makes an empty list of texts that grows by `append`; longer texts are cut.
   subroutine create_text_series(self, path, length, chunk_rows, description, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path, description
      integer, intent(in) :: length, chunk_rows
      type(error_type), allocatable, intent(out) :: error   !! status_file
      type(storage_type) :: storage
      logical :: failed

      if (self%reopened) then
         if (self%holds(path)) return
      end if
      storage = text_storage(length)
      call make_series(self%id, path, description, storage, 0, &
            chunks_type(chunk_rows, self%deflate), failed)
      call close_storage(storage)
      if (failed) call self%write_failure(path, error)
   end subroutine create_text_series

   subroutine append_reals(self, path, values, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      real(wp), intent(in), contiguous, target :: values(:)
      type(error_type), allocatable, intent(out) :: error

      call append_values(self, path, real_storage(), size(values), c_loc(values), error)
   end subroutine append_reals

   subroutine append_real_table(self, path, values, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      real(wp), intent(in), contiguous, target :: values(:, :)
      type(error_type), allocatable, intent(out) :: error

      call append_values(self, path, real_storage(), size(values), c_loc(values), error)
   end subroutine append_real_table

   subroutine append_integers(self, path, values, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      integer, intent(in) :: values(:)
      type(error_type), allocatable, intent(out) :: error

      call self%append_longs(path, int(values, int64), error)
   end subroutine append_integers

   subroutine append_longs(self, path, values, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      integer(int64), intent(in), contiguous, target :: values(:)
      type(error_type), allocatable, intent(out) :: error

      call append_values(self, path, long_storage(), size(values), c_loc(values), error)
   end subroutine append_longs

   subroutine append_texts(self, path, values, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path, values(:)
      type(error_type), allocatable, intent(out) :: error
      character(kind=c_char), allocatable, target :: bytes(:)
      type(storage_type) :: storage

      call to_bytes(values, bytes)
      storage = text_storage(max(1, len(values)))
      call append_values(self, path, storage, size(values), c_loc(bytes), error)
      call close_storage(storage)
   end subroutine append_texts

   subroutine append_values(self, path, storage, n_values, address, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      type(storage_type), intent(in) :: storage
      integer, intent(in) :: n_values
      type(c_ptr), intent(in) :: address
      type(error_type), allocatable, intent(out) :: error
      logical :: failed

      call append_block(self%id, path, storage, n_values, address, failed)
      if (failed) call self%write_failure(path, error)
   end subroutine append_values

   !> The last rows of a series of a reopened file.
   subroutine read_last_table(self, path, values, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      real(wp), intent(inout), contiguous, target :: values(:, :)   !! (component, row); (1, row)
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical :: failed

      call get_last_block(self%id, path, real_storage(), size(values), c_loc(values), failed)
      if (failed) call self%read_failure(path, error)
   end subroutine read_last_table

   subroutine read_last_longs(self, path, values, error)
      class(hdf5_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      integer(int64), intent(inout), contiguous, target :: values(:)
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical :: failed

      call get_last_block(self%id, path, long_storage(), size(values), c_loc(values), failed)
      if (failed) call self%read_failure(path, error)
   end subroutine read_last_longs

   !> The characters of the texts, one after the other; a blank for a text of no length.
   pure subroutine to_bytes(texts, bytes)
      character(len=*), intent(in) :: texts(:)
      character(kind=c_char), allocatable, target, intent(out) :: bytes(:)
      integer :: status

      allocate (bytes(max(1, len(texts))*size(texts)), stat=status)
      call check_allocation(status)
      bytes = c_char_' '
      if (len(texts) > 0) bytes = transfer(texts, bytes)
   end subroutine to_bytes

end module hdf5_file
