!> The increments of a static or dynamic step, with what is recorded after each.
module time_loop
   use kinds, only: wp, int64
   use errors, only: error_type, new_error, status_numerical
   use text, only: to_text
   use cost_account, only: enter, leave, next_increment, end_increments, phase_build, &
         phase_output
   use steps, only: step_type
   use energy_ledger, only: close_increment
   use effective_matrix, only: mark_implicit
   use impact_scene, only: scene_type
   use result_file, only: result_file_type, record_increment, write_system
   use command_line, only: version_text
   use run_log, only: log_type, say, note, write_status, has_line
   use progress, only: progress_type, show_progress
   use publishing, only: publishing_type, is_due, publish_now, was_slow_to_start
   use scene_setup, only: simulation_type
   use increment_count, only: count_increments, last_increment
   use step_start, only: start_step
   use increments, only: control_type, start_control, take_increment, take_automatic_increment
   use increment_checks, only: check_finite, check_energies, check_interpolation, check_balance, &
         needs_energies
   use twin_motion, only: twins_type, start_twins, take_fine_increment, compare_twins, &
         step_is_over
   use rehearsal, only: plan_type, rehearse, report_tolerance
   use deck_check, only: preview_type
   use run_report, only: report_step
   implicit none
   private

   public :: output_type, run_step

   !> What a run writes to.
   type :: output_type
      type(result_file_type) :: results
      type(log_type) :: log
      type(progress_type) :: progress
      type(preview_type) :: preview
      type(publishing_type) :: publishing
      real(wp) :: end_time = 0.0_wp              !! total time at the end of the run
      integer(int64) :: iterations = 0           !! at the end of the last increment
   end type output_type

