!> The parameters of `*DYNAMIC`: time integration, and what goes together.
module dynamic_reader
   use kinds, only: wp
   use errors, only: error_type
   use places, only: source_type, fail_at
   use steps, only: step_type
   use mesh, only: element_mass, element_gap, element_line, scheme_explicit, mass_consistent
   use model, only: model_type
   use cards, only: card_type, get_real_parameter, parameter_place, has_parameter
   use order_reader, only: read_order
   use text, only: to_text
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: read_dynamic

contains

   !> The integration parameters of *DYNAMIC.
   subroutine read_dynamic(step, model, card, error)
      type(step_type), intent(inout) :: step
      type(model_type), intent(in) :: model
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      real(wp), parameter :: third = 1.0_wp/3.0_wp, slack = 1.0e-12_wp

      step%explicit = has_parameter(card, 'EXPLICIT')
      call read_order(step, model%source, card, error)
      if (allocated(error)) return
      call read_tolerance(step, model%source, card, error)
      if (allocated(error)) return
      call get_real_parameter(card, 'ALPHA', step%alpha, model%source, error)
      if (allocated(error)) return
      if (step%alpha < -third - epsilon(third) .or. step%alpha > 0.0_wp) then
         call fail_at(error, model%source, parameter_place(card, 'ALPHA'), &
               'ALPHA is out of range', cure='write a number from -1/3 to 0')
         return
      end if
      step%gamma = 0.5_wp - step%alpha
      call get_real_parameter(card, 'GAMMA', step%gamma, model%source, error)
      if (allocated(error)) return
      step%beta = 0.25_wp*(0.5_wp + step%gamma)**2
      if (step%explicit) step%beta = 0.0_wp
      call get_real_parameter(card, 'BETA', step%beta, model%source, error)
      if (allocated(error)) return
      if (step%gamma < 0.5_wp) then
         call fail_at(error, model%source, parameter_place(card, 'GAMMA'), &
               'GAMMA below 1/2 is unstable', cure='write GAMMA >= 0.5')
      else if (step%gamma < 0.5_wp - step%alpha - slack) then
         call fail_at(error, model%source, parameter_place(card, 'GAMMA'), &
               'GAMMA below 1/2 - ALPHA is unstable', &
               cure='remove GAMMA, or write at least '//to_text(0.5_wp - step%alpha))
      else if (step%beta < 0.0_wp .or. step%beta > 0.5_wp) then
         call fail_at(error, model%source, parameter_place(card, 'BETA'), &
               'BETA is out of range', cure='write a number from 0 to 0.5')
      else
         call check_schemes(step, model, card, error)
      end if
   end subroutine read_dynamic

   !> TOLERANCE, and what goes with automatic increments.
   subroutine read_tolerance(step, source, card, error)
      type(step_type), intent(inout) :: step
      type(source_type), intent(in) :: source
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error

      call get_real_parameter(card, 'TOLERANCE', step%tolerance, source, error)
      if (allocated(error)) return
      if (step%explicit .and. .not. step%direct) then
         call fail_at(error, source, parameter_place(card, 'EXPLICIT'), &
               'automatic increments are for implicit steps', cure='write DIRECT, EXPLICIT')
      else if (.not. has_parameter(card, 'TOLERANCE')) then
         return
      else if (step%direct) then
         call fail_at(error, source, parameter_place(card, 'TOLERANCE'), &
               'TOLERANCE means nothing with DIRECT', cure='remove TOLERANCE, or DIRECT')
      else if (step%tolerance <= 0.0_wp) then
         call fail_at(error, source, parameter_place(card, 'TOLERANCE'), &
               'TOLERANCE must be positive', cure='write a number above 0, such as 1e-3')
      end if
   end subroutine read_tolerance

   !> beta = 0 and explicit elements belong together.
   subroutine check_schemes(step, model, card, error)
      type(step_type), intent(in) :: step
      type(model_type), intent(in) :: model
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      integer :: e

      if (step%explicit) then
         if (step%beta > 0.0_wp) then
            call fail_at(error, model%source, parameter_place(card, 'BETA'), &
                  'EXPLICIT means beta = 0', cure='remove BETA, or EXPLICIT')
         else if (abs(step%alpha) > 0.0_wp) then
            call fail_at(error, model%source, parameter_place(card, 'ALPHA'), &
                  'ALPHA means nothing with EXPLICIT', cure='remove ALPHA, or EXPLICIT')
         else if (any(model%groups%mass == mass_consistent)) then
            call fail_at(error, model%source, parameter_place(card, 'EXPLICIT'), &
                  'an element group has MASS=CONSISTENT, explicit steps need lumped masses', &
                  cure='write MASS=LUMPED, or remove EXPLICIT')
         end if
      else if (step%beta <= 0.0_wp) then
         e = first_implicit(model)
         if (e > 0) call fail_at(error, model%source, parameter_place(card, 'BETA'), &
               'beta = 0 with implicit elements: element '//to_text(model%elements%id(e)), &
               cure='write BETA > 0, or EXPLICIT, or put the elements into explicit groups')
         if (e == 0 .and. abs(step%alpha) > 0.0_wp) call fail_at(error, model%source, &
               parameter_place(card, 'ALPHA'), 'ALPHA with beta = 0 is unstable', &
               cure='remove ALPHA, or BETA')
      end if
   end subroutine check_schemes

   !> The first element with stiffness or damping that is in no explicit group, 0 if none is.
   pure function first_implicit(model) result(e)
      type(model_type), intent(in) :: model
      integer :: e
      logical, allocatable :: implicit_one(:)
      integer :: i, status

      allocate (implicit_one(model%elements%n), stat=status)
      call check_allocation(status)
      do e = 1, model%elements%n
         implicit_one(e) = all(model%elements%kind(e) /= [element_mass, element_gap, element_line])
      end do
      do i = 1, size(model%groups)
         if (model%groups(i)%scheme == scheme_explicit) then
            implicit_one(model%element_sets(model%groups(i)%set)%members) = .false.
         end if
      end do
      do e = 1, model%elements%n
         if (implicit_one(e)) return
      end do
      e = 0
   end function first_implicit

end module dynamic_reader
