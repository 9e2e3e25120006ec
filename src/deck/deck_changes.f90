!> Whether a deck is still what the state of an earlier run belongs to.
!>
!> Both decks are cut into cards, parameters put in and numbers read, so that only what they mean
!> counts. What the step reached and all before it compute must not have changed; the end of that
!> step may move, other records may be asked for, later steps may be anything.
module deck_changes
   use kinds, only: wp
   use errors, only: error_type
   use places, only: place_type, source_type, source_line, fail_at, line_text
   use numbers, only: parse_fraction
   use words, only: word_length, squeezed, find_word
   use cards, only: card_type, deck_type, parameter_type, has_parameter, parameter_index
   use card_rules, only: name_of
   use card_splitter, only: split_deck
   use fields, only: fields_type, split_line, field_text
   use symbols, only: definition_type, read_symbols, apply_definitions, substitute_in_cards
   implicit none
   private

   public :: deck_text_type, cut_deck, find_change, records_differ

   !> A deck as read before: its text and the cards in it.
   type :: deck_text_type
      type(source_type) :: source
      type(deck_type) :: deck
   end type deck_text_type

   integer, parameter :: kind_without_effect = 0, kind_record = 1, kind_essential = 2
   character(len=word_length), parameter :: without_effect(*) = [character(len=word_length) :: &
         'HEADING', 'PARAMETER', 'RESTART', 'PREPRINT', 'PRINT', 'NODE OUTPUT', 'ELEMENT OUTPUT', &
         'CONTACT OUTPUT', 'ENERGY OUTPUT']
   character(len=word_length), parameter :: records(*) = [character(len=word_length) :: &
         'NODE PRINT', 'NODE FILE', 'EL PRINT', 'EL FILE', 'CONTACT PRINT', 'CONTACT FILE', &
         'ENERGY PRINT', 'OUTPUT']
   character(len=*), parameter :: allowed = 'only the end of the step reached, *NODE PRINT and ' &
         //'the like, and later steps may change; else run the deck from its start'
   integer, parameter :: longest = 60            ! characters of an old line that are shown

