!> `*BOUNDARY`, `*INITIAL CONDITIONS` and `*CLOAD`: values at freedoms of nodes.
module condition_reader
   use kinds, only: wp
   use errors, only: error_type
   use places, only: source_type, fail_at, line_text
   use histories, only: boundary_type, nodal_value_type
   use histories, only: motion_displacement, motion_velocity, motion_acceleration
   use model, only: model_type
   use model_building, only: append, fit
   use integer_map, only: integer_map_type
   use cards, only: deck_type, card_type, get_word, has_parameter, parameter_place
   use fields, only: fields_type, split_line, check_count, field_place, field_text, is_given
   use fields, only: get_real
   use amplitude_reader, only: find_amplitude
   use set_reader, only: find_nodes
   use spring_reader, only: get_dof
   use words, only: word_length, find_word, advice
   use text, only: to_text
   implicit none
   private

   public :: read_boundaries, read_initial_conditions, read_loads

   character(len=word_length), parameter :: ic_types(*) = [character(len=word_length) :: &
         'DISPLACEMENT', 'VELOCITY']
   !> Supports by name, and the first and last freedom of each.
   character(len=word_length), parameter :: supports(*) = [character(len=word_length) :: &
         'ENCASTRE', 'PINNED', 'XSYMM', 'YSYMM', 'ZSYMM']
   integer, parameter :: support_range(2, 5) = reshape([1, 3, 1, 3, 1, 1, 2, 2, 3, 3], [2, 5])

