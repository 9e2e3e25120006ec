!> /restart of a result file: the state that a run can go on from, and what it was read from.
!>
!> Each entry of the archive is a dataset, written anew in its place while its size stays.
!> `index/entries` lists them and `index/checks` has a check sum of each: what is damaged is not
!> taken for a state.
module restart_group
   use kinds, only: wp, int64
   use errors, only: error_type, new_error, status_file
   use text, only: to_text
   use places, only: source_type
   use state_archive, only: archive_type, entry_type
   use memory_shortage, only: check_allocation
   use hdf5_file, only: hdf5_file_type
   use hdf5_reader, only: hdf5_reader_type
   implicit none
   private

   public :: restart_group_type, new_restart_group, write_state, write_deck_names, remove_state
   public :: read_state, continue_group

   !> To be raised when entries change their meaning.
   integer, parameter :: format_version = 1
   integer, parameter :: name_length = 160
   character(len=*), parameter :: root = '/restart'
   !> What is said of the entries: no entry has a name that begins so, nor with deck/.
   character(len=*), parameter :: contents = root//'/index'
   !> What an entry holds stands before its name in the list.
   character(len=*), parameter :: mark_real = 'real ', mark_integer = 'integer '
   character(len=*), parameter :: nl = new_line('a')
   !> Bytes of a dataset beyond its values, of a number, of a line of the list of entries.
   integer(int64), parameter :: header = 2048, number = 8
   integer(int64), parameter :: line = name_length + len(mark_integer)

   !> What is in the group, as far as this run has written it or has taken it over.
   type :: restart_group_type
      private
      character(len=name_length), allocatable :: files(:)         ! of the deck, in their order
      integer, allocatable :: n_lines(:)                          ! of them
      character(len=name_length), allocatable :: definitions(:)   ! NAME=VALUE of the command line
      character(len=name_length), allocatable :: entries(:)
      integer(int64), allocatable :: sizes(:)                     ! numbers of each entry
   end type restart_group_type

