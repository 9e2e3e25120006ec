!> Lines of a screen with labels on their left.
module explanation_lines
   use kinds, only: wp
   use text, only: to_text
   implicit none
   private

   public :: lines_type, short

   integer, parameter :: line_width = 100, label_width = 10
   integer, parameter :: most_lines = 30

   !> The lines, at most so many.
   type :: lines_type
      logical :: wanted = .false.
      integer :: n = 0
      character(len=line_width) :: lines(most_lines)
   contains
      procedure :: add
   end type lines_type

contains

   !> Adds a text behind a label, broken between words where it is too long.
   subroutine add(self, label, text)
      class(lines_type), intent(inout) :: self
      character(len=*), intent(in) :: label, text
      integer :: first, last, room

      room = line_width - label_width
      first = 1
      do while (first <= len_trim(text) .and. self%n < most_lines)
         last = len_trim(text)
         if (last - first + 1 > room) then
            last = first + index(text(first:first + room), ' ', back=.true.) - 2
            if (last < first) last = first + room - 1
         end if
         self%n = self%n + 1
         self%lines(self%n) = ''
         if (first == 1) self%lines(self%n) = label
         self%lines(self%n)(label_width + 1:) = text(first:last)
         first = last + 1
         do while (first <= len_trim(text))
            if (text(first:first) /= ' ') exit
            first = first + 1
         end do
      end do
   end subroutine add

   !> A number with four digits.
   pure function short(x) result(text)
      real(wp), intent(in) :: x
      character(len=:), allocatable :: text

      text = to_text(x, 4)
   end function short

end module explanation_lines
