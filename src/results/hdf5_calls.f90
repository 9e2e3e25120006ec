!> The calls to the HDF5 library, with those of hdf5_opening, hdf5_series and hdf5_changes the only
!> ones: groups, datasets and attributes by path. hdf5_file and hdf5_reader give them types.
module hdf5_calls
   use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_ptr
   use hdf5, only: h5_integer_kind, h5aclose_f, h5acreate_f, h5aexists_f, h5aopen_f, h5awrite_f, &
         h5dclose_f, h5dcreate_f, h5dget_space_f, h5dopen_f, h5dread_f, h5dwrite_f, h5gclose_f, &
         h5gcreate_f, h5kind_to_type, h5oclose_f, h5oopen_f, h5p_link_create_f, h5pclose_f, &
         h5pcreate_f, h5pset_create_inter_group_f, h5s_scalar_f, h5sclose_f, h5screate_f, &
         h5screate_simple_f, h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, &
         h5t_fortran_s1, h5t_ieee_f64le, h5t_native_double, h5t_native_integer, h5t_std_i64le, &
         h5t_std_u8le, h5t_str_nullpad_f, h5tclose_f, h5tcopy_f, h5tset_size_f, h5tset_strpad_f, &
         hid_t, hsize_t, size_t
   use kinds, only: int64
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: hid_t, hsize_t, storage_type
   public :: real_storage, integer_storage, long_storage, byte_storage, text_storage, close_storage
   public :: make_group
   public :: put_dataset, put_attribute, get_dims, shape_of, get_dataset, describe, link_property

   !> How one kind of value is stored and how it lies in memory.
   type :: storage_type
      integer(hid_t) :: in_file = -1
      integer(hid_t) :: in_memory = -1
      integer :: bytes = 8                       !! of a value in the file
   end type storage_type

