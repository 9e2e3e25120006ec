!> Numbers as a deck writes them: Fortran and C spelling, nothing that is not finite.
module numbers
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_null_char, c_null_ptr, c_ptr
   use display, only: foreign_character
   use kinds, only: wp, int64
   implicit none
   private

   public :: parse_integer, parse_real, parse_fraction, unit_vector

   !> The powers of ten that a double holds exactly.
   real(wp), parameter :: power_of_ten(0:22) = [1.0e0_wp, 1.0e1_wp, 1.0e2_wp, 1.0e3_wp, 1.0e4_wp, &
         1.0e5_wp, 1.0e6_wp, 1.0e7_wp, 1.0e8_wp, 1.0e9_wp, 1.0e10_wp, 1.0e11_wp, 1.0e12_wp, &
         1.0e13_wp, 1.0e14_wp, 1.0e15_wp, 1.0e16_wp, 1.0e17_wp, 1.0e18_wp, 1.0e19_wp, 1.0e20_wp, &
         1.0e21_wp, 1.0e22_wp]

   character(len=*), parameter :: blanks = ' '//achar(9)
   character(len=*), parameter :: too_small = "' is too small: nothing but 0 is below 4.95e-324"

   interface
      !> The number at the start of a text that ends with a zero byte, correctly rounded.
      pure function strtod(text, rest) result(value) bind(c, name='strtod')
         import :: c_char, c_double, c_ptr
         implicit none
         character(kind=c_char), intent(in) :: text(*)
         type(c_ptr), value, intent(in) :: rest
         real(c_double) :: value
      end function strtod
   end interface

