!> Further calls to the HDF5 library: what a file holds, and changes of it. Datasets are written
!> anew and taken away.
module hdf5_changes
   use, intrinsic :: iso_c_binding, only: c_ptr
   use hdf5, only: h5dclose_f, h5dget_type_f, h5dopen_f, h5dwrite_f, h5ldelete_f, &
         h5lexists_f, h5tclose_f, h5tequal_f, h5tget_size_f, size_t
   use hdf5_calls, only: hid_t, hsize_t, shape_of, storage_type
   implicit none
   private

   public :: has_object, remove_object, overwrite_dataset, text_length

contains

   !> Whether there is a group or dataset; all groups on the way are looked for too.
   function has_object(file, path) result(exists)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: path
      logical :: exists
      integer :: i, status

      exists = .false.
      do i = 2, len(path)
         if (i < len(path)) then
            if (path(i + 1:i + 1) /= '/') cycle
         end if
         call h5lexists_f(file, path(:i), exists, status)
         exists = exists .and. status >= 0
         if (.not. exists) return
      end do
   end function has_object

   !> Takes a group or dataset away, if it is there; its place in the file can be used again.
   subroutine remove_object(file, path, failed)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: path
      logical, intent(out) :: failed
      integer :: status

      failed = .false.
      if (.not. has_object(file, path)) return
      call h5ldelete_f(file, path, status)
      failed = status < 0
   end subroutine remove_object

   !> Writes a dataset of the same type and shape anew where it lies.
   subroutine overwrite_dataset(file, path, storage, dims, address, done)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: path
      type(storage_type), intent(in) :: storage
      integer(hsize_t), intent(in) :: dims(:)
      type(c_ptr), intent(in) :: address
      logical, intent(out) :: done               !! it is such a dataset, and was written
      integer(hid_t) :: dataset
      integer :: status(3)

      done = .false.
      if (.not. has_object(file, path)) return
      call h5dopen_f(file, path, dataset, status(1))
      if (status(1) < 0) return
      done = fits(dataset, storage, dims)
      status = 0
      if (done .and. product(dims) > 0) call h5dwrite_f(dataset, storage%in_memory, address, &
            status(2))
      call h5dclose_f(dataset, status(3))
      done = done .and. all(status >= 0)
   end subroutine overwrite_dataset

   !> Whether a dataset has this type and this shape.
   function fits(dataset, storage, dims)
      integer(hid_t), intent(in) :: dataset
      type(storage_type), intent(in) :: storage
      integer(hsize_t), intent(in) :: dims(:)
      logical :: fits
      integer(hsize_t), allocatable :: present_dims(:)
      integer(hid_t) :: kind
      integer :: status(3)
      logical :: failed

      fits = .false.
      call h5dget_type_f(dataset, kind, status(1))
      call h5tequal_f(kind, storage%in_file, fits, status(2))
      call h5tclose_f(kind, status(3))
      fits = fits .and. all(status >= 0)
      if (.not. fits) return
      call shape_of(dataset, present_dims, failed)
      fits = .not. failed .and. size(present_dims) == size(dims)
      if (fits) fits = all(present_dims == dims)
   end function fits

   !> Characters of each text of a dataset, 0 where it cannot be read.
   function text_length(file, path) result(length)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: path
      integer :: length
      integer(hid_t) :: dataset, kind
      integer(size_t) :: bytes
      integer :: status(5)

      length = 0
      call h5dopen_f(file, path, dataset, status(1))
      if (status(1) < 0) return
      call h5dget_type_f(dataset, kind, status(2))
      call h5tget_size_f(kind, bytes, status(3))
      call h5tclose_f(kind, status(4))
      call h5dclose_f(dataset, status(5))
      if (all(status >= 0)) length = int(bytes)
   end function text_length

end module hdf5_changes
