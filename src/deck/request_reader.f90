!> `PRINT` and `FILE` cards: what a step records.
module request_reader
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use places, only: source_type, fail_at, note_at
   use properties, only: name_length
   use steps, only: request_type, n_quantities, procedure_frequency
   use steps, only: request_node_print, request_node_file, request_element_print
   use steps, only: request_element_file, request_contact_print, request_contact_file
   use steps, only: request_energy_print
   use steps, only: quantity_u, quantity_v, quantity_a, quantity_rf, quantity_s, quantity_e
   use steps, only: quantity_ener, quantity_cf, quantity_cdis, quantity_peeq
   use steps, only: quantity_cpress, quantity_cslip, quantity_cstate
   use model, only: model_type
   use cards, only: deck_type, card_type, get_name_parameter, get_integer_parameter
   use cards, only: get_word, get_real_parameter, parameter_place, has_parameter
   use fields, only: fields_type, split_line, field_place, field_text
   use source_reader, only: add_note
   use set_reader, only: find_node_set, find_element_set
   use words, only: word_length, find_word, advice
   implicit none
   private

   public :: read_requests

   character(len=word_length), parameter :: node_words(*) = [character(len=word_length) :: &
         'U', 'V', 'A', 'RF']
   character(len=word_length), parameter :: element_words(*) = [character(len=word_length) :: &
         'S', 'E', 'ENER', 'PEEQ']
   !> CSTR is CalculiX's word for contact stresses.
   character(len=word_length), parameter :: contact_words(*) = [character(len=word_length) :: &
         'CF', 'CDIS', 'CPRESS', 'CSLIP', 'CSTATE', 'CSTR']
   integer, parameter :: node_quantities(*) = [quantity_u, quantity_v, quantity_a, quantity_rf]
   integer, parameter :: element_quantities(*) = [quantity_s, quantity_e, quantity_ener, &
         quantity_peeq]
   integer, parameter :: contact_quantities(*) = [quantity_cf, quantity_cdis, quantity_cpress, &
         quantity_cslip, quantity_cstate, quantity_cpress]

