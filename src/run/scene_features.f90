!> What a scene switches on: element groups, solver, supports, contact, records, energies; how large
!> each is and what it takes of the time of an increment and of the memory. The time is estimated by
!> counting: entries of the profile that a solution reads, numbers of an element matrix that a force
!> multiplies, points where stresses are updated, contact rows, values recorded.
module scene_features
   use kinds, only: wp
   use text, only: to_text, plural
   use mesh, only: scheme_implicit
   use element_types, only: kind_name
   use element_groups, only: group_type
   use skyline_matrix, only: profile_entries, profile_cost
   use steps, only: step_type, procedure_frequency, solver_mumps
   use surfaces, only: method_fictitious_force, method_penalty, method_lagrange
   use prescribed_motion, only: are_at_rest
   use scene_setup, only: simulation_type
   use increment_count, only: count_increments
   use structure, only: is_explicit
   use element_cost, only: iterations, group_seconds, pass_seconds
   use memory_estimate, only: memory_type, item_frames, item_rows, item_contact, item_matrices, &
         state_bytes
   use output_plan, only: plan_type
   use output_cost, only: output_cost_type, new_output_cost, bytes_text
   implicit none
   private

   public :: feature_type, feature_list_type, list_features, share_memory
   public :: kind_elements, kind_solution, kind_contact, kind_history, kind_frames, kind_energies, &
         kind_rest

   integer, parameter :: kind_elements = 1, kind_solution = 2, kind_supports = 3, &
         kind_contact = 4, kind_history = 5, kind_frames = 6, kind_energies = 7, kind_rest = 8, &
         kind_states = 9
   integer, parameter :: most_features = 64

   !> Seconds on a processor of today, each found by a run that does little else.
   real(wp), parameter :: profile_entry = 1.3e-9_wp      !! in a solution
   real(wp), parameter :: factor_operation = 1.0_wp/27.0e9_wp
   real(wp), parameter :: freedom_implicit = 25.0e-9_wp  !! vectors of an increment
   real(wp), parameter :: freedom_explicit = 3.0e-9_wp
   real(wp), parameter :: bare_increment = 1.5e-6_wp
   real(wp), parameter :: open_row = 0.1e-6_wp
   real(wp), parameter :: searched_row = 3.0e-6_wp       !! its partner looked for three times

   !> One thing that is switched on.
   type :: feature_type
      integer :: kind = 0                        !! one of the kind_ parameters
      character(len=:), allocatable :: name, size
      real(wp) :: seconds = 0.0_wp               !! of an increment
      real(wp) :: bytes = 0.0_wp
   end type feature_type

   !> All of a step.
   type :: feature_list_type
      integer :: step = 0
      integer :: n = 0
      type(feature_type) :: items(most_features)
      real(wp) :: increments = 0.0_wp            !! of the step, none where it has modes
      type(output_cost_type) :: output
   contains
      procedure :: total
   end type feature_list_type

