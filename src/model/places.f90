!> Where in the deck a thing was said, and messages that point there.
module places
   use errors, only: error_type, new_error, status_deck
   use text, only: to_text
   implicit none
   private

   public :: place_type, source_line_type, source_file_type, source_type
   public :: fail_at, note_at, place_text, line_text

   !> A stretch of one deck line; line 0 means nowhere in particular.
   type :: place_type
      integer :: file = 0     !! index into the source's files
      integer :: line = 0     !! from 1
      integer :: column = 0   !! first column of what is meant, from 1; 0 is the whole line
      integer :: length = 0   !! columns that the caret underlines
      integer :: card = 0     !! line of the keyword card it belongs to, 0 if it is the card
   end type place_type

   !> One line as it stands in the file.
   type :: source_line_type
      character(len=:), allocatable :: text
   end type source_line_type

   !> A deck file or one it includes.
   type :: source_file_type
      character(len=:), allocatable :: name
      type(source_line_type), allocatable :: lines(:)
      integer :: n_lines = 0
   end type source_file_type

   !> The text of the deck, kept so that any message can show the line it speaks of.
   type :: source_type
      type(source_file_type), allocatable :: files(:)
      integer :: n_files = 0
   end type source_type

contains

   !> Makes a deck error: what is wrong, "file:line", the card, the line with a caret, and the cure.
   pure subroutine fail_at(error, source, place, cause, cure)
      type(error_type), allocatable, intent(out) :: error
      type(source_type), intent(in) :: source
      type(place_type), intent(in) :: place
      character(len=*), intent(in) :: cause             !! what is wrong
      character(len=*), intent(in), optional :: cure    !! what would be right
      character(len=:), allocatable :: message

      message = place_text(source, place, cause)
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
               printable(source%files(place%file)%lines(place%card)%text)
      end if
      line = source%files(place%file)%lines(place%line)%text
      first = max(1, place%column)
      length = place%length
      if (place%column == 0) then
         first = max(1, verify(line, ' '//achar(9)))
         length = len_trim(line) - first + 1
      end if
      message = message//new_line('a')//marked(line, first, max(1, length))
   end function place_text

   !> A line with carets below a stretch of it; of a very long line the part around the stretch.
   pure function marked(line, first, length) result(lines)
      character(len=*), intent(in) :: line
      integer, intent(in) :: first, length
      character(len=:), allocatable :: lines
      integer, parameter :: longest = 160
      integer :: start, finish

      start = 1
      finish = len_trim(line)
      if (finish > longest) then
         start = max(1, first - longest/2)
         finish = min(finish, start + longest - 1)
      end if
      lines = '        '//printable(line(start:finish))//new_line('a')// &
            '        '//repeat(' ', columns(line(start:min(first - 1, len(line)))))// &
            repeat('^', max(1, columns(line(first:min(first + length - 1, finish)))))
   end function marked

   !> Columns that a text takes: the bytes that continue a UTF-8 character take none.
   pure function columns(string) result(n)
      character(len=*), intent(in) :: string
      integer :: n
      integer :: i

      n = 0
      do i = 1, len(string)
         if (iachar(string(i:i)) < 128 .or. iachar(string(i:i)) > 191) n = n + 1
      end do
   end function columns

   pure function is_known(source, place) result(known)
      type(source_type), intent(in) :: source
      type(place_type), intent(in) :: place
      logical :: known

      known = .false.
      if (place%file < 1 .or. place%file > source%n_files .or. place%line < 1) return
      known = place%line <= source%files(place%file)%n_lines
   end function is_known

   !> Control characters made blanks, so that a caret stays under what it points at.
   pure function printable(line) result(clean)
      character(len=*), intent(in) :: line
      character(len=len(line)) :: clean
      integer :: i

      clean = line
      do i = 1, len(line)
         if (iachar(line(i:i)) < 32 .or. iachar(line(i:i)) == 127) clean(i:i) = ' '
      end do
   end function printable

end module places
