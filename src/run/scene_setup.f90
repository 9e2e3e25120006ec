!> From the model to a scene that can be computed, step by step, with all checks before increments.
module scene_setup
   use kinds, only: wp, int64
   use errors, only: error_type
   use text, only: to_text, plural
   use memory_shortage, only: check_allocation
   use places, only: fail_at, note_at, source_line_type
   use model, only: model_type
   use mesh, only: scheme_implicit, scheme_explicit
   use steps, only: step_type, procedure_static, procedure_dynamic, procedure_frequency
   use histories, only: boundary_type, nodal_value_type, motion_acceleration
   use structure, only: structure_type, new_structure, diagonal_mass, inertia_force
   use equation_order, only: ordering_type, order_equations
   use external_load, only: begin_loads, add_reactions
   use prescribed_motion, only: begin_motions, start_motions, prescribed_freedoms
   use equation_of_motion, only: system_type, impose
   use solver_setup, only: begin_matrices
   use critical_step, only: critical_type
   use critical_check, only: check_critical, find_both
   use contact_pairs, only: contact_pair_list_type
   use impact_scene, only: scene_type, contact_motion_type, new_contact_motion
   use initial_contact, only: adjustment_type, build_rows, adjust_pairs, adjustment_remark
   use initial_overlap, only: check_overlaps, check_jump
   use impact_method, only: impact_method_type
   use increment_count, only: count_increments, check_remainder
   use massless_contacts, only: mark_massless_rows
   use named_freedoms, only: check_named_freedoms
   use friction_line, only: check_friction
   use automatic_groups, only: partition_type, resolve_automatic
   use impact_factory, only: make_impact_method, check_method, check_anchor
   use order_check, only: check_order
   implicit none
   private

   public :: simulation_type, build_scene, begin_step, meet_conditions, initial_motion, add_remark

   !> All that a run computes with.
   type :: simulation_type
      type(model_type) :: model
      type(scene_type) :: scene
      type(contact_pair_list_type) :: contact
      class(impact_method_type), allocatable :: method
      type(contact_motion_type) :: motion
      type(critical_type) :: critical(2)         !! of the implicit and explicit elements, this step
      type(partition_type) :: partition          !! what SCHEME=AUTO chose
      integer, allocatable :: deck_scheme(:)     !! (n_groups) as the deck has it
      type(source_line_type), allocatable :: remarks(:)
      type(ordering_type) :: ordering            !! of the equations, this step
      logical, allocatable :: held(:)            !! (n_freedoms) prescribed when they were ordered
      integer, allocatable :: ordered_scheme(:)  !! (n_groups) at that time
      real(wp) :: critical_gamma = -1.0_wp       !! for which `critical` holds, -1 for none
      integer(int64) :: n_events(5) = 0          !! by event_ kinds, over the whole run
      integer :: touching = 0                    !! rows in contact now
      integer :: most_touching = 0               !! at once so far
      logical, allocatable :: has_met(:)         !! by contact pairs
   end type simulation_type

