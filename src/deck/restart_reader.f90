!> `*RESTART, WRITE`: how often a run keeps a state that `--restart` goes on from.
module restart_reader
   use errors, only: error_type
   use places, only: fail_at
   use model, only: model_type
   use cards, only: deck_type, card_type, get_integer_parameter, has_parameter, parameter_place
   implicit none
   private

   public :: read_restarts

contains

   !> The card of each step; a step without one goes on as the step before.
   subroutine read_restarts(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      logical :: given(size(model%steps))
      integer :: i, s

      given = .false.
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword /= 'RESTART') cycle
         call check_restart(model, deck%cards(i), given, error)
         if (allocated(error)) return
         s = deck%cards(i)%step
         given(s) = .true.
         model%steps(s)%restart_frequency = 1
         call get_integer_parameter(deck%cards(i), 'FREQUENCY', 1, &
               model%steps(s)%restart_frequency, model%source, error)
         if (allocated(error)) return
      end do
      do s = 2, size(model%steps)
         if (.not. given(s)) model%steps(s)%restart_frequency = &
               model%steps(s - 1)%restart_frequency
      end do
   end subroutine read_restarts

   !> WRITE in a step, once; READ is a matter of the command line.
   subroutine check_restart(model, card, given, error)
      type(model_type), intent(in) :: model
      type(card_type), intent(in) :: card
      logical, intent(in) :: given(:)            !! by steps: there was a card before
      type(error_type), allocatable, intent(out) :: error

      if (has_parameter(card, 'READ')) then
         call fail_at(error, model%source, parameter_place(card, 'READ'), &
               '*RESTART, READ is not a matter of the deck', cure='remove the card and start ' &
               //'with: carom run DECK --restart OLD.h5')
      else if (has_parameter(card, 'STEP') .or. has_parameter(card, 'INC')) then
         call fail_at(error, model%source, card%place, 'STEP and INC of *RESTART belong to READ', &
               cure='write *RESTART, WRITE, FREQUENCY=n; the last state is kept')
      else if (.not. has_parameter(card, 'WRITE')) then
         call fail_at(error, model%source, card%place, '*RESTART needs the parameter WRITE', &
               cure='write *RESTART, WRITE, FREQUENCY=n')
      else if (card%step == 0) then
         call fail_at(error, model%source, card%place, '*RESTART, WRITE must stand inside a step', &
               cure='move it between *STEP and *END STEP')
      else if (given(card%step)) then
         call fail_at(error, model%source, card%place, 'this step has a *RESTART already', &
               cure='keep one of the two')
      end if
   end subroutine check_restart

end module restart_reader
