!> Makes the impact method that a deck asks for, and its settings.
module impact_factory
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use places, only: fail_at
   use model, only: model_type
   use steps, only: step_type, procedure_dynamic
   use surfaces, only: interaction_type, method_fictitious_force, method_penalty, method_lagrange
   use contact_pairs, only: contact_pair_list_type
   use mesh, only: scheme_explicit
   use constraint_rows, only: law_motion
   use impact_scene, only: impact_settings_type, scene_type
   use impact_method, only: impact_method_type
   use no_impact, only: no_impact_type
   use transformation, only: transformation_type
   use fourth_order_impacts, only: fourth_order_type
   use anchored_impacts, only: anchored_type
   use fictitious_force, only: fictitious_force_type
   use penalty_method, only: penalty_method_type
   use lagrange_multiplier, only: lagrange_multiplier_type
   implicit none
   private

   public :: make_impact_method, check_method, check_anchor

contains

   !> The method of the interactions in use; none without contact rows. One run has one method, one
   !> beta of the impact step, one limit of events and one return parameter.
   subroutine make_impact_method(model, list, method, settings, error)
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(in) :: list
      class(impact_method_type), allocatable, intent(out) :: method
      type(impact_settings_type), intent(out) :: settings
      type(error_type), allocatable, intent(out) :: error
      type(interaction_type) :: first
      integer :: i

      settings%fourth_order = any(model%steps%procedure == procedure_dynamic .and. &
            model%steps%order == 4)
      if (size(list%rows) == 0) then
         call allocate_method(0, settings, method)
         return
      end if
      first = model%interactions(list%rows(1)%interaction)
      do i = 2, size(list%rows)
         if (agree(first, model%interactions(list%rows(i)%interaction))) cycle
         call fail_at(error, model%source, model%interactions(list%rows(i)%interaction)%place, &
               'the interactions differ in METHOD, EVENTS, BETA, MAX EVENTS, RETURN or SOLUTION', &
               'one run has one of each; RESTITUTION and CAPTURE may differ')
         return
      end do
      settings%method = first%method
      settings%beta_choice = first%beta_choice
      settings%beta = first%beta
      settings%max_events = first%max_events
      settings%return_parameter = first%return_parameter
      settings%direct = first%direct
      settings%anchored = first%anchored
      settings%fictitious = first%method == method_fictitious_force
      settings%iterated = settings%fictitious .and. .not. &
            any(model%interactions(list%rows%interaction)%friction > 0.0_wp)
      settings%pure = settings%fictitious .and. .not. &
            all(model%interactions(list%rows%interaction)%has_restitution)
      call allocate_method(first%method, settings, method)
   end subroutine make_impact_method

   !> Of the type that does what is asked for.
   subroutine allocate_method(choice, settings, method)
      integer, intent(in) :: choice              !! method_ of the interactions, 0: no contact rows
      type(impact_settings_type), intent(in) :: settings
      class(impact_method_type), allocatable, intent(out) :: method
      integer :: status

      if (choice == method_fictitious_force) then
         allocate (fictitious_force_type :: method, stat=status)
         call check_allocation(status)
      else if (choice == method_penalty) then
         allocate (penalty_method_type :: method, stat=status)
         call check_allocation(status)
      else if (choice == method_lagrange) then
         allocate (lagrange_multiplier_type :: method, stat=status)
         call check_allocation(status)
      else if (settings%fourth_order) then
         allocate (fourth_order_type :: method, stat=status)
         call check_allocation(status)
      else if (choice == 0) then
         allocate (no_impact_type :: method, stat=status)
         call check_allocation(status)
      else if (settings%anchored) then
         allocate (anchored_type :: method, stat=status)
         call check_allocation(status)
      else
         allocate (transformation_type :: method, stat=status)
         call check_allocation(status)
      end if
   end subroutine allocate_method

   !> What a method cannot do in a step: the fictitious force of the end of an explicit step does
   !> not move that end; the pure method leaves an overlap that a much shorter step throws back.
   subroutine check_method(model, settings, step, beta, error)
      type(model_type), intent(in) :: model
      type(impact_settings_type), intent(in) :: settings
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: beta
      type(error_type), allocatable, intent(out) :: error

      if (.not. settings%fictitious .or. step%procedure /= procedure_dynamic) return
      if (.not. beta > 0.0_wp) then
         call fail_at(error, model%source, step%procedure_place, 'METHOD=FICTITIOUS FORCE in a ' &
               //'step with beta = 0: the force of its end does not move the end', &
               'take METHOD=TRANSFORMATION, or make elements implicit with *ELEMENT GROUP')
      else if (settings%pure .and. .not. step%direct) then
         call fail_at(error, model%source, step%procedure_place, 'METHOD=FICTITIOUS FORCE ' &
               //'without RESTITUTION in automatic increments: what overlap a long one leaves ' &
               //'a short one throws back', &
               'take *DYNAMIC, DIRECT, give a RESTITUTION, or another METHOD')
      end if
   end subroutine check_method

   !> Steps of one size that begin at events, and the cubic inside them, are for linear implicit
   !> elements, fixed increments and contact rows that stay as they are.
   subroutine check_anchor(model, scene, step, error)
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      type(step_type), intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: what

      if (.not. scene%settings%anchored .or. step%procedure /= procedure_dynamic) return
      if (.not. step%direct) then
         what = 'automatic increments'
      else if (.not. scene%system%structure%is_linear) then
         what = 'nonlinear elements'
      else if (any(scene%system%structure%groups%scheme == scheme_explicit)) then
         what = 'explicit elements'
      else if (scene%rows%moving) then
         what = 'bodies that slide on each other or on a circle'
      else if (any(scene%rows%amplitude > 0)) then
         what = 'a moving rigid surface'
      else if (any(scene%rows%law /= law_motion)) then
         what = 'contact nodes without mass'
      end if
      if (allocated(what)) call fail_at(error, model%source, step%procedure_place, &
            'EVENTS=ANCHOR cannot do with '//what, &
            'take EVENTS=SUBSTEP, the default, on *IMPACT')
   end subroutine check_anchor

   pure function agree(one, other) result(same)
      type(interaction_type), intent(in) :: one, other
      logical :: same

      same = one%method == other%method .and. one%beta_choice == other%beta_choice .and. &
            one%max_events == other%max_events .and. (one%anchored .eqv. other%anchored) .and. &
            (one%direct .eqv. other%direct) .and. &
            .not. abs(one%beta - other%beta) > 0.0_wp .and. &
            .not. abs(one%return_parameter - other%return_parameter) > 0.0_wp
   end function agree

end module impact_factory
