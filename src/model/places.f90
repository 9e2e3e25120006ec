!> Where in the deck a thing was said, and messages that point there.
module places
   use errors, only: error_type, new_error, status_deck
   use display, only: displayed, display_width, abridged
   use text, only: to_text
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: place_type, source_line_type, source_file_type, source_type
   public :: new_source_file, source_line, fail_at, note_at, place_text, line_text

   integer, parameter :: code_tab = 9, code_lf = 10, code_cr = 13
   integer, parameter :: longest_cause = 400     !! bytes of what is wrong, that quotes the deck

   !> A stretch of one deck line; line 0 means nowhere in particular.
   type :: place_type
      integer :: file = 0     !! index into the source's files
      integer :: line = 0     !! from 1
      integer :: column = 0   !! first column of what is meant, from 1; 0 is the whole line
      integer :: length = 0   !! columns that the caret underlines
      integer :: card = 0     !! line of the keyword card it belongs to, 0 if it is the card
   end type place_type

   !> One line of text.
   type :: source_line_type
      character(len=:), allocatable :: text
   end type source_line_type

   !> A deck file or one it includes: line i is content(first(i):last(i)).
   type :: source_file_type
      character(len=:), allocatable :: name
      character(len=:), allocatable :: content
      integer, allocatable :: first(:), last(:)   !! (n_lines)
      integer :: n_lines = 0
      type(place_type) :: included   !! the *INCLUDE that names it; line 0: the deck itself
   end type source_file_type

   !> The text of the deck, kept so that any message can show the line it speaks of.
   type :: source_type
      type(source_file_type), allocatable :: files(:)
      integer :: n_files = 0
      integer :: n_stored = 0   !! files whose text is here before they are read, in their order
   end type source_type

