!> Data lines cut at their commas, and the numbers and names in their fields.
module fields
   use kinds, only: wp
   use errors, only: error_type
   use places, only: place_type, source_type, source_line, fail_at
   use properties, only: name_length
   use words, only: squeezed, is_blank
   use numbers, only: parse_integer, parse_real
   use cards, only: deck_type, card_type, check_name
   use symbols, only: substitute, add_text
   use card_rules, only: usage_of
   use text, only: to_text
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: fields_type, split_line, check_count, only_line
   public :: field_place, field_text, is_given, is_integer
   public :: get_integer, get_real, get_reals, get_name

   !> One data line: field i is text(first(i):last(i)), from column(i) on of the line in the file.
   type :: fields_type
      integer :: n = 0
      logical :: continued = .false.             !! the line ends with a comma
      character(len=:), allocatable :: text
      integer, allocatable :: first(:), last(:)
      integer, allocatable :: column(:), width(:)
      integer :: rule = 0                        !! of the card, for advice
      type(place_type) :: place                  !! of the whole line
   end type fields_type

contains

   !> Cuts data line i of the deck; a comma at its end makes no field.
   pure subroutine split_line(fields, deck, card, i, source, error)
      type(fields_type), intent(inout) :: fields
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      integer, intent(in) :: i
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      fields%place = deck%data(i)
      fields%rule = card%rule
      fields%text = source_line(source, deck%data(i)%file, deck%data(i)%line)
      call cut_at_commas(fields)
      if (index(fields%text, '<') > 0) call substitute_fields(fields, deck, source, error)
   end subroutine split_line

   pure subroutine cut_at_commas(fields)
      type(fields_type), intent(inout) :: fields
      integer :: i, start, finish

      fields%n = 0
      start = 1
      do
         finish = index(fields%text(start:), ',') + start - 2
         if (finish < start - 1) finish = len(fields%text)
         call add_field(fields, start, finish)
         start = finish + 2
         if (start > len(fields%text) + 1) exit
      end do
      i = fields%n
      fields%continued = i > 1 .and. fields%last(i) < fields%first(i)
      if (fields%continued) fields%n = i - 1
   end subroutine cut_at_commas

   !> Appends the stretch of the line as a field, blanks around it dropped.
   pure subroutine add_field(fields, start, finish)
      type(fields_type), intent(inout) :: fields
      integer, intent(in) :: start, finish
      integer, allocatable :: room(:, :)
      integer :: first, last, n, status

      n = fields%n + 1
      if (.not. allocated(fields%first)) then
         allocate (fields%first(8), fields%last(8), fields%column(8), fields%width(8), stat=status)
         call check_allocation(status)
      end if
      if (n > size(fields%first)) then
         allocate (room(n, 4), source=0, stat=status)
         call check_allocation(status)
         fields%first = [fields%first, room(:, 1)]
         fields%last = [fields%last, room(:, 2)]
         fields%column = [fields%column, room(:, 3)]
         fields%width = [fields%width, room(:, 4)]
      end if
      first = start
      last = finish
      do while (first <= last)
         if (.not. is_blank(fields%text(first:first))) exit
         first = first + 1
      end do
      do while (last >= first)
         if (.not. is_blank(fields%text(last:last))) exit
         last = last - 1
      end do
      fields%n = n
      fields%first(n) = first
      fields%last(n) = last
      fields%column(n) = first
      fields%width(n) = last - first + 1
      if (last >= first) return
      fields%column(n) = start - 1
      if (start == 1) fields%column(n) = finish + 1
   end subroutine add_field

   !> Puts values in the place of <names>, field by field.
   pure subroutine substitute_fields(fields, deck, source, error)
      type(fields_type), intent(inout) :: fields
      type(deck_type), intent(in) :: deck
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: new_text, piece
      integer :: i, length

      new_text = ''
      length = 0
      do i = 1, fields%n
         call substitute(deck, fields%text(fields%first(i):fields%last(i)), &
               field_place(fields, i), piece, source, error)
         if (allocated(error)) return
         fields%first(i) = length + 1
         call add_text(new_text, length, piece)
         fields%last(i) = length
      end do
      fields%text = new_text(:length)
   end subroutine substitute_fields

   !> Place of field i, which may be missing.
   pure function field_place(fields, i) result(place)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: i
      type(place_type) :: place

      place = fields%place
      if (i > fields%n) return
      place%column = fields%column(i)
      place%length = max(1, fields%width(i))
   end function field_place

   pure function field_text(fields, i) result(string)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: i
      character(len=:), allocatable :: string

      string = ''
      if (i <= fields%n) string = fields%text(fields%first(i):fields%last(i))
   end function field_text

   !> True when field i is there and not empty.
   pure function is_given(fields, i) result(given)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: i
      logical :: given

      given = .false.
      if (i <= fields%n) given = fields%last(i) >= fields%first(i)
   end function is_given

   !> True when field i is made of digits and signs: an id, not a name.
   pure function is_integer(fields, i) result(integral)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: i
      logical :: integral

      integral = .false.
      if (is_given(fields, i)) integral = &
            verify(fields%text(fields%first(i):fields%last(i)), '+-0123456789') == 0
   end function is_integer

   !> Refuses fields beyond the last that means something.
   pure subroutine check_count(fields, n_max, source, error)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: n_max
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      if (fields%n > n_max) call fail_at(error, source, field_place(fields, n_max + 1), &
            'too many fields: at most '//to_text(n_max)//' here', &
            cure='a line is: '//usage_of(fields%rule))
   end subroutine check_count

   !> Cuts the one data line that a card must have, with at most n_max fields.
   pure subroutine only_line(fields, deck, card, n_max, source, error)
      type(fields_type), intent(inout) :: fields
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      integer, intent(in) :: n_max
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      if (card%last > card%first) then
         call fail_at(error, source, deck%data(card%first + 1), &
               'too many data lines: this card takes one', &
               cure='the line is: '//usage_of(card%rule))
         return
      end if
      call split_line(fields, deck, card, card%first, source, error)
      if (allocated(error)) return
      call check_count(fields, n_max, source, error)
   end subroutine only_line

   pure subroutine get_integer(fields, i, what, value, source, error)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: i
      character(len=*), intent(in) :: what   !! name of the value, for messages
      integer, intent(out) :: value
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: cause

      value = 0
      if (is_given(fields, i)) then
         call parse_integer(fields%text(fields%first(i):fields%last(i)), value, cause)
      else
         cause = 'missing'
      end if
      if (allocated(cause)) call fail_at(error, source, field_place(fields, i), &
            what//': '//cause, cure='a line is: '//usage_of(fields%rule))
   end subroutine get_integer

   pure subroutine get_real(fields, i, what, value, source, error)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: i
      character(len=*), intent(in) :: what
      real(wp), intent(out) :: value
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: cause

      value = 0.0_wp
      if (is_given(fields, i)) then
         call parse_real(fields%text(fields%first(i):fields%last(i)), value, cause)
      else
         cause = 'missing'
      end if
      if (allocated(cause)) call fail_at(error, source, field_place(fields, i), &
            what//': '//cause, cure='a line is: '//usage_of(fields%rule))
   end subroutine get_real

   !> Fields i to i+size-1 as reals; those beyond the first n_needed may be missing and stay 0.
   pure subroutine get_reals(fields, i, n_needed, what, values, source, error)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: i, n_needed
      character(len=*), intent(in) :: what
      real(wp), intent(out) :: values(:)
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      integer :: k

      values = 0.0_wp
      do k = 1, size(values)
         if (k > n_needed .and. .not. is_given(fields, i + k - 1)) cycle
         call get_real(fields, i + k - 1, what, values(k), source, error)
         if (allocated(error)) return
      end do
   end subroutine get_reals

   pure subroutine get_name(fields, i, what, name, source, error)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: i
      character(len=*), intent(in) :: what
      character(len=name_length), intent(out) :: name
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: word

      name = ''
      word = squeezed(field_text(fields, i))
      if (word == '') then
         call fail_at(error, source, field_place(fields, i), what//': missing', &
               cure='a line is: '//usage_of(fields%rule))
         return
      end if
      call check_name(word, field_place(fields, i), source, error)
      if (allocated(error)) return
      name = word
   end subroutine get_name

end module fields