contains

   !> The requests of a step; of a kind it does not mention it takes over those of the last
   !! step of its sort: frequency steps among themselves, the others among themselves.
   subroutine read_requests(model, deck, step, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      type(request_type), allocatable :: requests(:)
      type(request_type) :: request
      integer :: i, n, n_old, before, status

      n_old = 0
      before = step_before(model, step)
      if (before > 0) n_old = size(model%steps(before)%requests)
      n = 0
      do i = deck%first_card(step), deck%last_card(step)
         if (deck%cards(i)%step == step .and. kind_of(deck%cards(i)%keyword) > 0) n = n + 1
      end do
      allocate (requests(n + n_old), stat=status)
      call check_allocation(status)
      n = 0
      do i = deck%first_card(step), deck%last_card(step)
         if (deck%cards(i)%step /= step .or. kind_of(deck%cards(i)%keyword) == 0) cycle
         call read_request(request, model, deck, deck%cards(i), error)
         if (allocated(error)) return
         if (model%steps(step)%procedure == procedure_frequency) then
            if (any(request%kind == [request_node_print, request_element_print])) then
               call add_note(model%notes, note_at(model%source, request%place, 'a PRINT card ' &
                     //'has no effect in a frequency step: /frequency has its numbers, *NODE ' &
                     //'FILE and *EL FILE record its modes'))
               cycle
            end if
            call check_frequency(request, model, deck%cards(i), error)
            if (allocated(error)) return
         end if
         call note_habits(model, deck%cards(i), error)
         if (allocated(error)) return
         n = n + 1
         requests(n) = request
      end do
      if (before > 0) call inherit(model%steps(before)%requests, requests, n)
      model%steps(step)%requests = requests(:n)
   end subroutine read_requests

   !> The last step before this one that is a frequency step too, or that is none either.
   pure function step_before(model, step) result(before)
      type(model_type), intent(in) :: model
      integer, intent(in) :: step
      integer :: before
      logical :: wanted

      wanted = model%steps(step)%procedure == procedure_frequency
      do before = step - 1, 1, -1
         if ((model%steps(before)%procedure == procedure_frequency) .eqv. wanted) return
      end do
      before = 0
   end function step_before

   subroutine inherit(old, requests, n)
      type(request_type), intent(in) :: old(:)
      type(request_type), intent(inout) :: requests(:)
      integer, intent(inout) :: n
      integer :: i, n_own

      n_own = n
      do i = 1, size(old)
         if (any(requests(:n_own)%kind == old(i)%kind)) cycle
         n = n + 1
         requests(n) = old(i)
      end do
   end subroutine inherit

   !> A frequency step has mode shapes: displacements, and the stresses and strains they bring.
   subroutine check_frequency(request, model, card, error)
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      logical :: wrong(n_quantities)

      wrong = request%wanted
      select case (request%kind)
      case (request_node_file)
         wrong(quantity_u) = .false.
         if (any(wrong)) call fail_at(error, model%source, card%place, &
               'a frequency step has no velocities, accelerations and forces to record', &
               cure='write U alone')
      case (request_element_file)
         wrong([quantity_s, quantity_e]) = .false.
         if (any(wrong)) call fail_at(error, model%source, card%place, &
               'a frequency step has no plastic strains and energies to record', &
               cure='write S, E, or one of them')
      case default
         call fail_at(error, model%source, card%place, &
               'a frequency step has neither contact nor an energy balance', cure='remove the card')
      end select
   end subroutine check_frequency

   !> Habits of CalculiX decks that change nothing here.
   subroutine note_habits(model, card, error)
      type(model_type), intent(inout) :: model
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: totals(*) = [character(len=word_length) :: &
            'YES', 'ONLY', 'NO']
      character(len=word_length), parameter :: outputs(*) = [character(len=word_length) :: &
            '2D', '3D']
      character(len=:), allocatable :: columns
      integer :: choice

      columns = 'each element has its columns'
      if (card%keyword == 'NODEPRINT') columns = 'each node has its columns, sum them'
      call get_word(card, 'TOTALS', totals, choice, model%source, error)
      if (allocated(error)) return
      if (choice == 1 .or. choice == 2) call add_note(model%notes, note_at(model%source, &
            parameter_place(card, 'TOTALS'), 'TOTALS has no effect here: '//columns))
      call get_word(card, 'OUTPUT', outputs, choice, model%source, error)
      if (allocated(error)) return
      if (choice == 2) call add_note(model%notes, note_at(model%source, &
            parameter_place(card, 'OUTPUT'), &
            'OUTPUT=3D has no effect here: plane elements stay plane in the result'))
      if (has_parameter(card, 'SLAVE')) call note_surface(model, card, 'SLAVE', &
            slaves(model), error)
      if (allocated(error)) return
      if (has_parameter(card, 'MASTER')) call note_surface(model, card, 'MASTER', &
            masters(model), error)
   end subroutine note_habits

   !> A surface that *CONTACT PRINT names must be that of a pair; the other pairs are recorded too.
   subroutine note_surface(model, card, side, names, error)
      type(model_type), intent(inout) :: model
      type(card_type), intent(in) :: card
      character(len=*), intent(in) :: side       !! SLAVE or MASTER
      character(len=*), intent(in) :: names(:)   !! of that side of each pair
      type(error_type), allocatable, intent(out) :: error
      character(len=name_length) :: name

      call get_name_parameter(card, side, name, model%source, error)
      if (allocated(error)) return
      if (any(names == name)) then
         call add_note(model%notes, note_at(model%source, parameter_place(card, side), &
               side//' has no effect here: every contact pair has its columns'))
      else
         call fail_at(error, model%source, parameter_place(card, side), &
               'no contact pair has this '//side//': '//trim(name), &
               cure='write a surface of a *CONTACT PAIR; '//advice(name, names))
      end if
   end subroutine note_surface

   !> The slave of each contact pair.
   pure function slaves(model) result(names)
      type(model_type), intent(in) :: model
      character(len=name_length) :: names(size(model%pairs))

      names = model%surfaces(model%pairs%contactor)%name
   end function slaves

   !> The master of each contact pair.
   pure function masters(model) result(names)
      type(model_type), intent(in) :: model
      character(len=name_length) :: names(size(model%pairs))
      integer :: p

      do p = 1, size(names)
         associate (pair => model%pairs(p))
            if (pair%target > 0) then
               names(p) = model%surfaces(pair%target)%name
            else
               names(p) = model%rigid_surfaces(pair%rigid_target)%name
            end if
         end associate
      end do
   end function masters

   !> The kind of request a keyword makes, 0 if none.
   pure function kind_of(keyword) result(kind)
      character(len=*), intent(in) :: keyword
      integer :: kind

      select case (keyword)
      case ('NODEPRINT')
         kind = request_node_print
      case ('NODEFILE')
         kind = request_node_file
      case ('ELPRINT')
         kind = request_element_print
      case ('ELFILE')
         kind = request_element_file
      case ('CONTACTPRINT')
         kind = request_contact_print
      case ('CONTACTFILE')
         kind = request_contact_file
      case ('ENERGYPRINT')
         kind = request_energy_print
      case default
         kind = 0
      end select
   end function kind_of

   subroutine read_request(request, model, deck, card, error)
      type(request_type), intent(out) :: request
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error

      request%kind = kind_of(card%keyword)
      request%place = card%place
      call get_integer_parameter(card, 'FREQUENCY', 1, request%frequency, model%source, error)
      if (allocated(error)) return
      call read_set(request, model, card, error)
      if (allocated(error)) return
      select case (request%kind)
      case (request_node_print, request_node_file)
         call read_words(request, deck, card, node_words, node_quantities, model%source, error)
      case (request_element_print, request_element_file)
         call read_words(request, deck, card, element_words, element_quantities, model%source, &
               error)
      case (request_contact_print, request_contact_file)
         call read_words(request, deck, card, contact_words, contact_quantities, model%source, &
               error)
      case default
         call get_real_parameter(card, 'LIMIT', request%balance_limit, model%source, error)
         if (allocated(error) .or. .not. has_parameter(card, 'LIMIT')) return
         if (request%balance_limit > 0.0_wp) return
         call fail_at(error, model%source, parameter_place(card, 'LIMIT'), &
               'LIMIT must be positive', cure='write the balance error allowed, such as 1e-3')
      end select
   end subroutine read_request

   !> NSET or ELSET, whichever the card has.
   subroutine read_set(request, model, card, error)
      type(request_type), intent(inout) :: request
      type(model_type), intent(in) :: model
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=name_length) :: name

      if (has_parameter(card, 'NSET')) then
         call get_name_parameter(card, 'NSET', name, model%source, error)
         if (allocated(error)) return
         call find_node_set(model, name, parameter_place(card, 'NSET'), request%set, error)
      else if (has_parameter(card, 'ELSET')) then
         call get_name_parameter(card, 'ELSET', name, model%source, error)
         if (allocated(error)) return
         call find_element_set(model, name, parameter_place(card, 'ELSET'), request%set, error)
      end if
   end subroutine read_set

   !> The data lines: names of quantities.
   subroutine read_words(request, deck, card, list, quantities, source, error)
      type(request_type), intent(inout) :: request
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      character(len=*), intent(in) :: list(:)
      integer, intent(in) :: quantities(:)   !! what the words of the list stand for
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer :: line, k, choice

      do line = card%first, card%last
         call split_line(fields, deck, card, line, source, error)
         if (allocated(error)) return
         do k = 1, fields%n
            choice = find_word(field_text(fields, k), list)
            if (choice > 0) then
               request%wanted(quantities(choice)) = .true.
               cycle
            end if
            call fail_at(error, source, field_place(fields, k), &
                  "unknown quantity '"//field_text(fields, k)//"'", &
                  cure=advice(field_text(fields, k), list))
            return
         end do
      end do
   end subroutine read_words

end module request_reader
