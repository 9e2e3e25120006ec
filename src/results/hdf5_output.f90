!> An HDF5 file from its making to its closing, its groups, and datasets by their addresses;
!> hdf5_file gives them types.
!>
!> A file that is reopened (`modify_claimed`) is made again by the same calls as a new one: groups
!> and series that are there stay, datasets and attributes are written anew, in their old place
!> where they fit.
!>
!> It is written aside (part_file): what others see is what was published last, complete and
!> closed. Before data are written, `reserve` has the disk set their space aside. So a full disk is
!> met while the library is in order, and all that was written before can be closed and read. A
!> failure within the library is another matter: it is not called any more, not even to close, and
!> what was published stays.
module hdf5_output
   use kinds, only: int64, wp
   use errors, only: error_type, new_error, status_file
   use clock, only: seconds_now
   use file_calls, only: is_regular, look_at
   use part_file, only: part_file_type, claim, publish, finish, discard, reserve_room, &
         forget_room, is_claimed, has_published, part_path
   use, intrinsic :: iso_c_binding, only: c_ptr
   use hdf5_calls, only: hsize_t, make_group, put_dataset, storage_type
   use hdf5_series, only: cut_rows
   use hdf5_changes, only: has_object, overwrite_dataset, remove_object
   use hdf5_opening, only: close_file, create_file, file_size, flush_file, hid_t, modify_file
   implicit none
   private

   public :: hdf5_output_type

   !> Bytes kept free beyond all that is written in mid-run, for what a run adds when it ends.
   integer(int64), parameter :: margin = 2_int64**18
   !> The same when there is no more: then the run ends, and what still fits is written.
   integer(int64), parameter :: last_margin = 2_int64**14
   !> At the end of longer runs the program waits for the disk, seconds. That costs 15 to 40 ms,
   !> as much as a short run; one that a power failure takes away is soon run again.
   real(wp), parameter :: worth_waiting = 1.0_wp

   !> A file open for writing. It must be closed or dropped: nothing does so by itself.
   type :: hdf5_output_type
      integer(hid_t) :: id = -1
      character(len=:), allocatable :: path      !! as the user has named it
      type(part_file_type) :: place
      real(wp) :: started = 0.0_wp
      logical :: broken = .false.                !! the library has failed
      logical :: full = .false.                  !! there was no space for something
      logical :: saved = .false.                 !! closed, with all that was written
      logical :: reopened = .false.              !! it goes on from what it held
      integer :: deflate = 0                     !! compression of the series
   contains
      procedure :: create
      procedure :: create_claimed
      procedure :: modify_claimed
      procedure :: is_open
      procedure :: reserve
      procedure :: flush => flush_to_system
      procedure :: publish => publish_now
      procedure :: close => close_for_good
      procedure :: drop
      procedure :: remark
      procedure :: compress
      procedure :: create_group
      procedure :: holds
      procedure :: remove
      procedure :: cut
      procedure :: put => put_values
      procedure :: renew => renew_values
      procedure :: write_failure
      procedure :: read_failure
   end type hdf5_output_type