contains

   !> One step from its start, all its increments by its control of their sizes.
   subroutine run_step(simulation, i_step, output, error)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      integer :: outer

      call enter(simulation%scene%system%cost, phase_build, outer)
      call start_step(simulation, i_step, error)
      call leave(simulation%scene%system%cost, outer)
      if (allocated(error)) return
      call report_step(simulation, i_step, output%log)
      if (i_step == 1) call record_start(simulation, output, error)
      if (allocated(error)) return
      if (simulation%model%steps(i_step)%direct) then
         call run_fixed(simulation, i_step, output, error)
      else if (simulation%scene%system%static) then
         call run_automatic(simulation, i_step, output, error)
      else
         call run_to_tolerance(simulation, i_step, output, error)
      end if
      call end_increments(simulation%scene%system%cost)
   end subroutine run_step

   !> The system of equations and the initial state.
   subroutine record_start(simulation, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: implicit_equation(:)
      integer :: outer

      call enter(simulation%scene%system%cost, phase_output, outer, .true.)
      call mark_implicit(simulation%scene%system%structure, implicit_equation)
      call write_system(output%results, simulation%scene, version_text, implicit_equation, error)
      call leave(simulation%scene%system%cost, outer)
      if (allocated(error)) return
      call check_finite(simulation%motion%motion, simulation%scene%ledger, 0.0_wp, error)
      if (allocated(error)) return
      call check_energies(simulation%scene%ledger, simulation%motion%motion%t, 0.0_wp, error)
      if (allocated(error)) return
      call record_increment(output%results, simulation%scene, simulation%contact, &
            simulation%motion, simulation%model%steps(1)%requests, 0, .false., error)
      if (allocated(error)) return
      if (was_slow_to_start(output%publishing)) call publish_now(output%publishing, &
            output%results, output%log, simulation%scene%system%cost, error)
   end subroutine record_start

   !> Increments of one size, the last one shorter where they do not fill the step.
   subroutine run_fixed(simulation, i_step, output, error)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      integer :: increment, n_increments
      real(wp) :: t_start, dt, step_time

      associate (step => simulation%model%steps(i_step))
         n_increments = count_increments(step)
         t_start = simulation%motion%motion%t
         do increment = 1, n_increments
            dt = step%dt
            step_time = increment*step%dt
            if (increment == n_increments) then
               step_time = step%duration
               dt = last_increment(step, n_increments)
            end if
            call take_increment(simulation, dt, error)
            if (allocated(error)) return
            ! counted, not summed up: no drift of time over many increments
            simulation%motion%motion%t = t_start + step_time
            call finish_increment(simulation, [i_step, increment], [step_time, dt], output, error)
            if (allocated(error)) return
         end do
      end associate
   end subroutine run_fixed

   !> Static increments chosen by the program.
   subroutine run_automatic(simulation, i_step, output, error)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      type(control_type) :: control
      integer :: increment
      real(wp) :: t_start, dt, step_time

      t_start = simulation%motion%motion%t
      step_time = 0.0_wp
      increment = 0
      associate (step => simulation%model%steps(i_step))
         call start_control(control, step)
         do while (step_time < step%duration)
            increment = increment + 1
            call check_count(step, increment, step_time, error)
            if (allocated(error)) return
            call take_automatic_increment(simulation, control, step%duration - step_time, dt, error)
            if (allocated(error)) return
            step_time = step_time + dt
            if (step%duration - step_time <= 1.0e-12_wp*step%duration) step_time = step%duration
            simulation%motion%motion%t = t_start + step_time
            call finish_increment(simulation, [i_step, increment], [step_time, dt], output, error)
            if (allocated(error)) return
         end do
      end associate
      call say(output%log, 'step '//to_text(i_step)//': '//to_text(increment) &
            //' automatic increments, '//to_text(control%n_cut)//' tried in vain')
   end subroutine run_automatic

   !> A dynamic step in increments that keep its error to TOLERANCE.
   subroutine run_to_tolerance(simulation, i_step, output, error)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      type(plan_type) :: plan
      type(twins_type) :: twins
      integer :: increment

      call rehearse(simulation, i_step, output%log, plan, error)
      if (allocated(error)) return
      call start_twins(twins, simulation, plan%settings)
      increment = 0
      do while (.not. step_is_over(twins))
         increment = increment + 1
         call check_count(simulation%model%steps(i_step), increment, twins%step_time, error)
         if (allocated(error)) return
         call take_fine_increment(twins, simulation, error)
         if (allocated(error)) return
         call finish_increment(simulation, [i_step, increment], [twins%step_time, twins%dt], &
               output, error)
         if (allocated(error)) return
         call compare_twins(twins, simulation)
      end do
      call report_tolerance(plan, twins, i_step, output%log)
   end subroutine run_to_tolerance

   !> INC limits the automatic increments of a step.
   subroutine check_count(step, increment, step_time, error)
      type(step_type), intent(in) :: step
      integer, intent(in) :: increment
      real(wp), intent(in) :: step_time
      type(error_type), allocatable, intent(out) :: error

      if (step%max_increments == 0 .or. increment <= step%max_increments) return
      call new_error(error, status_numerical, 'INC='//to_text(step%max_increments) &
            //' increments are used up at step time '//to_text(step_time)//' of ' &
            //to_text(step%duration)//new_line('a')//'  cure: raise INC on *STEP')
   end subroutine check_count

   !> Energies, checks, records, progress.
   subroutine finish_increment(simulation, counts, times, output, error)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: counts(2)           !! step and increment
      real(wp), intent(in) :: times(2)           !! step time reached, size of the increment
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      integer :: n_events
      logical :: last

      associate (scene => simulation%scene, motion => simulation%motion, &
            step => simulation%model%steps(counts(1)))
         call check_finite(motion%motion, scene%ledger, times(2), error)
         if (allocated(error)) return
         last = times(1) >= step%duration
         if (last .or. needs_energies(step%requests, counts(2))) call close_increment( &
               scene%ledger, scene%system, motion%motion)
         call check_energies(scene%ledger, motion%motion%t, times(2), error)
         if (allocated(error)) return
         n_events = scene%n_events
         call count_events(simulation)
         call record_increment(output%results, scene, simulation%contact, motion, step%requests, &
               counts(2), last, error)
         if (allocated(error)) return
         call write_status(output%log, [counts, int(scene%n_iterations - output%iterations), &
               n_events], [times(1), motion%motion%t, times(2)])
         if (has_line(counts(2)) .and. .not. scene%system%structure%is_linear) then
            call note_residuals(scene, counts(2), output%log)
         end if
         output%iterations = scene%n_iterations
         call show_progress(output%progress, motion%motion%t/output%end_time, motion%motion%t)
         if (is_due(output%publishing)) call publish_now(output%publishing, output%results, &
               output%log, scene%system%cost, error)
         if (allocated(error)) return
         call next_increment(scene%system%cost)
         if (scene%settings%anchored) then
            call check_interpolation(scene%ledger, motion%motion%t, error)
            if (allocated(error)) return
         end if
         call check_balance(scene%ledger, step, motion%motion%t, error)
      end associate
   end subroutine finish_increment

   !> Adds the events of the increment at hand to the count of the run; sees how many rows touch.
   pure subroutine count_events(self)
      type(simulation_type), intent(inout) :: self
      integer :: i, n_touching

      do i = 1, self%scene%n_events
         associate (kind => self%scene%events(i)%kind, row => self%scene%events(i)%row)
            self%n_events(kind) = self%n_events(kind) + 1
            self%has_met(self%scene%rows%pair(row)) = .true.
         end associate
      end do
      n_touching = count(self%motion%touching .or. self%motion%lambda > 0.0_wp)
      self%most_touching = max(self%most_touching, n_touching)
      if (n_touching == 0 .or. all(self%has_met)) return
      do i = 1, self%scene%rows%n
         if (self%motion%touching(i) .or. self%motion%lambda(i) > 0.0_wp) then
            self%has_met(self%scene%rows%pair(i)) = .true.
         end if
      end do
   end subroutine count_events

   !> How Newton's method went in an increment (its last solution, where it has several).
   subroutine note_residuals(scene, increment, log)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: increment
      type(log_type), intent(in) :: log
      character(len=:), allocatable :: line
      integer :: i

      line = '  increment '//to_text(increment)//': residuals'
      do i = 1, scene%n_residuals
         line = line//' '//to_text(scene%residuals(i), 2)
      end do
      call note(log, line)
   end subroutine note_residuals

end module time_loop
