!> `PRINT` and `FILE` cards: what a step records.
module request_reader
   use kinds, only: wp
   use errors, only: error_type
   use places, only: source_type, fail_at
   use properties, only: name_length
   use steps, only: request_type, step_type, n_quantities
   use steps, only: request_node_print, request_node_file, request_element_print
   use steps, only: request_element_file, request_contact_print, request_contact_file
   use steps, only: request_energy_print
   use steps, only: quantity_u, quantity_v, quantity_a, quantity_rf, quantity_s, quantity_e
   use steps, only: quantity_ener, quantity_cf, quantity_cdis
   use model, only: model_type
   use cards, only: deck_type, card_type, get_name_parameter, get_integer_parameter
   use cards, only: get_real_parameter, parameter_place, has_parameter
   use fields, only: fields_type, split_line, field_place, field_text
   use set_reader, only: find_node_set, find_element_set
   use words, only: word_length, find_word, advice, squeezed
   implicit none
   private

   public :: read_requests

   character(len=word_length), parameter :: node_words(*) = [character(len=word_length) :: &
         'U', 'V', 'A', 'RF']
   character(len=word_length), parameter :: element_words(*) = [character(len=word_length) :: &
         'S', 'E', 'ENER']
   character(len=word_length), parameter :: contact_words(*) = [character(len=word_length) :: &
         'CF', 'CDIS']
   integer, parameter :: node_quantities(*) = [quantity_u, quantity_v, quantity_a, quantity_rf]
   integer, parameter :: element_quantities(*) = [quantity_s, quantity_e, quantity_ener]
   integer, parameter :: contact_quantities(*) = [quantity_cf, quantity_cdis]

contains

   !> The requests of a step; of a kind it does not mention it takes over those of the step before.
   subroutine read_requests(model, deck, step, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      type(request_type), allocatable :: requests(:)
      type(request_type) :: request
      integer :: i, n, n_old

      n_old = 0
      if (step > 1) n_old = size(model%steps(step - 1)%requests)
      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%step == step .and. kind_of(deck%cards(i)%keyword) > 0) n = n + 1
      end do
      allocate (requests(n + n_old))
      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%step /= step .or. kind_of(deck%cards(i)%keyword) == 0) cycle
         call read_request(request, model, deck, deck%cards(i), error)
         if (allocated(error)) return
         n = n + 1
         requests(n) = request
      end do
      call inherit(model, step, requests, n)
      model%steps(step)%requests = requests(:n)
   end subroutine read_requests

   subroutine inherit(model, step, requests, n)
      type(model_type), intent(in) :: model
      integer, intent(in) :: step
      type(request_type), intent(inout) :: requests(:)
      integer, intent(inout) :: n
      integer :: i, n_own

      if (step == 1) return
      n_own = n
      do i = 1, size(model%steps(step - 1)%requests)
         if (any(requests(:n_own)%kind == model%steps(step - 1)%requests(i)%kind)) cycle
         n = n + 1
         requests(n) = model%steps(step - 1)%requests(i)
      end do
   end subroutine inherit

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
            if (squeezed(field_text(fields, k)) == 'PEEQ') then
               call fail_at(error, source, field_place(fields, k), &
                     'PEEQ is known but does not work yet', cure=advice('', list))
            else
               call fail_at(error, source, field_place(fields, k), &
                     "unknown quantity '"//field_text(fields, k)//"'", &
                     cure=advice(field_text(fields, k), list))
            end if
            return
         end do
      end do
   end subroutine read_words

end module request_reader
