!> What `check --json` says of a deck.
module check_json
   use kinds, only: wp, int64
   use json_text, only: json_type
   use mesh, only: scheme_implicit, scheme_explicit
   use steps, only: procedure_frequency
   use skyline_matrix, only: profile_entries
   use stability_limit, only: stable_frequency
   use increment_count, only: count_increments
   use scene_setup, only: simulation_type
   use memory_estimate, only: memory_type
   use scene_features, only: feature_list_type
   use scene_advice, only: advice_list_type
   use explanation_lines, only: lines_type
   use notices, only: notice_list_type
   use run_report, only: procedure_name
   use json_report, only: put_model, put_notices, put_advice
   implicit none
   private

   public :: step_facts_type, facts_of, describe_check, put_lines

   !> A step in force.
   type :: step_facts_type
      integer :: n_equations = 0
      integer(int64) :: n_entries = 0            !! of the profile
      integer :: n_explicit = 0                  !! elements
      real(wp) :: critical = 0.0_wp              !! step of the explicit elements, 0: there is none
      real(wp) :: stable = 0.0_wp                !! largest for implicit ones, 0: any
      real(wp) :: omega = 0.0_wp                 !! highest implicit frequency, 0: not known
   end type step_facts_type

contains

   !> Those of the step that is in force.
   function facts_of(simulation) result(facts)
      type(simulation_type), intent(in) :: simulation
      type(step_facts_type) :: facts
      real(wp) :: limit
      integer :: g

      associate (system => simulation%scene%system)
         facts%n_equations = system%structure%map%n_eq
         facts%n_entries = profile_entries(system%profile)
         do g = 1, size(system%structure%groups)
            if (system%structure%groups(g)%scheme == scheme_explicit) facts%n_explicit = &
                  facts%n_explicit + size(system%structure%groups(g)%member)
         end do
         if (system%static) return
         if (facts%n_explicit > 0) facts%critical = simulation%critical(scheme_explicit)%step
         facts%omega = simulation%critical(scheme_implicit)%omega
         limit = stable_frequency(system%newmark)
         if (facts%omega > 0.0_wp .and. limit < huge(limit)) facts%stable = limit/facts%omega
      end associate
   end function facts_of

   !> Model, steps, features, memory, advice, warnings.
   subroutine describe_check(report, simulation, facts, memory, limit, features, advice, notices)
      type(json_type), intent(inout) :: report
      type(simulation_type), intent(in) :: simulation
      type(step_facts_type), intent(in) :: facts(:)
      type(memory_type), intent(in) :: memory
      real(wp), intent(in) :: limit              !! bytes
      type(feature_list_type), intent(in) :: features
      type(advice_list_type), intent(in) :: advice
      type(notice_list_type), intent(in) :: notices
      integer :: i

      associate (structure => simulation%scene%system%structure)
         call put_model(report, simulation%model, structure%map%n_freedoms, &
               size(structure%groups), simulation%scene%rows%n)
      end associate
      call report%open_list('steps')
      do i = 1, size(facts)
         call put_step(report, simulation, i, facts(i))
      end do
      call report%close()
      call report%open_object('memory')
      call report%put('estimate', memory%total())
      call put_positive(report, 'limit', merge(limit, 0.0_wp, limit < huge(limit)))
      call report%close()
      call put_features(report, features)
      call put_advice(report, [advice])
      call put_notices(report, notices)
   end subroutine describe_check

   !> What `check --explain` prints.
   subroutine put_lines(report, lines)
      type(json_type), intent(inout) :: report
      type(lines_type), intent(in) :: lines
      integer :: i

      call report%open_list('explanation')
      do i = 1, lines%n
         call report%put('', trim(lines%lines(i)))
      end do
      call report%close()
   end subroutine put_lines

   subroutine put_step(report, simulation, i_step, facts)
      type(json_type), intent(inout) :: report
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step
      type(step_facts_type), intent(in) :: facts

      call report%open_object('')
      associate (step => simulation%model%steps(i_step))
         call report%put('step', i_step)
         call report%put('procedure', procedure_name(step%procedure))
         call report%put('name', trim(step%name))
         if (step%procedure == procedure_frequency) then
            call report%put('modes', step%n_modes)
         else
            call report%put('duration', step%duration)
            call report%put('dt', step%dt)
            if (step%direct) then
               call report%put('increments', count_increments(step))
            else
               call report%put_null('increments')
            end if
         end if
      end associate
      call report%put('equations', facts%n_equations)
      call report%put('profile', facts%n_entries)
      call report%put('explicit_elements', facts%n_explicit)
      call put_positive(report, 'critical_step', facts%critical)
      call put_positive(report, 'stable_step', facts%stable)
      call put_positive(report, 'highest_frequency', facts%omega)
      call report%close()
   end subroutine put_step

   !> Null where there is no such number.
   subroutine put_positive(report, name, value)
      type(json_type), intent(inout) :: report
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: value

      if (value > 0.0_wp .and. value < huge(value)) then
         call report%put(name, value)
      else
         call report%put_null(name)
      end if
   end subroutine put_positive

   !> What the dearest step switches on, with what it takes.
   subroutine put_features(report, features)
      type(json_type), intent(inout) :: report
      type(feature_list_type), intent(in) :: features
      integer :: i

      call report%open_object('features')
      call report%put('step', features%step)
      call report%open_list('items')
      do i = 1, features%n
         associate (item => features%items(i))
            call report%open_object('')
            call report%put('name', trim(item%name))
            call report%put('size', trim(item%size))
            call report%put('bytes', item%bytes)
            call report%put('seconds_an_increment', item%seconds)
            call report%close()
         end associate
      end do
      call report%close()
      call report%close()
   end subroutine put_features

end module check_json
