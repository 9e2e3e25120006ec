!> The calls to the HDF5 library for series, datasets that grow by rows: they are made, appended to,
!> cut back, and their last rows read.
module hdf5_series
   use, intrinsic :: iso_c_binding, only: c_ptr
   use hdf5, only: h5dclose_f, h5dcreate_f, h5dget_space_f, h5dopen_f, h5dread_f, &
         h5dset_extent_f, h5dwrite_f, h5p_dataset_create_f, h5pclose_f, h5pcreate_f, &
         h5pset_chunk_f, h5pset_deflate_f, h5pset_shuffle_f, h5s_select_set_f, &
         h5s_unlimited_f, h5sclose_f, h5screate_simple_f, h5sselect_hyperslab_f
   use hdf5_calls, only: describe, get_dims, hid_t, hsize_t, link_property, shape_of, storage_type
   implicit none
   private

   public :: chunks_type, make_series, append_block, get_last_block, cut_rows

   !> How a growing dataset is cut into chunks, each of which lies together in the file.
   type :: chunks_type
      integer :: rows = 1
      integer :: deflate = 0   !! level of compression behind a shuffle of bytes, 0: none
   end type chunks_type

contains

   !> Makes an empty dataset that grows along its last dimension.
   subroutine make_series(file, path, description, storage, n_components, chunks, failed)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: path, description
      type(storage_type), intent(in) :: storage
      integer, intent(in) :: n_components   !! 0: a list; n: rows of n values
      type(chunks_type), intent(in) :: chunks
      logical, intent(out) :: failed
      integer(hsize_t), dimension(2) :: dims, most, chunk
      integer(hid_t) :: space, dataset, properties, links
      integer :: status(12), rank

      status = 0
      rank = merge(2, 1, n_components > 0)
      dims = int(n_components, hsize_t)
      most = dims
      chunk = dims
      dims(rank) = 0
      most(rank) = h5s_unlimited_f
      chunk(rank) = int(chunks%rows, hsize_t)
      call h5screate_simple_f(rank, dims, space, status(1), maxdims=most)
      call h5pcreate_f(h5p_dataset_create_f, properties, status(2))
      call h5pset_chunk_f(properties, rank, chunk, status(3))
      if (chunks%deflate > 0) then
         call h5pset_shuffle_f(properties, status(10))
         call h5pset_deflate_f(properties, chunks%deflate, status(11))
      end if
      call link_property(links, status(4))
      call h5dcreate_f(file, path, storage%in_file, space, dataset, status(5), &
            dcpl_id=properties, lcpl_id=links)
      if (status(5) >= 0) then
         call describe(dataset, description, status(12))
         call h5dclose_f(dataset, status(6))
      end if
      call h5pclose_f(links, status(7))
      call h5pclose_f(properties, status(8))
      call h5sclose_f(space, status(9))
      failed = any(status < 0)
   end subroutine make_series

   !> Extends a series by as many rows as the values make up and writes them there.
   subroutine append_block(file, path, storage, n_values, address, failed)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: path
      type(storage_type), intent(in) :: storage
      integer, intent(in) :: n_values   !! a whole number of rows
      type(c_ptr), intent(in) :: address
      logical, intent(out) :: failed
      integer(hid_t) :: dataset, space, block
      integer(hsize_t), allocatable :: dims(:)
      integer :: status(6), rank

      failed = .false.
      if (n_values == 0) return
      call h5dopen_f(file, path, dataset, status(1))
      failed = status(1) < 0
      if (failed) return
      call shape_of(dataset, dims, failed)
      if (failed) then
         call h5dclose_f(dataset, status(6))
         return
      end if
      rank = size(dims)
      dims(rank) = dims(rank) + n_values/product(dims(:rank - 1))
      call h5dset_extent_f(dataset, dims, status(2))
      call select_last(dataset, dims, n_values, space, block, status(3))
      call h5dwrite_f(dataset, storage%in_memory, address, status(4), mem_space_id=block, &
            file_space_id=space)
      call close_selection(space, block, status(5))
      call h5dclose_f(dataset, status(6))
      failed = failed .or. any(status < 0)
   end subroutine append_block

   !> Reads the last values of a series; the memory must hold them.
   subroutine get_last_block(file, path, storage, n_values, address, failed)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: path
      type(storage_type), intent(in) :: storage
      integer, intent(in) :: n_values   !! a whole number of rows, no more than there are
      type(c_ptr), intent(in) :: address
      logical, intent(out) :: failed
      type(c_ptr) :: memory
      integer(hid_t) :: dataset, space, block
      integer(hsize_t), allocatable :: dims(:)
      integer :: status(5)

      failed = .false.
      if (n_values == 0) return
      memory = address
      call h5dopen_f(file, path, dataset, status(1))
      failed = status(1) < 0
      if (failed) return
      call shape_of(dataset, dims, failed)
      if (failed) then
         call h5dclose_f(dataset, status(5))
         return
      end if
      call select_last(dataset, dims, n_values, space, block, status(2))
      call h5dread_f(dataset, storage%in_memory, memory, status(3), mem_space_id=block, &
            file_space_id=space)
      call close_selection(space, block, status(4))
      call h5dclose_f(dataset, status(5))
      failed = failed .or. any(status < 0)
   end subroutine get_last_block

   !> Selects the rows of the last values of a dataset of this shape.
   subroutine select_last(dataset, dims, n_values, space, block, status)
      integer(hid_t), intent(in) :: dataset
      integer(hsize_t), intent(in) :: dims(:)
      integer, intent(in) :: n_values
      integer(hid_t), intent(out) :: space, block   !! in the file, in memory; close_selection
      integer, intent(out) :: status             !! negative on failure
      integer(hsize_t) :: start(size(dims)), count(size(dims))
      integer :: each(3), rank

      rank = size(dims)
      count = dims
      count(rank) = n_values/product(dims(:rank - 1))
      start = 0
      start(rank) = dims(rank) - count(rank)
      call h5dget_space_f(dataset, space, each(1))
      call h5sselect_hyperslab_f(space, h5s_select_set_f, start, count, each(2))
      call h5screate_simple_f(rank, count, block, each(3))
      status = minval(each)
   end subroutine select_last

   subroutine close_selection(space, block, status)
      integer(hid_t), intent(in) :: space, block
      integer, intent(out) :: status             !! negative on failure
      integer :: other

      call h5sclose_f(block, status)
      call h5sclose_f(space, other)
      status = min(status, other)
   end subroutine close_selection

   !> Cuts a growing dataset back to its first rows.
   subroutine cut_rows(file, path, n_rows, n_missing, failed)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: path
      integer(hsize_t), intent(in) :: n_rows
      integer(hsize_t), intent(out) :: n_missing   !! rows that it lacks; it stays as it is then
      logical, intent(out) :: failed
      integer(hsize_t), allocatable :: dims(:)
      integer(hid_t) :: dataset
      integer :: status(3), rank

      n_missing = n_rows
      call get_dims(file, path, dims, failed)
      if (failed) return
      rank = size(dims)
      n_missing = max(0_hsize_t, n_rows - dims(rank))
      if (n_rows >= dims(rank)) return
      dims(rank) = n_rows
      call h5dopen_f(file, path, dataset, status(1))
      call h5dset_extent_f(dataset, dims, status(2))
      call h5dclose_f(dataset, status(3))
      failed = any(status < 0)
   end subroutine cut_rows

end module hdf5_series
