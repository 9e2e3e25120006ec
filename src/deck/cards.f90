!> Keyword cards with their parameters, and where their data lines are.
module cards
   use kinds, only: wp
   use errors, only: error_type
   use places, only: place_type, source_type, fail_at
   use properties, only: name_length
   use name_map, only: name_map_type
   use display, only: displayed
   use words, only: squeezed, find_word, advice
   use numbers, only: parse_integer, parse_fraction
   implicit none
   private

   public :: parameter_type, card_type, symbol_type, deck_type
   public :: parameter_index, has_parameter, parameter_place, count_cards
   public :: get_word, get_real_parameter, get_integer_parameter, get_name_parameter
   public :: check_name

   !> NAME=value on a keyword card.
   type :: parameter_type
      character(len=:), allocatable :: name    !! squeezed
      character(len=:), allocatable :: value   !! as written, not allocated without "="
      type(place_type) :: place                !! of the whole
   end type parameter_type

   !> A keyword card; its data lines are first to last of the deck's data.
   type :: card_type
      character(len=:), allocatable :: keyword   !! squeezed
      type(parameter_type), allocatable :: parameters(:)
      integer :: first = 1
      integer :: last = 0
      integer :: step = 0                        !! number of the step it stands in, 0: model
      integer :: rule = 0                        !! index into the card rules
      integer :: first_item = 1                  !! nodes or elements it defines, as indices
      integer :: last_item = 0
      type(place_type) :: place
   end type card_type

   !> `*PARAMETER`: a text that stands for `<name>`.
   type :: symbol_type
      character(len=name_length) :: name = ''
      character(len=:), allocatable :: value
      logical :: used = .false.
      type(place_type) :: place
   end type symbol_type

   !> The deck cut into cards.
   type :: deck_type
      type(card_type), allocatable :: cards(:)
      integer :: n_cards = 0
      integer, allocatable :: first_card(:), last_card(:)   !! (0:n_steps) where those of a step are
      type(place_type), allocatable :: data(:)   !! the lines that hold data, in order
      integer :: n_data = 0
      type(symbol_type), allocatable :: symbols(:)
      type(name_map_type) :: symbol_of           !! name to index of the symbol
   end type deck_type

contains

   !> How many cards have this keyword.
   pure function count_cards(deck, keyword) result(n)
      type(deck_type), intent(in) :: deck
      character(len=*), intent(in) :: keyword   !! squeezed
      integer :: n
      integer :: i

      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword == keyword) n = n + 1
      end do
   end function count_cards

   !> Index of a parameter of the card, 0 if it is not given.
   pure function parameter_index(card, name) result(position)
      type(card_type), intent(in) :: card
      character(len=*), intent(in) :: name   !! squeezed
      integer :: position

      do position = 1, size(card%parameters)
         if (card%parameters(position)%name == name) return
      end do
      position = 0
   end function parameter_index

   pure function has_parameter(card, name) result(given)
      type(card_type), intent(in) :: card
      character(len=*), intent(in) :: name
      logical :: given

      given = parameter_index(card, name) > 0
   end function has_parameter

   !> Place of a parameter, of the card if it is not given.
   pure function parameter_place(card, name) result(place)
      type(card_type), intent(in) :: card
      character(len=*), intent(in) :: name
      type(place_type) :: place
      integer :: i

      i = parameter_index(card, name)
      place = card%place
      if (i > 0) place = card%parameters(i)%place
   end function parameter_place

   !> Which of some words a parameter says; words marked ~ are known but do not work yet.
   pure subroutine get_word(card, name, list, choice, source, error)
      type(card_type), intent(in) :: card
      character(len=*), intent(in) :: name, list(:)
      integer, intent(out) :: choice   !! position in the list, 0 when the parameter is absent
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      type(place_type) :: place
      integer :: i

      choice = 0
      i = parameter_index(card, name)
      if (i == 0) return
      place = card%parameters(i)%place
      choice = find_word(card%parameters(i)%value, list)
      if (index(card%parameters(i)%value, '~') > 0) choice = 0
      if (choice > 0) return
      if (find_word('~'//card%parameters(i)%value, list) > 0) then
         call fail_at(error, source, place, name//'='//squeezed(card%parameters(i)%value)// &
               ' is known but does not work yet', cure=advice('', working(list)))
      else
         call fail_at(error, source, place, "unknown value '"//card%parameters(i)%value// &
               "' of "//name, cure=advice(card%parameters(i)%value, working(list)))
      end if
   end subroutine get_word

   !> The words of a list that work.
   pure function working(list) result(shorter)
      character(len=*), intent(in) :: list(:)
      character(len=len(list)), allocatable :: shorter(:)

      shorter = pack(list, list(:)(1:1) /= '~')
   end function working

   !> A real parameter; the value stays as it was when the parameter is absent.
   pure subroutine get_real_parameter(card, name, value, source, error)
      type(card_type), intent(in) :: card
      character(len=*), intent(in) :: name
      real(wp), intent(inout) :: value
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: cause
      integer :: i

      i = parameter_index(card, name)
      if (i == 0) return
      call parse_fraction(card%parameters(i)%value, value, cause)
      if (allocated(cause)) call fail_at(error, source, card%parameters(i)%place, &
            name//': '//cause, cure='write a finite number such as 0.5, 1e3 or 1/6')
   end subroutine get_real_parameter

   !> An integer parameter not below a limit; the value stays when the parameter is absent.
   pure subroutine get_integer_parameter(card, name, least, value, source, error)
      type(card_type), intent(in) :: card
      character(len=*), intent(in) :: name
      integer, intent(in) :: least
      integer, intent(inout) :: value
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: cause
      character(len=12) :: limit
      integer :: i

      i = parameter_index(card, name)
      if (i == 0) return
      call parse_integer(card%parameters(i)%value, value, cause)
      write (limit, '(i0)') least
      if (.not. allocated(cause)) then
         if (value < least) cause = 'it must be at least '//trim(limit)
      end if
      if (allocated(cause)) call fail_at(error, source, card%parameters(i)%place, &
            name//': '//cause, cure='write an integer from '//trim(limit)//' up')
   end subroutine get_integer_parameter

   !> A parameter that is a name; blank when the parameter is absent.
   pure subroutine get_name_parameter(card, name, value, source, error)
      type(card_type), intent(in) :: card
      character(len=*), intent(in) :: name
      character(len=name_length), intent(out) :: value
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      value = ''
      i = parameter_index(card, name)
      if (i == 0) return
      call check_name(squeezed(card%parameters(i)%value), card%parameters(i)%place, source, error)
      if (allocated(error)) return
      value = squeezed(card%parameters(i)%value)
   end subroutine get_name_parameter

   !> A name has 1 to 80 characters that can be seen, no "=", and does not read as an integer.
   pure subroutine check_name(name, place, source, error)
      character(len=*), intent(in) :: name
      type(place_type), intent(in) :: place
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      if (len(name) > name_length) then
         call fail_at(error, source, place, 'this name is too long', &
               cure='names have up to 80 characters (bytes of UTF-8)')
      else if (verify(name, '+-0123456789') == 0) then
         call fail_at(error, source, place, "'"//name//"' is no name", &
               cure='a name must not be a number')
      else if (index(name, '=') > 0) then
         call fail_at(error, source, place, "'"//name//"' is no name", &
               cure="a name holds no '=': is a comma missing before a parameter?")
      else if (displayed(name) /= name) then
         call fail_at(error, source, place, &
               "'"//name//"' is no name: it holds what cannot be seen", &
               cure='names are ASCII or UTF-8, without control characters and special blanks')
      end if
   end subroutine check_name

end module cards
