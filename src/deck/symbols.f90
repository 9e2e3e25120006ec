!> `*PARAMETER` and `--define`: texts that stand for `<name>` anywhere in the deck.
module symbols
   use kinds, only: wp
   use errors, only: error_type, new_error, status_usage
   use memory_shortage, only: check_allocation
   use places, only: place_type, source_type, source_line, fail_at
   use properties, only: name_length
   use words, only: squeezed, advice
   use numbers, only: parse_real
   use cards, only: deck_type, symbol_type
   implicit none
   private

   public :: definition_type, read_symbols, apply_definitions, substitute, substitute_in_cards
   public :: mark_used_symbols

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
            call read_symbol(deck%symbols(n), deck%data(j), deck%symbols(:n - 1), source, error)
            if (allocated(error)) return
         end do
      end do
   end subroutine read_symbols

   subroutine read_symbol(symbol, place, earlier, source, error)
      type(symbol_type), intent(out) :: symbol
      type(place_type), intent(in) :: place
      type(symbol_type), intent(in) :: earlier(:)
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: line, name, cause
      real(wp) :: number
      integer :: equals

      line = source_line(source, place%file, place%line)
      equals = index(line, '=')
      symbol%place = place
      if (equals == 0) then
         call fail_at(error, source, place, 'a parameter without a value', &
               cure='a line is: name = number')
         return
      end if
      name = squeezed(line(:equals - 1))
      symbol%value = trim(adjustl(squeezed(line(equals + 1:))))
      if (name == '' .or. len(name) > name_length .or. scan(name, '<>,') > 0) then
         call fail_at(error, source, place, "'"//name//"' is no name for a parameter", &
               cure='a line is: name = number')
         return
      end if
      symbol%name = name
      call parse_real(symbol%value, number, cause)
      if (allocated(cause)) then
         call fail_at(error, source, place, cause, cure='a line is: name = number')
      else if (find_symbol(earlier, name) > 0) then
         call fail_at(error, source, place, "parameter '"//name//"' is defined twice", &
               cure='keep one of the two')
      end if
   end subroutine read_symbol

   !> Replaces values by those of the command line.
   subroutine apply_definitions(deck, definitions, error)
      type(deck_type), intent(inout) :: deck
      type(definition_type), intent(in) :: definitions(:)
      type(error_type), allocatable, intent(out) :: error   !! status_usage
      character(len=:), allocatable :: cause
      real(wp) :: number
      integer :: i, k

      do i = 1, size(definitions)
         k = find_symbol(deck%symbols, definitions(i)%name)
         if (k == 0) then
            call new_error(error, status_usage, '--define '//definitions(i)%name// &
                  ': the deck declares no such *PARAMETER; '//declared(deck, definitions(i)%name))
            return
         end if
         call parse_real(squeezed(definitions(i)%value), number, cause)
         if (allocated(cause)) then
            call new_error(error, status_usage, '--define '//definitions(i)%name//': '//cause)
            return
         end if
         deck%symbols(k)%value = squeezed(definitions(i)%value)
      end do
   end subroutine apply_definitions

   !> Position of a name, 0 if it is not declared.
   pure function find_symbol(list, name) result(position)
      type(symbol_type), intent(in) :: list(:)
      character(len=*), intent(in) :: name
      integer :: position

      do position = 1, size(list)
         if (list(position)%name == squeezed(name)) return
      end do
      position = 0
   end function find_symbol

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
      integer :: start, opening, closing, k

      replaced = ''
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
         k = find_symbol(deck%symbols, string(opening + 1:closing - 1))
         if (k == 0) then
            call fail_at(error, source, place, 'no such parameter: '// &
                  string(opening:closing), cure=declared(deck, string(opening + 1:closing - 1)))
            return
         end if
         replaced = replaced//string(start:opening - 1)//deck%symbols(k)%value
         start = closing + 1
      end do
      replaced = replaced//string(start:)
   end subroutine substitute

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

   subroutine mark_used(deck, string)
      type(deck_type), intent(inout) :: deck
      character(len=*), intent(in) :: string
      character(len=:), allocatable :: wanted
      integer :: i

      if (index(string, '<') == 0) return
      wanted = squeezed(string)
      do i = 1, size(deck%symbols)
         if (index(wanted, '<'//trim(deck%symbols(i)%name)//'>') > 0) then
            deck%symbols(i)%used = .true.
         end if
      end do
   end subroutine mark_used

end module symbols