contains

   !> Creates the file; one that exists is replaced when this one is published or closed.
   subroutine create(self, path, error)
      class(hdf5_output_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error   !! status_file
      type(part_file_type) :: place

      call claim(place, path, .true., error)
      if (allocated(error)) return
      call self%create_claimed(place, path, error)
   end subroutine create

   !> Creates the file in a part file, which it takes over.
   subroutine create_claimed(self, place, path, error)
      class(hdf5_output_type), intent(inout) :: self
      type(part_file_type), intent(in) :: place
      character(len=*), intent(in) :: path       !! for messages
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical :: failed

      call take_over(self, place, path)
      call reserve_room(self%place, margin, error)
      if (allocated(error)) then
         call discard(self%place)
         return
      end if
      call create_file(part_path(place), self%id, failed)
      call forget_room(self%place)   ! the library has cut the file
      call begin(self, failed, error)
   end subroutine create_claimed

   !> Opens the file that a part file was filled with, for changes.
   subroutine modify_claimed(self, place, path, error)
      class(hdf5_output_type), intent(inout) :: self
      type(part_file_type), intent(in) :: place
      character(len=*), intent(in) :: path       !! for messages
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical :: failed

      call take_over(self, place, path)
      self%reopened = .true.
      call modify_file(part_path(place), self%id, failed)
      call begin(self, failed, error)
   end subroutine modify_claimed

   subroutine take_over(self, place, path)
      class(hdf5_output_type), intent(inout) :: self
      type(part_file_type), intent(in) :: place
      character(len=*), intent(in) :: path

      self%place = place
      self%path = path
      self%started = seconds_now()
      self%broken = .false.
      self%full = .false.
      self%saved = .false.
      self%reopened = .false.
   end subroutine take_over

   !> The first space of a file just opened.
   subroutine begin(self, failed, error)
      class(hdf5_output_type), intent(inout) :: self
      logical, intent(in) :: failed              !! it could not be opened
      type(error_type), allocatable, intent(out) :: error

      if (failed) then
         self%id = -1
         call self%write_failure('anything', error)
         call discard(self%place)
      else
         call self%reserve(0_int64, error)
      end if
   end subroutine begin

   !> Whether the file was opened and not yet closed.
   pure logical function is_open(self)
      class(hdf5_output_type), intent(in) :: self

      is_open = self%id >= 0
   end function is_open

   !> Makes sure that the disk has room for so much more; nothing may be written if it has not.
   subroutine reserve(self, bytes, error)
      class(hdf5_output_type), intent(inout) :: self
      integer(int64), intent(in) :: bytes        !! of data, with the room of all chunks begun
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer(int64) :: size
      logical :: failed

      failed = .not. self%is_open() .or. self%broken
      if (.not. failed) call file_size(self%id, size, failed)
      if (failed) then
         call self%write_failure('more', error)
      else
         call reserve_room(self%place, size + bytes + merge(last_margin, margin, self%full), error)
         self%full = self%full .or. allocated(error)
      end if
   end subroutine reserve

   !> Hands everything written so far to the operating system.
   subroutine flush_to_system(self, error)
      class(hdf5_output_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical :: failed

      failed = .not. self%is_open() .or. self%broken
      if (.not. failed) call flush_file(self%id, failed)
      if (failed) call self%write_failure('everything', error)
   end subroutine flush_to_system

   !> Lets others see all that was written so far. That takes a copy of the file.
   subroutine publish_now(self, error)
      class(hdf5_output_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error   !! status_file

      call self%flush(error)
      if (.not. allocated(error)) call publish(self%place, error)
   end subroutine publish_now

   !> Closes the file and lets others see all of it; does nothing when it is not open.
   subroutine close_for_good(self, error)
      class(hdf5_output_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error   !! status_file

      if (.not. self%is_open()) return
      call self%flush(error)
      call shut(self, error)
      if (allocated(error)) then
         call discard(self%place)
      else
         call finish(self%place, seconds_now() - self%started > worth_waiting, error)
         self%saved = .true.
      end if
   end subroutine close_for_good

   !> Gives the file up; what was published before stays.
   subroutine drop(self)
      class(hdf5_output_type), intent(inout) :: self
      type(error_type), allocatable :: ignored

      if (self%is_open()) call shut(self, ignored)
      call discard(self%place)
   end subroutine drop

   !> What a user has to know of the file at the path after a failure; empty if it is as expected.
   function remark(self) result(words)
      class(hdf5_output_type), intent(in) :: self
      character(len=:), allocatable :: words

      words = ''
      if (self%saved .or. .not. allocated(self%path)) return
      if (has_published(self%place)) then
         words = ''''//self%path//''' has the results up to when they were last saved'
      else if (is_regular(look_at(self%path))) then
         words = ''''//self%path//''' is still that of an earlier run: nothing of ' &
               //'this one was saved'
      else
         words = 'no results were saved'
      end if
   end function remark

   !> Closes the file for the library, unless that has failed before.
   subroutine shut(self, error)
      class(hdf5_output_type), intent(inout) :: self
      type(error_type), allocatable, intent(inout) :: error
      logical :: failed

      failed = self%broken
      if (.not. failed) call close_file(self%id, failed)
      self%id = -1
      if (failed .and. .not. allocated(error)) call self%write_failure('everything', error)
   end subroutine shut

   !> Makes a group; it must not exist yet unless the file was reopened.
   subroutine create_group(self, path, description, error)
      class(hdf5_output_type), intent(inout) :: self
      character(len=*), intent(in) :: path, description
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical :: failed

      if (self%reopened) then
         if (self%holds(path)) return
      end if
      call make_group(self%id, path, description, failed)
      if (failed) call self%write_failure(path, error)
   end subroutine create_group

   !> Whether there is a group or dataset of this path.
   logical function holds(self, path)
      class(hdf5_output_type), intent(in) :: self
      character(len=*), intent(in) :: path

      holds = has_object(self%id, path)
   end function holds

   !> Takes a group or dataset away, if it is there.
   subroutine remove(self, path, error)
      class(hdf5_output_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical :: failed

      call remove_object(self%id, path, failed)
      if (failed) call self%write_failure(path, error)
   end subroutine remove

   !> Cuts a series back to its first rows.
   subroutine cut(self, path, n_rows, short, error)
      class(hdf5_output_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      integer(int64), intent(in) :: n_rows
      character(len=:), allocatable, intent(out) :: short   !! its path if it has not so many
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer(hsize_t) :: n_missing
      logical :: failed

      if (.not. self%holds(path)) then
         short = path
         return
      end if
      call cut_rows(self%id, path, int(n_rows, hsize_t), n_missing, failed)
      if (n_missing > 0) short = path
      if (failed) call self%write_failure(path, error)
   end subroutine cut

   !> Writes a dataset; one of this path is an error unless the file was reopened.
   subroutine put_values(self, path, description, storage, dims, address, error)
      class(hdf5_output_type), intent(inout) :: self
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
      call self%reserve(room_of(storage, dims), error)
      if (allocated(error)) return
      call put_dataset(self%id, path, description, storage, dims, address, failed)
      if (failed) call self%write_failure(path, error)
   end subroutine put_values

   !> Bytes that a dataset takes at most, its header included.
   pure function room_of(storage, dims) result(bytes)
      type(storage_type), intent(in) :: storage
      integer(hsize_t), intent(in) :: dims(:)
      integer(int64) :: bytes
      integer(int64), parameter :: header = 2048

      bytes = header + storage%bytes*int(product(dims), int64)
   end function room_of

   !> Writes a dataset in the place of one of this path, if there is one.
   subroutine renew_values(self, path, description, storage, dims, address, error)
      class(hdf5_output_type), intent(inout) :: self
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
      call self%reserve(room_of(storage, dims), error)
      if (allocated(error)) return
      call put_dataset(self%id, path, description, storage, dims, address, failed)
      if (failed) call self%write_failure(path, error)
   end subroutine renew_values

   !> Compresses all series made from here on.
   pure subroutine compress(self, level)
      class(hdf5_output_type), intent(inout) :: self
      integer, intent(in) :: level   !! 0, not at all, to 9

      self%deflate = level
   end subroutine compress

   !> The error of something that could not be written; from here on nothing is.
   subroutine write_failure(self, object, error)
      class(hdf5_output_type), intent(inout) :: self
      character(len=*), intent(in) :: object
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: path

      path = '(no file)'
      if (allocated(self%path)) path = self%path
      self%broken = self%broken .or. is_claimed(self%place)
      call new_error(error, status_file, 'cannot write '//object//" to '"//path// &
            "': the disk fails or is full, there is no access any more, or the file is not open" &
            //new_line('a')//'  cure: see whether the disk has room and is in order')
   end subroutine write_failure

   !> The error of something that cannot be read from a reopened file.
   subroutine read_failure(self, object, error)
      class(hdf5_output_type), intent(inout) :: self
      character(len=*), intent(in) :: object
      type(error_type), allocatable, intent(out) :: error

      self%broken = self%broken .or. is_claimed(self%place)
      call new_error(error, status_file, 'cannot read '//object//" of '"//self%path &
            //"': it is damaged, or the disk fails"//new_line('a')//'  cure: start anew, or with ' &
            //'--restart from other results')
   end subroutine read_failure

end module hdf5_output