contains

   !> Takes over the text of a file and finds its lines: they end at line feeds; a carriage return
   !> before one goes too.
   pure subroutine new_source_file(self, name, content)
      type(source_file_type), intent(out) :: self
      character(len=*), intent(in) :: name
      character(len=:), allocatable, intent(inout) :: content   !! not allocated afterwards
      integer :: i, n, length, status

      length = len(content)
      n = 0
      do i = 1, length
         if (iachar(content(i:i)) == code_lf) n = n + 1
      end do
      if (length > 0) then
         if (iachar(content(length:length)) /= code_lf) n = n + 1
      end if
      allocate (self%first(n), self%last(n), stat=status)
      call check_allocation(status)
      self%name = name
      self%n_lines = n
      n = 1
      if (length > 0) self%first(1) = 1
      do i = 1, length
         if (iachar(content(i:i)) /= code_lf) cycle
         self%last(n) = i - 1
         n = n + 1
         if (i < length) self%first(n) = i + 1
      end do
      if (n == self%n_lines) self%last(n) = length
      do i = 1, self%n_lines
         if (self%last(i) < self%first(i)) cycle
         if (iachar(content(self%last(i):self%last(i))) == code_cr) self%last(i) = self%last(i) - 1
      end do
      call move_alloc(content, self%content)
   end subroutine new_source_file

   !> A line as it stands in the file.
   pure function source_line(source, file, line) result(text)
      type(source_type), intent(in) :: source
      integer, intent(in) :: file, line
      character(len=:), allocatable :: text

      associate (from => source%files(file))
         text = from%content(from%first(line):from%last(line))
      end associate
   end function source_line

   !> Makes a deck error: what is wrong, "file:line", the card, the line with a caret, and the cure.
   pure subroutine fail_at(error, source, place, cause, cure)
      type(error_type), allocatable, intent(out) :: error
      type(source_type), intent(in) :: source
      type(place_type), intent(in) :: place
      character(len=*), intent(in) :: cause             !! what is wrong
      character(len=*), intent(in), optional :: cure    !! what would be right
      character(len=:), allocatable :: message

      message = place_text(source, place, abridged(cause, longest_cause))
      if (present(cure)) message = message//new_line('a')//'  cure: '//cure
      call new_error(error, status_deck, message)
   end subroutine fail_at

   !> A note (no error) that points at a place: one line.
   pure function note_at(source, place, remark) result(note)
      type(source_type), intent(in) :: source
      type(place_type), intent(in) :: place
      character(len=*), intent(in) :: remark
      character(len=:), allocatable :: note

      note = remark
      if (is_known(source, place)) then
         note = source%files(place%file)%name//':'//to_text(place%line)//': '//remark
      end if
      note = displayed(note)
   end function note_at

   !> "file:line".
   pure function line_text(source, place) result(string)
      type(source_type), intent(in) :: source
      type(place_type), intent(in) :: place
      character(len=:), allocatable :: string

      string = 'an unknown place'
      if (is_known(source, place)) string = source%files(place%file)%name//':'//to_text(place%line)
   end function line_text

   !> "file:line: cause", then the card, the line and a caret below what is meant.
   pure function place_text(source, place, cause) result(message)
      type(source_type), intent(in) :: source
      type(place_type), intent(in) :: place
      character(len=*), intent(in) :: cause
      character(len=:), allocatable :: message
      character(len=:), allocatable :: line
      integer :: first, length

      message = note_at(source, place, cause)
      if (.not. is_known(source, place)) return
      if (place%card > 0 .and. place%card /= place%line) then
         message = message//new_line('a')//'  card: '// &
               printable(abridged(source_line(source, place%file, place%card), longest_cause))
      end if
      line = source_line(source, place%file, place%line)
      first = max(1, place%column)
      length = place%length
      if (place%column == 0) then
         first = max(1, verify(line, ' '//achar(code_tab)))
         length = len_trim(line) - first + 1
      end if
      message = message//new_line('a')//marked(line, first, max(1, length))// &
            way_of_includes(source, place%file)
   end function place_text

   !> A line for each *INCLUDE on the way to a file.
   pure function way_of_includes(source, file) result(lines)
      type(source_type), intent(in) :: source
      integer, intent(in) :: file
      character(len=:), allocatable :: lines
      type(place_type) :: place

      lines = ''
      place = source%files(file)%included
      do while (is_known(source, place))
         lines = lines//new_line('a')//'  included at '//line_text(source, place)
         place = source%files(place%file)%included
      end do
   end function way_of_includes

   !> A line with carets below a stretch of it; of a very long line the part around the stretch.
   pure function marked(line, first, length) result(lines)
      character(len=*), intent(in) :: line
      integer, intent(in) :: first, length
      character(len=:), allocatable :: lines
      integer, parameter :: longest = 160
      integer :: start, finish, i

      start = 1
      finish = len_trim(line)
      if (finish > longest) then
         start = max(1, first - longest/2)
         finish = min(finish, start + longest - 1)
         do i = 1, 3                             ! no character is cut
            if (start < first) start = start + merge(1, 0, continues(line, start))
            if (finish < len(line)) finish = finish + merge(1, 0, continues(line, finish + 1))
         end do
      end if
      lines = '        '//printable(line(start:finish))//new_line('a')//'        '// &
            repeat(' ', display_width(printable(line(start:min(first - 1, len(line))))))// &
            repeat('^', max(1, display_width(printable(line(first:min(first + length - 1, &
            finish))))))
   end function marked

   !> Whether a byte goes on with a character of UTF-8.
   pure function continues(line, i) result(does)
      character(len=*), intent(in) :: line
      integer, intent(in) :: i
      logical :: does

      does = iachar(line(i:i)) >= 128 .and. iachar(line(i:i)) < 192
   end function continues

   pure function is_known(source, place) result(known)
      type(source_type), intent(in) :: source
      type(place_type), intent(in) :: place
      logical :: known

      known = .false.
      if (place%file < 1 .or. place%file > source%n_files .or. place%line < 1) return
      known = place%line <= source%files(place%file)%n_lines
   end function is_known

   !> A line of a deck as it is shown: a tab is one blank, what cannot be seen an escape.
   pure function printable(line) result(clean)
      character(len=*), intent(in) :: line
      character(len=:), allocatable :: clean
      integer :: i

      clean = line
      do i = 1, len(line)
         if (iachar(line(i:i)) == code_tab) clean(i:i) = ' '
      end do
      clean = displayed(clean)
   end function printable

end module places