contains

   !> Structure, contact rows and impact method from the model in `self`; initial motion.
   subroutine build_scene(self, error)
      type(simulation_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      self%remarks = self%model%notes
      call new_structure(self%scene%system%structure, self%model, error)
      if (allocated(error)) return
      call build_rows(self%model, self%contact, self%scene, error)
      if (allocated(error)) return
      if (any(self%model%pairs%adjust)) call adjust_geometry(self, error)
      if (allocated(error)) return
      call resolve_automatic(self%model, self%scene%system%structure, self%partition, error)
      if (allocated(error)) return
      self%deck_scheme = self%scene%system%structure%groups%scheme
      call make_impact_method(self%model, self%contact, self%method, self%scene%settings, error)
      if (allocated(error)) return
      self%scene%impulse = [(0.0_wp, i=1, self%scene%rows%n)]
      self%scene%curvature = self%scene%impulse
      self%has_met = [(.false., i=1, size(self%contact%names))]
      call note_idle_conditions(self)
      call check_named_freedoms(self%model, self%scene%system%structure%map%freedom, error)
      if (allocated(error)) return
      call check_friction(self%model, self%contact, self%scene%rows, &
            self%scene%system%structure%map%freedom, error)
      if (allocated(error)) return
      call initial_motion(self, error)
   end subroutine build_scene

   !> ADJUST: nodes moved, the structure built anew where they are now.
   subroutine adjust_geometry(self, error)
      type(simulation_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      type(adjustment_type), allocatable :: adjustments(:)
      integer :: i

      call set_initial_motion(self)
      call adjust_pairs(self%model, self%contact, self%scene, self%motion%motion, adjustments, &
            error)
      if (allocated(error)) return
      do i = 1, size(adjustments)
         call add_remark(self, adjustment_remark(self%model, self%contact, adjustments(i)))
      end do
      if (all(adjustments%n_moved == 0)) return
      call new_structure(self%scene%system%structure, self%model, error)
      if (allocated(error)) error%message = error%message//new_line('a') &
            //'  (after ADJUST has moved nodes by up to ' &
            //to_text(maxval(adjustments%largest_move))//': place the bodies closer by hand)'
   end subroutine adjust_geometry

   !> Appends a remark for the log.
   subroutine add_remark(self, remark)
      type(simulation_type), intent(inout) :: self
      character(len=*), intent(in) :: remark
      type(source_line_type), allocatable :: longer(:)
      integer :: i, n, status

      n = size(self%remarks)
      do i = 1, n
         if (self%remarks(i)%text == remark) return
      end do
      allocate (longer(n + 1), stat=status)
      call check_allocation(status)
      longer(:n) = self%remarks
      longer(n + 1)%text = remark
      call move_alloc(longer, self%remarks)
   end subroutine add_remark

   !> A boundary condition without a freedom is noted.
   subroutine note_idle_conditions(self)
      type(simulation_type), intent(inout) :: self
      integer :: i

      call note_idle_boundaries(self, self%model%boundaries)
      do i = 1, size(self%model%steps)
         call note_idle_boundaries(self, self%model%steps(i)%boundaries)
      end do
   end subroutine note_idle_conditions

   subroutine note_idle_boundaries(self, boundaries)
      type(simulation_type), intent(inout) :: self
      type(boundary_type), intent(in) :: boundaries(:)
      integer :: i, first, n

      n = 0
      do i = size(boundaries), 1, -1
         if (self%scene%system%structure%map%freedom(boundaries(i)%dof, &
               boundaries(i)%node) > 0) cycle
         n = n + 1
         first = i
      end do
      if (n > 0) call add_remark(self, note_at(self%model%source, boundaries(first)%place, &
            plural(n, 'condition')//' from here on where nothing can move; accepted'))
   end subroutine note_idle_boundaries

   !> Initial displacements and velocities of the model; an overlap at the start is an error.
   subroutine initial_motion(self, error)
      type(simulation_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error

      call set_initial_motion(self)
      call check_overlaps(self%model, self%contact, self%scene, self%motion%motion, error)
   end subroutine initial_motion

   subroutine set_initial_motion(self)
      type(simulation_type), intent(inout) :: self

      associate (structure => self%scene%system%structure)
         call new_contact_motion(self%motion, structure%map%n_freedoms, self%scene%rows%n, &
               structure%n_history)
         call put_values(structure, self%model%initial_displacements, self%motion%motion%d)
         call put_values(structure, self%model%initial_velocities, self%motion%motion%v)
      end associate
   end subroutine set_initial_motion

   subroutine put_values(structure, values, vector)
      type(structure_type), intent(in) :: structure
      type(nodal_value_type), intent(in) :: values(:)
      real(wp), intent(inout) :: vector(:)
      integer :: i, f

      do i = 1, size(values)
         f = structure%map%freedom(values(i)%dof, values(i)%node)
         if (f > 0) vector(f) = values(i)%value
      end do
   end subroutine put_values

   !> Brings a step into force: conditions, loads, equations, profile, parameters. Of the motion
   !> only the time counts, and velocities are given to it: a deck that is looked through, and a run
   !> that is restored, have not moved. Errors: explicit step over the critical one, explicit
   !> freedoms without mass.
   subroutine begin_step(self, i_step, error)
      type(simulation_type), intent(inout) :: self
      integer, intent(in) :: i_step
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: held_before(:)
      real(wp) :: t

      t = self%motion%motion%t
      if (allocated(self%held)) held_before = self%held
      call check_procedures(self, i_step, error)
      if (allocated(error)) return
      call check_increments(self, i_step, error)
      if (allocated(error)) return
      associate (step => self%model%steps(i_step), system => self%scene%system)
         system%static = step%procedure /= procedure_dynamic
         system%newmark%gamma = step%gamma
         system%newmark%beta = step%beta
         system%newmark%alpha = step%alpha
         system%structure%groups%scheme = self%deck_scheme
         ! without time there is nothing to be explicit in
         if (system%static) system%structure%groups%scheme = scheme_implicit
         if (step%explicit) system%structure%groups%scheme = scheme_explicit
         call begin_conditions(self, i_step, t)
         call number_anew(self)
         call begin_matrices(system, step, self%model%source, error)
         if (allocated(error)) return
         call find_massless(system)
         self%scene%explicit%ready = .false.
         call begin_loads(system%loads, system%structure, self%model, i_step, t)
         if (step%procedure == procedure_static .and. allocated(held_before)) then
            if (any(held_before .and. .not. self%held)) call add_reactions(system%loads, &
                  size(self%held), step%duration, t)
         end if
         if (system%static) return
         ! the deck's initial velocities wait for the first dynamic step
         if (all(self%model%steps(:i_step - 1)%procedure == procedure_static)) call put_values( &
               system%structure, self%model%initial_velocities, self%motion%motion%v)
         call put_values(system%structure, step%initial_velocities, self%motion%motion%v)
         call check_frequencies(self, step, error)
         if (allocated(error)) return
         call note_driven_mass(self, step)
         call mark_massless_rows(self%model, self%contact, system, self%scene%rows, error)
         if (allocated(error)) return
         call check_method(self%model, self%scene%settings, step, system%newmark%beta, error)
         if (allocated(error)) return
         call check_remainder(self%model, self%scene%settings, step, error)
         if (allocated(error)) return
         call check_order(self%model, self%scene, step, error)
         if (allocated(error)) return
         call check_anchor(self%model, self%scene, step, error)
      end associate
   end subroutine begin_step

   !> Moves what is prescribed to where a dynamic step in force wants it. The motion must be the
   !> real one, that which the run has at this time: a node that jumps into its partner is an error.
   subroutine meet_conditions(self, error)
      type(simulation_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: before(:)

      if (self%scene%system%static) return
      before = self%motion%motion%d
      call impose(self%scene%system, self%motion%motion)
      call check_jump(self%model, self%contact, self%scene, before, self%motion%motion, error)
   end subroutine meet_conditions

   !> Orders the equations, unless nothing has changed that they depend on.
   subroutine number_anew(self)
      type(simulation_type), intent(inout) :: self
      logical :: held(self%scene%system%structure%map%n_freedoms)

      associate (system => self%scene%system)
         held = prescribed_freedoms(system%motions, size(held))
         if (allocated(self%held)) then
            if (all(self%held .eqv. held) .and. &
                  all(self%ordered_scheme == system%structure%groups%scheme)) return
         end if
         call order_equations(system%structure, held, self%model%equations, system%profile, &
               self%ordering)
         self%held = held
         self%ordered_scheme = system%structure%groups%scheme
         self%critical_gamma = -1.0_wp
      end associate
   end subroutine number_anew

   !> The frames of a frequency step have frequencies for times: no other step may follow, and none
   !> before it but static ones.
   subroutine check_procedures(self, i_step, error)
      type(simulation_type), intent(inout) :: self
      integer, intent(in) :: i_step
      type(error_type), allocatable, intent(out) :: error

      associate (steps => self%model%steps)
         if (steps(i_step)%procedure /= procedure_frequency) return
         if (i_step < size(steps) .or. any(steps(:i_step - 1)%procedure /= procedure_static)) then
            call fail_at(error, self%model%source, steps(i_step)%place, &
                  'a frequency step stands alone or last after *STATIC steps', &
                  'take the frequencies in a deck of their own')
         else if (self%scene%rows%n > 0) then
            call add_remark(self, note_at(self%model%source, steps(i_step)%procedure_place, &
                  'contact does not take part in free vibrations: all gaps count as open'))
         end if
      end associate
   end subroutine check_procedures

   !> INC must allow all increments of the step.
   subroutine check_increments(self, i_step, error)
      type(simulation_type), intent(in) :: self
      integer, intent(in) :: i_step
      type(error_type), allocatable, intent(out) :: error

      associate (step => self%model%steps(i_step))
         if (step%max_increments == 0 .or. .not. step%direct) return
         if (step%procedure == procedure_frequency) return
         if (count_increments(step) <= step%max_increments) return
         call fail_at(error, self%model%source, step%place, 'the step needs ' &
               //to_text(count_increments(step))//' increments, INC allows ' &
               //to_text(step%max_increments), &
               'raise INC, or take larger increments')
      end associate
   end subroutine check_increments

   subroutine begin_conditions(self, i_step, t)
      type(simulation_type), intent(inout) :: self
      integer, intent(in) :: i_step
      real(wp), intent(in) :: t
      type(boundary_type), allocatable :: boundaries(:)
      real(wp) :: span(2)

      associate (step => self%model%steps(i_step), system => self%scene%system)
         boundaries = step%boundaries
         if (i_step == 1 .and. .not. step%new_boundaries) boundaries = [ &
               self%model%boundaries, step%boundaries]
         span = [t, merge(1.0_wp, step%duration, step%procedure == procedure_frequency)]
         call begin_motions(system%motions, boundaries, system%structure%map%freedom, &
               self%model%amplitudes, .not. step%new_boundaries, span, system%static)
         call start_motions(system%motions, t, self%motion%motion%d, self%motion%motion%v)
      end associate
   end subroutine begin_conditions

   !> Equations without mass: they have no acceleration of their own.
   subroutine find_massless(system)
      type(system_type), intent(inout) :: system
      integer :: f, i
      real(wp), allocatable :: m(:)

      system%massless = [(.true., i=1, system%structure%map%n_eq)]
      m = diagonal_mass(system%structure)
      associate (map => system%structure%map)
         do f = 1, map%n_freedoms
            if (.not. m(f) > 0.0_wp) cycle
            do i = map%first(f), map%first(f + 1) - 1
               system%massless(map%equation(i)) = .false.
            end do
         end do
      end associate
   end subroutine find_massless

   !> A displacement or velocity that goes from point to point of an amplitude has no acceleration
   !> but jumps of the velocity, and what has consistent mass beside it does not feel those.
   subroutine note_driven_mass(self, step)
      type(simulation_type), intent(inout) :: self
      type(step_type), intent(in) :: step
      real(wp), dimension(self%scene%system%structure%map%n_freedoms) :: driven, inertia
      integer :: i, first

      if (.not. self%scene%system%structure%has_consistent_mass) return
      first = 0
      driven = 0.0_wp
      associate (map => self%scene%system%structure%map, boundaries => step%boundaries)
         do i = size(boundaries), 1, -1
            if (boundaries(i)%amplitude == 0 .or. boundaries(i)%motion == motion_acceleration) cycle
            if (map%freedom(boundaries(i)%dof, boundaries(i)%node) == 0) cycle
            driven(map%freedom(boundaries(i)%dof, boundaries(i)%node)) = 1.0_wp
            first = i
         end do
         if (first == 0) return
         inertia = inertia_force(self%scene%system%structure, driven)
         if (.not. any(abs(inertia) > 0.0_wp .and. .not. map%prescribed)) return
         call add_remark(self, note_at(self%model%source, boundaries(first)%place, 'warning: ' &
               //'displacements or velocities driven by an amplitude have no acceleration, and ' &
               //'their neighbours with consistent mass miss its inertia'//new_line('a') &
               //'  cure: TYPE=ACCELERATION, or MASS=LUMPED'))
      end associate
   end subroutine note_driven_mass

   !> Highest frequencies of the step, and whether its length is within what they allow.
   subroutine check_frequencies(self, step, error)
      type(simulation_type), intent(inout) :: self
      type(step_type), intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      type(source_line_type), allocatable :: notes(:)
      integer :: i

      call find_both(self%scene%system, step%gamma, self%critical_gamma, self%critical)
      call check_critical(self%model, self%scene, step, self%critical, notes, error)
      if (allocated(error)) return
      do i = 1, size(notes)
         call add_remark(self, notes(i)%text)
      end do
   end subroutine check_frequencies

end module scene_setup