contains

   !> All *BOUNDARY cards of a step, or of the model (step 0).
   subroutine read_boundaries(list, model, deck, step, error)
      type(boundary_type), allocatable, intent(out) :: list(:)
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      type(integer_map_type) :: given
      integer :: i, n

      n = 0
      do i = deck%first_card(step), deck%last_card(step)
         if (deck%cards(i)%keyword /= 'BOUNDARY' .or. deck%cards(i)%step /= step) cycle
         if (step == 0 .and. has_parameter(deck%cards(i), 'OP')) then
            call fail_at(error, model%source, parameter_place(deck%cards(i), 'OP'), &
                  'OP has a meaning inside a step only', cure='remove it')
            return
         end if
         call read_boundary_card(list, n, given, model, deck, deck%cards(i), error)
         if (allocated(error)) return
      end do
      call fit(list, n)
   end subroutine read_boundaries

   subroutine read_boundary_card(list, n, given, model, deck, card, error)
      type(boundary_type), allocatable, intent(inout) :: list(:)
      integer, intent(inout) :: n
      type(integer_map_type), intent(inout) :: given   !! freedom to index in the list
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: types(*) = [character(len=word_length) :: &
            'DISPLACEMENT', 'VELOCITY', 'ACCELERATION']
      integer, parameter :: motions(0:3) = &
            [motion_displacement, motion_displacement, motion_velocity, motion_acceleration]
      type(fields_type) :: fields
      type(boundary_type) :: boundary
      integer :: choice, line

      call get_word(card, 'TYPE', types, choice, model%source, error)
      if (allocated(error)) return
      boundary%motion = motions(choice)
      call find_amplitude(model, card, boundary%amplitude, error)
      if (allocated(error)) return
      do line = card%first, card%last
         call split_line(fields, deck, card, line, model%source, error)
         if (allocated(error)) return
         boundary%place = fields%place
         call read_boundary(list, n, given, model, fields, boundary, error)
         if (allocated(error)) return
      end do
   end subroutine read_boundary_card

   !> One line: the freedoms from first to last of a node or set.
   subroutine read_boundary(list, n, given, model, fields, boundary, error)
      type(boundary_type), allocatable, intent(inout) :: list(:)
      integer, intent(inout) :: n
      type(integer_map_type), intent(inout) :: given
      type(model_type), intent(in) :: model
      type(fields_type), intent(in) :: fields
      type(boundary_type), intent(inout) :: boundary
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: nodes(:)
      integer :: first, last, i, dof

      call check_count(fields, 4, model%source, error)
      if (allocated(error)) return
      call find_nodes(model, fields, 1, nodes, error)
      if (allocated(error)) return
      boundary%value = 0.0_wp
      if (is_word(field_text(fields, 2))) then
         call read_support(fields, first, last, model%source, error)
      else
         call read_range(fields, first, last, boundary%value, model%source, error)
      end if
      if (allocated(error)) return
      do i = 1, size(nodes)
         do dof = first, last
            boundary%node = nodes(i)
            boundary%dof = dof
            call add_boundary(list, n, given, model, boundary, error)
            if (allocated(error)) return
         end do
      end do
   end subroutine read_boundary

   !> First dof[, last dof[, value]].
   subroutine read_range(fields, first, last, value, source, error)
      type(fields_type), intent(in) :: fields
      integer, intent(out) :: first, last
      real(wp), intent(inout) :: value           !! stays where the line has none
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      call get_dof(fields, 2, first, source, error)
      last = first
      if (allocated(error)) return
      if (is_given(fields, 3)) call get_dof(fields, 3, last, source, error)
      if (allocated(error)) return
      if (last < first) then
         call fail_at(error, source, field_place(fields, 3), &
               'the last freedom is below the first', &
               cure='a line is: node or set, first dof[, last dof[, value]]')
         return
      end if
      if (is_given(fields, 4)) call get_real(fields, 4, 'value', value, source, error)
   end subroutine read_range

   !> A word in the place of the freedoms.
   subroutine read_support(fields, first, last, source, error)
      type(fields_type), intent(in) :: fields
      integer, intent(out) :: first, last
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: against(*) = [character(len=word_length) :: &
            'XASYMM', 'YASYMM', 'ZASYMM']
      character(len=*), parameter :: cures(*) = ['a line with the freedoms 2, 3 ', &
            'lines with 1 and with 3       ', 'a line with the freedoms 1, 2 ']
      integer :: i

      first = 0
      last = 0
      i = find_word(field_text(fields, 2), against)
      if (i > 0) then
         call fail_at(error, source, field_place(fields, 2), trim(against(i))// &
               ' is not known: an antisymmetric plane holds the freedoms along it', &
               cure='write '//trim(cures(i)))
         return
      end if
      i = find_word(field_text(fields, 2), supports)
      if (i == 0) then
         call fail_at(error, source, field_place(fields, 2), "unknown support '"// &
               field_text(fields, 2)//"'", cure='write the freedoms 1, 2, 3, or a word; '// &
               advice(field_text(fields, 2), supports))
         return
      end if
      first = support_range(1, i)
      last = support_range(2, i)
      call check_count(fields, 2, source, error)
   end subroutine read_support

   !> Whether a field holds a word, not a number.
   pure function is_word(text) result(word)
      character(len=*), intent(in) :: text
      logical :: word

      word = scan(text, 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ') == 1
   end function is_word

   !> Appends a condition; one said before is left out if the same, an error if it contradicts.
   subroutine add_boundary(list, n, given, model, boundary, error)
      type(boundary_type), allocatable, intent(inout) :: list(:)
      integer, intent(inout) :: n
      type(integer_map_type), intent(inout) :: given
      type(model_type), intent(in) :: model
      type(boundary_type), intent(in) :: boundary
      type(error_type), allocatable, intent(out) :: error
      integer :: twin

      twin = given%find(3*boundary%node + boundary%dof)
      if (twin == 0) then
         call append(list, n, boundary)
         call given%insert(3*boundary%node + boundary%dof, n)
         return
      end if
      if (list(twin)%motion == boundary%motion .and. &
            list(twin)%amplitude == boundary%amplitude .and. &
            abs(list(twin)%value - boundary%value) <= 0.0_wp) return
      call fail_at(error, model%source, boundary%place, 'freedom '//to_text(boundary%dof)// &
            ' of node '//to_text(model%nodes%id(boundary%node))//' is given another value at '// &
            line_text(model%source, list(twin)%place), cure='give every freedom one condition')
   end subroutine add_boundary

   !> All *INITIAL CONDITIONS of a step, or of the model (step 0).
   subroutine read_initial_conditions(displacements, velocities, model, deck, step, error)
      type(nodal_value_type), allocatable, intent(out) :: displacements(:), velocities(:)
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      type(integer_map_type) :: given_d, given_v
      integer :: i, n_d, n_v, choice

      n_d = 0
      n_v = 0
      do i = deck%first_card(step), deck%last_card(step)
         if (deck%cards(i)%keyword /= 'INITIALCONDITIONS' .or. deck%cards(i)%step /= step) cycle
         call get_word(deck%cards(i), 'TYPE', ic_types, choice, model%source, error)
         if (allocated(error)) return
         if (choice == 1 .and. step > 0) then
            call fail_at(error, model%source, deck%cards(i)%place, &
                  'initial displacements must not stand inside a step', &
                  cure='move the card before the first *STEP')
            return
         end if
         if (choice == 1) then
            call read_values(displacements, n_d, given_d, model, deck, deck%cards(i), error)
         else
            call read_values(velocities, n_v, given_v, model, deck, deck%cards(i), error)
         end if
         if (allocated(error)) return
      end do
      call fit(displacements, n_d)
      call fit(velocities, n_v)
   end subroutine read_initial_conditions

   !> Lines of node or set, dof, value; a freedom must not get two different values.
   subroutine read_values(list, n, given, model, deck, card, error)
      type(nodal_value_type), allocatable, intent(inout) :: list(:)
      integer, intent(inout) :: n
      type(integer_map_type), intent(inout) :: given
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      type(nodal_value_type) :: item
      integer, allocatable :: nodes(:)
      integer :: line, i, twin

      do line = card%first, card%last
         call read_value(item, nodes, model, deck, card, line, error)
         if (allocated(error)) return
         do i = 1, size(nodes)
            item%node = nodes(i)
            twin = given%find(3*item%node + item%dof)
            if (twin == 0) then
               call append(list, n, item)
               call given%insert(3*item%node + item%dof, n)
            else if (abs(list(twin)%value - item%value) > 0.0_wp) then
               call fail_at(error, model%source, item%place, 'freedom '//to_text(item%dof)// &
                     ' of node '//to_text(model%nodes%id(item%node))// &
                     ' is given another value at '// &
                     line_text(model%source, list(twin)%place), cure='give every freedom one value')
               return
            end if
         end do
      end do
   end subroutine read_values

   !> One line of node or set, dof, value.
   subroutine read_value(item, nodes, model, deck, card, line, error)
      type(nodal_value_type), intent(out) :: item
      integer, allocatable, intent(out) :: nodes(:)
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      integer, intent(in) :: line
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields

      call split_line(fields, deck, card, line, model%source, error)
      if (allocated(error)) return
      call check_count(fields, 3, model%source, error)
      if (allocated(error)) return
      call find_nodes(model, fields, 1, nodes, error)
      if (allocated(error)) return
      call get_dof(fields, 2, item%dof, model%source, error)
      if (allocated(error)) return
      call get_real(fields, 3, 'value', item%value, model%source, error)
      item%place = fields%place
   end subroutine read_value

   !> All *CLOAD cards of a step; loads on one freedom add up.
   subroutine read_loads(list, model, deck, step, error)
      type(nodal_value_type), allocatable, intent(out) :: list(:)
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      type(nodal_value_type) :: item
      integer, allocatable :: nodes(:)
      integer :: i, j, n, line, amplitude

      n = 0
      do i = deck%first_card(step), deck%last_card(step)
         if (deck%cards(i)%keyword /= 'CLOAD' .or. deck%cards(i)%step /= step) cycle
         call find_amplitude(model, deck%cards(i), amplitude, error)
         if (allocated(error)) return
         do line = deck%cards(i)%first, deck%cards(i)%last
            call read_value(item, nodes, model, deck, deck%cards(i), line, error)
            if (allocated(error)) return
            item%amplitude = amplitude
            do j = 1, size(nodes)
               item%node = nodes(j)
               call append(list, n, item)
            end do
         end do
      end do
      call fit(list, n)
   end subroutine read_loads

end module condition_reader
