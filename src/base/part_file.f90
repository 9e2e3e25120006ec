!> A file that is written aside under a name of its own, OUT.part, so that OUT is at every instant
!> complete and closed: OUT comes to be, and is replaced, by renaming alone.
!>
!> Written aside because the result library rewrites its metadata in place: a crash within that
!> leaves a torn file in whatever order it is flushed. A crash at any byte leaves OUT as it was
!> published last (or none), with OUT.part and OUT.next beside it, which the next run removes.
!> OUT.part is locked (flock) as long as the run lives; a lock ends with its process.
module part_file
   use kinds, only: int64
   use errors, only: error_type, new_error, status_file
   use text, only: to_text, lower_case
   use file_calls, only: file_facts_type, look_at, look_at_open, is_same, is_folder, is_regular, &
         true_path, folder_of, check_folder, make_folders, open_to_keep, open_to_read, close_open, &
         try_lock, copy_open, sync_open, sync_folder, rename_file, remove_file, reserve_blocks, &
         release_blocks, size_limit
   implicit none
   private

   public :: part_file_type, check_output, claim, fill_part, publish, finish, discard
   public :: reserve_room, forget_room, is_claimed, has_published, part_path, shown_path, owner_in

   !> An output that this process alone may write to.
   type :: part_file_type
      private
      character(len=:), allocatable :: shown     ! as the user has named it
      character(len=:), allocatable :: path      ! the same from the root
      integer :: descriptor = -1                 ! of the part file; it holds the lock
      type(file_facts_type) :: facts             ! of the part file
      logical :: published = .false.
      integer(int64) :: room = 0                 ! bytes of it that the disk has set aside
   end type part_file_type

   character(len=*), parameter :: part_ending = '.part', copy_ending = '.next'
   character(len=*), parameter :: nl = new_line('a')
   character(len=*), parameter :: lost_cure = 'leave OUT.h5 and OUT.h5.part alone while a run ' &
         //'writes them; to look at results, copy OUT.h5'

