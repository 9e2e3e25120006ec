!> A quantity at the points or in the cells of the moving mesh: its gathered frames, and how they
!> come into the result file. A frame in which nothing has changed is not written again: it begins
!> where the one before begins.
module grid_field
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use kinds, only: int64, wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use hdf5_file, only: hdf5_file_type
   implicit none
   private

   public :: field_type, new_field, chunk_rows, set_frame, is_sound, begin_frame, append_field
   public :: cut_field

   interface set_frame
      module procedure set_scalars, set_components
   end interface set_frame

   integer, parameter :: fewest_rows = 256     ! in a chunk of a field
   integer, parameter :: most_rows = 2**14     ! likewise

   !> One quantity at the points or in the cells, for the gathered frames and the next one.
   type :: field_type
      character(len=:), allocatable :: data_path, offset_path
      integer :: n = 0                      ! points or cells
      logical :: partial = .false.          ! NaN stands where there is no value
      real(wp), allocatable :: held(:, :)   ! (component, point or cell, frame after frame)
      logical, allocatable :: changed(:)    ! (frame) it is not as the one before
      integer(int64) :: n_rows = 0          ! in the file
   end type field_type

contains

   !> A field, all zero, for so many frames.
   subroutine new_field(field, n_components, n, n_frames)
      type(field_type), intent(out) :: field
      integer, intent(in) :: n_components, n     !! points or cells
      integer, intent(in) :: n_frames            !! gathered at most
      integer :: status

      field%n = n
      allocate (field%held(n_components, n*n_frames), source=0.0_wp, stat=status)
      call check_allocation(status)
      allocate (field%changed(n_frames), source=.false., stat=status)
      call check_allocation(status)
      field%changed(1) = .true.
   end subroutine new_field

   !> Points or cells that lie together in the file: frames are cut into equal chunks.
   pure integer function chunk_rows(field)
      type(field_type), intent(in) :: field
      integer :: n_chunks

      n_chunks = (field%n + most_rows - 1)/most_rows
      chunk_rows = max(fewest_rows, (field%n + n_chunks - 1)/max(1, n_chunks))
   end function chunk_rows

   !> Takes the values of a frame of one component.
   pure subroutine set_scalars(field, n_before, values)
      type(field_type), intent(inout) :: field
      integer, intent(in) :: n_before            !! frames gathered before
      real(wp), intent(in) :: values(:)          !! (point or cell)

      associate (frame => field%held(1, n_before*field%n + 1:(n_before + 1)*field%n), &
            changed => field%changed(n_before + 1))
         if (.not. changed) changed = any(differ(frame, values))
         frame = values
      end associate
   end subroutine set_scalars

   !> Takes the values of a frame.
   pure subroutine set_components(field, n_before, values)
      type(field_type), intent(inout) :: field
      integer, intent(in) :: n_before            !! frames gathered before
      real(wp), intent(in) :: values(:, :)       !! (component, point or cell)

      associate (frame => field%held(:, n_before*field%n + 1:(n_before + 1)*field%n), &
            changed => field%changed(n_before + 1))
         if (.not. changed) changed = any(differ(frame, values))
         frame = values
      end associate
   end subroutine set_components

   !> Bit by bit: NaN is the same as NaN here.
   elemental logical function differ(a, b)
      real(wp), intent(in) :: a, b

      differ = transfer(a, 0_int64) /= transfer(b, 0_int64)
   end function differ

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

   !> Begins a frame, behind so many, as the one before.
   pure subroutine begin_frame(field, n_before)
      type(field_type), intent(inout) :: field
      integer, intent(in) :: n_before            !! frames gathered before, one at least

      call copy_frame(field, n_before - 1, n_before)
      field%changed(n_before + 1) = .false.
   end subroutine begin_frame

   !> Writes the gathered frames that have changed, and where each frame begins. The first frame is
   !> the next one then, or as the last one written if there was no room to begin it.
   subroutine append_field(field, file, n_held, error)
      type(field_type), intent(inout) :: field
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: n_held              !! frames gathered
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer(int64) :: begin(n_held)
      integer :: i, n_new

      n_new = 0
      do i = 1, n_held
         if (field%changed(i)) then
            n_new = n_new + 1
            call copy_frame(field, i - 1, n_new - 1)
         end if
         begin(i) = field%n_rows + int(n_new - 1, int64)*field%n
      end do
      call file%append(field%data_path, field%held(:, :n_new*field%n), error)
      if (.not. allocated(error)) call file%append(field%offset_path, begin, error)
      if (allocated(error)) return
      field%n_rows = field%n_rows + int(n_new, int64)*field%n
      if (n_held < size(field%changed)) then
         call copy_frame(field, n_held, 0)
         field%changed(1) = field%changed(n_held + 1)
      else
         ! where the last frame stood is left alone above, unless it is what was put there
         call copy_frame(field, n_held - 1, 0)
         field%changed(1) = .false.
      end if
   end subroutine append_field

   !> Copies the frame behind so many to the place behind others.
   pure subroutine copy_frame(field, from, to)
      type(field_type), intent(inout) :: field
      integer, intent(in) :: from, to            !! frames before
      integer :: i

      if (from == to) return
      do i = 1, field%n
         field%held(:, to*field%n + i) = field%held(:, from*field%n + i)
      end do
   end subroutine copy_frame

   !> Leaves the first frames of a reopened file, and begins the next one as the last of them.
   subroutine cut_field(field, file, n_frames, short, error)
      type(field_type), intent(inout) :: field
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: n_frames
      character(len=:), allocatable, intent(out) :: short   !! what has not so many, if something
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer(int64) :: begin(1)

      field%n_rows = 0
      call file%cut(field%offset_path, int(n_frames, int64), short, error)
      if (allocated(error) .or. allocated(short)) return
      if (n_frames > 0) then
         call file%read_last(field%offset_path, begin, error)
         if (allocated(error)) return
         field%n_rows = min(max(0_int64, begin(1)), huge(begin) - field%n) + field%n
      end if
      call file%cut(field%data_path, field%n_rows, short, error)
      if (allocated(error) .or. allocated(short) .or. n_frames == 0) return
      call file%read_last(field%data_path, field%held(:, :field%n), error)
      field%changed(1) = .false.
   end subroutine cut_field

end module grid_field
