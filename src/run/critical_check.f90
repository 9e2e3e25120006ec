!> Whether a step is short enough for the highest frequencies: the critical step of explicit
!> elements, and the limit of implicit ones where Newmark's beta sets one.
module critical_check
   use kinds, only: wp
   use errors, only: error_type
   use text, only: to_text
   use memory_shortage, only: check_allocation
   use places, only: fail_at, note_at, source_line_type
   use model, only: model_type
   use mesh, only: scheme_implicit, scheme_explicit
   use steps, only: step_type
   use surfaces, only: beta_given, method_transformation
   use structure, only: structure_type, freedom_name
   use redistributed_mass, only: mark_contact_nodes
   use motion_state, only: newmark_type
   use stability_limit, only: stable_frequency
   use equation_of_motion, only: system_type
   use critical_step, only: critical_type, find_critical, reached_frequency
   use impact_scene, only: scene_type
   implicit none
   private

   public :: find_both, check_critical

   !> What round-off may make of a step that is just at its limit.
   real(wp), parameter :: slack = 1.0e-9_wp

contains

   !> What limits the implicit and the explicit elements, unless it is known already.
   subroutine find_both(system, gamma, known_for, critical)
      type(system_type), intent(inout) :: system
      real(wp), intent(in) :: gamma
      real(wp), intent(inout) :: known_for       !! gamma for which `critical` holds, -1 for none
      type(critical_type), intent(inout) :: critical(2)   !! of implicit and explicit elements

      if (abs(known_for - gamma) > 0.0_wp) then
         call find_critical(system%structure, scheme_implicit, gamma, critical(scheme_implicit))
         call find_critical(system%structure, scheme_explicit, gamma, critical(scheme_explicit))
         known_for = gamma
      end if
      system%omega_max = critical%omega
   end subroutine find_both

   !> Errors: a step over the critical one of explicit elements, or certainly over the limit of
   !> implicit ones; explicit freedoms without mass. Notes: a step that may be over it.
   subroutine check_critical(model, scene, step, critical, notes, error)
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      type(step_type), intent(in) :: step
      type(critical_type), intent(in) :: critical(2)
      type(source_line_type), allocatable, intent(out) :: notes(:)
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: culprit
      integer :: status

      allocate (notes(0), stat=status)
      call check_allocation(status)
      associate (structure => scene%system%structure, limit => critical(scheme_explicit))
         if (limit%massless_freedom > 0) then
            call fail_at(error, model%source, step%procedure_place, &
                  freedom_name(structure, limit%massless_freedom)//' is explicit and has no mass', &
                  cure_of_no_mass(model, structure%map%node(limit%massless_freedom)))
         else if (step%dt*(1.0_wp - slack) > limit%step) then
            culprit = ''
            if (limit%element > 0) culprit = ' of explicit element ' &
                  //to_text(model%elements%id(limit%element))
            call fail_at(error, model%source, step%time_place, 'the step '//to_text(step%dt) &
                  //' is over the critical step '//to_text(limit%step)//culprit, &
                  'take a step of at most '//to_text(0.9_wp*limit%step) &
                  //' (0.9 of the critical one), or make the element implicit with *ELEMENT GROUP')
         else if (step%dt > 0.95_wp*limit%step .and. scene%rows%n > 0) then
            call add_note(notes, note_at(model%source, step%time_place, &
                  'the step is within ' &
                  //'5 % of the critical step '//to_text(limit%step) &
                  //': contact then feeds the highest explicit mode, take 0.9 of it or less'))
         end if
         if (allocated(error)) return
         call check_implicit(model, scene, step, critical(scheme_implicit), notes, error)
         if (allocated(error)) return
         call check_impact_beta(model, scene, step, critical(scheme_implicit), notes)
      end associate
   end subroutine check_critical

   !> Newmark's limit of implicit elements, with beta below (gamma + 1/2)^2 / 4 perhaps finite: an
   !> error where the highest frequency is certainly over it, a note where it may be.
   subroutine check_implicit(model, scene, step, critical, notes, error)
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      type(step_type), intent(in) :: step
      type(critical_type), intent(in) :: critical
      type(source_line_type), allocatable, intent(inout) :: notes(:)
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: limit, sure
      character(len=:), allocatable :: over, cure

      if (.not. critical%omega <= huge(critical%omega)) then
         call fail_at(error, model%source, step%procedure_place, 'the highest frequency is not ' &
               //'finite'//element_of(model, critical)//': stiffness over mass overflows', &
               'give the model numbers that can be divided by each other: other units, more mass')
         return
      end if
      limit = stable_frequency(scene%system%newmark)
      if (critical%omega*step%dt*(1.0_wp - slack) <= limit) return
      sure = certain_frequency(scene%system, critical)
      over = ' is over the limit of beta = '//to_text(step%beta)//', ' &
            //to_text(limit, 4)//' / highest frequency = '
      cure = '; without BETA every step is stable'
      if (sure*step%dt*(1.0_wp - slack) > limit) then
         call fail_at(error, model%source, step%time_place, 'the step '//to_text(step%dt)//over &
               //to_text(limit/sure)//element_of(model, critical), &
               'take a step of at most '//to_text(limit/critical%omega)//cure)
      else
         call add_note(notes, note_at(model%source, step%time_place, 'warning: a step of ' &
               //to_text(step%dt)//' may be over the limit of beta = '//to_text(step%beta) &
               //': motion is stable for certain up to '//to_text(limit/critical%omega)//cure))
      end if
   end subroutine check_implicit

   !> A beta of the impact steps that grows the highest frequencies is let through, with a warning.
   subroutine check_impact_beta(model, scene, step, critical, notes)
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      type(step_type), intent(in) :: step
      type(critical_type), intent(in) :: critical
      type(source_line_type), allocatable, intent(inout) :: notes(:)
      type(newmark_type) :: newmark
      real(wp) :: limit

      associate (settings => scene%settings)
         if (scene%rows%n == 0 .or. settings%anchored) return
         if (settings%method /= method_transformation) return
         if (settings%beta_choice /= beta_given) return
         newmark = scene%system%newmark
         newmark%beta = settings%beta
      end associate
      limit = stable_frequency(newmark)
      if (critical%omega*step%dt*(1.0_wp - slack) <= limit) return
      call add_note(notes, note_at(model%source, step%time_place, &
            'warning: highest implicit frequency x step may reach ' &
            //to_text(critical%omega*step%dt, 4) &
            //', the beta of the impact step is stable up to '//to_text(limit, 4) &
            //': energy may grow at impacts; write BETA=AUTO, or take a smaller step'))
   end subroutine check_impact_beta

   !> A frequency that implicit motion certainly has; zero where that is not known: tangents vary,
   !> explicit elements take part, or damping raises the limit (as it does with gamma over 1/2).
   function certain_frequency(system, critical) result(omega)
      type(system_type), intent(in) :: system
      type(critical_type), intent(in) :: critical
      real(wp) :: omega

      omega = 0.0_wp
      if (.not. system%structure%is_linear) return
      if (any(system%structure%groups%scheme == scheme_explicit)) return
      if (critical%damping_rate > 0.0_wp .and. system%newmark%gamma > 0.5_wp) return
      omega = reached_frequency(system%structure, scheme_implicit)
   end function certain_frequency

   function element_of(model, critical) result(words)
      type(model_type), intent(in) :: model
      type(critical_type), intent(in) :: critical
      character(len=:), allocatable :: words

      words = ''
      if (critical%element > 0) words = ' (about element ' &
            //to_text(model%elements%id(critical%element))//')'
   end function element_of

   subroutine add_note(notes, text)
      type(source_line_type), allocatable, intent(inout) :: notes(:)
      character(len=*), intent(in) :: text
      type(source_line_type), allocatable :: longer(:)
      integer :: n, status

      n = size(notes)
      allocate (longer(n + 1), stat=status)
      call check_allocation(status)
      longer(:n) = notes
      longer(n + 1)%text = text
      call move_alloc(longer, notes)
   end subroutine add_note

   !> What helps an explicit node without mass.
   function cure_of_no_mass(model, node) result(cure)
      type(model_type), intent(in) :: model
      integer, intent(in) :: node
      character(len=:), allocatable :: cure
      logical :: contact(model%nodes%n)

      call mark_contact_nodes(model, contact)
      cure = 'give it a mass, or make its elements implicit with *ELEMENT GROUP'
      if (contact(node)) cure = 'MASS=REDISTRIBUTED takes the mass off contact nodes: make the ' &
            //'elements along the contact surfaces implicit with *ELEMENT GROUP, or leave it out'
   end function cure_of_no_mass

end module critical_check
