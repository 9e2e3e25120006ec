!> Text from outside as it may be shown. What a terminal would obey, show backwards or not show at
!> all (control characters, marks of direction, blanks of no or strange width), and bytes that are
!> no UTF-8, become escapes: \x9B for a byte, \u00A0 for a character.
module display
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: displayed, display_width, abridged, foreign_character
   public :: next_character, hexadecimal

contains

   !> The text with escapes for what cannot be seen; line feeds and tabs stay.
   pure function displayed(string) result(text)
      character(len=*), intent(in) :: string
      character(len=:), allocatable :: text
      character(len=:), allocatable :: buffer, mark
      integer :: i, n, code, length, status

      if (is_plain(string)) then
         text = string
         return
      end if
      allocate (character(len=10*len(string)) :: buffer, stat=status)
      call check_allocation(status)
      n = 0
      i = 1
      do while (i <= len(string))
         call next_character(string, i, code, length)
         if (is_visible(code)) then
            buffer(n + 1:n + length) = string(i:i + length - 1)
            n = n + length
         else
            mark = escape(code, iachar(string(i:i)))
            buffer(n + 1:n + len(mark)) = mark
            n = n + len(mark)
         end if
         i = i + length
      end do
      text = buffer(:n)
   end function displayed

   !> Columns that a displayed text takes on a terminal.
   pure function display_width(string) result(width)
      character(len=*), intent(in) :: string
      integer :: width
      integer :: i, code, length

      width = 0
      i = 1
      do while (i <= len(string))
         call next_character(string, i, code, length)
         width = width + columns_of(code)
         i = i + length
      end do
   end function display_width

   !> A text that is much too long with its middle left out; no character is cut.
   pure function abridged(string, most) result(text)
      character(len=*), intent(in) :: string
      integer, intent(in) :: most                !! bytes, at least 20
      character(len=:), allocatable :: text
      integer :: last, first, i

      if (len(string) <= most) then
         text = string
         return
      end if
      last = most/2
      first = len(string) - most/4 + 1
      do i = 1, 3
         if (.not. continues(string(last + 1:last + 1))) exit
         last = last - 1
      end do
      do i = 1, 3
         if (.not. continues(string(first:first))) exit
         first = first + 1
      end do
      text = string(:last)//' ... '//string(first:)
   end function abridged

   !> " (it holds U+2212)" for the first character beyond ASCII, nothing if there is none.
   pure function foreign_character(string) result(remark)
      character(len=*), intent(in) :: string
      character(len=:), allocatable :: remark
      integer :: i, code, length

      remark = ''
      do i = 1, len(string)
         if (iachar(string(i:i)) < 128) cycle
         call next_character(string, i, code, length)
         if (code < 0) then
            remark = ' (it holds the byte '//hexadecimal(iachar(string(i:i)), 2)//', no UTF-8)'
         else
            remark = ' (it holds U+'//hexadecimal(code, merge(4, 6, code < 65536))//')'
         end if
         return
      end do
   end function foreign_character

   !> Whether all is ASCII that can be seen.
   pure function is_plain(string) result(plain)
      character(len=*), intent(in) :: string
      logical :: plain
      integer :: i, code

      plain = .false.
      do i = 1, len(string)
         code = iachar(string(i:i))
         if (code > 127) return
         if (.not. is_visible(code)) return
      end do
      plain = .true.
   end function is_plain

   !> Whether a byte goes on with a character of UTF-8.
   pure function continues(byte) result(does)
      character(len=1), intent(in) :: byte
      logical :: does

      does = iachar(byte) >= 128 .and. iachar(byte) < 192
   end function continues

   !> The character that begins at a place, by RFC 3629; code -1 and one byte where there is none.
   pure subroutine next_character(string, start, code, length)
      character(len=*), intent(in) :: string
      integer, intent(in) :: start
      integer, intent(out) :: code
      integer, intent(out) :: length             !! bytes
      integer, parameter :: least(2:4) = [128, 2048, 65536]
      integer :: first, i

      first = iachar(string(start:start))
      code = first
      length = 1
      if (first < 128) return
      code = -1
      if (first < 194 .or. first > 244) return
      length = 2
      if (first >= 224) length = 3
      if (first >= 240) length = 4
      if (start + length - 1 <= len(string)) then
         code = iand(first, 2**(7 - length) - 1)
         do i = start + 1, start + length - 1
            if (.not. continues(string(i:i))) then
               code = -1
               exit
            end if
            code = 64*code + iand(iachar(string(i:i)), 63)
         end do
         if (code < least(length) .or. code > 1114111) code = -1
         if (code >= 55296 .and. code <= 57343) code = -1     ! halves of a pair
      end if
      if (code < 0) length = 1
   end subroutine next_character

   !> False for what is no character, and for those that do not show themselves.
   pure function is_visible(code) result(visible)
      integer, intent(in) :: code
      logical :: visible

      select case (code)
      case (:8, 11:31, 127:160, 173, 847, 1564, 4447:4448, 6068:6069, 6155:6158, 8192:8207, &
            8232:8239, 8287:8303, 10240, 12288, 12644, 57344:63743, 65279, 65440, 65520:65535, &
            917504:)
         visible = .false.
      case default
         visible = .true.
      end select
   end function is_visible

   !> Columns of a character: none of marks above others, two of the wide ones of Asian scripts.
   pure function columns_of(code) result(n)
      integer, intent(in) :: code
      integer :: n

      select case (code)
      case (768:879, 7616:7679, 8400:8447, 65024:65039, 65056:65071)
         n = 0
      case (4352:4447, 11904:42191, 44032:55203, 63744:64255, 65072:65135, 65281:65376, &
            65504:65510, 127744:129791, 131072:262141)
         n = 2
      case default
         n = 1
      end select
   end function columns_of

   pure function escape(code, byte) result(mark)
      integer, intent(in) :: code, byte
      character(len=:), allocatable :: mark

      if (code < 0) then
         mark = '\x'//hexadecimal(byte, 2)
      else if (code < 128) then
         mark = '\x'//hexadecimal(code, 2)
      else if (code < 65536) then
         mark = '\u'//hexadecimal(code, 4)
      else
         mark = '\U'//hexadecimal(code, 8)
      end if
   end function escape

   !> The last so many digits of a number that is not negative.
   pure function hexadecimal(number, n_digits) result(digits)
      integer, intent(in) :: number, n_digits
      character(len=n_digits) :: digits
      character(len=*), parameter :: all_digits = '0123456789ABCDEF'
      integer :: i, rest

      rest = number
      do i = n_digits, 1, -1
         digits(i:i) = all_digits(modulo(rest, 16) + 1:modulo(rest, 16) + 1)
         rest = rest/16
      end do
   end function hexadecimal

end module display
