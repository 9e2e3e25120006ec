!> `*STEP` to `*END STEP`: procedure, loads and requests.
module step_reader
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use places, only: source_type, fail_at, note_at
   use steps, only: step_type, procedure_static, procedure_dynamic, procedure_frequency, &
         solver_mumps
   use model, only: model_type
   use cards, only: deck_type, card_type, get_word, get_name_parameter, get_integer_parameter
   use cards, only: parameter_index, parameter_place, has_parameter
   use card_rules, only: usage_of
   use source_reader, only: add_note
   use fields, only: fields_type, only_line, field_place, is_given, get_reals, get_real, get_integer
   use condition_reader, only: read_boundaries, read_initial_conditions, read_loads
   use request_reader, only: read_requests
   use load_reader, only: read_distributed, read_base_motions
   use restart_reader, only: read_restarts
   use order_reader, only: check_one_order
   use dynamic_reader, only: read_dynamic
   use words, only: word_length, find_word
   implicit none
   private

   public :: read_steps

contains

   subroutine read_steps(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      integer :: s, n, status

      n = ubound(deck%first_card, 1)
      allocate (model%steps(n), stat=status)
      call check_allocation(status)
      do s = 1, n
         call read_step(model, s, deck, error)
         if (allocated(error)) return
      end do
      call read_restarts(model, deck, error)
   end subroutine read_steps

   subroutine read_step(model, s, deck, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: s
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      type(step_type) :: step

      call read_head(step, model, s, deck, error)
      if (allocated(error)) return
      call read_boundaries(step%boundaries, model, deck, s, error)
      if (allocated(error)) return
      call read_initial_conditions(step%initial_displacements, step%initial_velocities, model, &
            deck, s, error)
      if (allocated(error)) return
      call read_loads(step%loads, model, deck, s, error)
      if (allocated(error)) return
      call read_distributed(step%gravity, step%distributed, model, deck, s, error)
      if (allocated(error)) return
      call read_base_motions(step%base_motions, model, deck, s, error)
      if (allocated(error)) return
      call read_op(step%new_boundaries, 'BOUNDARY', model, deck, s, error)
      if (allocated(error)) return
      call read_op(step%new_loads, 'CLOAD', model, deck, s, error)
      if (allocated(error)) return
      call read_op(step%new_gravity, 'DLOAD', model, deck, s, error)
      if (allocated(error)) return
      step%new_distributed = step%new_gravity
      if (step%procedure == procedure_frequency) then
         call check_frequency_step(step, model, s, deck, error)
         if (allocated(error)) return
      end if
      call check_one_order(step, model, s, error)
      if (allocated(error)) return
      model%steps(s) = step
      call read_requests(model, deck, s, error)
   end subroutine read_step

   !> *STEP itself and the one procedure card.
   subroutine read_head(step, model, s, deck, error)
      type(step_type), intent(inout) :: step
      type(model_type), intent(inout) :: model   !! gets notes
      integer, intent(in) :: s
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      integer :: i, n

      n = 0
      do i = deck%first_card(s), deck%last_card(s)
         if (deck%cards(i)%step /= s) cycle
         select case (deck%cards(i)%keyword)
         case ('STEP')
            step%place = deck%cards(i)%place
            call get_name_parameter(deck%cards(i), 'NAME', step%name, model%source, error)
            if (allocated(error)) return
            call get_integer_parameter(deck%cards(i), 'INC', 1, step%max_increments, &
                  model%source, error)
         case ('STATIC', 'DYNAMIC', 'FREQUENCY')
            n = n + 1
            call read_procedure(step, n, model, deck, deck%cards(i), error)
         case default
            cycle
         end select
         if (allocated(error)) return
      end do
      if (n == 0) call fail_at(error, model%source, step%place, 'this step has no procedure', &
            cure='add *DYNAMIC, DIRECT or *STATIC with its line dt, T, or *FREQUENCY')
   end subroutine read_head

   !> Mode shapes are those of the structure at rest: nothing loads or moves it.
   subroutine check_frequency_step(step, model, s, deck, error)
      type(step_type), intent(in) :: step
      type(model_type), intent(in) :: model
      integer, intent(in) :: s
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: loads(*) = [character(len=word_length) :: &
            'CLOAD', 'DLOAD', 'BASE MOTION', 'INITIAL CONDITIONS']
      integer :: i, k

      do i = deck%first_card(s), deck%last_card(s)
         if (deck%cards(i)%step /= s) cycle
         k = find_word(deck%cards(i)%keyword, loads)
         if (k == 0) cycle
         call fail_at(error, model%source, deck%cards(i)%place, 'a frequency step takes no *'// &
               trim(loads(k)), cure='remove the card; mode shapes depend on no load')
         return
      end do
      do i = 1, size(step%boundaries)
         if (abs(step%boundaries(i)%value) <= 0.0_wp .and. step%boundaries(i)%amplitude == 0) cycle
         call fail_at(error, model%source, step%boundaries(i)%place, &
               'a frequency step can fix freedoms, not move them', &
               cure='leave out the value and AMPLITUDE')
         return
      end do
   end subroutine check_frequency_step

   subroutine read_procedure(step, n, model, deck, card, error)
      type(step_type), intent(inout) :: step
      integer, intent(in) :: n   !! procedure cards of this step so far
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error

      if (n > 1) then
         call fail_at(error, model%source, card%place, 'this step has a procedure already', &
               cure='write one of *STATIC, *DYNAMIC and *FREQUENCY in a step')
         return
      end if
      step%procedure_place = card%place
      step%time_place = card%place
      step%direct = has_parameter(card, 'DIRECT')
      step%procedure = procedure_static
      call read_solver(step, model, card, error)
      if (allocated(error)) return
      if (card%keyword == 'FREQUENCY') then
         step%procedure = procedure_frequency
         call read_modes(step, deck, card, model%source, error)
         return
      end if
      if (card%keyword == 'DYNAMIC') then
         step%procedure = procedure_dynamic
         call read_dynamic(step, model, card, error)
         if (allocated(error)) return
      end if
      call read_times(step, deck, card, model%source, error)
   end subroutine read_procedure

   !> SOLVER; modes are found with skylines alone. Instead of a solver of CalculiX one is chosen.
   subroutine read_solver(step, model, card, error)
      type(step_type), intent(inout) :: step
      type(model_type), intent(inout) :: model
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: solvers(*) = [character(len=word_length) :: &
            'AUTO', 'SKYLINE', 'MUMPS']
      character(len=word_length), parameter :: of_calculix(*) = [character(len=word_length) :: &
            'SPOOLES', 'PASTIX', 'PARDISO', 'TAUCS', 'SGI', 'ITERATIVE SCALING', &
            'ITERATIVE CHOLESKY']
      integer :: choice, i

      i = parameter_index(card, 'SOLVER')
      if (i == 0) return
      step%solver_place = card%parameters(i)%place
      if (find_word(card%parameters(i)%value, of_calculix) > 0) then
         call add_note(model%notes, note_at(model%source, step%solver_place, 'SOLVER='// &
               trim(card%parameters(i)%value)//' is not part of carom: AUTO in its place'))
         return
      end if
      call get_word(card, 'SOLVER', solvers, choice, model%source, error)
      if (allocated(error)) return
      step%solver = choice
      if (step%solver == solver_mumps .and. card%keyword == 'FREQUENCY') call fail_at(error, &
            model%source, step%solver_place, 'frequencies are not found with MUMPS', &
            cure='write SOLVER=SKYLINE, or remove SOLVER')
   end subroutine read_solver

   !> The line of *FREQUENCY; the range, if given, begins at 0.
   subroutine read_modes(step, deck, card, source, error)
      type(step_type), intent(inout) :: step
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      real(wp) :: lowest

      call only_line(fields, deck, card, 3, source, error)
      if (allocated(error)) return
      call get_integer(fields, 1, 'number of modes', step%n_modes, source, error)
      if (allocated(error)) return
      step%time_place = fields%place
      if (step%n_modes < 1) then
         call fail_at(error, source, field_place(fields, 1), &
               'the number of modes must be positive', cure='the line is: '//usage_of(card%rule))
         return
      end if
      lowest = 0.0_wp
      if (is_given(fields, 2)) call get_real(fields, 2, 'lowest frequency', lowest, source, error)
      if (allocated(error)) return
      if (abs(lowest) > 0.0_wp) then
         call fail_at(error, source, field_place(fields, 2), &
               'modes are found from the lowest on: a range begins at 0', &
               cure='write 0 or nothing there, and a number of modes that reaches far enough')
         return
      end if
      if (.not. is_given(fields, 3)) return
      call get_real(fields, 3, 'highest frequency', step%highest_frequency, source, error)
      if (allocated(error)) return
      if (.not. step%highest_frequency > 0.0_wp) call fail_at(error, source, &
            field_place(fields, 3), 'the highest frequency must be positive', &
            cure='the line is: '//usage_of(card%rule))
   end subroutine read_modes

   !> dt, T; only a static step may lack the line, it has 1, 1 then. Without DIRECT also the
   !! smallest and the largest increment, 0 where the program is to choose.
   subroutine read_times(step, deck, card, source, error)
      type(step_type), intent(inout) :: step
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      real(wp) :: times(4)

      if (card%last < card%first) then
         step%dt = 1.0_wp
         step%duration = 1.0_wp
         return
      end if
      call only_line(fields, deck, card, 4, source, error)
      if (allocated(error)) return
      call get_reals(fields, 1, 2, 'dt, T', times, source, error)
      if (allocated(error)) return
      step%dt = times(1)
      step%duration = times(2)
      step%time_place = fields%place
      if (step%dt <= 0.0_wp) then
         call fail_at(error, source, field_place(fields, 1), 'the time step must be positive', &
               cure='a line is: dt, T')
      else if (step%duration < step%dt) then
         call fail_at(error, source, field_place(fields, 2), &
               'the duration must not be shorter than the time step', cure='a line is: dt, T')
      else if (step%direct .and. step%duration/huge(1) > step%dt) then
         call fail_at(error, source, field_place(fields, 1), &
               'the duration takes too many steps', cure='a run has up to 2147483647 steps')
      else
         step%dt_min = times(3)
         step%dt_max = times(4)
         call check_limits(step, fields, source, error)
      end if
   end subroutine read_times

   !> dt min <= dt <= dt max, of automatic increments only.
   subroutine check_limits(step, fields, source, error)
      type(step_type), intent(in) :: step
      type(fields_type), intent(in) :: fields
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=*), parameter :: line = &
            'a line is: dt, T[, dt min, dt max] with dt between them'

      if (step%direct .and. fields%n > 2) then
         call fail_at(error, source, field_place(fields, 3), &
               'too many fields: at most 2 here, DIRECT means that all increments are dt', &
               cure='write dt, T, or remove DIRECT')
      else if (step%dt_min < 0.0_wp .or. step%dt_min > step%dt) then
         call fail_at(error, source, field_place(fields, 3), &
               'the smallest increment must be between 0 and dt', cure=line)
      else if (step%dt_max < 0.0_wp .or. (step%dt_max > 0.0_wp .and. step%dt_max < step%dt)) then
         call fail_at(error, source, field_place(fields, 4), &
               'the largest increment must not be below dt', cure=line)
      else if (step%dt_max > 0.0_wp .and. step%duration/huge(1) > step%dt_max) then
         call fail_at(error, source, field_place(fields, 4), &
               'the duration takes too many increments of this size', &
               cure='a run has up to 2147483647 increments')
      end if
   end subroutine check_limits

   !> OP=NEW on the cards of a keyword; all of one step must agree.
   subroutine read_op(is_new, keyword, model, deck, s, error)
      logical, intent(out) :: is_new
      character(len=*), intent(in) :: keyword
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: s
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: ops(*) = [character(len=word_length) :: 'MOD', 'NEW']
      integer :: i, n, choice

      is_new = .false.
      n = 0
      do i = deck%first_card(s), deck%last_card(s)
         if (deck%cards(i)%step /= s .or. deck%cards(i)%keyword /= keyword) cycle
         call get_word(deck%cards(i), 'OP', ops, choice, model%source, error)
         if (allocated(error)) return
         n = n + 1
         if (n > 1 .and. (is_new .neqv. choice == 2)) then
            call fail_at(error, model%source, parameter_place(deck%cards(i), 'OP'), &
                  'the *'//keyword//' cards of a step must have the same OP', &
                  cure='write OP=NEW on all of them or on none')
            return
         end if
         is_new = choice == 2
      end do
   end subroutine read_op

end module step_reader
