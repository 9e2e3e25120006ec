!> The run: steps and increments in time, with results, log and progress.
module simulation
   use kinds, only: wp, int64
   use errors, only: error_type, new_error, status_numerical
   use text, only: to_text
   use clock, only: seconds_now
   use steps, only: step_type, request_energy_print, procedure_frequency
   use motion_state, only: state_type
   use external_load, only: load_at
   use energy_ledger, only: ledger_type, open_ledger, close_increment
   use effective_matrix, only: mark_implicit
   use deck_reader, only: read_deck
   use impact_scene, only: contact_motion_type, accept_span
   use constrained_step, only: solve_statically
   use impact_jump, only: restart_acceleration
   use result_file, only: result_file_type, open_results, record_increment, close_results, &
         write_system, flush_results
   use command_line, only: command_type, version_text
   use run_log, only: log_type, open_log, close_log, say, write_status
   use progress, only: progress_type, start_progress, show_progress, end_progress
   use scene_setup, only: simulation_type, build_scene, begin_step, initial_motion, &
         count_increments, &
         last_increment, count_events
   use frequency_run, only: run_frequency_step
   use run_report, only: report_model, report_step, report_notes, report_summary
   implicit none
   private

   public :: run_deck, check_deck

   !> Results are brought to the disk at least this often, seconds.
   real(wp), parameter :: flush_interval = 5.0_wp

   !> What a run writes to.
   type :: output_type
      type(result_file_type) :: results
      type(log_type) :: log
      type(progress_type) :: progress
      real(wp) :: last_flush = 0.0_wp
      real(wp) :: end_time = 0.0_wp              !! total time at the end of the run
      integer(int64) :: iterations = 0           !! at the end of the last increment
   end type output_type

