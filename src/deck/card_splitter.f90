!> The deck's files cut into keyword cards and data lines; *INCLUDE is followed here.
module card_splitter
   use errors, only: error_type, new_error, status_file, status_deck
   use memory_shortage, only: check_allocation
   use places, only: place_type, source_type, source_file_type, source_line, fail_at
   use words, only: is_blank
   use cards, only: card_type, deck_type, parameter_index
   use card_rules, only: check_keyword
   use source_reader, only: add_file
   use keyword_lines, only: read_card_line, max_parameters
   implicit none
   private

   public :: split_deck

   integer, parameter :: kind_blank = 1, kind_comment = 2, kind_keyword = 3, kind_data = 4
   integer, parameter :: max_depth = 50
   integer, parameter :: max_files = 10000
   integer, parameter :: max_length = 2000000     !! of a line that is no comment

   !> What the splitting carries from line to line.
   type :: progress_type
      integer :: step = 0                 !! open step, 0 outside
      integer :: n_steps = 0
      integer :: open_step_card = 0       !! card that opened it
      integer :: depth = 0                !! of includes
      integer :: files(max_depth) = 0     !! those being read, outermost first
   end type progress_type

contains

   !> Reads the deck and all it includes.
   subroutine split_deck(deck, source, path, error)
      type(deck_type), intent(out) :: deck
      type(source_type), intent(inout) :: source
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error   !! status_file: the deck is not there
      type(progress_type) :: progress
      integer :: status

      allocate (deck%cards(64), deck%data(1024), stat=status)
      call check_allocation(status)
      call add_file(source, path, place_type(), error)
      if (allocated(error)) return
      call split_file(deck, source, 1, progress, error)
      if (allocated(error)) return
      if (deck%n_cards == 0) then
         call new_error(error, status_deck, path//':1: the deck is empty'//new_line('a')// &
               '  cure: write at least *NODE, *ELEMENT and a step')
      else if (progress%step > 0) then
         call fail_at(error, source, deck%cards(progress%open_step_card)%place, &
               'this step has no *END STEP', cure='close it with *END STEP')
      else if (progress%n_steps == 0) then
         call fail_at(error, source, deck%cards(deck%n_cards)%place, &
               'the deck has no step', cure='add *STEP, *DYNAMIC or *STATIC, *END STEP')
      else
         call find_ranges(deck, progress%n_steps)
      end if
   end subroutine split_deck

   !> First and last card of every step; those of the model (step 0) stand before and between.
   pure subroutine find_ranges(deck, n_steps)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: n_steps
      integer :: i, s, status

      allocate (deck%first_card(0:n_steps), source=deck%n_cards + 1, stat=status)
      call check_allocation(status)
      allocate (deck%last_card(0:n_steps), source=0, stat=status)
      call check_allocation(status)
      do i = 1, deck%n_cards
         s = deck%cards(i)%step
         deck%first_card(s) = min(i, deck%first_card(s))
         deck%last_card(s) = i
      end do
   end subroutine find_ranges

   recursive subroutine split_file(deck, source, file, progress, error)
      type(deck_type), intent(inout) :: deck
      type(source_type), intent(inout) :: source
      integer, intent(in) :: file
      type(progress_type), intent(inout) :: progress
      type(error_type), allocatable, intent(out) :: error
      integer :: line

      progress%depth = progress%depth + 1
      progress%files(progress%depth) = file
      line = 1
      do while (line <= source%files(file)%n_lines)
         select case (kind_of(source%files(file), line))
         case (kind_keyword)
            call check_length(source, file, line, error)
            if (.not. allocated(error)) call read_card(deck, source, file, line, error)
            if (.not. allocated(error)) call place_card(deck, source, progress, error)
         case (kind_data)
            call check_length(source, file, line, error)
            if (.not. allocated(error)) call add_data(deck, source, file, line, error)
         case default
            continue
         end select
         if (allocated(error)) return
         line = line + 1
      end do
      progress%depth = progress%depth - 1
   end subroutine split_file

   pure subroutine check_length(source, file, line, error)
      type(source_type), intent(in) :: source
      integer, intent(in) :: file, line
      type(error_type), allocatable, intent(out) :: error
      type(place_type) :: place

      associate (from => source%files(file))
         if (from%last(line) - from%first(line) < max_length) return
      end associate
      place%file = file
      place%line = line
      place%column = 1
      place%length = 1
      call fail_at(error, source, place, 'this line is too long', &
            cure='a line that is no comment may have 2 000 000 characters')
   end subroutine check_length

   !> Blank, comment, keyword or data line.
   pure function kind_of(file, line) result(kind)
      type(source_file_type), intent(in) :: file
      integer, intent(in) :: line
      integer :: kind
      integer :: first, last

      kind = kind_blank
      last = file%last(line)
      do first = file%first(line), last
         if (.not. is_blank(file%content(first:first))) exit
      end do
      if (first > last) return
      kind = kind_data
      if (file%content(first:first) /= '*') return
      kind = kind_keyword
      if (first == last) return
      if (file%content(first + 1:first + 1) == '*') kind = kind_comment
   end function kind_of

   pure subroutine add_data(deck, source, file, line, error)
      type(deck_type), intent(inout) :: deck
      type(source_type), intent(in) :: source
      integer, intent(in) :: file, line
      type(error_type), allocatable, intent(out) :: error
      type(place_type), allocatable :: longer(:)
      type(place_type) :: place
      integer :: status

      place%file = file
      place%line = line
      if (deck%n_cards == 0) then
         call fail_at(error, source, place, 'data before any keyword card', &
               cure='begin with a keyword such as *HEADING or *NODE; comments begin with **')
         return
      end if
      associate (card => deck%cards(deck%n_cards))
         if (card%place%file == file) place%card = card%place%line
         if (deck%n_data == size(deck%data)) then
            allocate (longer(2*deck%n_data), stat=status)
            call check_allocation(status)
            longer(:deck%n_data) = deck%data
            call move_alloc(longer, deck%data)
         end if
         deck%n_data = deck%n_data + 1
         deck%data(deck%n_data) = place
         card%last = deck%n_data
      end associate
   end subroutine add_data

   !> Reads a keyword line and those that a trailing comma joins to it.
   subroutine read_card(deck, source, file, line, error)
      type(deck_type), intent(inout) :: deck
      type(source_type), intent(in) :: source
      integer, intent(in) :: file
      integer, intent(inout) :: line   !! first line in, last line out
      type(error_type), allocatable, intent(out) :: error
      type(card_type) :: card
      type(place_type) :: place
      logical :: continued
      integer :: next, status

      allocate (card%parameters(0), stat=status)
      call check_allocation(status)
      card%keyword = ''
      card%first = deck%n_data + 1
      card%last = deck%n_data
      place%file = file
      place%line = line
      card%place = place
      call read_card_line(card, source_line(source, file, line), place, continued)
      if (card%keyword == '') then
         call fail_at(error, source, card%place, "a '*' without a keyword", &
               cure='write *KEYWORD, or ** for a comment')
         return
      end if
      do while (continued .and. line < source%files(file)%n_lines)
         next = line + 1
         do while (kind_of(source%files(file), next) == kind_comment)
            if (next == source%files(file)%n_lines) exit
            next = next + 1
         end do
         if (kind_of(source%files(file), next) /= kind_data) exit
         line = next
         place%line = line
         place%card = card%place%line
         call read_card_line(card, source_line(source, file, line), place, continued)
         if (size(card%parameters) <= max_parameters) cycle
         call fail_at(error, source, place, 'this card has too many parameters', &
               cure='the comma at the end of a line continues the keyword line: remove it')
         return
      end do
      call append_card(deck, card)
   end subroutine read_card

   subroutine append_card(deck, card)
      type(deck_type), intent(inout) :: deck
      type(card_type), intent(inout) :: card     !! empty afterwards
      type(card_type), allocatable :: longer(:)
      integer :: i, status

      if (deck%n_cards == size(deck%cards)) then
         allocate (longer(2*deck%n_cards), stat=status)
         call check_allocation(status)
         do i = 1, deck%n_cards
            call move_card(deck%cards(i), longer(i))
         end do
         call move_alloc(longer, deck%cards)
      end if
      deck%n_cards = deck%n_cards + 1
      call move_card(card, deck%cards(deck%n_cards))
   end subroutine append_card

   !> A card as the splitting knows it: the items it defines are found later.
   pure subroutine move_card(from, to)
      type(card_type), intent(inout) :: from
      type(card_type), intent(inout) :: to

      call move_alloc(from%keyword, to%keyword)
      call move_alloc(from%parameters, to%parameters)
      to%first = from%first
      to%last = from%last
      to%step = from%step
      to%rule = from%rule
      to%place = from%place
   end subroutine move_card

   !> Gives the newest card its step; opens and closes steps; follows includes.
   recursive subroutine place_card(deck, source, progress, error)
      type(deck_type), intent(inout) :: deck
      type(source_type), intent(inout) :: source
      type(progress_type), intent(inout) :: progress
      type(error_type), allocatable, intent(out) :: error
      type(place_type) :: place

      call check_keyword(deck%cards(deck%n_cards), source, error)
      if (allocated(error)) return
      place = deck%cards(deck%n_cards)%place
      select case (deck%cards(deck%n_cards)%keyword)
      case ('STEP')
         if (progress%step > 0) then
            call fail_at(error, source, place, 'a step inside a step', &
                  cure='close the step before with *END STEP')
            return
         end if
         progress%n_steps = progress%n_steps + 1
         progress%step = progress%n_steps
         progress%open_step_card = deck%n_cards
         deck%cards(deck%n_cards)%step = progress%step
      case ('ENDSTEP')
         if (progress%step == 0) then
            call fail_at(error, source, place, '*END STEP without *STEP', &
                  cure='remove it, or open the step with *STEP')
            return
         end if
         deck%cards(deck%n_cards)%step = progress%step
         progress%step = 0
      case ('INCLUDE')
         call follow_include(deck, source, progress, error)
         return
      case default
         deck%cards(deck%n_cards)%step = progress%step
      end select
   end subroutine place_card

   !> Takes the *INCLUDE card away and reads its file in its place.
   recursive subroutine follow_include(deck, source, progress, error)
      type(deck_type), intent(inout) :: deck
      type(source_type), intent(inout) :: source
      type(progress_type), intent(inout) :: progress
      type(error_type), allocatable, intent(out) :: error
      type(card_type) :: card
      character(len=:), allocatable :: path, trouble
      integer :: i, file

      card = deck%cards(deck%n_cards)
      deck%n_cards = deck%n_cards - 1
      i = parameter_index(card, 'INPUT')
      if (i == 0 .or. size(card%parameters) /= 1) then
         call fail_at(error, source, card%place, &
               '*INCLUDE needs the parameter INPUT, and no other', &
               cure='write *INCLUDE, INPUT=file')
         return
      end if
      if (.not. allocated(card%parameters(1)%value)) card%parameters(1)%value = ''
      path = beside(source%files(card%place%file)%name, unquoted(card%parameters(1)%value))
      call find_trouble(source, progress, path, trouble)
      if (allocated(trouble)) then
         call fail_at(error, source, card%parameters(1)%place, trouble, &
               cure='a file must not include itself, directly or through others')
         return
      else if (source%n_files >= max_files) then
         call fail_at(error, source, card%parameters(1)%place, &
               'this deck reads more than 10000 files', &
               cure='a file that is included twice in each of many files is read very often')
         return
      end if
      call add_file(source, path, card%parameters(1)%place, error)
      if (allocated(error)) then
         trouble = error%message(:index(error%message//new_line('a'), new_line('a')) - 1)
         if (error%status == status_file) call fail_at(error, source, card%parameters(1)%place, &
               trouble, cure='the path is relative to the file that includes')
         return
      end if
      file = source%n_files      ! a copy: n_files grows with every include in that file
      call split_file(deck, source, file, progress, error)
   end subroutine follow_include

   !> A file that is being read must not be included again.
   subroutine find_trouble(source, progress, path, trouble)
      type(source_type), intent(in) :: source
      type(progress_type), intent(in) :: progress
      character(len=*), intent(in) :: path
      character(len=:), allocatable, intent(out) :: trouble
      integer :: i

      do i = 1, progress%depth
         if (source%files(progress%files(i))%name /= path) cycle
         trouble = "include loop: '"//path//"' is being read already"
         return
      end do
      if (progress%depth >= max_depth) trouble = 'includes go too deep'
   end subroutine find_trouble

   !> A path relative to the folder of a file.
   pure function beside(file, path) result(whole)
      character(len=*), intent(in) :: file, path
      character(len=:), allocatable :: whole

      whole = path
      if (len(path) == 0) return
      if (path(1:1) == '/') return
      whole = file(:index(file, '/', back=.true.))//path
      do while (index(whole, '/./') > 0)
         whole = whole(:index(whole, '/./'))//whole(index(whole, '/./') + 3:)
      end do
      if (index(path, './') == 1 .and. index(whole, './') == 1) whole = whole(3:)
   end function beside

   pure function unquoted(string) result(bare)
      character(len=*), intent(in) :: string
      character(len=:), allocatable :: bare
      integer :: n

      bare = string
      n = len(string)
      if (n < 2) return
      if (scan(string(1:1), '"''') == 1 .and. string(n:n) == string(1:1)) bare = string(2:n - 1)
   end function unquoted

end module card_splitter
