!> Small text helpers: case, numbers to text, joining of lists.
module text
   use kinds, only: wp, int64
   implicit none
   private

   public :: lower_case, upper_case, to_text, plural, shell_word

   !> A number as text without blanks: integers in full, reals in the shortest of the usual forms.
   interface to_text
      module procedure :: integer_to_text, long_to_text, real_to_text
   end interface to_text

contains

   !> The text with A-Z made a-z.
   pure function lower_case(string) result(lower)
      character(len=*), intent(in) :: string
      character(len=len(string)) :: lower
      integer :: i, code

      do i = 1, len(string)
         code = iachar(string(i:i))
         lower(i:i) = string(i:i)
         if (code >= iachar('A') .and. code <= iachar('Z')) lower(i:i) = achar(code + 32)
      end do
   end function lower_case

   !> The text with a-z made A-Z.
   pure function upper_case(string) result(upper)
      character(len=*), intent(in) :: string
      character(len=len(string)) :: upper
      integer :: i, code

      do i = 1, len(string)
         code = iachar(string(i:i))
         upper(i:i) = string(i:i)
         if (code >= iachar('a') .and. code <= iachar('z')) upper(i:i) = achar(code - 32)
      end do
   end function upper_case

   pure function integer_to_text(value) result(string)
      integer, intent(in) :: value
      character(len=:), allocatable :: string

      string = long_to_text(int(value, int64))
   end function integer_to_text

   pure function long_to_text(value) result(string)
      integer(int64), intent(in) :: value
      character(len=:), allocatable :: string
      character(len=24) :: buffer

      write (buffer, '(i0)') value
      string = trim(buffer)
   end function long_to_text

   !> A real with the given number of significant digits (default 6), trailing zeros dropped.
   pure function real_to_text(value, digits) result(string)
      real(wp), intent(in) :: value
      integer, intent(in), optional :: digits
      character(len=:), allocatable :: string
      character(len=40) :: buffer, form
      integer :: n_digits, exponent, last

      n_digits = 6
      if (present(digits)) n_digits = digits
      write (form, '(a,i0,a,i0,a)') '(es', n_digits + 9, '.', n_digits - 1, 'e3)'
      write (buffer, form) value
      buffer = adjustl(buffer)
      last = index(buffer, 'E')
      if (last == 0) then
         string = trim(buffer)
         return
      end if
      read (buffer(last + 1:), *) exponent
      if (exponent >= -4 .and. exponent < n_digits) then
         write (form, '(a,i0,a)') '(f40.', max(0, n_digits - 1 - exponent), ')'
         write (buffer, form) value
         string = without_zeros(trim(adjustl(buffer)))
      else
         string = without_zeros(buffer(:last - 1))//'e'//integer_to_text(exponent)
      end if
   end function real_to_text

   !> Drops the zeros behind a decimal point, and the point with them.
   pure function without_zeros(string) result(short)
      character(len=*), intent(in) :: string
      character(len=:), allocatable :: short
      integer :: last

      last = len(string)
      if (index(string, '.') > 0) then
         last = verify(string, '0', back=.true.)
         if (string(last:last) == '.') last = last - 1
      end if
      short = string(:last)
      if (short == '-0') short = '0'
   end function without_zeros

   !> "1 node", "2 nodes".
   pure function plural(count, word) result(string)
      integer, intent(in) :: count
      character(len=*), intent(in) :: word
      character(len=:), allocatable :: string

      string = to_text(count)//' '//word
      if (count /= 1) string = string//'s'
   end function plural

   !> A word as a shell takes it: in quotation marks unless all its characters are harmless there.
   pure function shell_word(word) result(quoted)
      character(len=*), intent(in) :: word
      character(len=:), allocatable :: quoted
      character(len=*), parameter :: harmless = 'abcdefghijklmnopqrstuvwxyz' &
            //'ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%'
      integer :: i

      quoted = word
      if (len(word) > 0 .and. verify(word, harmless) == 0) return
      quoted = ''''
      do i = 1, len(word)
         if (word(i:i) == '''') then
            quoted = quoted//'''\'''''
         else
            quoted = quoted//word(i:i)
         end if
      end do
      quoted = quoted//''''
   end function shell_word

end module text
