!> Lines of a screen with labels on their left.
module explanation_lines
   use kinds, only: wp
   use text, only: to_text
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: lines_type, short

   integer, parameter :: line_width = 100, label_width = 10
   integer, parameter :: first_room = 30

   !> The lines.
   type :: lines_type
      logical :: wanted = .false.
      integer :: n = 0
      character(len=line_width), allocatable :: lines(:)   !! grown by doubling
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
      do while (first <= len_trim(text))
         last = len_trim(text)
         if (last - first + 1 > room) then
            last = first + index(text(first:first + room), ' ', back=.true.) - 2
            if (last < first) last = first + room - 1
         end if
         call make_room(self)
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

   subroutine make_room(self)
      class(lines_type), intent(inout) :: self
      character(len=line_width), allocatable :: longer(:)
      integer :: status

      if (.not. allocated(self%lines)) then
         allocate (self%lines(first_room), stat=status)
         call check_allocation(status)
      end if
      if (self%n < size(self%lines)) return
      allocate (longer(2*self%n), stat=status)
      call check_allocation(status)
      longer(:self%n) = self%lines
      call move_alloc(longer, self%lines)
   end subroutine make_room

   !> A number with four digits.
   pure function short(x) result(text)
      real(wp), intent(in) :: x
      character(len=:), allocatable :: text

      text = to_text(x, 4)
   end function short

end module explanation_lines