contains

   !> What is to be said of the deck.
   subroutine new_restart_group(self, source, definitions)
      type(restart_group_type), intent(out) :: self
      type(source_type), intent(in) :: source
      character(len=*), intent(in) :: definitions(:)   !! NAME=VALUE
      integer :: i, status

      allocate (self%files(source%n_files), self%n_lines(source%n_files), stat=status)
      call check_allocation(status)
      do i = 1, source%n_files
         self%files(i) = source%files(i)%name
         self%n_lines(i) = source%files(i)%n_lines
      end do
      self%definitions = definitions
   end subroutine new_restart_group

   !> How the text in /model/deck is made up, and what has replaced parameters in it.
   subroutine write_deck_names(self, file, error)
      type(restart_group_type), intent(in) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(error_type), allocatable, intent(out) :: error

      call file%remove(root//'/deck', error)
      if (allocated(error)) return
      call file%write_dataset(root//'/deck/files', self%files, &
            'the deck and what it includes, in the order of /model/deck', error)
      if (allocated(error)) return
      call file%write_dataset(root//'/deck/lines', self%n_lines, 'lines of each file', error)
      if (allocated(error)) return
      call file%write_dataset(root//'/deck/definitions', self%definitions, &
            'parameters replaced by --define', error)
   end subroutine write_deck_names

   !> The group is there already, with the archive that was read from it: its entries are written
   !> anew where they lie.
   subroutine continue_group(self, archive)
      type(restart_group_type), intent(inout) :: self
      type(archive_type), intent(in) :: archive
      character(len=name_length) :: entries(archive%n)
      integer :: i

      do i = 1, archive%n
         entries(i) = marked_name(archive%entries(i))
      end do
      self%entries = entries
      call keep_sizes(self, archive)
   end subroutine continue_group

   !> Writes the archive in the place of the one before; where the disk has no room for it, that one
   !> stays whole: all room is reserved before anything is changed.
   subroutine write_state(self, file, archive, error)
      type(restart_group_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(archive_type), intent(in) :: archive
      type(error_type), allocatable, intent(out) :: error   !! status_file
      character(len=name_length) :: entries(archive%n)
      integer(int64) :: checks(archive%n), bytes
      integer :: i

      do i = 1, archive%n
         entries(i) = marked_name(archive%entries(i))
         checks(i) = check_sum(archive%entries(i))
      end do
      bytes = needed_room(self, archive, entries)
      if (bytes > 0) call file%reserve(bytes, error)
      if (allocated(error)) return
      if (.not. allocated(self%entries)) call begin_group(self, file, error)
      if (allocated(error)) return
      do i = 1, archive%n
         call write_entry(file, archive%entries(i), error)
         if (allocated(error)) return
      end do
      call file%overwrite(contents//'/checks', checks, 'check sums of the entries', error)
      if (allocated(error)) return
      call list_entries(self, file, entries, error)
      call keep_sizes(self, archive)
   end subroutine write_state

   !> An empty group; what an earlier run has left there goes.
   subroutine begin_group(self, file, error)
      type(restart_group_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(error_type), allocatable, intent(out) :: error
      integer :: status

      call remove_state(file, error)
      if (allocated(error)) return
      call file%create_group(root, 'the state that a run can go on from with --restart', error)
      if (allocated(error)) return
      call file%write_dataset(contents//'/format', [format_version], &
            'version of the meaning of the entries', error)
      if (allocated(error)) return
      call write_deck_names(self, file, error)
      allocate (self%entries(0), self%sizes(0), stat=status)
      call check_allocation(status)
   end subroutine begin_group

   !> Bytes of all that has no place of its size in the group yet, 0 if everything has.
   pure function needed_room(self, archive, entries) result(bytes)
      type(restart_group_type), intent(in) :: self
      type(archive_type), intent(in) :: archive
      character(len=*), intent(in) :: entries(:)   !! their names, marked
      integer(int64) :: bytes, n_numbers
      integer :: i

      bytes = 0
      do i = 1, archive%n
         n_numbers = size_of(archive%entries(i))
         if (has_place(self, i, entries(i), n_numbers)) cycle
         bytes = bytes + header + number*n_numbers
      end do
      if (allocated(self%entries)) then
         if (bytes == 0 .and. size(self%entries) == archive%n) return
      end if
      ! the group with its format and its deck, the list and the check sums
      bytes = bytes + 8*header + (line + number)*archive%n &
            + line*(2*size(self%files) + size(self%definitions))
   end function needed_room

   !> Whether an entry of this name and size is there; most have the same number as before.
   pure logical function has_place(self, i, name, n_numbers)
      type(restart_group_type), intent(in) :: self
      integer, intent(in) :: i
      character(len=*), intent(in) :: name       !! marked
      integer(int64), intent(in) :: n_numbers

      has_place = .false.
      if (.not. allocated(self%entries)) return
      if (i <= size(self%entries)) has_place = self%entries(i) == name &
            .and. self%sizes(i) == n_numbers
      if (.not. has_place) has_place = any(self%entries == name .and. self%sizes == n_numbers)
   end function has_place

   subroutine keep_sizes(self, archive)
      type(restart_group_type), intent(inout) :: self
      type(archive_type), intent(in) :: archive
      integer(int64) :: sizes(archive%n)
      integer :: i

      do i = 1, archive%n
         sizes(i) = size_of(archive%entries(i))
      end do
      self%sizes = sizes
   end subroutine keep_sizes

   !> Numbers of an entry.
   pure function size_of(entry) result(n)
      type(entry_type), intent(in) :: entry
      integer(int64) :: n

      if (allocated(entry%reals)) then
         n = size(entry%reals, kind=int64)
      else
         n = size(entry%integers, kind=int64)
      end if
   end function size_of

   subroutine write_entry(file, entry, error)
      type(hdf5_file_type), intent(inout) :: file
      type(entry_type), intent(in) :: entry
      type(error_type), allocatable, intent(out) :: error
      character(len=*), parameter :: meaning = 'part of the state: '

      if (allocated(entry%reals)) then
         call file%overwrite(root//'/'//entry%name, entry%reals, meaning//entry%name, error)
      else
         call file%overwrite(root//'/'//entry%name, entry%integers, meaning//entry%name, error)
      end if
   end subroutine write_entry

   !> The list of entries, where it is another than before; entries that are none any more go.
   subroutine list_entries(self, file, entries, error)
      type(restart_group_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: entries(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      if (size(entries) == size(self%entries)) then
         if (all(entries == self%entries)) return
      end if
      do i = 1, size(self%entries)
         if (any(entries == self%entries(i))) cycle
         call file%remove(root//'/'//plain_name(self%entries(i)), error)
         if (allocated(error)) return
      end do
      call file%remove(contents//'/entries', error)
      if (allocated(error)) return
      call file%write_dataset(contents//'/entries', entries, &
            'names of all entries, with their kinds', error)
      self%entries = entries
   end subroutine list_entries

   !> Takes the group away: there is nothing to go on from any more.
   subroutine remove_state(file, error)
      type(hdf5_file_type), intent(inout) :: file
      type(error_type), allocatable, intent(out) :: error

      call file%remove(root, error)
   end subroutine remove_state

   !> The state in a result file.
   subroutine read_state(reader, path, archive, error)
      type(hdf5_reader_type), intent(in) :: reader   !! open
      character(len=*), intent(in) :: path           !! of the file, for messages
      type(archive_type), intent(out) :: archive
      type(error_type), allocatable, intent(out) :: error   !! status_file
      character(len=name_length), allocatable :: entries(:)
      integer(int64), allocatable :: checks(:)
      logical :: sound
      integer :: i

      call check_group(reader, path, error)
      if (allocated(error)) return
      call reader%read_texts(contents//'/entries', name_length, entries, error)
      if (.not. allocated(error)) call reader%read_dataset(contents//'/checks', checks, error)
      sound = .not. allocated(error)
      if (sound) sound = size(checks) == size(entries)
      if (sound) then
         do i = 1, size(entries)
            call read_entry(reader, entries(i), checks(i), archive, sound)
            if (.not. sound) exit
         end do
      end if
      if (allocated(error)) deallocate (error)
      if (.not. sound) call new_error(error, status_file, 'the state in '''//path//''' is damaged' &
            //nl//'  cure: go on from a copy of the file, or run the deck from its start')
   end subroutine read_state

   !> That there is a state, of the format written here.
   subroutine check_group(reader, path, error)
      type(hdf5_reader_type), intent(in) :: reader
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: version(:)
      logical :: is_result

      is_result = reader%holds('/VTKHDF')
      if (is_result) is_result = reader%holds('/model/deck')
      if (.not. is_result) then
         call new_error(error, status_file, ''''//path//''' is no result file of carom'//nl &
               //'  cure: name the .h5 file of an earlier run')
         return
      else if (.not. reader%holds(root)) then
         call new_error(error, status_file, ''''//path//''' holds no state to go on from: its ' &
               //'run came to its end without *RESTART, or had kept none yet'//nl &
               //'  cure: run the deck from its start, with *RESTART, WRITE in its steps')
         return
      end if
      call reader%read_dataset(contents//'/format', version, error)
      if (allocated(error)) return
      if (size(version) == 1) then
         if (version(1) == format_version) return
      end if
      call new_error(error, status_file, 'the state in '''//path//''' has another format than ' &
            //'this program writes ('//to_text(format_version)//')'//nl &
            //'  cure: go on with the version of carom that wrote it (attribute of /model)')
   end subroutine check_group

   !> Appends an entry to the archive if it is what was written.
   subroutine read_entry(reader, marked, check, archive, sound)
      type(hdf5_reader_type), intent(in) :: reader
      character(len=*), intent(in) :: marked     !! its name, with its kind
      integer(int64), intent(in) :: check
      type(archive_type), intent(inout) :: archive
      logical, intent(out) :: sound
      type(error_type), allocatable :: error
      real(wp), allocatable :: reals(:)
      integer(int64), allocatable :: integers(:)

      if (index(marked, mark_real) == 1) then
         call reader%read_dataset(root//'/'//plain_name(marked), reals, error)
         if (.not. allocated(error)) call archive%add_reals(plain_name(marked), reals)
      else
         call reader%read_dataset(root//'/'//plain_name(marked), integers, error)
         if (.not. allocated(error)) call archive%add_integers(plain_name(marked), integers)
      end if
      sound = .not. allocated(error)
      if (sound) sound = check_sum(archive%entries(archive%n)) == check
   end subroutine read_entry

   pure function marked_name(entry) result(name)
      type(entry_type), intent(in) :: entry
      character(len=:), allocatable :: name

      if (allocated(entry%reals)) then
         name = mark_real//entry%name
      else
         name = mark_integer//entry%name
      end if
   end function marked_name

   pure function plain_name(marked) result(name)
      character(len=*), intent(in) :: marked
      character(len=:), allocatable :: name

      name = trim(marked(index(marked, ' ') + 1:))
   end function plain_name

   !> All bits of an entry folded into 64, turned from one number to the next.
   pure function check_sum(entry) result(sum)
      type(entry_type), intent(in) :: entry
      integer(int64) :: sum
      integer, parameter :: turn = 7
      integer :: i

      if (allocated(entry%reals)) then
         sum = size(entry%reals)
         do i = 1, size(entry%reals)
            sum = ieor(ishftc(sum, turn), transfer(entry%reals(i), sum))
         end do
      else
         sum = size(entry%integers)
         do i = 1, size(entry%integers)
            sum = ieor(ishftc(sum, turn), entry%integers(i))
         end do
      end if
   end function check_sum

end module restart_group