contains

   function real_storage() result(storage)
      type(storage_type) :: storage

      storage%in_file = h5t_ieee_f64le
      storage%in_memory = h5t_native_double
   end function real_storage

   function integer_storage() result(storage)
      type(storage_type) :: storage

      storage%in_file = h5t_std_i64le
      storage%in_memory = h5t_native_integer
   end function integer_storage

   function long_storage() result(storage)
      type(storage_type) :: storage

      storage%in_file = h5t_std_i64le
      storage%in_memory = h5kind_to_type(int64, h5_integer_kind)
   end function long_storage

   !> Unsigned 8 bit numbers, in memory as in the file.
   function byte_storage() result(storage)
      type(storage_type) :: storage

      storage%bytes = 1
      storage%in_file = h5t_std_u8le
      storage%in_memory = h5t_std_u8le
   end function byte_storage

   !> Texts of the given length, ASCII; `close_storage` gives its types back.
   function text_storage(length) result(storage)
      integer, intent(in) :: length
      type(storage_type) :: storage
      integer :: status

      storage%bytes = length
      call h5tcopy_f(h5t_fortran_s1, storage%in_memory, status)
      call h5tset_size_f(storage%in_memory, int(length, size_t), status)
      call h5tcopy_f(storage%in_memory, storage%in_file, status)
      call h5tset_strpad_f(storage%in_file, h5t_str_nullpad_f, status)
   end function text_storage

   subroutine close_storage(storage)
      type(storage_type), intent(in) :: storage
      integer :: status

      call h5tclose_f(storage%in_file, status)
      call h5tclose_f(storage%in_memory, status)
   end subroutine close_storage

   subroutine make_group(file, path, description, failed)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: path, description
      logical, intent(out) :: failed
      integer(hid_t) :: group, links
      integer :: status(5)

      call link_property(links, status(1))
      call h5gcreate_f(file, path, group, status(2), lcpl_id=links)
      call describe(group, description, status(3))
      call h5gclose_f(group, status(4))
      call h5pclose_f(links, status(5))
      failed = any(status < 0)
   end subroutine make_group

   !> Makes a dataset of fixed size and writes it.
   subroutine put_dataset(file, path, description, storage, dims, address, failed)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: path, description
      type(storage_type), intent(in) :: storage
      integer(hsize_t), intent(in) :: dims(:)   !! no dimension: a scalar
      type(c_ptr), intent(in) :: address
      logical, intent(out) :: failed
      integer(hid_t) :: space, dataset, links
      integer :: status(8)

      status = 0
      call make_space(dims, space, status(1))
      call link_property(links, status(2))
      call h5dcreate_f(file, path, storage%in_file, space, dataset, status(3), lcpl_id=links)
      if (status(3) >= 0) then
         call describe(dataset, description, status(8))
         if (product(dims) > 0) call h5dwrite_f(dataset, storage%in_memory, address, status(4))
         call h5dclose_f(dataset, status(5))
      end if
      call h5pclose_f(links, status(6))
      call h5sclose_f(space, status(7))
      failed = any(status < 0)
   end subroutine put_dataset

   !> Makes an attribute, or rewrites one of the same type and shape.
   subroutine put_attribute(file, object, name, storage, dims, address, failed)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: object, name
      type(storage_type), intent(in) :: storage
      integer(hsize_t), intent(in) :: dims(:)   !! no dimension: a scalar
      type(c_ptr), intent(in) :: address
      logical, intent(out) :: failed
      integer(hid_t) :: owner, attribute
      integer :: status(6)
      logical :: exists

      call h5oopen_f(file, object, owner, status(1))
      failed = status(1) < 0
      if (failed) return
      status = 0
      call h5aexists_f(owner, name, exists, status(2))
      if (exists) then
         call h5aopen_f(owner, name, attribute, status(3))
         if (status(3) >= 0) then
            call h5awrite_f(attribute, storage%in_memory, address, status(4))
            call h5aclose_f(attribute, status(5))
         end if
      else
         call make_attribute(owner, name, storage, dims, address, status(3))
      end if
      call h5oclose_f(owner, status(6))
      failed = any(status < 0)
   end subroutine put_attribute

   subroutine make_attribute(owner, name, storage, dims, address, status)
      integer(hid_t), intent(in) :: owner
      character(len=*), intent(in) :: name
      type(storage_type), intent(in) :: storage
      integer(hsize_t), intent(in) :: dims(:)
      type(c_ptr), intent(in) :: address
      integer, intent(out) :: status
      integer(hid_t) :: space, attribute
      integer :: all_status(5)

      all_status = 0
      call make_space(dims, space, all_status(1))
      call h5acreate_f(owner, name, storage%in_file, space, attribute, all_status(2))
      if (all_status(2) >= 0) then
         call h5awrite_f(attribute, storage%in_memory, address, all_status(4))
         call h5aclose_f(attribute, all_status(5))
      end if
      call h5sclose_f(space, all_status(3))
      status = minval(all_status)
   end subroutine make_attribute

   !> Gives an object its description.
   subroutine describe(owner, description, status)
      integer(hid_t), intent(in) :: owner
      character(len=*), intent(in) :: description
      integer, intent(out) :: status
      character(kind=c_char), target :: bytes(max(1, len(description)))
      type(storage_type) :: storage
      integer :: i

      bytes = c_char_' '
      bytes(:len(description)) = [(description(i:i), i=1, len(description))]
      storage = text_storage(size(bytes))
      call make_attribute(owner, 'description', storage, [integer(hsize_t) ::], c_loc(bytes), &
            status)
      call close_storage(storage)
   end subroutine describe

   !> The shape of a dataset as Fortran sees it: rows last; none for a scalar.
   subroutine get_dims(file, path, dims, failed)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: path
      integer(hsize_t), allocatable, intent(out) :: dims(:)
      logical, intent(out) :: failed
      integer(hid_t) :: dataset
      integer :: status

      call h5dopen_f(file, path, dataset, status)
      failed = status < 0
      if (failed) return
      call shape_of(dataset, dims, failed)
      call h5dclose_f(dataset, status)
      failed = failed .or. status < 0
   end subroutine get_dims

   subroutine shape_of(dataset, dims, failed)
      integer(hid_t), intent(in) :: dataset
      integer(hsize_t), allocatable, intent(out) :: dims(:)
      logical, intent(out) :: failed
      integer(hsize_t), allocatable :: most(:)
      integer(hid_t) :: space
      integer :: status(4), rank, allocation

      status = 0
      call h5dget_space_f(dataset, space, status(1))
      call h5sget_simple_extent_ndims_f(space, rank, status(2))
      allocate (dims(max(0, rank)), most(max(0, rank)), stat=allocation)
      call check_allocation(allocation)
      if (rank > 0) call h5sget_simple_extent_dims_f(space, dims, most, status(3))
      call h5sclose_f(space, status(4))
      failed = any(status < 0)
   end subroutine shape_of

   !> Reads a whole dataset; the memory must hold it.
   subroutine get_dataset(file, path, storage, address, failed)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: path
      type(storage_type), intent(in) :: storage
      type(c_ptr), intent(in) :: address
      logical, intent(out) :: failed
      type(c_ptr) :: memory
      integer(hid_t) :: dataset
      integer :: status(3)

      memory = address
      call h5dopen_f(file, path, dataset, status(1))
      call h5dread_f(dataset, storage%in_memory, memory, status(2))
      call h5dclose_f(dataset, status(3))
      failed = any(status < 0)
   end subroutine get_dataset

   !> A scalar space for no dimensions, a simple one otherwise.
   subroutine make_space(dims, space, status)
      integer(hsize_t), intent(in) :: dims(:)
      integer(hid_t), intent(out) :: space
      integer, intent(out) :: status

      if (size(dims) == 0) then
         call h5screate_f(h5s_scalar_f, space, status)
      else
         call h5screate_simple_f(size(dims), dims, space, status)
      end if
   end subroutine make_space

   !> The property that makes missing groups on the way to a new object.
   subroutine link_property(links, status)
      integer(hid_t), intent(out) :: links
      integer, intent(out) :: status

      call h5pcreate_f(h5p_link_create_f, links, status)
      call h5pset_create_inter_group_f(links, 1, status)
   end subroutine link_property

end module hdf5_calls
