!> `*CONTACT PAIR`: which surface may touch which, and how that is looked at.
module pair_reader
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use places, only: source_type, fail_at, line_text
   use properties, only: name_length
   use surfaces, only: contact_pair_type
   use model, only: model_type
   use name_map, only: name_map_type
   use text, only: to_text
   use cards, only: deck_type, card_type, get_word, get_name_parameter, get_real_parameter
   use cards, only: has_parameter, parameter_index, parameter_place, get_integer_parameter
   use fields, only: fields_type, split_line, check_count, field_place, get_name
   use words, only: word_length, advice
   implicit none
   private

   public :: read_pairs

contains

   !> One pair a data line; then what pairs mean beside each other.
   subroutine read_pairs(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      type(name_map_type) :: pair_of
      integer :: i, n, status

      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword == 'CONTACTPAIR') then
            n = n + deck%cards(i)%last - deck%cards(i)%first + 1
         end if
      end do
      allocate (model%pairs(n), stat=status)
      call check_allocation(status)
      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword /= 'CONTACTPAIR') cycle
         call read_pair_card(model, n, pair_of, deck, deck%cards(i), error)
         if (allocated(error)) return
      end do
      call check_masses(model, error)
   end subroutine read_pairs

   subroutine read_pair_card(model, n, pair_of, deck, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(inout) :: n   !! pairs so far
      type(name_map_type), intent(inout) :: pair_of
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      type(contact_pair_type) :: pair
      integer :: line

      call read_options(pair, model, card, error)
      if (allocated(error)) return
      do line = card%first, card%last
         call split_line(fields, deck, card, line, model%source, error)
         if (allocated(error)) return
         pair%place = fields%place
         call read_slave(pair, model, fields, error)
         if (allocated(error)) return
         call read_master(pair, model, fields, error)
         if (allocated(error)) return
         call check_pair(pair, model, fields, error)
         if (allocated(error)) return
         call check_pair_is_new(pair, model, n + 1, pair_of, fields, error)
         if (allocated(error)) return
         n = n + 1
         model%pairs(n) = pair
      end do
   end subroutine read_pair_card

   !> The parameters of the card, which hold for all of its pairs.
   subroutine read_options(pair, model, card, error)
      type(contact_pair_type), intent(inout) :: pair
      type(model_type), intent(in) :: model
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: types(*) = [character(len=word_length) :: &
            'NODE TO SURFACE', 'SURFACE TO SURFACE']
      character(len=word_length), parameter :: masses(*) = [character(len=word_length) :: &
            'REDISTRIBUTED']
      character(len=name_length) :: name
      integer :: choice

      call get_word(card, 'TYPE', types, choice, model%source, error)
      if (allocated(error)) return
      pair%weighted = choice == 2
      call read_passes(pair, model%source, card, error)
      if (allocated(error)) return
      call get_word(card, 'MASS', masses, choice, model%source, error)
      if (allocated(error)) return
      pair%redistributed = choice == 1
      pair%small_sliding = has_parameter(card, 'SMALLSLIDING')
      call read_adjustment(pair, model, card, error)
      if (allocated(error)) return
      call get_name_parameter(card, 'INTERACTION', name, model%source, error)
      if (allocated(error)) return
      pair%interaction = model%interaction_of%find(name)
      if (pair%interaction == 0) call fail_at(error, model%source, &
            parameter_place(card, 'INTERACTION'), 'no such surface interaction: '//trim(name), &
            cure='define it with *SURFACE INTERACTION; '//advice(name, [model%interactions%name]))
   end subroutine read_options

   !> PASSES: 1 or 2.
   subroutine read_passes(pair, source, card, error)
      type(contact_pair_type), intent(inout) :: pair
      type(source_type), intent(in) :: source
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error

      pair%passes = 1
      call get_integer_parameter(card, 'PASSES', 1, pair%passes, source, error)
      if (allocated(error)) return
      if (pair%passes > 2) call fail_at(error, source, parameter_place(card, 'PASSES'), &
            'PASSES is out of range', cure='write 1 or 2')
   end subroutine read_passes

   !> ADJUST, or ADJUST=distance.
   subroutine read_adjustment(pair, model, card, error)
      type(contact_pair_type), intent(inout) :: pair
      type(model_type), intent(in) :: model
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      i = parameter_index(card, 'ADJUST')
      if (i == 0) return
      pair%adjust = .true.
      if (.not. allocated(card%parameters(i)%value)) return
      call get_real_parameter(card, 'ADJUST', pair%adjust_distance, model%source, error)
      if (allocated(error)) return
      if (pair%adjust_distance < 0.0_wp) call fail_at(error, model%source, &
            parameter_place(card, 'ADJUST'), 'the distance of ADJUST must not be negative', &
            cure='write ADJUST alone for overlaps only, or the width of the gaps to close too')
   end subroutine read_adjustment

   subroutine read_slave(pair, model, fields, error)
      type(contact_pair_type), intent(inout) :: pair
      type(model_type), intent(in) :: model
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      character(len=name_length) :: name

      call check_count(fields, 2, model%source, error)
      if (allocated(error)) return
      call get_name(fields, 1, 'slave surface', name, model%source, error)
      if (allocated(error)) return
      pair%contactor = model%surface_of%find(name)
      if (pair%contactor > 0) return
      if (model%rigid_surface_of%find(name) > 0) then
         call fail_at(error, model%source, field_place(fields, 1), &
               'a rigid surface cannot be the slave', cure='write: slave, rigid surface')
      else
         call fail_at(error, model%source, field_place(fields, 1), 'no such surface: '// &
               trim(name), cure='define it with *SURFACE; '//advice(name, [model%surfaces%name]))
      end if
   end subroutine read_slave

   subroutine read_master(pair, model, fields, error)
      type(contact_pair_type), intent(inout) :: pair
      type(model_type), intent(in) :: model
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      character(len=name_length) :: name

      call get_name(fields, 2, 'master surface', name, model%source, error)
      if (allocated(error)) return
      pair%target = model%surface_of%find(name)
      pair%rigid_target = model%rigid_surface_of%find(name)
      if (pair%target + pair%rigid_target == 0) then
         call fail_at(error, model%source, field_place(fields, 2), 'no such surface: '// &
               trim(name), cure='define it with *SURFACE, TYPE=ELEMENT or with *RIGID SURFACE; '// &
               advice(name, masters(model)))
      else if (pair%target > 0) then
         if (.not. has_edges(model, pair%target)) call fail_at(error, model%source, &
               field_place(fields, 2), 'a surface of nodes cannot be the master', &
               cure='define it with TYPE=ELEMENT, or name a *RIGID SURFACE')
      end if
   end subroutine read_master

   !> Names of all surfaces that can be masters.
   pure function masters(model) result(names)
      type(model_type), intent(in) :: model
      character(len=name_length), allocatable :: names(:)
      logical :: able(size(model%surfaces))
      integer :: i

      do i = 1, size(able)
         able(i) = has_edges(model, i)
      end do
      names = [pack(model%surfaces%name, able), model%rigid_surfaces%name]
   end function masters

   !> Whether a surface is of TYPE=ELEMENT.
   pure function has_edges(model, surface) result(has)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      logical :: has

      has = size(model%surfaces(surface)%edges, 2) > 0
   end function has_edges

   !> What the parameters of a card ask of the surfaces of a pair.
   subroutine check_pair(pair, model, fields, error)
      type(contact_pair_type), intent(in) :: pair
      type(model_type), intent(in) :: model
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error

      call check_edges(pair, model, fields, error)
      if (allocated(error)) return
      if (pair%passes == 2 .and. pair%rigid_target > 0) then
         call fail_at(error, model%source, field_place(fields, 2), &
               'with PASSES=2 each surface is slave once, a rigid surface cannot be', &
               cure='remove PASSES=2')
      else if (pair%passes == 2 .and. pair%target == pair%contactor) then
         call fail_at(error, model%source, field_place(fields, 2), &
               'PASSES=2 means nothing for a surface against itself', &
               cure='remove PASSES=2: every node of the surface is slave already')
      else if (pair%adjust .and. pair%target == pair%contactor) then
         call fail_at(error, model%source, field_place(fields, 2), &
               'ADJUST means nothing for a surface against itself', &
               cure='remove ADJUST, or make two surfaces of it: one stays, the other is moved')
      end if
   end subroutine check_pair

   !> Weighted rows, two passes and redistributed masses need edges on the slave.
   subroutine check_edges(pair, model, fields, error)
      type(contact_pair_type), intent(in) :: pair
      type(model_type), intent(in) :: model
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: what

      if (has_edges(model, pair%contactor)) return
      if (pair%weighted) then
         what = 'TYPE=SURFACE TO SURFACE'
      else if (pair%passes == 2) then
         what = 'PASSES=2'
      else if (pair%redistributed) then
         what = 'MASS=REDISTRIBUTED'
      else
         return
      end if
      call fail_at(error, model%source, field_place(fields, 1), &
            what//' needs a slave with edges, this one is made of nodes', &
            cure='define it with *SURFACE, TYPE=ELEMENT, or remove '//what)
   end subroutine check_edges

   !> Two surfaces make one pair.
   subroutine check_pair_is_new(pair, model, n, pair_of, fields, error)
      type(contact_pair_type), intent(in) :: pair
      type(model_type), intent(in) :: model
      integer, intent(in) :: n   !! its index
      type(name_map_type), intent(inout) :: pair_of   !! "slave target rigid target" to index
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      integer :: twin

      twin = pair_of%find(key(pair%contactor, pair%target, pair%rigid_target))
      if (twin > 0) then
         call fail_at(error, model%source, fields%place, 'this pair stands at '// &
               line_text(model%source, model%pairs(twin)%place)//' already', &
               cure='keep one of the two')
         return
      end if
      if (pair%target > 0) twin = pair_of%find(key(pair%target, pair%contactor, 0))
      if (twin > 0) then
         call fail_at(error, model%source, fields%place, 'this is the pair at '// &
               line_text(model%source, model%pairs(twin)%place)//' with its surfaces exchanged', &
               cure='keep one of the two, and write PASSES=2 on its card for both ways')
         return
      end if
      call pair_of%insert(key(pair%contactor, pair%target, pair%rigid_target), n)

   contains

      pure function key(contactor, target, rigid_target) result(name)
         integer, intent(in) :: contactor, target, rigid_target
         character(len=:), allocatable :: name

         name = to_text(contactor)//' '//to_text(target)//' '//to_text(rigid_target)
      end function key

   end subroutine check_pair_is_new

   !> A node without mass has no rebound, in whatever pair it is the slave.
   subroutine check_masses(model, error)
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: massless(:)
      integer :: p, status

      if (.not. any(model%pairs%redistributed)) return
      allocate (massless(model%nodes%n), source=.false., stat=status)
      call check_allocation(status)
      do p = 1, size(model%pairs)
         if (.not. model%pairs(p)%redistributed) cycle
         massless(model%surfaces(model%pairs(p)%contactor)%nodes) = .true.
         if (model%pairs(p)%target == 0) cycle
         massless(model%surfaces(model%pairs(p)%target)%nodes) = .true.
      end do
      do p = 1, size(model%pairs)
         associate (pair => model%pairs(p))
            if (.not. model%interactions(pair%interaction)%has_restitution) cycle
            if (.not. any(massless(model%surfaces(pair%contactor)%nodes))) cycle
            call fail_at(error, model%source, pair%place, 'MASS=REDISTRIBUTED leaves nodes of '// &
                  trim(model%surfaces(pair%contactor)%name)//' without mass, they cannot '// &
                  "rebound as RESTITUTION of the interaction '"// &
                  trim(model%interactions(pair%interaction)%name)//"' says", &
                  cure='remove RESTITUTION from its *IMPACT, or MASS')
            return
         end associate
      end do
   end subroutine check_masses

end module pair_reader