contains

   !> Whether a file may be written at a path, as far as can be told without making anything.
   subroutine check_output(path, may_replace, error)
      character(len=*), intent(in) :: path
      logical, intent(in) :: may_replace         !! a file that is there
      type(error_type), allocatable, intent(out) :: error   !! status_file
      type(file_facts_type) :: facts
      character(len=:), allocatable :: folder, reason

      folder = folder_of(path)
      facts = look_at(path)
      if (is_folder(facts)) then
         call file_error(error, path, 'it is a directory', 'name a file in it')
      else if (facts%exists .and. .not. is_regular(facts)) then
         call file_error(error, path, 'it is not a file but a device, pipe or socket', &
               'give the results another name with -o')
      else if (facts%exists .and. .not. may_replace) then
         call file_error(error, path, 'it exists', &
               '--overwrite replaces it; or give the results another name with -o')
      else if (.not. is_folder(look_at(folder))) then
         call file_error(error, path, 'there is no directory '''//folder//'''', &
               'make it, or give the results another place with -o')
      else
         call check_folder(folder, reason)
         if (len(reason) > 0) call file_error(error, path, 'nothing can be written in '''//folder &
               //''': '//reason, 'a directory that may be written to, with -o')
      end if
   end subroutine check_output

   !> Takes an output: makes its part file, empty, and locks it. What a crash has left is removed;
   !> a file at the path itself stays until it is replaced.
   subroutine claim(self, path, may_replace, error)
      type(part_file_type), intent(out) :: self
      character(len=*), intent(in) :: path
      logical, intent(in) :: may_replace         !! a file that is there
      type(error_type), allocatable, intent(out) :: error   !! status_file
      type(file_facts_type) :: before

      call check_output(path, may_replace, error)
      if (allocated(error)) return
      self%shown = path
      self%path = true_path(path)
      if (len(self%path) == 0) self%path = true_path(folder_of(path))//'/' &
            //path(index(path, '/', back=.true.) + 1:)
      before = look_at(part_path(self))
      call refuse_odd(self, part_ending, error)
      if (.not. allocated(error)) call refuse_odd(self, copy_ending, error)
      if (.not. allocated(error)) call lock_part(self, error)
      if (allocated(error)) return
      ! another run may have ended since
      call check_output(path, may_replace, error)
      if (allocated(error)) then
         if (.not. before%exists) call remove_file(part_path(self))
         call close_open(self%descriptor)
         return
      end if
      call remove_file(self%path//copy_ending)
   end subroutine claim

   !> What stands in the place of a file beside the output and is none is left alone: it could
   !> neither be written to nor be removed, or it would wait for a reader for ever.
   subroutine refuse_odd(self, ending, error)
      type(part_file_type), intent(in) :: self
      character(len=*), intent(in) :: ending
      type(error_type), allocatable, intent(out) :: error
      type(file_facts_type) :: facts

      facts = look_at(self%path//ending)
      if (.not. facts%exists .or. is_regular(facts)) return
      call file_error(error, self%shown//ending, 'it is a directory, pipe or device', &
            'remove it, or give the results another name with -o')
   end subroutine refuse_odd

   !> Opens and locks the part file.
   subroutine lock_part(self, error)
      type(part_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: most_tries = 100
      character(len=:), allocatable :: reason
      logical :: taken
      integer :: i

      do i = 1, most_tries
         call open_to_keep(part_path(self), self%descriptor, reason)
         if (len(reason) > 0) then
            call file_error(error, self%shown//part_ending, reason, &
                  'a directory that may be written to, with -o')
            return
         end if
         call try_lock(self%descriptor, taken)
         self%facts = look_at_open(self%descriptor)
         if (taken) then
            call refuse_taken(self, error)
            return
         end if
         ! the run that had it may have renamed it in the meantime
         if (is_same(self%facts, look_at(part_path(self)))) return
         call close_open(self%descriptor)
      end do
      call file_error(error, self%shown//part_ending, 'it is removed as soon as it is made', &
            'give the results another place with -o')
   end subroutine lock_part

   subroutine refuse_taken(self, error)
      type(part_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: who
      integer :: owner

      owner = lock_owner(self%facts)
      who = 'another run is writing to it'
      if (owner > 0) who = who//' (process '//to_text(owner)//')'
      call close_open(self%descriptor)
      call file_error(error, self%shown, who, &
            'wait for it, stop it, or give the results another name with -o')
   end subroutine refuse_taken

   !> The process that holds the lock of a file, from the list in /proc/locks; 0 if not known.
   function lock_owner(facts) result(owner)
      type(file_facts_type), intent(in) :: facts
      integer :: owner
      character(len=200) :: line
      integer :: unit, status

      owner = 0
      open (newunit=unit, file='/proc/locks', action='read', status='old', iostat=status)
      if (status /= 0) return
      do
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         owner = owner_in(line, facts)
         if (owner > 0) exit
      end do
      close (unit)
   end function lock_owner

   !> The process that a line of /proc/locks says to hold the lock of a file, 0 if it is of another
   !> one; the file is MAJOR:MINOR:INODE there, the first two with two hexadecimal digits or more.
   pure function owner_in(line, facts) result(owner)
      character(len=*), intent(in) :: line
      type(file_facts_type), intent(in) :: facts
      integer :: owner
      character(len=40) :: name
      integer :: status, place, first

      owner = 0
      write (name, '(z0.2, a, z0.2, a, i0)') facts%device(1), ':', facts%device(2), ':', &
            facts%inode
      place = index(line, ' '//trim(lower_case(name))//' ')
      if (place == 0 .or. index(line, 'FLOCK') == 0 .or. index(line, '->') > 0) return
      first = index(line(:place - 1), ' ', back=.true.)
      read (line(first + 1:place), *, iostat=status) owner
      if (status /= 0) owner = 0
   end function owner_in

   !> Copies a file into the part file, which is empty so far.
   subroutine fill_part(self, path, error)
      type(part_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error   !! status_file
      character(len=:), allocatable :: reason
      integer :: descriptor

      call open_to_read(path, descriptor, reason)
      if (len(reason) == 0) call copy_open(descriptor, part_path(self), .false., reason)
      call close_open(descriptor)
      if (len(reason) > 0) call file_error(error, self%shown//part_ending, &
            'copying '''//path//''': '//reason, 'make room, or another place with -o')
   end subroutine fill_part

   !> Sets space on the disk aside, so that the part file can grow to a size: a disk that fills up,
   !> or a limit of the process, is met here and not within the library, which then cannot even
   !> close its file.
   subroutine reserve_room(self, size, error)
      type(part_file_type), intent(inout) :: self
      integer(int64), intent(in) :: size         !! bytes
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer(int64), parameter :: least = 2_int64**20, most = 2_int64**26
      character(len=:), allocatable :: reason
      integer(int64) :: ample

      if (size > size_limit()) then
         call full_error(self, 'the limit of the size of a file (ulimit -f) is reached', error)
         return
      end if
      if (size <= self%room) return
      ! ahead, so that it is done seldom; where there is no space for that, to the byte
      ample = size + min(most, max(least, size/16))
      call reserve_blocks(self%descriptor, self%room, ample, reason)
      if (len(reason) > 0) then
         ample = size
         call reserve_blocks(self%descriptor, self%room, ample, reason)
      end if
      if (len(reason) > 0) then
         call full_error(self, reason, error)
      else
         self%room = ample
      end if
   end subroutine reserve_room

   !> Nothing is set aside any more.
   pure subroutine forget_room(self)
      type(part_file_type), intent(inout) :: self

      self%room = 0
   end subroutine forget_room

   !> Brings the state of the part file, which its writer has flushed, to the path itself. If that
   !> fails the path has what it had.
   subroutine publish(self, error)
      type(part_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error   !! status_file
      character(len=:), allocatable :: reason

      if (is_lost(self)) then
         call file_error(error, self%shown, 'it was removed while the run was writing it', &
               lost_cure)
         return
      end if
      call refuse_odd(self, copy_ending, error)
      if (allocated(error)) return
      call replace_by_copy(self, reason)
      if (len(reason) > 0) call full_error(self, reason, error)
   end subroutine publish

   !> A copy of the part file takes the place of what is at the path.
   subroutine replace_by_copy(self, reason)
      type(part_file_type), intent(inout) :: self
      character(len=:), allocatable, intent(out) :: reason

      ! a pipe, say, would wait for a reader
      call remove_file(self%path//copy_ending)
      call copy_open(self%descriptor, self%path//copy_ending, .true., reason)
      if (len(reason) == 0) call rename_file(self%path//copy_ending, self%path, reason)
      if (len(reason) > 0) call remove_file(self%path//copy_ending)
      self%published = self%published .or. len(reason) == 0
   end subroutine replace_by_copy

   !> Renames the part file, which its writer has closed, to the path itself. If someone has removed
   !> it, it is saved again all the same, and that is an error.
   subroutine finish(self, to_disk, error)
      type(part_file_type), intent(inout) :: self
      logical, intent(in) :: to_disk             !! wait until the disk has it all
      type(error_type), allocatable, intent(out) :: error   !! status_file
      character(len=:), allocatable :: reason

      call release_blocks(self%descriptor)
      if (is_lost(self)) then
         call save_again(self, error)
      else
         reason = ''
         if (to_disk) call sync_open(self%descriptor, reason)
         if (len(reason) == 0) call rename_file(part_path(self), self%path, reason)
         if (len(reason) > 0) call file_error(error, self%shown, reason, 'the results are ' &
               //'complete in '''//self%shown//part_ending//''': rename it')
         if (to_disk) call sync_folder(folder_of(self%path))
      end if
      call close_open(self%descriptor)
   end subroutine finish

   !> Saves the results although their files, or the directory, were removed. What another run
   !> writes there by now is left alone.
   subroutine save_again(self, error)
      type(part_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      type(file_facts_type) :: facts
      character(len=:), allocatable :: reason

      facts = look_at(part_path(self))
      if (facts%exists .and. .not. is_same(facts, self%facts)) then
         reason = 'another run writes there by now'
      else
         call make_folders(folder_of(self%path))
         call replace_by_copy(self, reason)
         if (len(reason) == 0) call remove_file(part_path(self))
      end if
      if (len(reason) == 0) then
         call file_error(error, self%shown, 'it was removed while the run was writing it; the ' &
               //'results up to then have been saved there again', lost_cure)
      else
         call file_error(error, self%shown, 'it was removed while the run was writing it, and ' &
               //'could not be saved again: '//reason, lost_cure)
      end if
   end subroutine save_again

   !> Gives the output up: the part file goes, what is at the path stays.
   subroutine discard(self)
      type(part_file_type), intent(inout) :: self

      if (self%descriptor < 0) return
      if (is_same(self%facts, look_at(part_path(self)))) call remove_file(part_path(self))
      call close_open(self%descriptor)
   end subroutine discard

   !> Whether the file that the user sees, or the part file, is no longer there.
   function is_lost(self)
      type(part_file_type), intent(in) :: self
      logical :: is_lost
      type(file_facts_type) :: facts

      is_lost = .not. is_same(self%facts, look_at(part_path(self)))
      facts = look_at(self%path)
      if (self%published) is_lost = is_lost .or. .not. facts%exists
   end function is_lost

   !> Whether the output is held by this process.
   pure logical function is_claimed(self)
      type(part_file_type), intent(in) :: self

      is_claimed = self%descriptor >= 0
   end function is_claimed

   !> Whether something of this run is at the path.
   pure logical function has_published(self)
      type(part_file_type), intent(in) :: self

      has_published = self%published
   end function has_published

   !> The file to write to, from the root.
   pure function part_path(self) result(path)
      type(part_file_type), intent(in) :: self
      character(len=:), allocatable :: path

      path = self%path//part_ending
   end function part_path

   !> The path itself, as the user has named it.
   pure function shown_path(self) result(path)
      type(part_file_type), intent(in) :: self
      character(len=:), allocatable :: path

      path = self%shown
   end function shown_path

   !> No space, or no access any more: what is lost by that.
   subroutine full_error(self, reason, error)
      type(part_file_type), intent(in) :: self
      character(len=*), intent(in) :: reason
      type(error_type), allocatable, intent(out) :: error

      call file_error(error, self%shown, reason, 'make room, or raise the limit; or ask for ' &
            //'fewer results (FREQUENCY, *OUTPUT, COMPRESS)')
   end subroutine full_error

   subroutine file_error(error, path, reason, cure)
      type(error_type), allocatable, intent(out) :: error
      character(len=*), intent(in) :: path, reason, cure

      call new_error(error, status_file, 'cannot write '''//path//''': '//reason//nl//'  cure: ' &
            //cure)
   end subroutine file_error

end module part_file
