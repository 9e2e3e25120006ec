!> A quantity at the points or in the cells of the moving mesh: its gathered frames, and how they
!> come into the result file.
module grid_field
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use kinds, only: int64, wp
   use errors, only: error_type
   use hdf5_file, only: hdf5_file_type
   implicit none
   private

   public :: field_type, chunk_rows, is_sound, append_field, copy_frame, cut_field

   integer, parameter :: fewest_rows = 256     ! in a chunk of a field
   integer, parameter :: most_rows = 2**14     ! likewise

   !> One quantity at the points or in the cells, for the gathered frames and the next one.
   type :: field_type
      character(len=:), allocatable :: data_path, offset_path
      integer :: n = 0                      ! points or cells
      logical :: partial = .false.          ! NaN stands where there is no value
      real(wp), allocatable :: held(:, :)   ! (component, point or cell, frame after frame)
   end type field_type

contains

   !> Points or cells that lie together in the file: frames are cut into equal chunks.
   pure integer function chunk_rows(field)
      type(field_type), intent(in) :: field
      integer :: n_chunks

      n_chunks = (field%n + most_rows - 1)/most_rows
      chunk_rows = max(fewest_rows, (field%n + n_chunks - 1)/max(1, n_chunks))
   end function chunk_rows

   !> Whether all values of a frame are finite, or NaN where that is allowed.
   pure function is_sound(field, n_before) result(sound)
      type(field_type), intent(in) :: field
      integer, intent(in) :: n_before            !! frames gathered before
      logical :: sound

      associate (values => field%held(:, n_before*field%n + 1:(n_before + 1)*field%n))
         if (field%partial) then
            ! to compare a NaN is an invalid operation, to ask for one is not
            sound = all(ieee_is_finite(values) .or. ieee_is_nan(values))
         else
            sound = all(ieee_is_finite(values))
         end if
      end associate
   end function is_sound

   !> Writes the gathered frames, and where each begins.
   subroutine append_field(field, file, n_written, n_held, error)
      type(field_type), intent(in) :: field
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: n_written           !! frames in the file
      integer, intent(in) :: n_held              !! frames gathered
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer(int64) :: begin(n_held)
      integer :: i

      call file%append(field%data_path, field%held(:, :n_held*field%n), error)
      if (allocated(error)) return
      do i = 1, n_held
         begin(i) = int(n_written + i - 1, int64)*field%n
      end do
      call file%append(field%offset_path, begin, error)
   end subroutine append_field

   !> Copies the frame behind one place in the list to the one behind another.
   pure subroutine copy_frame(field, from, to)
      type(field_type), intent(inout) :: field
      integer, intent(in) :: from, to
      integer :: i

      if (from == to) return
      do i = 1, field%n
         field%held(:, to + i) = field%held(:, from + i)
      end do
   end subroutine copy_frame

   !> Leaves the first frames of a reopened file.
   subroutine cut_field(field, file, n_frames, short, error)
      type(field_type), intent(in) :: field
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: n_frames
      character(len=:), allocatable, intent(out) :: short   !! what has not so many, if something
      type(error_type), allocatable, intent(out) :: error   !! status_file

      call file%cut(field%data_path, int(n_frames, int64)*field%n, short, error)
      if (allocated(error) .or. allocated(short)) return
      call file%cut(field%offset_path, int(n_frames, int64), short, error)
   end subroutine cut_field

end module grid_field
