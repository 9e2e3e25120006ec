!> `*NSET`, `*ELSET` and the sets that *NODE and *ELEMENT fill; what names of sets mean.
module set_reader
   use errors, only: error_type
   use places, only: place_type, source_type, fail_at
   use properties, only: name_length
   use integer_map, only: integer_map_type
   use mesh, only: set_type
   use model, only: model_type
   use model_building, only: append
   use set_drafts, only: draft_type, drafts_type, resolve_sets
   use name_map, only: name_map_type
   use cards, only: deck_type, card_type, get_name_parameter, has_parameter, parameter_place
   use fields, only: fields_type, split_line, check_count, field_place, is_given, is_integer
   use fields, only: get_integer, get_name
   use plain_lines, only: scan_integers
   use words, only: advice
   use text, only: to_text
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: read_sets, find_nodes, find_element_set, find_node_set

   integer, parameter :: most_plain = 32   !! ids on a line that are read the quick way

contains

   !> Reads all sets; they may name each other in any order.
   subroutine read_sets(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      type(drafts_type) :: family

      family%what = 'element'
      call read_family(family, ['ELSET  ', 'ELEMENT'], model%elements%index_of, deck, &
            model%source, error)
      if (.not. allocated(error)) call resolve_sets(family, model%source, error)
      if (allocated(error)) return
      call keep_family(model%element_sets, model%element_set_of, family)
      family = drafts_type(what='node')
      call read_family(family, ['NSET', 'NODE'], model%nodes%index_of, deck, model%source, error)
      if (.not. allocated(error)) call add_nodes_of_elements(family, model, deck, error)
      if (.not. allocated(error)) call resolve_sets(family, model%source, error)
      if (allocated(error)) return
      call keep_family(model%node_sets, model%node_set_of, family)
   end subroutine read_sets

   !> The sets of nodes or of elements, from their own cards and those that define members.
   subroutine read_family(family, keywords, index_of, deck, source, error)
      type(drafts_type), intent(inout) :: family
      character(len=*), intent(in) :: keywords(2)   !! the first one is the parameter's name too
      type(integer_map_type), intent(in) :: index_of
      type(deck_type), intent(in) :: deck
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      integer :: i, set

      call name_sets(family, keywords, trim(keywords(1)), deck, source, error)
      if (allocated(error)) return
      do i = 1, deck%n_cards
         if (all(deck%cards(i)%keyword /= keywords)) cycle
         if (.not. has_parameter(deck%cards(i), trim(keywords(1)))) cycle
         call open_set(family, deck%cards(i), trim(keywords(1)), set, source, error)
         if (allocated(error)) return
         call read_members(family, set, deck%cards(i), index_of, deck, source, error)
         if (allocated(error)) return
      end do
   end subroutine read_family

   !> Moves sets that are done into the model.
   subroutine keep_family(sets, set_of, family)
      type(set_type), allocatable, intent(out) :: sets(:)
      type(name_map_type), intent(out) :: set_of
      type(drafts_type), intent(inout) :: family
      integer :: i, status

      set_of = family%set_of
      allocate (sets(family%n), stat=status)
      call check_allocation(status)
      do i = 1, family%n
         sets(i)%name = family%sets(i)%name
         sets(i)%place = family%sets(i)%place
         call move_alloc(family%sets(i)%members, sets(i)%members)
      end do
   end subroutine keep_family

   !> `*NSET, ELSET=`: all nodes of the elements of a set.
   subroutine add_nodes_of_elements(family, model, deck, error)
      type(drafts_type), intent(inout) :: family
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      character(len=name_length) :: name
      integer :: i, j, k, set, part

      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword /= 'NSET') cycle
         if (.not. has_parameter(deck%cards(i), 'ELSET')) cycle
         if (has_parameter(deck%cards(i), 'GENERATE')) then
            call fail_at(error, model%source, parameter_place(deck%cards(i), 'GENERATE'), &
                  'GENERATE means nothing with ELSET', cure='write two *NSET cards of one name')
            return
         end if
         call open_set(family, deck%cards(i), 'NSET', set, model%source, error)
         if (allocated(error)) return
         call get_name_parameter(deck%cards(i), 'ELSET', name, model%source, error)
         if (allocated(error)) return
         call find_element_set(model, name, parameter_place(deck%cards(i), 'ELSET'), part, error)
         if (allocated(error)) return
         associate (draft => family%drafts(set), members => model%element_sets(part)%members)
            do j = 1, size(members)
               do k = model%elements%first(members(j)), model%elements%first(members(j) + 1) - 1
                  call append(draft%members, draft%n_members, model%elements%nodes(k))
               end do
            end do
         end associate
      end do
   end subroutine add_nodes_of_elements

   !> Makes an empty draft for every name, so that sets may be used before they are defined.
   subroutine name_sets(family, keywords, parameter_name, deck, source, error)
      type(drafts_type), intent(inout) :: family
      character(len=*), intent(in) :: keywords(2), parameter_name
      type(deck_type), intent(in) :: deck
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      integer :: i, n, set, status

      n = 0
      do i = 1, deck%n_cards
         if (any(deck%cards(i)%keyword == keywords)) n = n + 1
      end do
      allocate (family%sets(n), family%drafts(n), stat=status)
      call check_allocation(status)
      do i = 1, deck%n_cards
         if (all(deck%cards(i)%keyword /= keywords)) cycle
         if (.not. has_parameter(deck%cards(i), parameter_name)) cycle
         call open_set(family, deck%cards(i), parameter_name, set, source, error)
         if (allocated(error)) return
      end do
   end subroutine name_sets

   !> Index of the set that a card fills; a new name is added.
   subroutine open_set(family, card, parameter_name, set, source, error)
      type(drafts_type), intent(inout) :: family
      type(card_type), intent(in) :: card
      character(len=*), intent(in) :: parameter_name
      integer, intent(out) :: set
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=name_length) :: name
      integer :: status

      set = 0
      call get_name_parameter(card, parameter_name, name, source, error)
      if (allocated(error)) return
      set = family%set_of%find(name)
      if (set > 0) return
      family%n = family%n + 1
      set = family%n
      call family%set_of%insert(name, set)
      family%sets(set)%name = name
      family%sets(set)%place = card%place
      allocate (family%drafts(set)%members(8), family%drafts(set)%parts(0), stat=status)
      call check_allocation(status)
      allocate (family%drafts(set)%part_places(0), stat=status)
      call check_allocation(status)
   end subroutine open_set

   !> Adds what the data lines of a card say to a set.
   subroutine read_members(family, set, card, index_of, deck, source, error)
      type(drafts_type), intent(inout) :: family
      integer, intent(in) :: set
      type(card_type), intent(in) :: card
      type(integer_map_type), intent(in) :: index_of
      type(deck_type), intent(in) :: deck
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer :: line, item
      logical :: done

      associate (draft => family%drafts(set))
         do item = card%first_item, card%last_item
            call append(draft%members, draft%n_members, item)
         end do
      end associate
      if (all(card%keyword /= ['NSET ', 'ELSET'])) return
      do line = card%first, card%last
         call take_plain_ids(family%drafts(set), card, deck%data(line), index_of, source, done)
         if (done) cycle
         call split_line(fields, deck, card, line, source, error)
         if (allocated(error)) return
         if (has_parameter(card, 'GENERATE')) then
            call add_range(family, set, fields, index_of, source, error)
         else
            call add_fields(family, set, fields, index_of, source, error)
         end if
         if (allocated(error)) return
      end do
   end subroutine read_members

   !> Takes a line that lists nothing but ids that exist; leaves any other as it is.
   pure subroutine take_plain_ids(draft, card, place, index_of, source, done)
      type(draft_type), intent(inout) :: draft
      type(card_type), intent(in) :: card
      type(place_type), intent(in) :: place
      type(integer_map_type), intent(in) :: index_of
      type(source_type), intent(in) :: source
      logical, intent(out) :: done
      integer :: items(most_plain), n, i

      done = .not. has_parameter(card, 'GENERATE')
      if (.not. done) return
      associate (file => source%files(place%file))
         call scan_integers(file%content(file%first(place%line):file%last(place%line)), items, n, &
               done)
      end associate
      do i = 1, n
         if (.not. done) return
         items(i) = index_of%find(items(i))
         done = items(i) > 0
      end do
      do i = 1, merge(n, 0, done)
         call append(draft%members, draft%n_members, items(i))
      end do
   end subroutine take_plain_ids

   !> Ids and names of sets, one a field.
   subroutine add_fields(family, set, fields, index_of, source, error)
      type(drafts_type), intent(inout) :: family
      integer, intent(in) :: set
      type(fields_type), intent(in) :: fields
      type(integer_map_type), intent(in) :: index_of
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      integer :: k, id

      do k = 1, fields%n
         if (is_given(fields, k) .and. .not. is_integer(fields, k)) then
            call add_part(family, set, fields, k, source, error)
         else
            call get_integer(fields, k, trim(family%what)//' id', id, source, error)
            if (allocated(error)) return
            call add_member(family, set, id, index_of, field_place(fields, k), source, error)
         end if
         if (allocated(error)) return
      end do
   end subroutine add_fields

   subroutine add_member(family, set, id, index_of, place, source, error)
      type(drafts_type), intent(inout) :: family
      integer, intent(in) :: set, id
      type(integer_map_type), intent(in) :: index_of
      type(place_type), intent(in) :: place
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      integer :: member

      member = index_of%find(id)
      if (member == 0) then
         call fail_at(error, source, place, 'no such '//trim(family%what)//': '//to_text(id), &
               cure='members of a set must be defined')
         return
      end if
      associate (draft => family%drafts(set))
         call append(draft%members, draft%n_members, member)
      end associate
   end subroutine add_member

   !> A field that names another set.
   subroutine add_part(family, set, fields, k, source, error)
      type(drafts_type), intent(inout) :: family
      integer, intent(in) :: set, k
      type(fields_type), intent(in) :: fields
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=name_length) :: name
      integer :: part, n

      call get_name(fields, k, trim(family%what)//' id or set', name, source, error)
      if (allocated(error)) return
      part = family%set_of%find(name)
      if (part == 0) then
         call fail_at(error, source, field_place(fields, k), &
               'no such '//trim(family%what)//' set: '//trim(name), &
               cure=advice(name, [family%sets(:family%n)%name]))
         return
      end if
      associate (draft => family%drafts(set))
         n = draft%n_parts
         call append(draft%part_places, n, field_place(fields, k))
         call append(draft%parts, draft%n_parts, part)
      end associate
   end subroutine add_part

   !> first, last[, step]; every id of the range must exist.
   subroutine add_range(family, set, fields, index_of, source, error)
      type(drafts_type), intent(inout) :: family
      integer, intent(in) :: set
      type(fields_type), intent(in) :: fields
      type(integer_map_type), intent(in) :: index_of
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      integer :: first, last, step, i

      call check_count(fields, 3, source, error)
      if (allocated(error)) return
      call get_integer(fields, 1, 'first', first, source, error)
      if (allocated(error)) return
      call get_integer(fields, 2, 'last', last, source, error)
      if (allocated(error)) return
      step = 1
      if (is_given(fields, 3)) call get_integer(fields, 3, 'step', step, source, error)
      if (allocated(error)) return
      if (first < 1) then
         call fail_at(error, source, field_place(fields, 1), 'ids are positive', &
               cure='write first, last[, step]')
      else if (last < first) then
         call fail_at(error, source, field_place(fields, 2), &
               'the last of the range is below the first', cure='write first, last[, step]')
      else if (step < 1) then
         call fail_at(error, source, field_place(fields, 3), &
               'the step of the range must be positive', cure='write first, last[, step]')
      end if
      if (allocated(error)) return
      do i = 0, (last - first)/step
         call add_member(family, set, first + i*step, index_of, field_place(fields, 1), &
               source, error)
         if (allocated(error)) return
      end do
   end subroutine add_range

   !> The nodes that a field names: one by its id, or those of a set.
   subroutine find_nodes(model, fields, k, nodes, error)
      type(model_type), intent(in) :: model
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: k
      integer, allocatable, intent(out) :: nodes(:)   !! indices
      type(error_type), allocatable, intent(out) :: error
      character(len=name_length) :: name
      integer :: id, set

      if (is_integer(fields, k)) then
         call get_integer(fields, k, 'node id', id, model%source, error)
         if (allocated(error)) return
         nodes = [model%nodes%index_of%find(id)]
         if (nodes(1) == 0) call fail_at(error, model%source, field_place(fields, k), &
               'no such node: '//to_text(id), cure='define it with *NODE')
         return
      end if
      call get_name(fields, k, 'node id or set', name, model%source, error)
      if (allocated(error)) return
      call find_node_set(model, name, field_place(fields, k), set, error)
      if (allocated(error)) return
      nodes = model%node_sets(set)%members
   end subroutine find_nodes

   !> Index of a node set by its name.
   subroutine find_node_set(model, name, place, set, error)
      type(model_type), intent(in) :: model
      character(len=*), intent(in) :: name
      type(place_type), intent(in) :: place
      integer, intent(out) :: set
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: cause

      set = model%node_set_of%find(name)
      if (set > 0) return
      cause = 'no such node set: '//trim(name)
      if (model%element_set_of%find(name) > 0) then
         call fail_at(error, model%source, place, cause//'; '//trim(name)// &
               ' is a set of elements', &
               cure='make a set of their nodes before the first *STEP: *NSET, NSET='// &
               trim(name)//', ELSET='//trim(name))
      else
         call fail_at(error, model%source, place, cause, &
               cure='define it with *NSET; '//advice(name, [model%node_sets%name]))
      end if
   end subroutine find_node_set

   !> Index of an element set by its name.
   subroutine find_element_set(model, name, place, set, error)
      type(model_type), intent(in) :: model
      character(len=*), intent(in) :: name
      type(place_type), intent(in) :: place
      integer, intent(out) :: set
      type(error_type), allocatable, intent(out) :: error

      set = model%element_set_of%find(name)
      if (set == 0) call fail_at(error, model%source, place, 'no such element set: '//trim(name), &
            cure='define it with *ELSET; '//advice(name, pack(model%element_sets%name, &
            model%element_sets%name(1:8) /= 'element ')))      ! not those of *DLOAD on an element
   end subroutine find_element_set

end module set_reader