contains

   !> An integer, sign allowed; anything else, a decimal point too, leaves a cause.
   pure subroutine parse_integer(string, value, cause)
      character(len=*), intent(in) :: string
      integer, intent(out) :: value
      character(len=:), allocatable, intent(out) :: cause   !! not allocated when all is well
      integer(int64) :: number
      integer :: i, start

      value = 0
      start = 1
      if (is_sign(string, 1)) start = 2
      if (start > len(string) .or. verify(string(start:), '0123456789') > 0) then
         cause = "'"//string//"' is not an integer"//foreign_character(string)
         return
      end if
      number = 0
      do i = start, len(string)
         number = 10*number + (iachar(string(i:i)) - iachar('0'))
         if (number > huge(value)) then
            cause = "the integer '"//string//"' is out of range"
            return
         end if
      end do
      if (string(1:1) == '-') number = -number
      value = int(number)
   end subroutine parse_integer

   !> A finite real: digits with a point or none, exponent marked by e or d. What would be rounded
   !> to zero is refused too: it was not meant to be nothing.
   pure subroutine parse_real(string, value, cause)
      character(len=*), intent(in) :: string
      real(wp), intent(out) :: value
      character(len=:), allocatable, intent(out) :: cause   !! not allocated when all is well
      integer(int64) :: mantissa
      integer :: n_digits, exponent
      logical :: valid

      call scan_real(string, mantissa, n_digits, exponent, valid)
      value = 0.0_wp
      if (.not. valid) then
         cause = "'"//string//"' is not a number"//foreign_character(string)
      else if (mantissa == 0) then
         value = 0.0_wp
      else if (n_digits + exponent > 309) then
         cause = "the number '"//string//"' is too large"
      else if (n_digits + exponent < -330) then
         cause = "the number '"//string//too_small
      else if (mantissa < 2_int64**53 .and. n_digits <= 18 .and. abs(exponent) <= 22) then
         value = scaled(mantissa, exponent)
         if (string(1:1) == '-') value = -value
      else if (exceeds_huge(mantissa, n_digits, exponent)) then
         cause = "the number '"//string//"' is too large"
      else
         value = rounded(string)
         if (.not. abs(value) > 0.0_wp) cause = "the number '"//string//too_small
      end if
   end subroutine parse_real

   !> A real, or two of them with a slash between, such as 1/6.
   pure subroutine parse_fraction(string, value, cause)
      character(len=*), intent(in) :: string
      real(wp), intent(out) :: value
      character(len=:), allocatable, intent(out) :: cause   !! not allocated when all is well
      real(wp) :: divisor
      integer :: slash

      slash = index(string, '/')
      if (slash == 0) then
         call parse_real(string, value, cause)
         return
      end if
      call parse_real(string(:verify(string(:slash - 1), blanks, back=.true.)), value, cause)
      if (allocated(cause)) return
      call parse_real(string(slash + verify(string(slash + 1:)//'.', blanks):), divisor, cause)
      if (allocated(cause)) return
      if (abs(divisor) <= 0.0_wp) then
         cause = "'"//string//"' divides by zero"
         return
      end if
      if (abs(divisor) < 1.0_wp .and. abs(value) >= abs(divisor)*huge(value)) then
         cause = "the number '"//string//"' is too large"
      else if (abs(value) > 0.0_wp .and. .not. abs(value/divisor) > 0.0_wp) then
         cause = "the number '"//string//too_small
      else
         value = value/divisor
      end if
   end subroutine parse_fraction

   !> A vector of any length but zero made one of length one, without overflow on the way.
   pure function unit_vector(vector) result(direction)
      real(wp), intent(in) :: vector(:)
      real(wp) :: direction(size(vector))

      direction = vector/maxval(abs(vector))
      direction = direction/norm2(direction)
   end function unit_vector

   !> Takes a number apart; its size is mantissa times ten to the exponent, as long as the
   !> significant digits number 18 or fewer (further digits count in n_digits alone).
   pure subroutine scan_real(string, mantissa, n_digits, exponent, valid)
      character(len=*), intent(in) :: string
      integer(int64), intent(out) :: mantissa
      integer, intent(out) :: n_digits, exponent
      logical, intent(out) :: valid
      integer :: i, digit, written, n_seen
      logical :: point

      mantissa = 0
      n_digits = 0
      exponent = 0
      n_seen = 0
      point = .false.
      written = 0
      i = 1
      if (is_sign(string, 1)) i = 2
      do while (i <= len(string))
         digit = iachar(string(i:i)) - iachar('0')
         if (digit >= 0 .and. digit <= 9) then
            n_seen = n_seen + 1
            if (point) exponent = exponent - 1
            if (mantissa > 0 .or. digit > 0) n_digits = n_digits + 1
            if (n_digits <= 18) mantissa = 10*mantissa + digit
         else if (string(i:i) == '.' .and. .not. point) then
            point = .true.
         else
            exit
         end if
         i = i + 1
      end do
      valid = n_seen > 0
      if (valid .and. i <= len(string)) call scan_exponent(string(i:), written, valid)
      exponent = exponent + written
   end subroutine scan_real

   !> The part from the exponent letter on; absurd exponents saturate.
   pure subroutine scan_exponent(string, exponent, valid)
      character(len=*), intent(in) :: string
      integer, intent(out) :: exponent
      logical, intent(out) :: valid
      integer :: i, start, digit

      exponent = 0
      valid = .false.
      if (.not. is_exponent_letter(string(1:1))) return
      start = 2
      if (is_sign(string, 2)) start = 3
      do i = start, len(string)
         digit = iachar(string(i:i)) - iachar('0')
         if (digit < 0 .or. digit > 9) return
         exponent = min(100000000, 10*exponent + digit)
      end do
      if (start > len(string)) return
      valid = .true.
      if (string(2:2) == '-') exponent = -exponent
   end subroutine scan_exponent

   pure function is_sign(string, i) result(sign)
      character(len=*), intent(in) :: string
      integer, intent(in) :: i
      logical :: sign

      sign = .false.
      if (i <= len(string)) sign = string(i:i) == '+' .or. string(i:i) == '-'
   end function is_sign

   pure function is_exponent_letter(letter) result(marks)
      character(len=1), intent(in) :: letter
      logical :: marks

      select case (letter)
      case ('e', 'E', 'd', 'D')
         marks = .true.
      case default
         marks = .false.
      end select
   end function is_exponent_letter

   !> A valid number rounded by the C library, which knows no exponent letter but e.
   pure function rounded(string) result(value)
      character(len=*), intent(in) :: string
      real(wp) :: value
      character(kind=c_char) :: text(len(string) + 1)
      integer :: i

      do i = 1, len(string)
         text(i) = string(i:i)
         if (is_exponent_letter(string(i:i))) text(i) = 'e'
      end do
      text(len(string) + 1) = c_null_char
      value = real(strtod(text, c_null_ptr), wp)
   end function rounded

   !> Exact while both factors are: the quotient or product is rounded once.
   pure function scaled(mantissa, exponent) result(value)
      integer(int64), intent(in) :: mantissa
      integer, intent(in) :: exponent
      real(wp) :: value

      if (exponent < 0) then
         value = real(mantissa, wp)/power_of_ten(-exponent)
      else
         value = real(mantissa, wp)*power_of_ten(exponent)
      end if
   end function scaled

   !> True when the number rounds to more than the largest double, 1.7976931348623157e308.
   pure function exceeds_huge(mantissa, n_digits, exponent) result(exceeds)
      integer(int64), intent(in) :: mantissa
      integer, intent(in) :: n_digits, exponent
      logical :: exceeds
      integer(int64) :: leading
      integer :: kept

      exceeds = .false.
      if (n_digits + exponent < 309) return
      kept = min(n_digits, 18)
      leading = mantissa
      if (kept == 18) leading = leading/10
      if (kept < 17) leading = leading*10_int64**(17 - kept)
      exceeds = leading > 17976931348623157_int64
   end function exceeds_huge

end module numbers