contains

   !> Cuts a deck whose text is known into its cards.
   subroutine cut_deck(self, source, definitions, error)
      type(deck_text_type), intent(out) :: self
      type(source_type), intent(in) :: source
      type(definition_type), intent(in) :: definitions(:)
      type(error_type), allocatable, intent(out) :: error

      self%source = source
      self%source%n_stored = source%n_files
      self%source%n_files = 0
      call split_deck(self%deck, self%source, source%files(1)%name, error)
      if (allocated(error)) return
      call read_symbols(self%deck, self%source, error)
      if (allocated(error)) return
      call apply_definitions(self%deck, definitions, error)
      if (allocated(error)) return
      call substitute_in_cards(self%deck, self%source, error)
   end subroutine cut_deck

   !> The first change that a state in a step does not allow, as an error.
   subroutine find_change(new, old, i_step, error)
      type(deck_text_type), intent(in) :: new, old
      integer, intent(in) :: i_step              !! reached
      type(error_type), allocatable, intent(out) :: error
      integer :: i, j

      i = 0
      j = 0
      do
         call next_card(new%deck, kind_essential, i_step, i)
         call next_card(old%deck, kind_essential, i_step, j)
         if (i == 0 .and. j == 0) return
         if (i == 0) then
            call fail_at(error, new%source, new%deck%cards(new%deck%n_cards)%place, &
                  'the deck has changed: it has no '//described(old, j)//' any more', cure=allowed)
         else if (j == 0) then
            call fail_at(error, new%source, new%deck%cards(i)%place, &
                  'the deck has changed: this card was not there', cure=allowed)
         else
            call compare_cards(new, i, old, j, i_step, error)
         end if
         if (allocated(error)) return
      end do
   end subroutine find_change

   !> Whether other records are asked for in the steps up to the one reached; which, for a message.
   subroutine records_differ(new, old, i_step, differ, what)
      type(deck_text_type), intent(in) :: new, old
      integer, intent(in) :: i_step
      logical, intent(out) :: differ
      character(len=:), allocatable, intent(out) :: what
      type(error_type), allocatable :: error
      integer :: i, j

      i = 0
      j = 0
      what = ''
      do
         call next_card(new%deck, kind_record, i_step, i)
         call next_card(old%deck, kind_record, i_step, j)
         differ = i > 0 .or. j > 0
         if (.not. differ) return
         if (i > 0 .and. j > 0) then
            call compare_cards(new, i, old, j, 0, error)
            if (.not. allocated(error)) cycle
         end if
         what = name_of(old%deck%cards(max(1, j))%rule)
         if (i > 0) what = name_of(new%deck%cards(i)%rule)//' at ' &
               //line_text(new%source, new%deck%cards(i)%place)
         return
      end do
   end subroutine records_differ

   !> The next card of a kind in the model or in steps up to one, 0 behind the last.
   pure subroutine next_card(deck, kind, i_step, i)
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: kind, i_step
      integer, intent(inout) :: i

      do i = i + 1, deck%n_cards
         if (deck%cards(i)%step <= i_step .and. kind_of(deck%cards(i)) == kind) return
      end do
      i = 0
   end subroutine next_card

   pure function kind_of(card) result(kind)
      type(card_type), intent(in) :: card
      integer :: kind

      kind = kind_essential
      if (find_word(card%keyword, without_effect) > 0) kind = kind_without_effect
      if (find_word(card%keyword, records) > 0) kind = kind_record
      if (card%keyword == 'OUTPUT' .and. .not. has_parameter(card, 'COMPRESS')) kind = &
            kind_without_effect
   end function kind_of

   !> Whether two cards mean the same, but for the end of the step reached and its INC.
   subroutine compare_cards(new, i, old, j, i_step, error)
      type(deck_text_type), intent(in) :: new, old
      integer, intent(in) :: i, j                !! the cards
      integer, intent(in) :: i_step              !! reached
      type(error_type), allocatable, intent(out) :: error
      logical :: in_step
      integer :: line

      associate (card => new%deck%cards(i), card_before => old%deck%cards(j))
         in_step = card%step == i_step .and. i_step > 0
         if (card%keyword /= card_before%keyword .or. card%step /= card_before%step) then
            call fail_at(error, new%source, card%place, 'the deck has changed: here was ' &
                  //described(old, j), cure=allowed)
         else if (.not. same_parameters(card, card_before, in_step)) then
            call fail_at(error, new%source, card%place, 'the deck has changed: this card was ' &
                  //described(old, j), cure=allowed)
         end if
         if (allocated(error)) return
         do line = 0, max(card%last - card%first, card_before%last - card_before%first)
            if (card%first + line > card%last) then
               call fail_at(error, new%source, card%place, 'the deck has changed: this card had ' &
                     //'one more line: '//shown(old, j, line), cure=allowed)
            else if (card_before%first + line > card_before%last) then
               call fail_at(error, new%source, new%deck%data(card%first + line), &
                     'the deck has changed: this line was not there', cure=allowed)
            else
               call compare_lines(new, i, old, j, line, in_step, error)
            end if
            if (allocated(error)) return
         end do
      end associate
   end subroutine compare_cards

   !> Whether the parameters are the same in any order, but for those that compute nothing.
   pure function same_parameters(a, b, in_step) result(same)
      type(card_type), intent(in) :: a, b        !! of one keyword
      logical, intent(in) :: in_step             !! the card stands in the step reached
      logical :: same
      integer :: i, k

      same = .false.
      do i = 1, size(a%parameters)
         if (may_change(a, a%parameters(i)%name, in_step)) cycle
         k = parameter_index(b, a%parameters(i)%name)
         if (k == 0) return
         if (.not. same_value(a%parameters(i), b%parameters(k))) return
      end do
      do k = 1, size(b%parameters)
         if (may_change(b, b%parameters(k)%name, in_step)) cycle
         if (.not. has_parameter(a, b%parameters(k)%name)) return
      end do
      same = .true.
   end function same_parameters

   !> A name for the log, where to stop.
   pure function may_change(card, name, in_step) result(free)
      type(card_type), intent(in) :: card
      character(len=*), intent(in) :: name
      logical, intent(in) :: in_step
      logical :: free

      free = card%keyword == 'STEP' .and. (name == 'NAME' .or. (name == 'INC' .and. in_step))
      free = free .or. (card%keyword == 'ENERGYPRINT' .and. name == 'LIMIT')
   end function may_change

   pure function same_value(a, b) result(same)
      type(parameter_type), intent(in) :: a, b
      logical :: same

      same = allocated(a%value) .eqv. allocated(b%value)
      if (same .and. allocated(a%value)) same = same_text(a%value, b%value)
   end function same_value

   !> The same words or the same number.
   pure function same_text(a, b) result(same)
      character(len=*), intent(in) :: a, b
      logical :: same
      character(len=:), allocatable :: cause
      real(wp) :: values(2)

      same = squeezed(a) == squeezed(b)
      if (same) return
      call parse_fraction(a, values(1), cause)
      if (allocated(cause)) return
      call parse_fraction(b, values(2), cause)
      if (.not. allocated(cause)) same = .not. abs(values(1) - values(2)) > 0.0_wp
   end function same_text

   !> Compares a data line, counted from 0; of the procedure card of the step reached without T.
   subroutine compare_lines(new, i, old, j, line, in_step, error)
      type(deck_text_type), intent(in) :: new, old
      integer, intent(in) :: i, j, line
      logical, intent(in) :: in_step             !! the card stands in the step reached
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields, fields_before
      type(place_type) :: place, place_before
      integer :: k

      place = new%deck%data(new%deck%cards(i)%first + line)
      place_before = old%deck%data(old%deck%cards(j)%first + line)
      if (.not. holds_symbol(new%source, place) .and. same_line(new%source, place, old%source, &
            place_before)) return
      call split_line(fields, new%deck, new%deck%cards(i), new%deck%cards(i)%first + line, &
            new%source, error)
      if (allocated(error)) return
      call split_line(fields_before, old%deck, old%deck%cards(j), old%deck%cards(j)%first + line, &
            old%source, error)
      if (allocated(error)) return
      do k = 1, max(fields%n, fields_before%n)
         if (same_text(field_text(fields, k), field_text(fields_before, k))) cycle
         if (k == 2 .and. in_step .and. is_procedure(new%deck%cards(i))) then
            call check_end(new, i, place, error)
         else
            call fail_at(error, new%source, place, 'the deck has changed: this line was ''' &
                  //shown(old, j, line)//'''', cure=allowed)
         end if
         if (allocated(error)) return
      end do
   end subroutine compare_lines

   !> The end of a step can move where nothing before it depends on it.
   subroutine check_end(new, i, place, error)
      type(deck_text_type), intent(in) :: new
      integer, intent(in) :: i                   !! the procedure card
      type(place_type), intent(in) :: place
      type(error_type), allocatable, intent(out) :: error
      character(len=*), parameter :: cure = 'finish the step as it was, and add a step behind it'

      if (new%deck%cards(i)%keyword == 'STATIC') then
         call fail_at(error, new%source, place, 'T has changed, and the loads of a static step ' &
               //'grow over its whole length', cure=cure)
      end if
   end subroutine check_end

   pure function is_procedure(card) result(answer)
      type(card_type), intent(in) :: card
      logical :: answer

      answer = card%keyword == 'DYNAMIC' .or. card%keyword == 'STATIC'
   end function is_procedure

   pure function holds_symbol(source, place) result(holds)
      type(source_type), intent(in) :: source
      type(place_type), intent(in) :: place
      logical :: holds

      associate (from => source%files(place%file))
         holds = index(from%content(from%first(place%line):from%last(place%line)), '<') > 0
      end associate
   end function holds_symbol

   !> Whether two lines are the same to the letter.
   pure function same_line(a, place_a, b, place_b) result(same)
      type(source_type), intent(in) :: a, b
      type(place_type), intent(in) :: place_a, place_b
      logical :: same

      associate (from => a%files(place_a%file), from_b => b%files(place_b%file))
         same = from%content(from%first(place_a%line):from%last(place_a%line)) == &
               from_b%content(from_b%first(place_b%line):from_b%last(place_b%line))
      end associate
   end function same_line

   !> A card of the earlier deck as it stood there, and where.
   function described(old, j) result(text)
      type(deck_text_type), intent(in) :: old
      integer, intent(in) :: j
      character(len=:), allocatable :: text
      integer :: i

      associate (card => old%deck%cards(j))
         text = name_of(card%rule)
         do i = 1, size(card%parameters)
            text = text//', '//card%parameters(i)%name
            if (allocated(card%parameters(i)%value)) text = text//'='//card%parameters(i)%value
         end do
         text = ''''//shortened(text)//''' ('//line_text(old%source, card%place)//' then)'
      end associate
   end function described

   !> A data line of the earlier deck, counted from 0, parameters put in.
   function shown(old, j, line) result(text)
      type(deck_text_type), intent(in) :: old
      integer, intent(in) :: j, line
      character(len=:), allocatable :: text
      type(fields_type) :: fields
      type(error_type), allocatable :: error
      integer :: k

      associate (card => old%deck%cards(j))
         call split_line(fields, old%deck, card, card%first + line, old%source, error)
         text = field_text(fields, 1)
         do k = 2, fields%n
            text = text//', '//field_text(fields, k)
         end do
      end associate
      text = shortened(text)
   end function shown

   pure function shortened(text) result(short)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: short

      short = text
      if (len(text) > longest) short = text(:longest - 4)//' ...'
   end function shortened

end module deck_changes
