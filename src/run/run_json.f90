!> What `run --json` says of a run: as the summary in the log, with all digits.
module run_json
   use kinds, only: wp
   use json_text, only: json_type
   use memory_use, only: resident_memory
   use cost_account, only: n_phases, phase_names
   use scene_setup, only: simulation_type
   use scene_advice, only: advice_list_type
   use step_tally, only: tally_type, count_names, n_counts, energy_names, n_energies, energies_of
   use run_report, only: procedure_name
   use run_summary, only: event_kinds, event_names, n_event_kinds
   use run_output, only: output_type
   use json_report, only: put_model, put_notices, put_advice, put_optional
   implicit none
   private

   public :: describe_run

contains

   !> All of it, as far as the run has got.
   subroutine describe_run(report, simulation, output, lessons)
      type(json_type), intent(inout) :: report
      type(simulation_type), intent(in) :: simulation
      type(output_type), intent(in) :: output
      type(advice_list_type), intent(in) :: lessons   !! of the run
      integer :: i

      associate (scene => simulation%scene)
         call put_model(report, simulation%model, scene%system%structure%map%n_freedoms, &
               size(scene%system%structure%groups), scene%rows%n)
         call put_optional(report, 'log', output%log%name)
         call report%put('has_results', output%results%has_records)
         call report%put('goes_on', output%tally%goes_on)
         call report%put('time', simulation%motion%motion%t)
         call put_steps(report, simulation, output%tally)
         call report%open_object('events')
         do i = 1, n_event_kinds
            call report%put(trim(event_names(i)), simulation%n_events(event_kinds(i)))
         end do
         call report%close()
         call report%put('most_touching', simulation%most_touching)
         call put_energies(report, simulation, output%tally)
         call put_memory(report, output)
         call put_times(report, simulation)
      end associate
      call put_notices(report, output%log%notices)
      call put_advice(report, [output%preview%advice, lessons])
   end subroutine describe_run

   subroutine put_steps(report, simulation, tally)
      type(json_type), intent(inout) :: report
      type(simulation_type), intent(in) :: simulation
      type(tally_type), intent(in) :: tally
      integer :: i, k

      call report%open_list('steps')
      do i = 1, size(tally%seconds)
         call report%open_object('')
         call report%put('step', i)
         call report%put('procedure', procedure_name(simulation%model%steps(i)%procedure))
         call report%put('name', trim(simulation%model%steps(i)%name))
         do k = 1, n_counts
            call report%put(trim(count_names(k)), tally%counts(k, i))
         end do
         call report%put('seconds', tally%seconds(i))
         call report%close()
      end do
      call report%close()
      associate (cost => simulation%scene%system%cost)
         call report%put('element_updates', cost%element_updates)
         call report%put('energy_updates', cost%energy_updates)
         call report%put('stress_updates', cost%stress_updates)
         call report%put('contact_searches', simulation%scene%geometry%n_searches)
      end associate
   end subroutine put_steps

   subroutine put_energies(report, simulation, tally)
      type(json_type), intent(inout) :: report
      type(simulation_type), intent(in) :: simulation
      type(tally_type), intent(in) :: tally

      associate (ledger => simulation%scene%ledger)
         call report%open_object('energies')
         call put_kinds('start', tally%at_start)
         call put_kinds('end', energies_of(ledger))
         call report%put('end_time', ledger%time)
         call report%put('largest', ledger%scale)
         call report%close()
         call report%put('balance_error', ledger%balance_error)
      end associate

   contains

      subroutine put_kinds(name, energies)
         character(len=*), intent(in) :: name
         real(wp), intent(in) :: energies(n_energies)
         integer :: i

         call report%open_object(name)
         do i = 1, n_energies
            call report%put(trim(energy_names(i)), energies(i))
         end do
         call report%close()
      end subroutine put_kinds

   end subroutine put_energies

   !> Bytes: most resident, as estimated before the run.
   subroutine put_memory(report, output)
      type(json_type), intent(inout) :: report
      type(output_type), intent(in) :: output
      real(wp) :: now, most

      call resident_memory(now, most)
      call report%open_object('memory')
      call report%put('peak', most)
      call report%put('estimate', output%preview%memory%total())
      call report%close()
   end subroutine put_memory

   !> Seconds, by phases and all.
   subroutine put_times(report, simulation)
      type(json_type), intent(inout) :: report
      type(simulation_type), intent(in) :: simulation
      integer :: i

      associate (cost => simulation%scene%system%cost)
         call report%open_object('seconds')
         do i = 1, n_phases
            call report%put(trim(phase_names(i)), cost%seconds(i))
         end do
         call report%put('elapsed', cost%elapsed)
         call report%put('processor', cost%processor)
         call report%close()
      end associate
   end subroutine put_times

end module run_json
