!> Keyword lines cut into the keyword and its parameters.
module keyword_lines
   use memory_shortage, only: check_allocation
   use places, only: place_type
   use words, only: squeezed, is_blank
   use cards, only: card_type, parameter_type
   implicit none
   private

   public :: read_card_line, max_parameters

   integer, parameter :: max_parameters = 100     !! of a card; none knows so many

contains

   !> One line of a keyword card: the keyword (if it is still missing), then parameters.
   subroutine read_card_line(card, line, place, continued)
      type(card_type), intent(inout) :: card
      character(len=*), intent(in) :: line
      type(place_type), intent(in) :: place
      logical, intent(out) :: continued
      integer :: start, finish, first, last

      continued = .false.
      start = 1
      do while (start <= len(line))
         finish = index(line(start:), ',') + start - 2
         if (finish < start - 1) finish = len(line)
         continued = finish < len(line)
         call trim_ends(line, start, finish, first, last)
         start = finish + 2
         if (first > last) cycle
         continued = .false.
         if (card%keyword == '') then
            card%keyword = squeezed(line(first + 1:last))
            card%place%column = first
            card%place%length = last - first + 1
         else
            call add_parameter(card, line(first:last), place, first)
         end if
         continued = finish < len(line)
      end do
   end subroutine read_card_line

   pure subroutine trim_ends(line, start, finish, first, last)
      character(len=*), intent(in) :: line
      integer, intent(in) :: start, finish
      integer, intent(out) :: first, last

      first = start
      last = finish
      do while (first <= last)
         if (.not. is_blank(line(first:first))) exit
         first = first + 1
      end do
      do while (last >= first)
         if (.not. is_blank(line(last:last))) exit
         last = last - 1
      end do
   end subroutine trim_ends

   subroutine add_parameter(card, string, place, column)
      type(card_type), intent(inout) :: card
      character(len=*), intent(in) :: string
      type(place_type), intent(in) :: place
      integer, intent(in) :: column
      type(parameter_type), allocatable :: longer(:)
      integer :: i, n, equals, first, last, status

      n = size(card%parameters)
      if (n > max_parameters) return             ! an error already
      allocate (longer(n + 1), stat=status)
      call check_allocation(status)
      do i = 1, n
         longer(i) = card%parameters(i)
      end do
      equals = index(string, '=')
      if (equals > 0) then
         longer(n + 1)%name = squeezed(string(:equals - 1))
         call trim_ends(string, equals + 1, len(string), first, last)
         longer(n + 1)%value = string(first:last)
      else
         longer(n + 1)%name = squeezed(string)
      end if
      longer(n + 1)%place = place
      longer(n + 1)%place%column = column
      longer(n + 1)%place%length = len(string)
      call move_alloc(longer, card%parameters)
   end subroutine add_parameter

end module keyword_lines
