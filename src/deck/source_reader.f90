!> Files to lines: the text of the deck as it stands, ready to be shown in messages.
module source_reader
   use, intrinsic :: iso_fortran_env, only: int64
   use errors, only: error_type, new_error, status_file
   use memory_shortage, only: check_allocation
   use file_calls, only: file_facts_type, look_at, is_regular
   use places, only: source_type, source_file_type, source_line_type, place_type, fail_at
   use places, only: new_source_file
   implicit none
   private

   public :: add_file, add_note

   integer, parameter :: code_tab = 9

contains

   !> Reads a file and appends it to the source, which may know its text already; a byte that is no
   !> text is an error.
   subroutine add_file(source, path, error)
      type(source_type), intent(inout) :: source
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error   !! status_file if it cannot be read
      character(len=:), allocatable :: content

      if (source%n_files < source%n_stored) then
         source%n_files = source%n_files + 1
         return
      end if
      call read_content(path, content, error)
      if (allocated(error)) return
      call make_room(source)
      source%n_files = source%n_files + 1
      call new_source_file(source%files(source%n_files), path, content)
      call check_bytes(source, source%n_files, error)
   end subroutine add_file

   !> The bytes of a file, a byte order mark dropped.
   subroutine read_content(path, content, error)
      character(len=*), intent(in) :: path
      character(len=:), allocatable, intent(out) :: content
      type(error_type), allocatable, intent(out) :: error
      character(len=*), parameter :: byte_order_mark = char(239)//char(187)//char(191)
      character(len=200) :: reason
      type(file_facts_type) :: facts
      integer(int64) :: length
      integer :: unit, status

      facts = look_at(path)
      if (facts%exists .and. .not. is_regular(facts)) then
         ! reading a pipe could wait for ever
         call new_error(error, status_file, 'cannot read '''//path//''': it is a directory, ' &
               //'pipe or device'//new_line('a')//'  cure: save the deck in a file')
         return
      end if
      open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
            action='read', iostat=status, iomsg=reason)
      if (status /= 0) then
         call new_error(error, status_file, "cannot open '"//path//"':"// &
               trim(reason(index(reason, ': ', back=.true.) + 1:))//new_line('a')// &
               '  cure: check the name, and that the file may be read')
         return
      end if
      inquire (unit=unit, size=length)
      if (length < 0 .or. length > int(huge(unit) - 1, int64)) then
         close (unit)
         call new_error(error, status_file, "cannot read '"//path//"': not a file of text")
         return
      end if
      allocate (character(len=int(length)) :: content, stat=status)
      call check_allocation(status)
      if (length > 0) read (unit, iostat=status, iomsg=reason) content
      close (unit)
      if (status /= 0) then
         call new_error(error, status_file, "cannot read '"//path//"': "//trim(reason))
      else if (length >= 3) then
         if (content(1:3) == byte_order_mark) content = content(4:)
      end if
   end subroutine read_content

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
            call fail_at(error, source, place, &
                  'this is not a text file: it holds a control byte', &
                  cure='decks are plain text (ASCII or UTF-8)')
            return
         end do
      end associate
   end subroutine check_bytes

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
      end do
      call move_alloc(files, source%files)
   end subroutine make_room

   !> Appends a remark to the notes for the log.
   pure subroutine add_note(notes, remark)
      type(source_line_type), allocatable, intent(inout) :: notes(:)
      character(len=*), intent(in) :: remark
      type(source_line_type), allocatable :: longer(:)
      integer :: i, n, status

      n = 0
      if (allocated(notes)) n = size(notes)
      allocate (longer(n + 1), stat=status)
      call check_allocation(status)
      do i = 1, n
         call move_alloc(notes(i)%text, longer(i)%text)
      end do
      longer(n + 1)%text = remark
      call move_alloc(longer, notes)
   end subroutine add_note

end module source_reader
