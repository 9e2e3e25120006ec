!> The quick way through the long tables of a deck: data lines that hold nothing but numbers and
!> commas are taken apart where they stand in the file. A line that is anything else (a parameter
!> in angle brackets, a name, a missing field, one too many) is left to the module `fields`, which
!> alone knows what to say about it.
module plain_lines
   use kinds, only: wp
   use numbers, only: parse_real
   implicit none
   private

   public :: scan_integers, scan_point

   integer, parameter :: most_digits = 9   !! of an integer: they cannot overflow

contains

   !> The integers of a line, at least one and as many as there is room for at most; a comma at the
   !> end makes no field.
   pure subroutine scan_integers(line, values, n, plain)
      character(len=*), intent(in) :: line
      integer, intent(out) :: values(:)
      integer, intent(out) :: n
      logical, intent(out) :: plain              !! whether the line holds just these integers
      integer :: start

      n = 0
      start = 1
      plain = .true.
      do while (start <= len(line))
         if (n > 0) then
            if (is_empty(line, start)) exit
         end if
         plain = n < size(values)
         if (.not. plain) return
         n = n + 1
         call scan_integer(line, start, values(n), plain)
         if (.not. plain) return
      end do
      plain = n > 0
   end subroutine scan_integers

   !> An id with two or three coordinates; a missing third one is zero.
   pure subroutine scan_point(line, id, x, plain)
      character(len=*), intent(in) :: line
      integer, intent(out) :: id
      real(wp), intent(out) :: x(3)
      logical, intent(out) :: plain              !! whether the line holds just these numbers
      integer :: start, n

      x = 0.0_wp
      start = 1
      n = 0
      call scan_integer(line, start, id, plain)
      do while (plain .and. start <= len(line))
         if (n >= 2) then
            if (is_empty(line, start)) exit
         end if
         plain = n < 3
         if (.not. plain) return
         n = n + 1
         call scan_real_field(line, start, x(n), plain)
      end do
      plain = plain .and. n >= 2
   end subroutine scan_point

   !> One field with blanks around it, from `start` on; afterwards that is the start of the next.
   pure subroutine scan_integer(line, start, value, plain)
      character(len=*), intent(in) :: line
      integer, intent(inout) :: start
      integer, intent(out) :: value
      logical, intent(out) :: plain
      integer :: i, digit, n_digits
      logical :: negative

      value = 0
      n_digits = 0
      i = first_letter(line, start)
      negative = .false.
      if (i <= len(line)) then
         negative = line(i:i) == '-'
         if (negative .or. line(i:i) == '+') i = i + 1
      end if
      do i = i, len(line)
         digit = iachar(line(i:i)) - iachar('0')
         if (digit < 0 .or. digit > 9 .or. n_digits == most_digits) exit
         n_digits = n_digits + 1
         value = 10*value + digit
      end do
      if (negative) value = -value
      i = first_letter(line, i)
      plain = n_digits > 0
      if (i <= len(line)) plain = plain .and. line(i:i) == ','
      start = i + 1
   end subroutine scan_integer

   pure subroutine scan_real_field(line, start, value, plain)
      character(len=*), intent(in) :: line
      integer, intent(inout) :: start
      real(wp), intent(out) :: value
      logical, intent(out) :: plain
      character(len=:), allocatable :: cause
      integer :: first, last

      first = first_letter(line, start)
      do last = first, len(line)
         if (line(last:last) == ',') exit
      end do
      start = last + 1
      do last = last - 1, first, -1
         if (line(last:last) /= ' ' .and. iachar(line(last:last)) /= 9) exit
      end do
      call parse_real(line(first:last), value, cause)
      plain = .not. allocated(cause)
   end subroutine scan_real_field

   !> Whether only blanks are left.
   pure function is_empty(line, start) result(empty)
      character(len=*), intent(in) :: line
      integer, intent(in) :: start
      logical :: empty

      empty = first_letter(line, start) > len(line)
   end function is_empty

   !> The first place from `start` on that is neither blank nor tab; behind the end if all are.
   pure function first_letter(line, start) result(place)
      character(len=*), intent(in) :: line
      integer, intent(in) :: start
      integer :: place

      do place = start, len(line)
         if (line(place:place) /= ' ' .and. iachar(line(place:place)) /= 9) return
      end do
   end function first_letter

end module plain_lines
