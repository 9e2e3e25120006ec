!> `*NODE` and `*ELEMENT`.
module mesh_reader
   use kinds, only: wp
   use errors, only: error_type
   use places, only: place_type, source_type, fail_at, line_text
   use mesh, only: element_table_type
   use model, only: model_type
   use cards, only: deck_type, card_type, get_word, parameter_index
   use fields, only: fields_type, split_line, check_count, field_place
   use fields, only: get_integer, get_reals
   use plain_lines, only: scan_integers, scan_point
   use foreign_words, only: type_cure
   use element_types, only: type_names, kinds_of_types, nodes_of_types, most_nodes
   use words, only: find_word
   use text, only: to_text
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: read_nodes, read_elements

contains

   !> Fills the table of nodes from all *NODE cards.
   subroutine read_nodes(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(inout) :: deck
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer :: i, j, n, status
      logical :: done

      n = count_lines(deck, 'NODE')
      allocate (model%nodes%id(n), model%nodes%x(3, n), model%nodes%place(n), stat=status)
      call check_allocation(status)
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword /= 'NODE') cycle
         deck%cards(i)%first_item = model%nodes%n + 1
         do j = deck%cards(i)%first, deck%cards(i)%last
            call take_plain_node(model, deck%data(j), done)
            if (done) cycle
            call split_line(fields, deck, deck%cards(i), j, model%source, error)
            if (allocated(error)) return
            call read_node(model, fields, error)
            if (allocated(error)) return
         end do
         deck%cards(i)%last_item = model%nodes%n
      end do
   end subroutine read_nodes

   !> Takes a line that is all numbers and right; leaves any other as it is.
   pure subroutine take_plain_node(model, place, done)
      type(model_type), intent(inout) :: model
      type(place_type), intent(in) :: place
      logical, intent(out) :: done
      integer :: id
      real(wp) :: x(3)

      associate (file => model%source%files(place%file))
         call scan_point(file%content(file%first(place%line):file%last(place%line)), id, x, done)
      end associate
      done = done .and. id > 0
      if (done) done = model%nodes%index_of%find(id) == 0
      if (done) call add_node(model, id, x, place)
   end subroutine take_plain_node

   pure subroutine add_node(model, id, x, place)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: id
      real(wp), intent(in) :: x(3)
      type(place_type), intent(in) :: place
      integer :: n

      n = model%nodes%n + 1
      model%nodes%n = n
      model%nodes%id(n) = id
      model%nodes%x(:, n) = x
      model%nodes%place(n) = place
      call model%nodes%index_of%insert(id, n)
   end subroutine add_node

   subroutine read_node(model, fields, error)
      type(model_type), intent(inout) :: model
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      integer :: id, twin
      real(wp) :: x(3)

      call check_count(fields, 4, model%source, error)
      if (allocated(error)) return
      call get_integer(fields, 1, 'node id', id, model%source, error)
      if (allocated(error)) return
      call get_reals(fields, 2, 2, 'coordinate', x, model%source, error)
      if (allocated(error)) return
      if (id < 1) then
         call fail_at(error, model%source, field_place(fields, 1), &
               'a node id must be positive', cure='number nodes from 1')
         return
      end if
      twin = model%nodes%index_of%find(id)
      if (twin > 0) then
         call fail_at(error, model%source, field_place(fields, 1), 'node '//to_text(id)// &
               ' is defined twice, first at '//line_text(model%source, model%nodes%place(twin)), &
               cure='give every node its own id')
         return
      end if
      call add_node(model, id, x, fields%place)
   end subroutine read_node

   !> Fills the table of elements from all *ELEMENT cards.
   subroutine read_elements(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(inout) :: deck
      type(error_type), allocatable, intent(out) :: error
      integer :: i, n, n_nodes, status

      n = count_lines(deck, 'ELEMENT')
      call count_nodes(model, deck, n_nodes, error)
      if (allocated(error)) return
      allocate (model%elements%id(n), model%elements%kind(n), model%elements%place(n), stat=status)
      call check_allocation(status)
      allocate (model%elements%first(n + 1), model%elements%nodes(n_nodes), stat=status)
      call check_allocation(status)
      model%elements%first(1) = 1
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword /= 'ELEMENT') cycle
         deck%cards(i)%first_item = model%elements%n + 1
         call read_element_card(model, deck, deck%cards(i), error)
         if (allocated(error)) return
         deck%cards(i)%last_item = model%elements%n
      end do
      if (model%elements%n < n) call cut_to_size(model%elements)
      allocate (model%elements%section(model%elements%n), source=0, stat=status)
      call check_allocation(status)
   end subroutine read_elements

   !> Gives back what was kept for the lines that only go on with an element.
   pure subroutine cut_to_size(elements)
      type(element_table_type), intent(inout) :: elements
      integer :: n

      n = elements%n
      elements%id = elements%id(:n)
      elements%kind = elements%kind(:n)
      elements%place = elements%place(:n)
      elements%first = elements%first(:n + 1)
      elements%nodes = elements%nodes(:elements%first(n + 1) - 1)
   end subroutine cut_to_size

   !> Room for the nodes of all elements: as if every line held an element.
   subroutine count_nodes(model, deck, n_nodes, error)
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      integer, intent(out) :: n_nodes
      type(error_type), allocatable, intent(out) :: error
      integer :: i, choice

      n_nodes = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword /= 'ELEMENT') cycle
         call get_type(deck%cards(i), choice, model%source, error)
         if (allocated(error)) return
         n_nodes = n_nodes + &
               nodes_of_types(choice)*(deck%cards(i)%last - deck%cards(i)%first + 1)
      end do
   end subroutine count_nodes

   !> The element type of a card; of one that only others know what to do about it.
   subroutine get_type(card, choice, source, error)
      type(card_type), intent(in) :: card
      integer, intent(out) :: choice   !! position in `type_names`
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: cure

      call get_word(card, 'TYPE', type_names, choice, source, error)
      if (.not. allocated(error)) return
      associate (given => card%parameters(parameter_index(card, 'TYPE')))
         cure = type_cure(given%value)
         if (cure /= '') call fail_at(error, source, given%place, &
               "unknown value '"//given%value//"' of TYPE", cure=cure)
      end associate
   end subroutine get_type

   subroutine read_element_card(model, deck, card, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      type(place_type) :: places(1 + most_nodes), place
      integer :: numbers(1 + most_nodes), choice, line, n
      logical :: done

      call get_type(card, choice, model%source, error)
      if (allocated(error)) return
      n = 1 + nodes_of_types(choice)
      line = card%first
      do while (line <= card%last)
         place = deck%data(line)
         call take_plain_element(model, kinds_of_types(choice), n, place, done)
         if (done) then
            line = line + 1
            cycle
         end if
         call read_numbers(numbers(:n), places(:n), deck, card, line, model%source, error)
         if (allocated(error)) return
         call add_element(model, kinds_of_types(choice), numbers(:n), places(:n), place, error)
         if (allocated(error)) return
      end do
   end subroutine read_element_card

   !> Takes a line that is one whole element, all numbers and right; leaves any other as it is.
   pure subroutine take_plain_element(model, kind, n, place, done)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: kind
      integer, intent(in) :: n                   !! numbers of the element: id and nodes
      type(place_type), intent(in) :: place
      logical, intent(out) :: done
      integer :: numbers(n), nodes(n - 1), n_read, k

      associate (file => model%source%files(place%file))
         call scan_integers(file%content(file%first(place%line):file%last(place%line)), numbers, &
               n_read, done)
      end associate
      done = done .and. n_read == n
      if (.not. done) return
      done = numbers(1) > 0
      if (done) done = model%elements%index_of%find(numbers(1)) == 0
      do k = 1, n - 1
         if (.not. done) return
         nodes(k) = model%nodes%index_of%find(numbers(k + 1))
         done = nodes(k) > 0 .and. all(nodes(:k - 1) /= nodes(k))
      end do
      if (done) call append_element(model, kind, numbers(1), nodes, place)
   end subroutine take_plain_element

   !> Appends an element that is right.
   pure subroutine append_element(model, kind, id, nodes, place)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: kind, id
      integer, intent(in) :: nodes(:)            !! indices
      type(place_type), intent(in) :: place
      integer :: e

      e = model%elements%n + 1
      model%elements%n = e
      model%elements%id(e) = id
      model%elements%kind(e) = kind
      model%elements%place(e) = place
      associate (first => model%elements%first)
         first(e + 1) = first(e) + size(nodes)
         model%elements%nodes(first(e):first(e + 1) - 1) = nodes
      end associate
      call model%elements%index_of%insert(id, e)
   end subroutine append_element

   !> The id and the nodes of one element, over as many lines as trailing commas join.
   subroutine read_numbers(numbers, places, deck, card, line, source, error)
      integer, intent(out) :: numbers(:)
      type(place_type), intent(out) :: places(:)
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      integer, intent(inout) :: line   !! first line in, the line behind the last out
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer :: k, n_read, n_here

      n_read = 0
      do while (n_read < size(numbers))
         call split_line(fields, deck, card, line, source, error)
         if (allocated(error)) return
         line = line + 1
         n_here = size(numbers) - n_read
         if (fields%n > n_here) then
            call fail_at(error, source, field_place(fields, n_here + 1), &
                  'too many fields: at most '//to_text(n_here)//' here', cure=line_cure(card))
            return
         end if
         if (fields%continued .and. line <= card%last) n_here = min(n_here, fields%n)
         do k = 1, n_here
            n_read = n_read + 1
            places(n_read) = field_place(fields, k)
            call get_integer(fields, k, what_is(n_read), numbers(n_read), source, error)
            if (allocated(error)) return
         end do
      end do
   end subroutine read_numbers

   !> What a line of an element card holds.
   pure function line_cure(card) result(cure)
      type(card_type), intent(in) :: card
      character(len=:), allocatable :: cure
      integer :: choice

      associate (name => card%parameters(parameter_index(card, 'TYPE'))%value)
         choice = find_word(name, type_names)
         cure = 'a line is: id, '//to_text(nodes_of_types(choice))//' nodes of the '// &
               trim(type_names(choice))//' element; gmsh meshes are of Mesh.ElementOrder 1 or 2'
      end associate
   end function line_cure

   pure function what_is(position) result(what)
      integer, intent(in) :: position
      character(len=:), allocatable :: what

      what = 'element id'
      if (position > 1) what = 'node '//to_text(position - 1)//' of the element'
   end function what_is

   subroutine add_element(model, kind, numbers, places, place, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: kind, numbers(:)
      type(place_type), intent(in) :: places(:), place
      type(error_type), allocatable, intent(out) :: error
      integer :: nodes(size(numbers) - 1), k, twin

      if (numbers(1) < 1) then
         call fail_at(error, model%source, places(1), 'an element id must be positive', &
               cure='number elements from 1')
         return
      end if
      twin = model%elements%index_of%find(numbers(1))
      if (twin > 0) then
         call fail_at(error, model%source, places(1), 'element '//to_text(numbers(1))// &
               ' is defined twice, first at '// &
               line_text(model%source, model%elements%place(twin)), &
               cure='give every element its own id')
         return
      end if
      do k = 2, size(numbers)
         nodes(k - 1) = model%nodes%index_of%find(numbers(k))
         if (nodes(k - 1) == 0) then
            call fail_at(error, model%source, places(k), 'no such node: '//to_text(numbers(k)), &
                  cure='define it with *NODE')
            return
         end if
      end do
      do k = 3, size(numbers)
         if (all(numbers(2:k - 1) /= numbers(k))) cycle
         call fail_at(error, model%source, places(k), 'the same node twice in one element', &
               cure='join different nodes')
         return
      end do
      call append_element(model, kind, numbers(1), nodes, place)
   end subroutine add_element

   !> Data lines of all cards of a keyword.
   pure function count_lines(deck, keyword) result(n)
      type(deck_type), intent(in) :: deck
      character(len=*), intent(in) :: keyword
      integer :: n
      integer :: i

      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword == keyword) n = n + deck%cards(i)%last - deck%cards(i)%first + 1
      end do
   end function count_lines

end module mesh_reader
