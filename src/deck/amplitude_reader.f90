!> `*AMPLITUDE`, and amplitudes named on other cards.
module amplitude_reader
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use places, only: fail_at
   use properties, only: name_length
   use histories, only: time_step, time_total
   use model, only: model_type
   use cards, only: deck_type, card_type, count_cards, get_word, get_name_parameter, parameter_place
   use cards, only: parameter_index
   use fields, only: fields_type, split_line, check_count, field_place, get_real
   use words, only: word_length, squeezed, advice
   implicit none
   private

   public :: read_amplitudes, find_amplitude

contains

   subroutine read_amplitudes(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      integer :: i, n, status

      allocate (model%amplitudes(count_cards(deck, 'AMPLITUDE')), stat=status)
      call check_allocation(status)
      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword /= 'AMPLITUDE') cycle
         n = n + 1
         call read_amplitude(model, n, deck, deck%cards(i), error)
         if (allocated(error)) return
      end do
   end subroutine read_amplitudes

   subroutine read_amplitude(model, n, deck, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n   !! index of the amplitude
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: times(*) = [character(len=word_length) :: &
            'STEP TIME', 'TOTAL TIME']
      type(fields_type) :: fields
      integer :: choice, line, k, status

      associate (amplitude => model%amplitudes(n))
         call get_name_parameter(card, 'NAME', amplitude%name, model%source, error)
         if (allocated(error)) return
         if (model%amplitude_of%find(amplitude%name) > 0) then
            call fail_at(error, model%source, parameter_place(card, 'NAME'), &
                  "amplitude '"//trim(amplitude%name)//"' is defined twice", &
                  cure='give every amplitude its own name')
            return
         end if
         call model%amplitude_of%insert(amplitude%name, n)
         call get_word(card, 'TIME', times, choice, model%source, error)
         if (allocated(error)) return
         call check_definition(model, card, error)
         if (allocated(error)) return
         amplitude%time = time_step
         if (choice == 2) amplitude%time = time_total
         amplitude%place = card%place
         k = 4*(card%last - card%first + 1)
         allocate (amplitude%t(k), amplitude%a(k), stat=status)
         call check_allocation(status)
      end associate
      k = 0
      do line = card%first, card%last
         call split_line(fields, deck, card, line, model%source, error)
         if (allocated(error)) return
         call read_pairs(model, n, k, fields, error)
         if (allocated(error)) return
      end do
      model%amplitudes(n)%t = model%amplitudes(n)%t(:k)
      model%amplitudes(n)%a = model%amplitudes(n)%a(:k)
   end subroutine read_amplitude

   !> DEFINITION: other programs know curves by formulas too.
   subroutine check_definition(model, card, error)
      type(model_type), intent(in) :: model
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      i = parameter_index(card, 'DEFINITION')
      if (i == 0) return
      if (squeezed(card%parameters(i)%value) == 'TABULAR') return
      call fail_at(error, model%source, card%parameters(i)%place, &
            "unknown value '"//card%parameters(i)%value//"' of DEFINITION", cure='write the ' &
            //'curve by its points, pairs of time, value with straight lines between them; ' &
            //'allowed: TABULAR')
   end subroutine check_definition

   !> Up to four pairs of time and value; k counts those of the amplitude.
   subroutine read_pairs(model, n, k, fields, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n
      integer, intent(inout) :: k
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: t, a
      integer :: i

      call check_count(fields, 8, model%source, error)
      if (allocated(error)) return
      if (mod(fields%n, 2) /= 0) then
         call fail_at(error, model%source, field_place(fields, fields%n), &
               'a time without its value', cure='a line is: up to 4 pairs of time, value')
         return
      end if
      do i = 1, fields%n, 2
         call get_real(fields, i, 'time', t, model%source, error)
         if (allocated(error)) return
         call get_real(fields, i + 1, 'value', a, model%source, error)
         if (allocated(error)) return
         if (k > 0) then
            if (t <= model%amplitudes(n)%t(k)) then
               call fail_at(error, model%source, field_place(fields, i), &
                     'the times of an amplitude must increase', &
                     cure='order the pairs by time, each time once')
               return
            end if
         end if
         k = k + 1
         model%amplitudes(n)%t(k) = t
         model%amplitudes(n)%a(k) = a
      end do
   end subroutine read_pairs

   !> Index of the amplitude that the card's AMPLITUDE names, 0 without one.
   subroutine find_amplitude(model, card, amplitude, error)
      type(model_type), intent(in) :: model
      type(card_type), intent(in) :: card
      integer, intent(out) :: amplitude
      type(error_type), allocatable, intent(out) :: error
      character(len=name_length) :: name

      amplitude = 0
      call get_name_parameter(card, 'AMPLITUDE', name, model%source, error)
      if (allocated(error) .or. name == '') return
      amplitude = model%amplitude_of%find(name)
      if (amplitude == 0) call fail_at(error, model%source, parameter_place(card, 'AMPLITUDE'), &
            'no such amplitude: '//trim(name), &
            cure='define it with *AMPLITUDE; '//advice(name, [model%amplitudes%name]))
   end subroutine find_amplitude

end module amplitude_reader
