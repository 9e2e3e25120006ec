!> `*SURFACE, TYPE=ELEMENT`: the edges of a surface, from sides of solids or from boundary lines.
module edge_surface_reader
   use errors, only: error_type
   use places, only: fail_at
   use properties, only: name_length
   use mesh, only: element_line, is_solid_kind
   use element_sides, only: side_finder_type, new_side_finder, is_built, find_sides
   use element_sides, only: count_sides, side_nodes, side_key, key_element, key_side
   use model, only: model_type
   use model_building, only: append, fit, sort_unique
   use cards, only: deck_type, card_type
   use fields, only: fields_type, split_line, check_count, field_place, field_text
   use fields, only: is_given, is_integer, get_integer, get_name
   use set_reader, only: find_element_set
   use element_types, only: kind_name
   use words, only: word_length, find_word, advice
   use text, only: to_text
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: read_edges

   character(len=word_length), parameter :: side_words(*) = [character(len=word_length) :: &
         'S1', 'S2', 'S3', 'S4']

contains

   !> Fills edges, their elements and nodes of a surface; a side that is named twice counts once.
   subroutine read_edges(model, n, finder, deck, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n                           !! the surface
      type(side_finder_type), intent(inout) :: finder    !! is built when first needed
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer, allocatable :: keys(:)
      integer :: n_keys, line

      if (.not. is_built(finder)) call new_side_finder(finder, model%elements, model%nodes%n)
      n_keys = 0
      do line = card%first, card%last
         call split_line(fields, deck, card, line, model%source, error)
         if (allocated(error)) return
         call read_line(keys, n_keys, model, finder, fields, error)
         if (allocated(error)) return
      end do
      call fit(keys, n_keys)
      call sort_unique(keys)
      call store_edges(model, n, keys)
   end subroutine read_edges

   subroutine store_edges(model, n, keys)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n, keys(:)
      integer, allocatable :: nodes(:)
      integer :: i, status

      associate (surface => model%surfaces(n))
         surface%edge_element = key_element(keys)
         allocate (surface%edges(3, size(keys)), stat=status)
         call check_allocation(status)
         do i = 1, size(keys)
            surface%edges(:, i) = side_nodes(model%elements, key_element(keys(i)), &
                  key_side(keys(i)))
         end do
         nodes = pack(surface%edges, surface%edges > 0)
         call sort_unique(nodes)
         call move_alloc(nodes, surface%nodes)
      end associate
   end subroutine store_edges

   !> Element or set, side; without a side the elements are boundary lines.
   subroutine read_line(keys, n_keys, model, finder, fields, error)
      integer, allocatable, intent(inout) :: keys(:)
      integer, intent(inout) :: n_keys
      type(model_type), intent(in) :: model
      type(side_finder_type), intent(in) :: finder
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: elements(:)
      integer :: side, i, key

      call check_count(fields, 2, model%source, error)
      if (allocated(error)) return
      call find_elements(model, fields, elements, error)
      if (allocated(error)) return
      call read_side(side, model, fields, error)
      if (allocated(error)) return
      do i = 1, size(elements)
         if (side > 0) then
            call check_side(model, elements(i), side, fields, error)
            if (allocated(error)) return
            key = side_key(elements(i), side)
         else
            call find_owner(key, model, finder, elements(i), fields, error)
            if (allocated(error)) return
         end if
         call check_outside(model, finder, key, fields, error)
         if (allocated(error)) return
         call append(keys, n_keys, key)
      end do
   end subroutine read_line

   !> The elements that field 1 names: one by its id, or those of a set.
   subroutine find_elements(model, fields, elements, error)
      type(model_type), intent(in) :: model
      type(fields_type), intent(in) :: fields
      integer, allocatable, intent(out) :: elements(:)   !! indices
      type(error_type), allocatable, intent(out) :: error
      character(len=name_length) :: name
      integer :: id, set

      if (is_integer(fields, 1)) then
         call get_integer(fields, 1, 'element id', id, model%source, error)
         if (allocated(error)) return
         elements = [model%elements%index_of%find(id)]
         if (elements(1) == 0) call fail_at(error, model%source, field_place(fields, 1), &
               'no such element: '//to_text(id), &
               cure='define it with *ELEMENT; a surface of nodes needs TYPE=NODE')
         return
      end if
      call get_name(fields, 1, 'element id or set', name, model%source, error)
      if (allocated(error)) return
      if (model%element_set_of%find(name) == 0 .and. model%node_set_of%find(name) > 0) then
         call fail_at(error, model%source, field_place(fields, 1), &
               trim(name)//' is a set of nodes', &
               cure='name a set of elements, or write TYPE=NODE on the *SURFACE card')
         return
      end if
      call find_element_set(model, name, field_place(fields, 1), set, error)
      if (allocated(error)) return
      elements = model%element_sets(set)%members
   end subroutine find_elements

   !> S1 to S4 as a number, 0 where the line ends before it.
   subroutine read_side(side, model, fields, error)
      integer, intent(out) :: side
      type(model_type), intent(in) :: model
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error

      side = 0
      if (.not. is_given(fields, 2)) return
      side = find_word(field_text(fields, 2), side_words)
      if (side == 0) call fail_at(error, model%source, field_place(fields, 2), &
            "unknown side '"//field_text(fields, 2)//"'", &
            cure=advice(field_text(fields, 2), side_words))
   end subroutine read_side

   !> Only solids have sides, and triangles three of them.
   subroutine check_side(model, e, side, fields, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: e, side
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: what

      if (side <= count_sides(model%elements%kind(e))) return
      what = 'element '//to_text(model%elements%id(e))//' is '//kind_name(model%elements%kind(e))
      if (is_solid_kind(model%elements%kind(e))) then
         call fail_at(error, model%source, field_place(fields, 2), what//', it has no side S4', &
               cure='sides 1, 2, 3 of a triangle are S1, S2, S3')
      else if (model%elements%kind(e) == element_line) then
         call fail_at(error, model%source, field_place(fields, 2), &
               'element '//to_text(model%elements%id(e))//' is a line, it has no sides', &
               cure='name the line alone: its side is that of the element it belongs to')
      else
         call fail_at(error, model%source, field_place(fields, 2), what//', it has no sides', &
               cure='sides belong to plane and axisymmetric elements')
      end if
   end subroutine check_side

   !> The side of a solid on which a boundary line lies, whatever the direction of the line.
   subroutine find_owner(key, model, finder, e, fields, error)
      integer, intent(out) :: key
      type(model_type), intent(in) :: model
      type(side_finder_type), intent(in) :: finder
      integer, intent(in) :: e
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: what

      key = 0
      what = 'element '//to_text(model%elements%id(e))//' is '//kind_name(model%elements%kind(e))
      if (is_solid_kind(model%elements%kind(e))) then
         call fail_at(error, model%source, field_place(fields, 1), what//': which side of it?', &
               cure='write element or set, S1 to S4')
      else if (model%elements%kind(e) /= element_line) then
         call fail_at(error, model%source, field_place(fields, 1), what//', it has no sides', &
               cure='name plane or axisymmetric elements with a side, or lines without a section')
      end if
      if (allocated(error)) return
      key = side_of_line(model, finder, e)
      if (key == 0) call fail_at(error, model%source, field_place(fields, 1), &
            'line element '//to_text(model%elements%id(e))//' is no side of any '// &
            'plane or axisymmetric element', cure='give it the nodes of such a side')
   end subroutine find_owner

   !> The first side that has all nodes of a line, 0 if none has. Some meshers write the middle node
   !> of a line last, others between its ends.
   pure function side_of_line(model, finder, e) result(key)
      type(model_type), intent(in) :: model
      type(side_finder_type), intent(in) :: finder
      integer, intent(in) :: e
      integer :: key
      integer, allocatable :: keys(:)
      integer :: nodes(3), side(3), n, turn, i

      n = model%elements%first(e + 1) - model%elements%first(e)
      nodes = 0
      nodes(:n) = model%elements%nodes(model%elements%first(e):model%elements%first(e + 1) - 1)
      do turn = 1, 3
         call find_sides(finder, model%elements, nodes, keys)
         do i = 1, size(keys)
            key = keys(i)
            side = side_nodes(model%elements, key_element(key), key_side(key))
            if (n == 2 .or. side(3) == nodes(3)) return
         end do
         if (n == 2) exit
         nodes = cshift(nodes, 1)
      end do
      key = 0
   end function side_of_line

   !> A side with an element on both sides of it lies inside a body, not on its surface.
   subroutine check_outside(model, finder, key, fields, error)
      type(model_type), intent(in) :: model
      type(side_finder_type), intent(in) :: finder
      integer, intent(in) :: key
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: keys(:)
      integer :: i

      call find_sides(finder, model%elements, &
            side_nodes(model%elements, key_element(key), key_side(key)), keys)
      do i = 1, size(keys)
         if (keys(i) == key) cycle
         call fail_at(error, model%source, field_place(fields, 1), side_name(key)// &
               ' lies inside the body: it is '//side_name(keys(i))//' too', &
               cure='name sides of the outline only; the faces of a crack need nodes of their own')
         return
      end do

   contains

      pure function side_name(number) result(name)
         integer, intent(in) :: number
         character(len=:), allocatable :: name

         name = 'side S'//to_text(key_side(number))//' of element '// &
               to_text(model%elements%id(key_element(number)))
      end function side_name

   end subroutine check_outside

end module edge_surface_reader