contains

   !> Reads the deck, builds every step once without running, and says what a run would do.
   subroutine check_deck(command, error)
      type(command_type), intent(in) :: command
      type(error_type), allocatable, intent(out) :: error
      type(simulation_type) :: simulation
      type(log_type) :: log

      call read_deck(simulation%model, command%deck, command%definitions, error)
      if (allocated(error)) return
      call prepare(simulation, log, .true., error)
      if (.not. allocated(error)) call say(log, 'the deck is sound')
   end subroutine check_deck

   !> Builds the scene and goes through all steps without time passing, for their errors.
   subroutine prepare(simulation, log, aloud, error)
      type(simulation_type), intent(inout) :: simulation
      type(log_type), intent(in) :: log
      logical, intent(in) :: aloud
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      call build_scene(simulation, error)
      if (allocated(error)) return
      if (aloud) call report_model(simulation, log)
      do i = 1, size(simulation%model%steps)
         call begin_step(simulation, i, error)
         if (allocated(error)) return
         if (aloud) call report_step(simulation, i, log)
         simulation%motion%motion%t = simulation%motion%motion%t &
               + simulation%model%steps(i)%duration
      end do
      if (aloud) call report_notes(simulation, log)
   end subroutine prepare

   !> A whole run. Files are made only after the deck has been found sound.
   subroutine run_deck(command, error)
      type(command_type), intent(in) :: command
      type(error_type), allocatable, intent(out) :: error
      type(simulation_type) :: simulation
      type(output_type) :: output
      type(error_type), allocatable :: close_error
      real(wp) :: started

      started = seconds_now()
      call read_deck(simulation%model, command%deck, command%definitions, error)
      if (allocated(error)) return
      call prepare(simulation, output%log, .false., error)
      if (allocated(error)) return
      output%end_time = simulation%motion%motion%t
      call rebuild(simulation, error)
      if (allocated(error)) return
      call open_log(output%log, stem_of(command%output), command%quiet, error)
      if (allocated(error)) return
      call run_steps(simulation, command, output, error)
      call end_progress(output%progress)
      call close_results(output%results, close_error)
      if (.not. allocated(error) .and. allocated(close_error)) call move_alloc(close_error, error)
      call report_summary(simulation, seconds_now() - started, output%log)
      call report_end(output%log, error)
      call close_log(output%log)
   end subroutine run_deck

   !> The last line of the log: how the run ended; what a message says beyond its first line, as the
   !> cure, goes before.
   subroutine report_end(log, error)
      type(log_type), intent(in) :: log
      type(error_type), allocatable, intent(in) :: error
      integer :: cut

      if (.not. allocated(error)) then
         call say(log, 'completed')
         return
      end if
      cut = index(error%message//new_line('a'), new_line('a'))
      if (cut < len(error%message)) call say(log, error%message(cut + 1:))
      call say(log, 'stopped: '//error%message(:cut - 1))
   end subroutine report_end

   !> Back to the start of the run after the rehearsal of its steps.
   subroutine rebuild(simulation, error)
      type(simulation_type), intent(inout) :: simulation
      type(error_type), allocatable, intent(out) :: error

      deallocate (simulation%scene%system%motions%motions, simulation%scene%system%loads%loads)
      call initial_motion(simulation, error)
   end subroutine rebuild

   !> The path without its ending.
   pure function stem_of(path) result(stem)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: stem
      integer :: dot

      dot = index(path, '.', back=.true.)
      if (dot <= index(path, '/', back=.true.) + 1) dot = len(path) + 1
      stem = path(:dot - 1)
   end function stem_of

   subroutine run_steps(simulation, command, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(command_type), intent(in) :: command
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      call report_model(simulation, output%log)
      call report_notes(simulation, output%log)
      call open_results(output%results, command%output, simulation%model, simulation%scene, &
            simulation%contact, error)
      if (allocated(error)) return
      call start_progress(output%progress, command%quiet)
      do i = 1, size(simulation%model%steps)
         if (simulation%model%steps(i)%procedure == procedure_frequency) then
            call run_frequency_step(simulation, i, output%results, output%log, error)
         else
            call run_step(simulation, i, output, error)
         end if
         if (allocated(error)) return
      end do
   end subroutine run_steps

   subroutine run_step(simulation, i_step, output, error)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      integer :: increment, n_increments
      real(wp) :: t_start, dt, t_end

      call start_step(simulation, i_step, output, error)
      if (allocated(error)) return
      associate (step => simulation%model%steps(i_step))
         n_increments = count_increments(step)
         t_start = simulation%motion%motion%t
         do increment = 1, n_increments
            dt = step%dt
            t_end = t_start + increment*step%dt
            if (increment == n_increments) then
               t_end = t_start + step%duration
               dt = last_increment(step, n_increments)
            end if
            call take_increment(simulation, dt, error)
            if (allocated(error)) return
            ! counted, not summed up: no drift of time over many increments
            simulation%motion%motion%t = t_end
            call finish_increment(simulation, i_step, increment, increment == n_increments, &
                  output, &
                  error)
            if (allocated(error)) return
         end do
      end associate
   end subroutine run_step

   !> Conditions, loads and first acceleration of a step; the initial state is recorded.
   subroutine start_step(simulation, i_step, output, error)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: implicit_equation(:)
      real(wp), allocatable :: load_before(:)
      real(wp) :: before

      before = simulation%scene%ledger%total
      if (i_step > 1) load_before = load_now(simulation)
      call begin_step(simulation, i_step, error)
      if (allocated(error)) return
      call report_step(simulation, i_step, output%log)
      associate (scene => simulation%scene)
         if (i_step == 1) then
            call open_ledger(scene%ledger, scene%system, simulation%motion%motion)
         else
            ! what conditions give or take at the start of a later step comes from outside
            call close_increment(scene%ledger, scene%system, simulation%motion%motion)
            scene%ledger%external_work = scene%ledger%external_work + scene%ledger%total - before
         end if
         if (starts_anew(simulation, i_step)) then
            call simulation%method%start(scene, simulation%motion, &
                  simulation%model%steps(i_step)%dt, &
                  error)
            if (allocated(error)) return
         else if (i_step > 1 .and. .not. scene%system%static) then
            call meet_new_load(simulation, load_before, error)
            if (allocated(error)) return
         end if
         if (i_step > 1) return
         call close_increment(scene%ledger, scene%system, simulation%motion%motion)
         call mark_implicit(scene%system%structure, implicit_equation)
         call write_system(output%results, scene, version_text, implicit_equation, error)
         if (allocated(error)) return
         call record_increment(output%results, scene, simulation%contact, simulation%motion, &
               simulation%model%steps(1)%requests, 0, .false., error)
         if (allocated(error)) return
         call flush_results(output%results, error)
      end associate
   end subroutine start_step

   !> The applied forces at the time reached.
   function load_now(simulation) result(force)
      type(simulation_type), intent(in) :: simulation
      real(wp) :: force(simulation%scene%system%structure%map%n_freedoms)

      force = load_at(simulation%scene%system%loads, size(force), simulation%motion%motion%t)
   end function load_now

   !> A load that jumps where one dynamic step goes on from another changes the acceleration at
   !> once; carried on, the old one would take half of the jump off the first increment.
   subroutine meet_new_load(simulation, load_before, error)
      type(simulation_type), intent(inout) :: simulation
      real(wp), intent(in) :: load_before(:)
      type(error_type), allocatable, intent(out) :: error
      real(wp), parameter :: round_off = 1.0e-12_wp

      if (maxval(abs(load_now(simulation) - load_before)) <= &
            round_off*maxval(abs(load_before))) return
      call restart_acceleration(simulation%scene, simulation%motion, error)
      simulation%motion%fresh = .true.
   end subroutine meet_new_load

   !> A dynamic step finds its own acceleration unless it goes on from another dynamic step.
   pure function starts_anew(simulation, i_step) result(anew)
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step
      logical :: anew

      anew = .false.
      if (simulation%scene%system%static) return
      anew = i_step == 1
      if (anew) return
      anew = simulation%model%steps(i_step &
            - 1)%procedure /= simulation%model%steps(i_step)%procedure
      anew = anew .or. size(simulation%model%steps(i_step)%initial_velocities) > 0
   end function starts_anew

   !> One increment by the step's procedure.
   subroutine take_increment(simulation, dt, error)
      type(simulation_type), intent(inout) :: simulation
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      type(contact_motion_type) :: next

      simulation%scene%impulse = 0.0_wp
      if (.not. simulation%scene%system%static) then
         call simulation%method%advance(simulation%scene, simulation%motion, dt, error)
         return
      end if
      call solve_statically(simulation%scene, simulation%motion, dt, next, error)
      if (allocated(error)) return
      call accept_span(simulation%scene, simulation%motion, next)
      simulation%motion = next
   end subroutine take_increment

   !> Energies, checks, records, progress.
   subroutine finish_increment(simulation, i_step, increment, last, output, error)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step, increment
      logical, intent(in) :: last
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      integer :: n_events

      associate (scene => simulation%scene, motion => simulation%motion, &
            step => simulation%model%steps(i_step))
         call check_finite(motion%motion, step%dt, error)
         if (allocated(error)) return
         call close_increment(scene%ledger, scene%system, motion%motion)
         n_events = scene%n_events
         call count_events(simulation)
         call record_increment(output%results, scene, simulation%contact, motion, step%requests, &
               increment, last, error)
         if (allocated(error)) return
         call write_status(output%log, [i_step, increment, &
               int(scene%n_iterations - output%iterations), n_events], &
               [increment*step%dt, motion%motion%t, step%dt])
         output%iterations = scene%n_iterations
         call show_progress(output%progress, motion%motion%t/output%end_time, motion%motion%t)
         call flush_now_and_then(output, error)
         if (allocated(error)) return
         call check_balance(scene%ledger, step, motion%motion%t, error)
      end associate
   end subroutine finish_increment

   !> A motion that is not finite stops the run; what was good is in the results.
   subroutine check_finite(motion, dt, error)
      type(state_type), intent(in) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error

      if (all(abs(motion%d) <= huge(1.0_wp)) .and. all(abs(motion%v) <= huge(1.0_wp)) .and. &
            all(abs(motion%a) <= huge(1.0_wp))) return
      call new_error(error, status_numerical, &
            'the motion is not finite (NaN or infinite) at time ' &
            //to_text(motion%t)//'; the last good increment is at '//to_text(motion%t - dt) &
            //new_line('a') &
            //'  cure: a smaller step, and a look at the loads and the energy before it')
   end subroutine check_finite

   !> The deck's limit on the balance error, a part of the largest energy met.
   subroutine check_balance(ledger, step, t, error)
      type(ledger_type), intent(in) :: ledger
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: t
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(step%requests)
         if (step%requests(i)%kind /= request_energy_print) cycle
         if (.not. step%requests(i)%balance_limit > 0.0_wp) cycle
         if (abs(ledger%balance_error) <= step%requests(i)%balance_limit*ledger%scale) cycle
         call new_error(error, status_numerical, 'the energy balance error ' &
               //to_text(ledger%balance_error)//' at time '//to_text(t)//' exceeds LIMIT=' &
               //to_text(step%requests(i)%balance_limit)//' of the energy '//to_text(ledger%scale) &
               //new_line('a')//'  cure: a smaller step, or a larger LIMIT on *ENERGY PRINT')
         return
      end do
   end subroutine check_balance

   !> Keeps the file complete up to a few seconds ago.
   subroutine flush_now_and_then(output, error)
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: now

      now = seconds_now()
      if (now - output%last_flush < flush_interval) return
      call flush_results(output%results, error)
      output%last_flush = now
   end subroutine flush_now_and_then

end module simulation
