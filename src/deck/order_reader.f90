!> ORDER of `*DYNAMIC`: Newmark's method, of second order, or Gauss', of fourth.
module order_reader
   use errors, only: error_type
   use places, only: source_type, fail_at
   use steps, only: step_type, procedure_dynamic, solver_mumps
   use model, only: model_type
   use cards, only: card_type, get_integer_parameter, parameter_place, has_parameter
   use words, only: word_length
   implicit none
   private

   public :: read_order, check_one_order

contains

   !> ORDER: 2, Newmark's method, or 4, which takes no other parameter but DIRECT and SOLVER.
   subroutine read_order(step, source, card, error)
      type(step_type), intent(inout) :: step
      type(source_type), intent(in) :: source
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: others(*) = [character(len=word_length) :: &
            'EXPLICIT', 'GAMMA', 'BETA', 'ALPHA', 'TOLERANCE']
      integer :: i

      step%order_place = card%place
      if (.not. has_parameter(card, 'ORDER')) return
      step%order_place = parameter_place(card, 'ORDER')
      call get_integer_parameter(card, 'ORDER', 1, step%order, source, error)
      if (allocated(error)) return
      if (step%order /= 2 .and. step%order /= 4) then
         call fail_at(error, source, step%order_place, 'no scheme of this order', &
               cure='write ORDER=2, the default, or ORDER=4')
      else if (step%order == 2) then
         return
      else if (.not. step%direct) then
         call fail_at(error, source, step%order_place, &
               'ORDER=4 with automatic increments: it goes in increments of one size', &
               cure='write DIRECT, ORDER=4, or remove ORDER')
      else if (step%solver == solver_mumps) then
         call fail_at(error, source, step%solver_place, &
               'ORDER=4 has complex matrices, which MUMPS is not built in for', &
               cure='write SOLVER=SKYLINE, or remove SOLVER or ORDER')
      else
         do i = 1, size(others)
            if (.not. has_parameter(card, trim(others(i)))) cycle
            call fail_at(error, source, parameter_place(card, trim(others(i))), &
                  trim(others(i))//' means nothing with ORDER=4, which has no parameters', &
                  cure='remove it, or ORDER')
            return
         end do
      end if
   end subroutine read_order

   !> Impacts are treated in one way in all dynamic steps.
   subroutine check_one_order(step, model, s, error)
      type(step_type), intent(in) :: step
      type(model_type), intent(in) :: model
      integer, intent(in) :: s
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      if (step%procedure /= procedure_dynamic) return
      do i = 1, s - 1
         if (model%steps(i)%procedure /= procedure_dynamic) cycle
         if (model%steps(i)%order == step%order) return     ! as all before it
         call fail_at(error, model%source, step%order_place, &
               'dynamic steps of different ORDER', &
               cure='write the same ORDER on all *DYNAMIC cards')
         return
      end do
   end subroutine check_one_order

end module order_reader
