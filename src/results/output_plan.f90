!> Which results a deck asks for, over all its steps together.
module output_plan
   use, intrinsic :: iso_c_binding, only: c_bool
   use memory_shortage, only: check_allocation
   use model, only: model_type
   use steps, only: request_type, n_quantities, procedure_frequency, request_node_print, &
         request_element_print, request_contact_print, request_energy_print, quantity_cf, &
         quantity_cdis, quantity_cpress, quantity_cslip, quantity_cstate, is_frame_request
   implicit none
   private

   public :: plan_type, new_plan, is_due

   !> What is recorded of each node, element and pair; a byte each.
   type :: plan_type
      logical(c_bool), allocatable :: node_print(:, :)      !! (n_quantities, n_nodes)
      logical(c_bool), allocatable :: element_print(:, :)   !! (n_quantities, n_elements)
      logical :: contact_print(n_quantities) = .false.
      logical :: file(n_quantities) = .false.       !! fields of the grid
      logical :: energy = .false.
      logical :: modes_only = .false.               !! a frequency step has the grid to itself
   end type plan_type

contains

   !> Gathers the requests of all steps. Contact forces come with pressures (printed: the number
   !> of touching nodes), gaps with slip and state.
   subroutine new_plan(self, model)
      type(plan_type), intent(out) :: self
      type(model_type), intent(in) :: model
      integer :: s, r, status

      allocate (self%node_print(n_quantities, model%nodes%n), stat=status)
      call check_allocation(status)
      allocate (self%element_print(n_quantities, model%elements%n), stat=status)
      call check_allocation(status)
      self%node_print = .false._c_bool
      self%element_print = .false._c_bool
      self%modes_only = any(model%steps%procedure == procedure_frequency)
      do s = 1, size(model%steps)
         do r = 1, size(model%steps(s)%requests)
            ! frames of modes have nothing of what other steps ask for
            if (self%modes_only .and. model%steps(s)%procedure /= procedure_frequency .and. &
                  is_frame_request(model%steps(s)%requests(r))) cycle
            call add_request(self, model, model%steps(s)%requests(r))
         end do
      end do
   end subroutine new_plan

   subroutine add_request(self, model, request)
      type(plan_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(request_type), intent(in) :: request
      integer :: i

      select case (request%kind)
      case (request_node_print)
         do i = 1, n_quantities
            if (.not. request%wanted(i)) cycle
            if (request%set == 0) then
               self%node_print(i, :) = .true._c_bool
            else
               self%node_print(i, model%node_sets(request%set)%members) = .true._c_bool
            end if
         end do
      case (request_element_print)
         do i = 1, n_quantities
            if (.not. request%wanted(i)) cycle
            if (request%set == 0) then
               self%element_print(i, :) = .true._c_bool
            else
               self%element_print(i, model%element_sets(request%set)%members) = .true._c_bool
            end if
         end do
      case (request_contact_print)
         self%contact_print = self%contact_print .or. request%wanted
         if (request%wanted(quantity_cf)) self%contact_print(quantity_cstate) = .true.
         if (request%wanted(quantity_cdis)) self%contact_print(quantity_cslip) = .true.
      case (request_energy_print)
         self%energy = .true.
      case default
         self%file = self%file .or. request%wanted
         if (request%wanted(quantity_cf)) self%file(quantity_cpress) = .true.
         if (request%wanted(quantity_cdis)) self%file([quantity_cslip, quantity_cstate]) = .true.
      end select
   end subroutine add_request

   !> Whether some request of the given kinds asks for this increment of its step.
   pure function is_due(requests, kinds, increment, last) result(due)
      type(request_type), intent(in) :: requests(:)
      integer, intent(in) :: kinds(:)            !! request_ parameters
      integer, intent(in) :: increment
      logical, intent(in) :: last                !! the last increment of a step is always recorded
      logical :: due
      integer :: i

      due = .false.
      do i = 1, size(requests)
         if (.not. any(kinds == requests(i)%kind)) cycle
         due = due .or. last .or. modulo(increment, requests(i)%frequency) == 0
      end do
   end function is_due

end module output_plan
