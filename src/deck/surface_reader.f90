!> `*SURFACE`, `*RIGID SURFACE` and the `*CONTACT PAIR`s that bring them together.
module surface_reader
   use kinds, only: wp
   use errors, only: error_type
   use places, only: fail_at
   use properties, only: name_length
   use model, only: model_type
   use model_building, only: find_named, append, fit, sort_unique
   use cards, only: deck_type, card_type, count_cards, get_word, get_name_parameter
   use cards, only: parameter_place
   use fields, only: fields_type, split_line, check_count, field_place, get_reals, get_name
   use amplitude_reader, only: find_amplitude
   use numbers, only: unit_vector
   use set_reader, only: find_nodes
   use words, only: word_length, advice
   use text, only: to_text
   implicit none
   private

   public :: read_surfaces, read_pairs

contains

   !> Node surfaces and rigid surfaces; they share one set of names.
   subroutine read_surfaces(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      integer :: i, n, n_rigid

      allocate (model%surfaces(count_cards(deck, 'SURFACE')))
      allocate (model%rigid_surfaces(count_cards(deck, 'RIGIDSURFACE')))
      n = 0
      n_rigid = 0
      do i = 1, deck%n_cards
         select case (deck%cards(i)%keyword)
         case ('SURFACE')
            n = n + 1
            call read_surface(model, n, deck, deck%cards(i), error)
         case ('RIGIDSURFACE')
            n_rigid = n_rigid + 1
            call read_rigid_surface(model, n_rigid, deck, deck%cards(i), error)
         case default
            cycle
         end select
         if (allocated(error)) return
      end do
   end subroutine read_surfaces

   !> The name of a surface, not used before.
   subroutine get_new_name(model, card, name, error)
      type(model_type), intent(in) :: model
      type(card_type), intent(in) :: card
      character(len=name_length), intent(out) :: name
      type(error_type), allocatable, intent(out) :: error

      call get_name_parameter(card, 'NAME', name, model%source, error)
      if (allocated(error)) return
      if (find_named(model%surfaces, name) + find_named(model%rigid_surfaces, name) == 0) return
      call fail_at(error, model%source, parameter_place(card, 'NAME'), &
            "surface '"//trim(name)//"' is defined twice", cure='give every surface its own name')
   end subroutine get_new_name

   subroutine read_surface(model, n, deck, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: types(*) = [character(len=word_length) :: &
            'NODE', '~ELEMENT']
      type(fields_type) :: fields
      character(len=name_length) :: name
      integer, allocatable :: nodes(:), more(:)
      integer :: choice, line, k, i, n_nodes

      call get_new_name(model, card, name, error)
      if (allocated(error)) return
      call get_word(card, 'TYPE', types, choice, model%source, error)
      if (allocated(error)) return
      n_nodes = 0
      do line = card%first, card%last
         call split_line(fields, deck, card, line, model%source, error)
         if (allocated(error)) return
         do k = 1, fields%n
            call find_nodes(model, fields, k, more, error)
            if (allocated(error)) return
            do i = 1, size(more)
               call append(nodes, n_nodes, more(i))
            end do
         end do
      end do
      call fit(nodes, n_nodes)
      call sort_unique(nodes)
      model%surfaces(n)%name = name
      model%surfaces(n)%place = card%place
      call move_alloc(nodes, model%surfaces(n)%nodes)
      allocate (model%surfaces(n)%edges(3, 0), model%surfaces(n)%edge_element(0))
   end subroutine read_surface

   subroutine read_rigid_surface(model, n, deck, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: types(*) = [character(len=word_length) :: &
            'PLANE', '~CIRCLE']
      character(len=name_length) :: name
      integer :: choice, n_lines
      real(wp) :: point(3), normal(3), motion(4)

      call get_new_name(model, card, name, error)
      if (allocated(error)) return
      call get_word(card, 'TYPE', types, choice, model%source, error)
      if (allocated(error)) return
      model%rigid_surfaces(n)%name = name
      model%rigid_surfaces(n)%place = card%place
      call find_amplitude(model, card, model%rigid_surfaces(n)%amplitude, error)
      if (allocated(error)) return
      n_lines = 2
      if (model%rigid_surfaces(n)%amplitude > 0) n_lines = 3
      if (card%last - card%first + 1 /= n_lines) then
         call fail_at(error, model%source, deck%data(min(card%last, card%first + n_lines)), &
               'this card takes '//to_text(n_lines)//' data lines', &
               cure='point, normal, and with AMPLITUDE direction and size of the motion')
         return
      end if
      call read_vector(model, deck, card, 1, point, error)
      if (allocated(error)) return
      call read_vector(model, deck, card, 2, normal, error)
      if (allocated(error)) return
      model%rigid_surfaces(n)%point = point
      model%rigid_surfaces(n)%normal = unit_vector(normal)
      if (n_lines == 2) return
      call read_vector(model, deck, card, 3, motion, error)
      if (allocated(error)) return
      model%rigid_surfaces(n)%motion = motion(4)*unit_vector(motion(:3))
   end subroutine read_rigid_surface

   !> Line 1 of a rigid surface (a point), 2 (a direction) or 3 (a direction and a size).
   subroutine read_vector(model, deck, card, k, values, error)
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      integer, intent(in) :: k
      real(wp), intent(out) :: values(:)
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer :: n_needed

      n_needed = 2
      if (size(values) == 4) n_needed = 4
      call split_line(fields, deck, card, card%first + k - 1, model%source, error)
      if (allocated(error)) return
      call check_count(fields, size(values), model%source, error)
      if (allocated(error)) return
      call get_reals(fields, 1, n_needed, 'component', values, model%source, error)
      if (allocated(error)) return
      if (k == 1) return
      if (all(abs(values(:3)) <= 0.0_wp)) call fail_at(error, model%source, &
            field_place(fields, 1), 'this direction has no length', &
            cure='write a vector of any length but zero')
   end subroutine read_vector

   !> *CONTACT PAIR, one pair a line.
   subroutine read_pairs(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      integer :: i, n

      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword == 'CONTACTPAIR') then
            n = n + deck%cards(i)%last - deck%cards(i)%first + 1
         end if
      end do
      allocate (model%pairs(n))
      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword /= 'CONTACTPAIR') cycle
         call read_pair_card(model, n, deck, deck%cards(i), error)
         if (allocated(error)) return
      end do
   end subroutine read_pairs

   subroutine read_pair_card(model, n, deck, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(inout) :: n   !! pairs so far
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: types(*) = [character(len=word_length) :: &
            'NODE TO SURFACE', '~SURFACE TO SURFACE']
      character(len=word_length), parameter :: passes(*) = [character(len=word_length) :: '1', '~2']
      type(fields_type) :: fields
      character(len=name_length) :: name
      integer :: choice, interaction, line

      call get_word(card, 'TYPE', types, choice, model%source, error)
      if (allocated(error)) return
      call get_word(card, 'PASSES', passes, choice, model%source, error)
      if (allocated(error)) return
      call get_name_parameter(card, 'INTERACTION', name, model%source, error)
      if (allocated(error)) return
      interaction = find_named(model%interactions, name)
      if (interaction == 0) then
         call fail_at(error, model%source, parameter_place(card, 'INTERACTION'), &
               'no such surface interaction: '//trim(name), &
               cure='define it with *SURFACE INTERACTION; '// &
               advice(name, [model%interactions%name]))
         return
      end if
      do line = card%first, card%last
         call split_line(fields, deck, card, line, model%source, error)
         if (allocated(error)) return
         n = n + 1
         model%pairs(n)%interaction = interaction
         model%pairs(n)%place = fields%place
         call read_pair(model, n, fields, error)
         if (allocated(error)) return
      end do
   end subroutine read_pair_card

   subroutine read_pair(model, n, fields, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      character(len=name_length) :: slave, master

      call check_count(fields, 2, model%source, error)
      if (allocated(error)) return
      call get_name(fields, 1, 'slave surface', slave, model%source, error)
      if (allocated(error)) return
      call get_name(fields, 2, 'master surface', master, model%source, error)
      if (allocated(error)) return
      model%pairs(n)%contactor = find_named(model%surfaces, slave)
      model%pairs(n)%rigid_target = find_named(model%rigid_surfaces, master)
      if (model%pairs(n)%contactor == 0) then
         if (find_named(model%rigid_surfaces, slave) > 0) then
            call fail_at(error, model%source, field_place(fields, 1), &
                  'a rigid surface cannot be the slave', cure='write: slave, rigid surface')
         else
            call fail_at(error, model%source, field_place(fields, 1), 'no such surface: '// &
                  trim(slave), &
                  cure='define it with *SURFACE; '//advice(slave, [model%surfaces%name]))
         end if
      else if (model%pairs(n)%rigid_target == 0) then
         if (find_named(model%surfaces, master) > 0) then
            call fail_at(error, model%source, field_place(fields, 2), &
                  'a surface of nodes cannot be the master', &
                  cure='name a *RIGID SURFACE; deformable masters do not work yet')
         else
            call fail_at(error, model%source, field_place(fields, 2), 'no such rigid surface: '// &
                  trim(master), &
                  cure='define it with *RIGID SURFACE; '// &
                  advice(master, [model%rigid_surfaces%name]))
         end if
      end if
   end subroutine read_pair

end module surface_reader
