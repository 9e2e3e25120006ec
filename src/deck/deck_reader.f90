!> A deck file to a model: cuts it into cards, then lets one reader a family fill its part.
module deck_reader
   use display, only: displayed
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use places, only: fail_at, note_at, source_line
   use model, only: model_type
   use histories, only: boundary_type, nodal_value_type
   use cards, only: deck_type, card_type, has_parameter, parameter_index, parameter_place
   use cards, only: get_integer_parameter
   use card_rules, only: check_card, name_of, is_note_card
   use card_splitter, only: split_deck
   use symbols, only: definition_type, read_symbols, apply_definitions, substitute_in_cards
   use symbols, only: mark_used_symbols
   use source_reader, only: add_note
   use mesh_reader, only: read_nodes, read_elements
   use set_reader, only: read_sets
   use amplitude_reader, only: read_amplitudes
   use material_reader, only: read_materials
   use interaction_reader, only: read_interactions, check_methods
   use section_reader, only: read_sections
   use group_reader, only: read_groups
   use surface_reader, only: read_surfaces
   use pair_reader, only: read_pairs
   use condition_reader, only: read_boundaries, read_initial_conditions
   use equation_reader, only: read_equations, check_equations
   use step_reader, only: read_steps
   use overruled_starts, only: note_overruled_starts
   implicit none
   private

   public :: read_deck, definition_type

contains

   !> Reads a deck and all it includes. Every list of the model is allocated afterwards.
   subroutine read_deck(model, path, definitions, error)
      type(model_type), intent(out) :: model
      character(len=*), intent(in) :: path
      type(definition_type), intent(in) :: definitions(:)   !! override *PARAMETER of the same name
      type(error_type), allocatable, intent(out) :: error   !! its status tells which kind
      type(deck_type) :: deck
      integer :: status

      allocate (model%notes(0), stat=status)
      call check_allocation(status)
      call split_deck(deck, model%source, path, error)
      if (allocated(error)) return
      call read_symbols(deck, model%source, error)
      if (allocated(error)) return
      call apply_definitions(deck, definitions, error)
      if (allocated(error)) return
      call substitute_in_cards(deck, model%source, error)
      if (allocated(error)) return
      call check_cards(model, deck, error)
      if (allocated(error)) return
      call read_mesh(model, deck, error)
      if (allocated(error)) return
      call read_matter(model, deck, error)
      if (allocated(error)) return
      call read_history(model, deck, error)
   end subroutine read_deck

   !> Checks every card against the rules; keeps the heading and the notes.
   subroutine check_cards(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(inout) :: deck
      type(error_type), allocatable, intent(out) :: error
      logical :: behind_step
      integer :: i

      call keep_heading(model, deck)
      behind_step = .false.
      do i = 1, deck%n_cards
         call check_card(deck%cards(i), deck%data, model%source, behind_step, error)
         if (allocated(error)) return
         behind_step = behind_step .or. deck%cards(i)%step > 0
         if (deck%cards(i)%keyword == 'OUTPUT' .and. has_parameter(deck%cards(i), 'COMPRESS')) then
            call read_compression(model, deck%cards(i), error)
            if (allocated(error)) return
         else if (is_note_card(deck%cards(i)%rule)) then
            call add_note(model%notes, note_at(model%source, deck%cards(i)%place, &
                  name_of(deck%cards(i)%rule)//' has no effect here'))
         end if
      end do
      call mark_used_symbols(deck, model%source)
      do i = 1, size(deck%symbols)
         if (deck%symbols(i)%used) cycle
         call add_note(model%notes, note_at(model%source, deck%symbols(i)%place, &
               'the parameter '//trim(deck%symbols(i)%name)//' is not used'))
      end do
   end subroutine check_cards

   !> `*OUTPUT, COMPRESS`: a level from 1, also where none is given, to 9.
   pure subroutine read_compression(model, card, error)
      type(model_type), intent(inout) :: model
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      integer :: level

      level = 1
      if (allocated(card%parameters(parameter_index(card, 'COMPRESS'))%value)) then
         call get_integer_parameter(card, 'COMPRESS', 1, level, model%source, error)
         if (allocated(error)) return
      end if
      model%compression = level
      if (level > 9) call fail_at(error, model%source, parameter_place(card, 'COMPRESS'), &
            'COMPRESS: the highest level is 9', cure='1 is fast, 9 is small; write 1 to 9')
   end subroutine read_compression

   !> The lines of all *HEADING cards, as they may be shown.
   subroutine keep_heading(model, deck)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      character(len=:), allocatable :: text
      integer :: pass, i, j, n, status

      do pass = 1, 2                             ! counts, then copies
         n = 0
         do i = 1, deck%n_cards
            if (deck%cards(i)%keyword /= 'HEADING') cycle
            do j = deck%cards(i)%first, deck%cards(i)%last
               call put_line(n, source_line(model%source, deck%data(j)%file, deck%data(j)%line))
            end do
         end do
         if (pass == 1) then
            allocate (character(len=n) :: text, stat=status)
            call check_allocation(status)
         end if
      end do
      model%heading = displayed(text)

   contains

      subroutine put_line(n, line)
         integer, intent(inout) :: n   !! characters so far
         character(len=*), intent(in) :: line

         if (n > 0) then
            n = n + 1
            if (allocated(text)) text(n:n) = new_line('a')
         end if
         if (allocated(text)) text(n + 1:n + len_trim(line)) = line
         n = n + len_trim(line)
      end subroutine put_line

   end subroutine keep_heading

   !> Nodes, elements, sets.
   subroutine read_mesh(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(inout) :: deck
      type(error_type), allocatable, intent(out) :: error

      call read_nodes(model, deck, error)
      if (allocated(error)) return
      if (model%nodes%n == 0) then
         call fail_at(error, model%source, deck%cards(1)%place, 'the deck has no node', &
               cure='add *NODE with the nodes of the model')
         return
      end if
      call read_elements(model, deck, error)
      if (allocated(error)) return
      call read_sets(model, deck, error)
   end subroutine read_mesh

   !> What the elements and surfaces are made of.
   subroutine read_matter(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error

      call read_amplitudes(model, deck, error)
      if (allocated(error)) return
      call read_materials(model, deck, error)
      if (allocated(error)) return
      call read_interactions(model, deck, error)
      if (allocated(error)) return
      call read_sections(model, deck, error)
      if (allocated(error)) return
      call read_groups(model, deck, error)
      if (allocated(error)) return
      call read_surfaces(model, deck, error)
      if (allocated(error)) return
      call read_pairs(model, deck, error)
      if (allocated(error)) return
      call check_methods(model, error)
   end subroutine read_matter

   !> Conditions, constraints and steps.
   subroutine read_history(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      type(boundary_type), allocatable :: boundaries(:)
      type(nodal_value_type), allocatable :: displacements(:), velocities(:)

      call read_boundaries(boundaries, model, deck, 0, error)
      if (allocated(error)) return
      call move_alloc(boundaries, model%boundaries)
      call read_initial_conditions(displacements, velocities, model, deck, 0, error)
      if (allocated(error)) return
      call move_alloc(displacements, model%initial_displacements)
      call move_alloc(velocities, model%initial_velocities)
      call read_equations(model, deck, error)
      if (allocated(error)) return
      call read_steps(model, deck, error)
      if (allocated(error)) return
      call note_overruled_starts(model)
      call check_equations(model, error)
   end subroutine read_history

end module deck_reader
