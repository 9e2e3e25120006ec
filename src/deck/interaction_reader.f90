!> `*SURFACE INTERACTION` with its `*IMPACT` and its `*FRICTION`.
module interaction_reader
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use places, only: source_type, fail_at, note_at
   use surfaces, only: interaction_type, method_transformation, method_fictitious_force
   use surfaces, only: method_penalty, method_lagrange, beta_given
   use properties, only: section_gap
   use model, only: model_type
   use cards, only: deck_type, card_type, count_cards, get_word, get_real_parameter
   use cards, only: get_name_parameter, get_integer_parameter, parameter_place, has_parameter
   use cards, only: parameter_index
   use fields, only: fields_type, only_line, field_place, get_reals
   use numbers, only: parse_fraction
   use source_reader, only: add_note
   use words, only: word_length, squeezed
   implicit none
   private

   public :: read_interactions, check_methods

   !> Beyond it forces along the cone overflow.
   real(wp), parameter :: most_friction = 1.0e6_wp
   character(len=word_length), parameter :: method_words(*) = [character(len=word_length) :: &
         'TRANSFORMATION', 'FICTITIOUS FORCE', 'PENALTY', 'LAGRANGE']
   integer, parameter :: methods(*) = [method_transformation, method_fictitious_force, &
         method_penalty, method_lagrange]

