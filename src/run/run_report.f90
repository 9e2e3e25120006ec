!> What the log says of a model and its steps.
module run_report
   use kinds, only: wp, int64
   use display, only: displayed
   use text, only: to_text, plural
   use places, only: source_type
   use mesh, only: scheme_implicit, scheme_explicit
   use steps, only: procedure_static, procedure_dynamic, procedure_frequency
   use skyline_matrix, only: profile_entries
   use equation_order, only: ordering_type, order_names, n_orders
   use model, only: model_type
   use surfaces, only: beta_given, contact_pair_type, rigid_plane, method_fictitious_force, &
         method_penalty, method_lagrange
   use transformation, only: impact_beta
   use stability_limit, only: stable_frequency
   use automatic_groups, only: partition_type
   use increment_count, only: count_increments
   use scene_setup, only: simulation_type
   use program_version, only: version_text
   use run_log, only: log_type, say, remark
   implicit none
   private

   public :: report_model, report_step, report_notes, procedure_name

contains

   !> Heading, sizes, contact pairs.
   subroutine report_model(simulation, log)
      type(simulation_type), intent(in) :: simulation
      type(log_type), intent(in) :: log

      call say(log, 'carom '//version_text())
      if (len_trim(simulation%model%heading) > 0) call say(log, trim(simulation%model%heading))
      call report_files(simulation%model%source, log)
      call say(log, 'model: '//plural(simulation%model%nodes%n, 'node')//', ' &
            //plural(simulation%model%elements%n, 'element')//' in ' &
            //plural(size(simulation%scene%system%structure%groups), 'group')//', ' &
            //plural(simulation%scene%system%structure%map%n_freedoms, 'freedom')//', ' &
            //plural(simulation%scene%rows%n, 'contact row'))
      call report_pairs(simulation, log)
      if (simulation%partition%n_elements > 0) call report_partition(simulation%partition, log)
   end subroutine report_model

   !> The files that were read, of very many the first.
   subroutine report_files(source, log)
      type(source_type), intent(in) :: source
      type(log_type), intent(in) :: log
      integer, parameter :: most = 100
      integer :: i

      do i = 1, min(source%n_files, most)
         associate (file => source%files(i))
            call say(log, trim(merge('included:', 'deck:    ', file%included%line > 0))//' ' &
                  //displayed(file%name)//', '//plural(file%n_lines, 'line')//', ' &
                  //plural(len(file%content), 'byte'))
         end associate
      end do
      if (source%n_files > most) call say(log, 'included: ' &
            //plural(source%n_files - most, 'further file'))
   end subroutine report_files

   !> What SCHEME=AUTO chose, and what it saves.
   subroutine report_partition(partition, log)
      type(partition_type), intent(in) :: partition
      type(log_type), intent(in) :: log

      call say(log, 'SCHEME=AUTO at the step '//to_text(partition%dt)//': ' &
            //to_text(partition%n_explicit)//' of '//plural(partition%n_elements, 'element') &
            //' explicit, '//to_text(partition%n_elements - partition%n_explicit)//' implicit')
      call say(log, '  profile '//to_text(partition%entries(1))//' entries instead of ' &
            //to_text(partition%entries(2))//' if all were implicit, factorization ' &
            //to_text(partition%cost(1), 3)//' operations instead of ' &
            //to_text(partition%cost(2), 3))
   end subroutine report_partition

   !> Procedure, equations, profile, groups, critical step, impact method.
   subroutine report_step(simulation, i_step, log)
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step
      type(log_type), intent(in) :: log
      character(len=:), allocatable :: line
      integer(int64) :: entries

      associate (step => simulation%model%steps(i_step), system => simulation%scene%system)
         line = 'step '//to_text(i_step)//': '//procedure_name(step%procedure)
         if (len_trim(step%name) > 0) line = line//' '//trim(step%name)
         if (step%procedure == procedure_frequency) then
            call say(log, line//', '//plural(step%n_modes, 'mode'))
         else if (step%direct) then
            call say(log, line//', '//plural(count_increments(step), 'increment')//' of ' &
                  //to_text(step%dt)//' over '//to_text(step%duration))
         else
            call say(log, line//', automatic increments from '//to_text(step%dt)//' on over ' &
                  //to_text(step%duration))
         end if
         entries = profile_entries(system%profile)
         call say(log, '  '//plural(system%structure%map%n_eq, 'equation')//', profile ' &
               //to_text(entries)//' entries ('//to_text(8.0e-6_wp*real(entries, wp), 3)//' MB)')
         call report_ordering(simulation%ordering, log)
         if (len(system%matrices%choice%text) > 0) call say(log, '  '//system%matrices%choice%text)
         if (.not. system%static) call report_dynamics(simulation, log)
      end associate
   end subroutine report_step

   pure function procedure_name(procedure) result(name)
      integer, intent(in) :: procedure
      character(len=:), allocatable :: name

      select case (procedure)
      case (procedure_static)
         name = 'static'
      case (procedure_dynamic)
         name = 'dynamic'
      case default
         name = 'frequency'
      end select
   end function procedure_name

   !> Profile and factorization cost of each order that was tried.
   subroutine report_ordering(ordering, log)
      type(ordering_type), intent(in) :: ordering
      type(log_type), intent(in) :: log
      character(len=:), allocatable :: line
      integer :: i

      if (.not. ordering%compared) return
      line = '  order of the equations: '//trim(order_names(ordering%taken))//' (profile, cost: '
      do i = 1, n_orders
         if (i > 1) line = line//'; '
         line = line//trim(order_names(i))//' '//to_text(ordering%entries(i))//', ' &
               //to_text(ordering%cost(i), 3)
      end do
      call say(log, line//')')
   end subroutine report_ordering

   subroutine report_dynamics(simulation, log)
      type(simulation_type), intent(in) :: simulation
      type(log_type), intent(in) :: log
      character(len=:), allocatable :: line
      integer :: n_explicit, g

      n_explicit = 0
      associate (system => simulation%scene%system)
         do g = 1, size(system%structure%groups)
            if (system%structure%groups(g)%scheme /= scheme_explicit) cycle
            n_explicit = n_explicit + size(system%structure%groups(g)%member)
         end do
         line = '  Newmark gamma '//to_text(system%newmark%gamma)//', beta ' &
               //to_text(system%newmark%beta)
         if (abs(system%newmark%alpha) > 0.0_wp) line = line//', HHT alpha ' &
               //to_text(system%newmark%alpha)
         if (simulation%scene%settings%fourth_order) line = "  Gauss' method in two stages, " &
               //'order 4; a complex factorization or solution counts as four'
         call say(log, line)
         if (n_explicit > 0) call say(log, '  '//plural(n_explicit, 'explicit element') &
               //', critical step '//to_text(simulation%critical(scheme_explicit)%step))
         associate (omega => simulation%critical(scheme_implicit)%omega, &
               limit => stable_frequency(system%newmark))
            if (omega > 0.0_wp) then
               line = '  highest implicit frequency at most '//to_text(omega)//' rad/time'
               if (limit < huge(limit)) line = line//', stable up to a step of ' &
                     //to_text(limit/omega)
               call say(log, line)
            end if
         end associate
      end associate
      call report_impact(simulation, log)
   end subroutine report_dynamics

   !> The method of impacts; one run has one.
   subroutine report_impact(simulation, log)
      type(simulation_type), intent(in) :: simulation
      type(log_type), intent(in) :: log
      character(len=:), allocatable :: line

      if (simulation%scene%rows%n == 0) return
      associate (settings => simulation%scene%settings)
         select case (settings%method)
         case (method_fictitious_force)
            line = 'fictitious force, return parameter '//to_text(settings%return_parameter)
            if (settings%direct) line = line//', fixed point solved directly'
         case (method_penalty)
            associate (k => simulation%scene%rows%stiffness)
               line = 'penalty, stiffness '//to_text(minval(k))
               if (maxval(k) > minval(k)) line = line//' to '//to_text(maxval(k))
            end associate
         case (method_lagrange)
            line = 'Lagrange multipliers, velocities corrected at the ends of steps'
         case default
            if (settings%fourth_order) then
               line = 'transformation, order 4: stepped to every impact anew'
            else if (settings%anchored) then
               line = 'transformation, steps of one size that begin at events'
            else
               line = 'transformation, beta of the impact step ' &
                     //to_text(impact_beta(simulation%scene))//' ('//trim(merge( &
                     'given           ', 'that of the step', &
                     settings%beta_choice == beta_given))//')'
            end if
         end select
      end associate
      call say(log, '  impact: '//line)
   end subroutine report_impact

   !> Each contact pair: who faces whom, and how they behave.
   subroutine report_pairs(simulation, log)
      type(simulation_type), intent(in) :: simulation
      type(log_type), intent(in) :: log
      character(len=:), allocatable :: line
      integer :: p

      associate (model => simulation%model)
         do p = 1, size(model%pairs)
            associate (pair => model%pairs(p), interaction => &
                  model%interactions(model%pairs(p)%interaction))
               line = 'contact pair '//trim(model%surfaces(pair%contactor)%name)//': '
               line = line//plural(size(model%surfaces(pair%contactor)%nodes), 'slave node') &
                     //' on '//partner_of(model, pair)//kind_of(pair)
               if (interaction%friction > 0.0_wp) line = line//', friction ' &
                     //to_text(interaction%friction)
               call say(log, line)
            end associate
         end do
      end associate
   end subroutine report_pairs

   !> The partner of a pair's slave, in words.
   pure function partner_of(model, pair) result(text)
      type(model_type), intent(in) :: model
      type(contact_pair_type), intent(in) :: pair
      character(len=:), allocatable :: text

      if (pair%target == 0) then
         text = 'circle '
         if (model%rigid_surfaces(pair%rigid_target)%kind == rigid_plane) text = 'plane '
         text = 'the rigid '//text//trim(model%rigid_surfaces(pair%rigid_target)%name)
      else if (pair%target == pair%contactor) then
         text = 'its own '//plural(size(model%surfaces(pair%target)%edges, 2), 'edge')
      else
         text = plural(size(model%surfaces(pair%target)%edges, 2), 'edge')//' of ' &
               //trim(model%surfaces(pair%target)%name)
      end if
   end function partner_of

   pure function kind_of(pair) result(text)
      type(contact_pair_type), intent(in) :: pair
      character(len=:), allocatable :: text

      text = ''
      if (pair%target > 0) text = ', node to surface'
      if (pair%weighted) text = ', surface to surface'
      if (pair%passes == 2) text = text//' both ways'
      if (pair%small_sliding) text = text//', small sliding'
      if (pair%redistributed) text = text//', contact nodes without mass'
   end function kind_of

   !> Notes on the deck and its steps.
   subroutine report_notes(simulation, log)
      type(simulation_type), intent(in) :: simulation
      type(log_type), intent(inout) :: log
      integer :: i

      do i = 1, size(simulation%remarks)
         call remark(log, simulation%remarks(i)%text)
      end do
   end subroutine report_notes

end module run_report
