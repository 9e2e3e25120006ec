!> `*PARAMETER` and `--define`: texts that stand for `<name>` anywhere in the deck.
module symbols
   use kinds, only: wp
   use errors, only: error_type, new_error, status_usage
   use memory_shortage, only: check_allocation
   use places, only: place_type, source_type, source_line, fail_at
   use properties, only: name_length
   use words, only: squeezed, advice, is_blank
   use display, only: displayed
   use numbers, only: parse_real
   use cards, only: deck_type, symbol_type
   implicit none
   private

   public :: definition_type, read_symbols, apply_definitions, substitute, substitute_in_cards
   public :: mark_used_symbols, add_text

   character(len=*), parameter :: usage = 'a line is: name = number'

   !> NAME=VALUE from the command line.
   type :: definition_type
      character(len=:), allocatable :: name, value
   end type definition_type

contains

   !> Collects the `name = number` lines of all *PARAMETER cards.
   subroutine read_symbols(deck, source, error)
      type(deck_type), intent(inout) :: deck
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      integer :: i, j, n, status

      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword == 'PARAMETER') then
            n = n + deck%cards(i)%last - deck%cards(i)%first + 1
         end if
      end do
      allocate (deck%symbols(n), stat=status)
      call check_allocation(status)
      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword /= 'PARAMETER') cycle
         do j = deck%cards(i)%first, deck%cards(i)%last
            n = n + 1
            call read_symbol(deck, n, deck%data(j), source, error)
            if (allocated(error)) return
         end do
      end do
   end subroutine read_symbols

   !> Symbol n, from a line "name = number".
   subroutine read_symbol(deck, n, place, source, error)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: n
      type(place_type), intent(in) :: place
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: line, name, cause
      integer :: equals

      line = source_line(source, place%file, place%line)
      equals = index(line, '=')
      deck%symbols(n)%place = place
      if (equals == 0) then
         call fail_at(error, source, place, 'a parameter without a value', cure=usage)
         return
      end if
      call read_name(name, line(:equals - 1), place, source, error)
      if (allocated(error)) return
      deck%symbols(n)%name = name
      call read_number(line(equals + 1:), deck%symbols(n)%value, cause)
      if (allocated(cause)) then
         call fail_at(error, source, stretch(place, line, equals + 1), cause, cure=usage)
      else if (deck%symbol_of%find(name) > 0) then
         call fail_at(error, source, place, "parameter '"//name//"' is defined twice", &
               cure='keep one of the two')
      else
         call deck%symbol_of%insert(name, n)
      end if
   end subroutine read_symbol

   !> The name of a symbol, squeezed.
   subroutine read_name(name, string, place, source, error)
      character(len=:), allocatable, intent(out) :: name
      character(len=*), intent(in) :: string
      type(place_type), intent(in) :: place
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      name = squeezed(string)
      if (name == '' .or. len(name) > name_length .or. scan(name, '<>,') > 0 .or. &
            displayed(name) /= name) call fail_at(error, source, stretch(place, string, 1), &
            "'"//name//"' is no name for a parameter", cure=usage)
   end subroutine read_name

   !> The text of a number, blanks around it dropped; those within it are an error.
   pure subroutine read_number(string, value, cause)
      character(len=*), intent(in) :: string
      character(len=:), allocatable, intent(out) :: value
      character(len=:), allocatable, intent(out) :: cause   !! not allocated when all is well
      real(wp) :: number
      integer :: first, last

      first = 1
      do first = 1, len(string)
         if (.not. is_blank(string(first:first))) exit
      end do
      do last = len(string), first, -1
         if (.not. is_blank(string(last:last))) exit
      end do
      value = string(first:last)
      call parse_real(value, number, cause)
   end subroutine read_number

   !> The place of what stands from a column on, to the end of a line.
   pure function stretch(place, line, first) result(part)
      type(place_type), intent(in) :: place
      character(len=*), intent(in) :: line
      integer, intent(in) :: first
      type(place_type) :: part
      integer :: column, last

      part = place
      do column = first, len(line)
         if (.not. is_blank(line(column:column))) exit
      end do
      if (column > len(line)) return
      do last = len(line), column, -1
         if (.not. is_blank(line(last:last))) exit
      end do
      part%column = column
      part%length = last - column + 1
   end function stretch

   !> Replaces values by those of the command line.
   subroutine apply_definitions(deck, definitions, error)
      type(deck_type), intent(inout) :: deck
      type(definition_type), intent(in) :: definitions(:)
      type(error_type), allocatable, intent(out) :: error   !! status_usage
      character(len=:), allocatable :: cause, value
      integer :: i, k

      do i = 1, size(definitions)
         k = deck%symbol_of%find(squeezed(definitions(i)%name))
         if (k == 0) then
            call new_error(error, status_usage, '--define '//definitions(i)%name// &
                  ': the deck declares no such *PARAMETER; '//declared(deck, definitions(i)%name))
            return
         end if
         call read_number(definitions(i)%value, value, cause)
         if (allocated(cause)) then
            call new_error(error, status_usage, '--define '//definitions(i)%name//': '//cause)
            return
         end if
         deck%symbols(k)%value = value
      end do
   end subroutine apply_definitions

   !> "allowed: A, B", or that there are none.
   pure function declared(deck, name) result(string)
      type(deck_type), intent(in) :: deck
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: string

      string = 'it declares none'
      if (size(deck%symbols) > 0) string = advice(name, [deck%symbols%name])
   end function declared

   !> A text with every <name> replaced by its value.
   pure subroutine substitute(deck, string, place, replaced, source, error)
      type(deck_type), intent(in) :: deck
      character(len=*), intent(in) :: string
      type(place_type), intent(in) :: place
      character(len=:), allocatable, intent(out) :: replaced
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      integer :: start, opening, closing, k, length

      replaced = ''
      length = 0
      start = 1
      do
         opening = index(string(start:), '<')
         if (opening == 0) exit
         opening = opening + start - 1
         closing = index(string(opening:), '>') + opening - 1
         if (closing < opening) then
            call fail_at(error, source, place, "'<' without '>'", &
                  cure='a parameter is written <name>')
            return
         end if
         k = deck%symbol_of%find(squeezed(string(opening + 1:closing - 1)))
         if (k == 0) then
            call fail_at(error, source, place, 'no such parameter: '// &
                  string(opening:closing), cure=declared(deck, string(opening + 1:closing - 1)))
            return
         end if
         call add_text(replaced, length, string(start:opening - 1))
         call add_text(replaced, length, deck%symbols(k)%value)
         start = closing + 1
      end do
      call add_text(replaced, length, string(start:))
      replaced = replaced(:length)
   end subroutine substitute

   !> Puts a piece behind the first characters of a text that grows by doubling.
   pure subroutine add_text(text, length, piece)
      character(len=:), allocatable, intent(inout) :: text
      integer, intent(inout) :: length           !! characters in use
      character(len=*), intent(in) :: piece
      character(len=:), allocatable :: longer
      integer :: status

      if (length + len(piece) > len(text)) then
         allocate (character(len=2*length + len(piece)) :: longer, stat=status)
         call check_allocation(status)
         longer(:length) = text(:length)
         call move_alloc(longer, text)
      end if
      text(length + 1:length + len(piece)) = piece
      length = length + len(piece)
   end subroutine add_text

   !> Substitutes in the parameters of all keyword cards.
   subroutine substitute_in_cards(deck, source, error)
      type(deck_type), intent(inout) :: deck
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: value, replaced
      integer :: i, j

      do i = 1, deck%n_cards
         do j = 1, size(deck%cards(i)%parameters)
            if (.not. allocated(deck%cards(i)%parameters(j)%value)) cycle
            value = deck%cards(i)%parameters(j)%value
            if (index(value, '<') == 0) cycle
            call mark_used(deck, value)
            call substitute(deck, value, deck%cards(i)%parameters(j)%place, replaced, source, error)
            if (allocated(error)) return
            deck%cards(i)%parameters(j)%value = replaced
         end do
      end do
   end subroutine substitute_in_cards

   !> Marks the parameters that data lines use.
   subroutine mark_used_symbols(deck, source)
      type(deck_type), intent(inout) :: deck
      type(source_type), intent(in) :: source
      integer :: i

      if (size(deck%symbols) == 0) return
      do i = 1, deck%n_data
         associate (from => source%files(deck%data(i)%file), line => deck%data(i)%line)
            call mark_used(deck, from%content(from%first(line):from%last(line)))
         end associate
      end do
   end subroutine mark_used_symbols

   !> Marks the symbols that a text names.
   subroutine mark_used(deck, string)
      type(deck_type), intent(inout) :: deck
      character(len=*), intent(in) :: string
      integer :: opening, closing, k

      closing = 0
      do
         opening = index(string(closing + 1:), '<') + closing
         if (opening == closing) return
         closing = index(string(opening + 1:), '>') + opening
         if (closing == opening) return
         k = deck%symbol_of%find(squeezed(string(opening + 1:closing - 1)))
         if (k > 0) deck%symbols(k)%used = .true.
      end do
   end subroutine mark_used

end module symbols
