!> Files to lines: the text of the deck as it stands, ready to be shown in messages.
module source_reader
   use kinds, only: int64
   use display, only: abridged
   use text, only: to_text
   use errors, only: error_type, new_error, status_file, status_deck
   use memory_shortage, only: check_allocation
   use file_calls, only: file_facts_type, look_at, is_regular
   use places, only: source_type, source_file_type, source_line_type, place_type, fail_at
   use places, only: new_source_file
   implicit none
   private

   public :: add_file, add_note

   integer, parameter :: code_tab = 9
   integer, parameter :: most_notes = 1000
   integer, parameter :: longest_path = 400   !! bytes of a path in messages
   integer(int64), parameter :: most_bytes = 2147483646_int64

contains

   !> Reads a file and appends it to the source, which may know its text already; a byte that is no
   !> text is an error. Pipes and devices are not opened: they could wait for ever, or never end.
   subroutine add_file(source, path, included, error)
      type(source_type), intent(inout) :: source
      character(len=*), intent(in) :: path
      type(place_type), intent(in) :: included              !! the *INCLUDE, line 0 for the deck
      type(error_type), allocatable, intent(out) :: error   !! status_file if it cannot be read
      character(len=:), allocatable :: content
      integer(int64) :: length

      if (source%n_files < source%n_stored) then
         source%n_files = source%n_files + 1
         source%files(source%n_files)%included = included
         return
      end if
      call check_kind(path, error)
      if (allocated(error)) return
      inquire (file=path, size=length)
      if (length == 0) then
         call refuse_empty(path, included%line == 0, error)
         return
      end if
      call read_content(path, content, total_length(source), error)
      if (allocated(error)) return
      call make_room(source)
      source%n_files = source%n_files + 1
      call new_source_file(source%files(source%n_files), path, content)
      source%files(source%n_files)%included = included
      call check_bytes(source, source%n_files, error)
   end subroutine add_file

   subroutine check_kind(path, error)
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error
      type(file_facts_type) :: facts

      facts = look_at(path)
      if (.not. facts%exists .or. is_regular(facts)) return
      call new_error(error, status_file, 'cannot read '''//abridged(path, longest_path) &
            //''': it is a directory, pipe or device'//new_line('a') &
            //'  cure: save the deck in a file')
   end subroutine check_kind

   subroutine refuse_empty(path, is_deck, error)
      character(len=*), intent(in) :: path
      logical, intent(in) :: is_deck             !! not an included file
      type(error_type), allocatable, intent(out) :: error

      if (is_deck) then
         call new_error(error, status_deck, path//':1: the deck is empty'// &
               new_line('a')//'  cure: write at least *NODE, *ELEMENT and a step')
      else
         call new_error(error, status_file, "'"//path//"' is empty")
      end if
   end subroutine refuse_empty

   !> Bytes of all files so far.
   pure function total_length(source) result(total)
      type(source_type), intent(in) :: source
      integer(int64) :: total
      integer :: i

      total = 0
      do i = 1, source%n_files
         total = total + len(source%files(i)%content, int64)
      end do
   end function total_length

   !> The bytes of a file, a byte order mark dropped.
   subroutine read_content(path, content, so_far, error)
      character(len=*), intent(in) :: path
      character(len=:), allocatable, intent(out) :: content
      integer(int64), intent(in) :: so_far                  !! bytes of the files before
      type(error_type), allocatable, intent(out) :: error
      character(len=*), parameter :: byte_order_mark = char(239)//char(187)//char(191)
      character(len=:), allocatable :: reason
      integer(int64) :: length
      integer :: unit, status

      call open_file(path, unit, length, error)
      if (allocated(error)) return
      if (length < 0 .or. length > most_bytes - so_far) then
         close (unit)
         call new_error(error, status_file, "cannot read '"//path//"': a deck with all that it "// &
               'includes may have 2 147 483 646 bytes')
         return
      end if
      reason = 'there is no memory for its '//to_text(length)//' bytes'
      allocate (character(len=int(length)) :: content, stat=status)
      if (status == 0) call read_bytes(unit, content, status, reason)
      close (unit)
      if (status /= 0) then
         call new_error(error, status_file, "cannot read '"//path//"': "//reason)
      else if (length >= 3) then
         if (content(1:3) == byte_order_mark) content = content(4:)
      end if
   end subroutine read_content

   subroutine open_file(path, unit, length, error)
      character(len=*), intent(in) :: path
      integer, intent(out) :: unit
      integer(int64), intent(out) :: length                 !! bytes
      type(error_type), allocatable, intent(out) :: error
      character(len=len(path) + 200) :: reason   ! it repeats the path
      integer :: status

      length = -1
      open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
            action='read', iostat=status, iomsg=reason)
      if (status == 0) then
         inquire (unit=unit, size=length)
      else
         call new_error(error, status_file, "cannot open '"//abridged(path, longest_path)//"':"// &
               trim(reason(index(reason, ': ', back=.true.) + 1:))//new_line('a')// &
               '  cure: check the name, and that the file may be read')
      end if
   end subroutine open_file

   subroutine read_bytes(unit, content, status, reason)
      integer, intent(in) :: unit
      character(len=:), allocatable, intent(inout) :: content   !! has its length
      integer, intent(out) :: status             !! 0 when all is well
      character(len=:), allocatable, intent(inout) :: reason
      character(len=200) :: message

      read (unit, iostat=status, iomsg=message) content
      if (status /= 0) reason = trim(message)
   end subroutine read_bytes

   !> Refuses control bytes: the file is no text.
   pure subroutine check_bytes(source, file, error)
      type(source_type), intent(in) :: source
      integer, intent(in) :: file
      type(error_type), allocatable, intent(out) :: error
      type(place_type) :: place
      integer :: i, column

      associate (from => source%files(file))
         do i = 1, from%n_lines
            column = first_control_byte(from%content(from%first(i):from%last(i)))
            if (column == 0) cycle
            place%file = file
            place%line = i
            place%column = column
            place%length = 1
            call fail_at(error, source, place, 'this is not a text file: it holds '// &
                  name_of_byte(from%content(from%first(i) + column - 1:from%last(i))), &
                  cure='decks are plain text (ASCII or UTF-8), their lines end with a line '// &
                  'feed, with a carriage return before it or none')
            return
         end do
      end associate
   end subroutine check_bytes

   !> The control byte at the start of a text.
   pure function name_of_byte(string) result(name)
      character(len=*), intent(in) :: string
      character(len=:), allocatable :: name
      character(len=2) :: digits

      write (digits, '(z2.2)') iachar(string(1:1))
      name = 'the control byte '//digits
      if (iachar(string(1:1)) == 13) name = name//', a carriage return without a line feed'
      if (iachar(string(1:1)) == 12) name = name//', a form feed'
   end function name_of_byte

   pure function first_control_byte(line) result(column)
      character(len=*), intent(in) :: line
      integer :: column
      integer :: code

      do column = 1, len(line)
         code = iachar(line(column:column))
         if ((code < 32 .and. code /= code_tab) .or. code == 127) return
      end do
      column = 0
   end function first_control_byte

   !> Room for one more file; the text of those present is moved, not copied.
   pure subroutine make_room(source)
      type(source_type), intent(inout) :: source
      type(source_file_type), allocatable :: files(:)
      integer :: i, status

      if (.not. allocated(source%files)) then
         allocate (source%files(4), stat=status)
         call check_allocation(status)
      end if
      if (source%n_files < size(source%files)) return
      allocate (files(2*size(source%files)), stat=status)
      call check_allocation(status)
      do i = 1, source%n_files
         call move_alloc(source%files(i)%name, files(i)%name)
         call move_alloc(source%files(i)%content, files(i)%content)
         call move_alloc(source%files(i)%first, files(i)%first)
         call move_alloc(source%files(i)%last, files(i)%last)
         files(i)%n_lines = source%files(i)%n_lines
         files(i)%included = source%files(i)%included
      end do
      call move_alloc(files, source%files)
   end subroutine make_room

   !> Appends a remark to the notes for the log; of very many the last says that there are more.
   pure subroutine add_note(notes, remark)
      type(source_line_type), allocatable, intent(inout) :: notes(:)
      character(len=*), intent(in) :: remark
      type(source_line_type), allocatable :: longer(:)
      integer :: i, n, status

      n = 0
      if (allocated(notes)) n = size(notes)
      if (n > most_notes) return
      allocate (longer(n + 1), stat=status)
      call check_allocation(status)
      do i = 1, n
         call move_alloc(notes(i)%text, longer(i)%text)
      end do
      longer(n + 1)%text = remark
      if (n == most_notes) longer(n + 1)%text = 'further notes on the deck are left out'
      call move_alloc(longer, notes)
   end subroutine add_note

end module source_reader