contains

   !> Interactions in the order of the deck; *IMPACT and *FRICTION belong to the one before them.
   subroutine read_interactions(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      integer :: i, n, with_friction, status

      allocate (model%interactions(count_cards(deck, 'SURFACEINTERACTION')), stat=status)
      call check_allocation(status)
      n = 0
      with_friction = 0
      do i = 1, deck%n_cards
         select case (deck%cards(i)%keyword)
         case ('SURFACEINTERACTION')
            n = n + 1
            call open_interaction(model, n, deck%cards(i), error)
         case ('IMPACT')
            call check_opened(n, deck%cards(i), model%source, error)
            if (allocated(error)) return
            call read_impact(model%interactions(n), deck%cards(i), model%source, error)
         case ('FRICTION')
            call check_opened(n, deck%cards(i), model%source, error)
            if (allocated(error)) return
            call read_friction(model%interactions(n), with_friction == n, deck, &
                  deck%cards(i), model%source, error)
            with_friction = n
         case default
            cycle
         end select
         if (allocated(error)) return
      end do
   end subroutine read_interactions

   !> There must be an interaction that *IMPACT or *FRICTION belongs to.
   subroutine check_opened(n, card, source, error)
      integer, intent(in) :: n   !! interactions so far
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      if (n > 0) return
      call fail_at(error, source, card%place, &
            '*'//card%keyword//' belongs to a surface interaction', &
            cure='put *SURFACE INTERACTION, NAME=name before it')
   end subroutine check_opened

   subroutine open_interaction(model, n, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error

      call get_name_parameter(card, 'NAME', model%interactions(n)%name, model%source, error)
      if (allocated(error)) return
      model%interactions(n)%place = card%place
      if (model%interaction_of%find(model%interactions(n)%name) == 0) then
         call model%interaction_of%insert(model%interactions(n)%name, n)
         return
      end if
      call fail_at(error, model%source, parameter_place(card, 'NAME'), "surface interaction '"// &
            trim(model%interactions(n)%name)//"' is defined twice", &
            cure='give every interaction its own name')
   end subroutine open_interaction

   subroutine read_impact(interaction, card, source, error)
      type(interaction_type), intent(inout) :: interaction
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      if (interaction%has_impact) then
         call fail_at(error, source, card%place, 'this interaction has *IMPACT already', &
               cure='keep one of the two')
         return
      end if
      interaction%has_impact = .true.
      call read_method(interaction, card, source, error)
      if (allocated(error)) return
      call refuse_strangers(interaction%method, card, source, error)
      if (allocated(error)) return
      call read_stiffness(interaction, card, source, error)
      if (allocated(error)) return
      call read_speeds(interaction, card, source, error)
      if (allocated(error)) return
      call read_beta(interaction, card, source, error)
      if (allocated(error)) return
      call get_integer_parameter(card, 'MAXEVENTS', 1, interaction%max_events, source, error)
   end subroutine read_impact

   !> METHOD, SOLUTION and EVENTS.
   subroutine read_method(interaction, card, source, error)
      type(interaction_type), intent(inout) :: interaction
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: solutions(*) = [character(len=word_length) :: &
            'ITERATION', 'DIRECT']
      character(len=word_length), parameter :: events(*) = [character(len=word_length) :: &
            'SUBSTEP', 'ANCHOR']
      integer :: choice

      call get_word(card, 'METHOD', method_words, choice, source, error)
      if (allocated(error)) return
      interaction%method = methods(max(1, choice))
      call get_word(card, 'SOLUTION', solutions, choice, source, error)
      if (allocated(error)) return
      interaction%direct = choice == 2
      call get_word(card, 'EVENTS', events, choice, source, error)
      if (allocated(error)) return
      interaction%anchored = choice == 2
      if (.not. (interaction%anchored .and. has_parameter(card, 'BETA'))) return
      call fail_at(error, source, parameter_place(card, 'BETA'), 'BETA means nothing with ' &
            //'EVENTS=ANCHOR: a step with an impact is like any other', &
            cure='remove it, or take EVENTS=SUBSTEP')
   end subroutine read_method

   !> A parameter that a method would ignore is an error.
   subroutine refuse_strangers(method, card, source, error)
      integer, intent(in) :: method
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: names(*) = [character(len=word_length) :: &
            'RESTITUTION', 'RETURN', 'SOLUTION', 'BETA', 'CAPTURE', 'MAX EVENTS', 'EVENTS', &
            'STIFFNESS']
      logical, parameter :: yes = .true., no = .false.
      !> Which of the names mean something, a column a method in the order of their words.
      logical, parameter :: known(8, 4) = reshape([ &
            yes, no, no, yes, yes, yes, yes, no, &
            yes, yes, yes, no, yes, yes, no, no, &
            no, no, no, no, no, no, no, yes, &
            no, no, no, no, no, no, no, no], [8, 4])
      integer :: i, m

      m = findloc(methods, method, dim=1)
      do i = 1, size(names)
         if (known(i, m) .or. .not. has_parameter(card, squeezed(names(i)))) cycle
         call fail_at(error, source, parameter_place(card, squeezed(names(i))), &
               trim(names(i))//' means nothing with METHOD='//trim(method_words(m)), &
               cure='remove it, or change the method')
         return
      end do
   end subroutine refuse_strangers

   !> STIFFNESS, which the penalty method must have.
   subroutine read_stiffness(interaction, card, source, error)
      type(interaction_type), intent(inout) :: interaction
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      if (interaction%method /= method_penalty) return
      if (.not. has_parameter(card, 'STIFFNESS')) then
         call fail_at(error, source, parameter_place(card, 'METHOD'), &
               'METHOD=PENALTY needs the parameter STIFFNESS', &
               cure='write STIFFNESS=k, the force on a node that overlaps by one unit of length')
         return
      end if
      call get_real_parameter(card, 'STIFFNESS', interaction%stiffness, source, error)
      if (allocated(error)) return
      if (.not. interaction%stiffness > 0.0_wp) call fail_at(error, source, &
            parameter_place(card, 'STIFFNESS'), 'STIFFNESS must be positive', &
            cure='write a number above 0')
   end subroutine read_stiffness

   !> One coefficient. CalculiX takes a second number, a slope for sticking; here that is exact.
   subroutine read_friction(interaction, again, deck, card, source, error)
      type(interaction_type), intent(inout) :: interaction
      logical, intent(in) :: again   !! whether the interaction has friction already
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      real(wp) :: values(1)

      if (again) then
         call fail_at(error, source, card%place, 'this interaction has *FRICTION already', &
               cure='keep one of the two')
         return
      end if
      call only_line(fields, deck, card, 2, source, error)
      if (allocated(error)) return
      if (fields%n == 2) then
         call fail_at(error, source, field_place(fields, 2), &
               'there is no stick slope here: a node that sticks does not move at all', &
               cure='write the coefficient of friction alone')
         return
      end if
      call get_reals(fields, 1, 1, 'coefficient of friction', values, source, error)
      if (allocated(error)) return
      interaction%friction = values(1)
      if (values(1) < 0.0_wp) then
         call fail_at(error, source, field_place(fields, 1), &
               'the coefficient of friction must not be negative', cure='write a number from 0 up')
      else if (values(1) > most_friction) then
         call fail_at(error, source, field_place(fields, 1), &
               'the coefficient of friction must not exceed 1e6', cure='1e6 sticks as well')
      end if
   end subroutine read_friction

   !> RESTITUTION, RETURN and CAPTURE.
   subroutine read_speeds(interaction, card, source, error)
      type(interaction_type), intent(inout) :: interaction
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      interaction%has_restitution = has_parameter(card, 'RESTITUTION')
      call get_real_parameter(card, 'RESTITUTION', interaction%restitution, source, error)
      if (allocated(error)) return
      call get_real_parameter(card, 'RETURN', interaction%return_parameter, source, error)
      if (allocated(error)) return
      interaction%has_capture = has_parameter(card, 'CAPTURE')
      call get_real_parameter(card, 'CAPTURE', interaction%capture, source, error)
      if (allocated(error)) return
      if (interaction%restitution < 0.0_wp .or. interaction%restitution > 1.0_wp) then
         call fail_at(error, source, parameter_place(card, 'RESTITUTION'), &
               'RESTITUTION is out of range', cure='write a number from 0 to 1')
      else if (interaction%return_parameter <= 0.0_wp .or. &
            interaction%return_parameter >= 1.0_wp) then
         call fail_at(error, source, parameter_place(card, 'RETURN'), &
               'RETURN is out of range', cure='write a number between 0 and 1, neither included')
      else if (interaction%capture < 0.0_wp) then
         call fail_at(error, source, parameter_place(card, 'CAPTURE'), &
               'CAPTURE must not be negative', cure='write a speed from 0 up')
      end if
   end subroutine read_speeds

   !> BETA: AUTO, a number or a fraction such as 1/6.
   subroutine read_beta(interaction, card, source, error)
      type(interaction_type), intent(inout) :: interaction
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=*), parameter :: cure = 'write AUTO, a number from 0 to 0.5, or one as 1/6'
      character(len=:), allocatable :: cause
      integer :: i

      i = parameter_index(card, 'BETA')
      if (i == 0) return
      if (squeezed(card%parameters(i)%value) == 'AUTO') return
      interaction%beta_choice = beta_given
      call parse_fraction(squeezed(card%parameters(i)%value), interaction%beta, cause)
      if (.not. allocated(cause)) then
         if (interaction%beta < 0.0_wp .or. interaction%beta > 0.5_wp) cause = 'out of range'
      end if
      if (allocated(cause)) call fail_at(error, source, card%parameters(i)%place, &
            'BETA: '//cause, cure=cure)
   end subroutine read_beta

   !> All interactions in use must have one method; those not in use are noted.
   subroutine check_methods(model, error)
      type(model_type), intent(inout) :: model
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: used(:)
      integer :: i, first, status

      allocate (used(size(model%interactions)), source=.false., stat=status)
      call check_allocation(status)
      do i = 1, size(model%pairs)
         used(model%pairs(i)%interaction) = .true.
      end do
      do i = 1, size(model%sections)
         if (model%sections(i)%kind == section_gap) used(model%sections(i)%interaction) = .true.
      end do
      first = 0
      do i = 1, size(used)
         if (.not. used(i)) then
            call add_note(model%notes, note_at(model%source, model%interactions(i)%place, &
                  "surface interaction '"//trim(model%interactions(i)%name)//"' is not used"))
            cycle
         end if
         if (first == 0) first = i
         if (model%interactions(i)%method == model%interactions(first)%method) cycle
         call fail_at(error, model%source, model%interactions(i)%place, &
               "the interactions '"//trim(model%interactions(first)%name)//"' and '"// &
               trim(model%interactions(i)%name)//"' have different methods", &
               cure='give all interactions in use the same METHOD')
         return
      end do
   end subroutine check_methods

end module interaction_reader