contains

   !> The features of a step that is in force.
   subroutine list_features(self, simulation, i_step, plan)
      type(feature_list_type), intent(out) :: self
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step
      type(plan_type), intent(in) :: plan        !! what is recorded
      real(wp) :: freedoms

      self%step = i_step
      associate (step => simulation%model%steps(i_step))
         if (step%procedure /= procedure_frequency) self%increments &
               = real(count_increments(step), wp)
         call new_output_cost(self%output, simulation, step, self%increments, plan)
         call add_elements(self, simulation, step)
         call add_solution(self, simulation, step)
         call add_supports(self, simulation)
         call add_pairs(self, simulation)
         call add_output(self, simulation)
      end associate
      freedoms = freedom_implicit
      if (is_explicit(simulation%scene%system%structure)) freedoms = freedom_explicit
      call add(self, kind_rest, 'vectors and the rest', &
            plural(simulation%scene%system%structure%map%n_freedoms, 'freedom') &
            //', the model and the program', bare_increment + freedoms &
            *real(simulation%scene%system%structure%map%n_freedoms, wp))
   end subroutine list_features

   !> Seconds of the whole step.
   pure real(wp) function total(self)
      class(feature_list_type), intent(in) :: self

      total = self%increments*sum(self%items(:self%n)%seconds)
   end function total

   !> Shares the memory out to features, contact by its rows; the rest is the model's.
   subroutine share_memory(self, memory)
      type(feature_list_type), intent(inout) :: self
      type(memory_type), intent(in) :: memory

      associate (items => self%items(:self%n))
         items%bytes = 0.0_wp
         where (items%kind == kind_solution) items%bytes = memory%items(item_matrices)
         where (items%kind == kind_history) items%bytes = memory%items(item_rows)
         where (items%kind == kind_frames) items%bytes = memory%items(item_frames)
         where (items%kind == kind_contact) items%bytes = memory%items(item_contact) &
               *items%seconds/sum(items%seconds, mask=items%kind == kind_contact)
         where (items%kind == kind_rest) items%bytes = max(0.0_wp, memory%total() &
               - sum(items%bytes))
      end associate
   end subroutine share_memory

   subroutine add(self, kind, name, size, seconds)
      type(feature_list_type), intent(inout) :: self
      integer, intent(in) :: kind
      character(len=*), intent(in) :: name, size
      real(wp), intent(in) :: seconds

      if (self%n == most_features) return
      self%n = self%n + 1
      associate (item => self%items(self%n))
         item%kind = kind
         item%name = name
         item%size = size
         item%seconds = seconds
      end associate
   end subroutine add

   !> Groups, those that differ in nothing said here together.
   subroutine add_elements(self, simulation, step)
      type(feature_list_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(step_type), intent(in) :: step
      integer, dimension(size(simulation%scene%system%structure%groups)) :: first, n
      real(wp) :: seconds(size(first))
      integer :: g, k, n_sorts
      logical :: linear

      n = 0
      seconds = 0.0_wp
      n_sorts = 0
      associate (groups => simulation%scene%system%structure%groups)
         linear = simulation%scene%system%structure%is_linear
         do g = 1, size(groups)
            do k = 1, n_sorts
               if (are_alike(groups(first(k)), groups(g))) exit
            end do
            if (k > n_sorts) first(k) = g
            n_sorts = max(n_sorts, k)
            n(k) = n(k) + size(groups(g)%member)
            seconds(k) = seconds(k) + group_seconds(groups(g), step, linear)
         end do
         do k = 1, n_sorts
            call add(self, kind_elements, to_text(n(k))//' '//name_of(groups(first(k))), &
                  traits_of(groups(first(k)), simulation%scene%system%static), seconds(k))
         end do
      end associate
   end subroutine add_elements

   pure logical function are_alike(one, other)
      type(group_type), intent(in) :: one, other

      are_alike = one%kind == other%kind .and. one%scheme == other%scheme .and. &
            (one%lumped .eqv. other%lumped) .and. &
            (one%element%linear .eqv. other%element%linear) .and. &
            (size(one%damping) > 0 .eqv. size(other%damping) > 0)
   end function are_alike

   pure function name_of(group) result(name)
      type(group_type), intent(in) :: group
      character(len=:), allocatable :: name

      name = kind_name(group%kind)
      if (.not. group%resists) return
      name = trim(merge('implicit', 'explicit', group%scheme == scheme_implicit))//' '//name
   end function name_of

   !> "consistent mass, damped, plastic".
   pure function traits_of(group, static) result(traits)
      type(group_type), intent(in) :: group
      logical, intent(in) :: static
      character(len=:), allocatable :: traits

      traits = ''
      if (.not. static .and. group%element%n_points > 0) traits = ', '//trim(merge( &
            'lumped mass    ', 'consistent mass', group%lumped))
      if (size(group%damping) > 0) traits = traits//', damped'
      if (group%element%n_history > 0) then
         traits = traits//', plastic'
      else if (.not. group%element%linear) then
         traits = traits//', nonlinear'
      end if
      traits = traits(min(len(traits) + 1, 3):)
   end function traits_of

   !> Solutions of an increment, and its part of the factorizations.
   subroutine add_solution(self, simulation, step)
      type(feature_list_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(step_type), intent(in) :: step
      character(len=:), allocatable :: text
      real(wp) :: n_factorizations, n_solutions, seconds

      associate (system => simulation%scene%system)
         if (is_explicit(system%structure) .and. profile_entries(system%profile) &
               == system%profile%n) then
            call add(self, kind_solution, 'diagonal mass', &
                  plural(system%profile%n, 'equation')//', no matrix is factorized', 0.0_wp)
            return
         end if
         n_factorizations = 1.0_wp
         n_solutions = max(1.0_wp, self%increments)
         if (.not. system%structure%is_linear) then
            n_solutions = iterations*n_solutions
            n_factorizations = n_solutions
         else if (system%structure%has_consistent_mass .and. .not. system%static) then
            n_factorizations = 2.0_wp
         end if
         text = 'skyline'
         if (system%matrices%choice%taken == solver_mumps) text = 'sparse, MUMPS'
         text = plural(system%profile%n, 'equation')//', '//text//' of ' &
               //to_text(real(profile_entries(system%profile), wp), 3)//' numbers, factorized ' &
               //times(n_factorizations)
         seconds = (n_factorizations*factor_operation*profile_cost(system%profile) &
               + n_solutions*profile_entry*real(profile_entries(system%profile), wp)) &
               /max(1.0_wp, self%increments)
         if (step%order == 4) seconds = 4.0_wp*seconds
      end associate
      call add(self, kind_solution, 'solution', text, seconds)
   end subroutine add_solution

   pure function times(n) result(text)
      real(wp), intent(in) :: n
      character(len=:), allocatable :: text

      text = to_text(n, 3)//' times'
      if (n < 1.5_wp) text = 'once'
      if (n > 1.5_wp .and. n < 2.5_wp) text = 'twice'
   end function times

   !> Freedoms held or moved, constraints. Where supports move, their work wants the forces of all
   !> elements at both ends of an increment.
   subroutine add_supports(self, simulation)
      type(feature_list_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      character(len=:), allocatable :: text
      real(wp) :: seconds
      integer :: n_held
      logical :: at_rest

      associate (system => simulation%scene%system, state => simulation%motion%motion)
         n_held = count(system%structure%map%prescribed)
         seconds = 0.0_wp
         text = ''
         if (n_held > 0) then
            at_rest = are_at_rest(system%motions, state%d, state%v, state%a)
            text = ', '//plural(n_held, 'freedom')//trim(merge(' held           ', &
                  ' held or moving ', at_rest))
            if (.not. at_rest) seconds = 2.0_wp*pass_seconds(system%structure)
         end if
         if (size(system%structure%map%dependent) > 0) text = text//', ' &
               //plural(size(system%structure%map%dependent), 'linear constraint')
      end associate
      if (len(text) > 0) call add(self, kind_supports, 'supports', text(3:), seconds)
   end subroutine add_supports

   !> Contact pairs and gap elements, while they are open.
   subroutine add_pairs(self, simulation)
      type(feature_list_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      integer :: p, n
      real(wp) :: seconds

      associate (list => simulation%contact, rows => simulation%scene%rows)
         do p = 1, size(list%names)
            if (self%n == most_features) exit
            n = count(list%rows%pair == p)
            if (n == 0) cycle
            seconds = open_row
            if (any(list%rows%pair == p .and. list%rows%model_pair > 0) .and. rows%moving) then
               seconds = seconds + searched_row
            end if
            call add(self, kind_contact, 'contact '//trim(list%names(p)), &
                  contact_text(simulation, p, n), seconds*real(n, wp))
         end do
      end associate
   end subroutine add_pairs

   !> "11 rows, transformation, friction".
   function contact_text(simulation, p, n) result(text)
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: p, n                !! index of the pair, its rows
      character(len=:), allocatable :: text

      associate (scene => simulation%scene, own => simulation%contact%rows%pair == p)
         text = plural(n, 'row')//', '
         select case (scene%settings%method)
         case (method_fictitious_force)
            text = text//'fictitious force'
         case (method_penalty)
            text = text//'penalty'
         case (method_lagrange)
            text = text//'Lagrange multipliers'
         case default
            text = text//'transformation'
         end select
         if (any(scene%rows%friction > 0.0_wp .and. own)) text = text//', friction'
         if (any(scene%rows%massless .and. own)) text = text//', nodes without mass'
         if (scene%rows%moving) text = text//', partners searched for'
      end associate
   end function contact_text

   subroutine add_output(self, simulation)
      type(feature_list_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      real(wp) :: seconds

      associate (output => self%output)
         if (output%n_columns > 0) call add(self, kind_history, 'history', &
               plural(output%n_columns, 'column')//every(output%print_every), &
               output%row_seconds/output%print_every)
         call add(self, kind_frames, 'frames', output%fields//', ' &
               //plural(int(min(output%n_frames, 2.0e9_wp)), 'frame')//' of ' &
               //bytes_text(output%frame_bytes), output%frame_seconds*output%n_frames &
               /max(1.0_wp, self%increments))
         call add_states(self, simulation)
         if (.not. output%energies) return
         seconds = energy_passes(simulation)*pass_seconds(simulation%scene%system%structure)
         call add(self, kind_energies, 'energies', 'of the whole' &
               //several(size(simulation%scene%system%structure%groups)) &
               //every(output%energy_every), seconds/output%energy_every)
      end associate
   end subroutine add_output

   !> States for a restart. Their writing is put off where it would take more than a twentieth of
   !> the time.
   subroutine add_states(self, simulation)
      type(feature_list_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation

      associate (step => simulation%model%steps(self%step))
         if (step%restart_frequency == 0) return
         call add(self, kind_states, 'restart', 'states of '//bytes_text(state_bytes(simulation)) &
               //every(real(step%restart_frequency, wp)), 0.0_wp)
      end associate
   end subroutine add_states

   !> Passes over the elements for their energies: explicit steps find them on their way; those of
   !> several groups are found by themselves.
   pure real(wp) function energy_passes(simulation)
      type(simulation_type), intent(in) :: simulation

      energy_passes = 1.0_wp
      if (is_explicit(simulation%scene%system%structure)) energy_passes = 0.0_wp
      if (size(simulation%scene%system%structure%groups) > 1) energy_passes = energy_passes + 2.0_wp
   end function energy_passes

   pure function several(n) result(text)
      integer, intent(in) :: n
      character(len=:), allocatable :: text

      text = ''
      if (n > 1) text = ' and of '//to_text(n)//' groups'
   end function several

   pure function every(frequency) result(text)
      real(wp), intent(in) :: frequency
      character(len=:), allocatable :: text

      text = ', every increment'
      if (frequency > 1.5_wp) text = ', every '//to_text(frequency)//' increments'
   end function every

end module scene_features
