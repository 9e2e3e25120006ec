!> A frequency step: the modes, their table in the log and their results.
module frequency_run
   use kinds, only: wp
   use cost_account, only: enter, leave, phase_factor
   use errors, only: error_type, status_numerical
   use text, only: to_text, plural
   use places, only: fail_at
   use eigen_analysis, only: modes_type, find_modes, keep_modes_up_to
   use effective_matrix, only: mark_implicit
   use steps, only: step_type
   use result_file, only: result_file_type, write_system
   use mode_recorder, only: record_modes
   use program_version, only: version_text
   use run_log, only: log_type, say, remark
   use scene_setup, only: simulation_type, begin_step
   use run_report, only: report_step
   implicit none
   private

   public :: run_frequency_step

contains

   !> Finds and records the modes about the state reached.
   subroutine run_frequency_step(simulation, i_step, results, log, error)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(result_file_type), intent(inout) :: results
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      type(modes_type) :: modes
      logical, allocatable :: implicit_equation(:)
      integer :: outer

      call begin_step(simulation, i_step, error)
      if (allocated(error)) return
      call report_step(simulation, i_step, log)
      associate (system => simulation%scene%system, step => simulation%model%steps(i_step), &
            state => simulation%motion%motion)
         if (i_step == 1) then
            call mark_implicit(system%structure, implicit_equation)
            call write_system(results, simulation%scene, version_text(), implicit_equation, error)
            if (allocated(error)) return
         end if
         call enter(system%cost, phase_factor, outer)
         call find_modes(system%structure, system%profile, state%d, state%history, step%n_modes, &
               modes, error)
         call leave(system%cost, outer)
         if (allocated(error)) return
         system%matrices%n_factorizations = system%matrices%n_factorizations &
               + modes%n_factorizations
         if (modes%n == 0) then
            call fail_at(error, simulation%model%source, step%procedure_place, &
                  'there are no modes: nothing that can move has mass', &
                  'give the materials a density, or add MASS elements')
            error%status = status_numerical    ! found by computing: the run has begun
            return
         end if
         call choose_modes(simulation, step, modes, log, error)
         if (allocated(error)) return
         call report_modes(modes, log)
         call record_modes(results, simulation%scene, simulation%contact, simulation%motion, &
               modes, error)
      end associate
   end subroutine run_frequency_step

   !> Leaves out the modes above the step's highest frequency. Error: all are.
   subroutine choose_modes(simulation, step, modes, log, error)
      type(simulation_type), intent(in) :: simulation
      type(step_type), intent(in) :: step
      type(modes_type), intent(inout) :: modes
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      integer :: n_found

      n_found = modes%n
      if (n_found < step%n_modes) call remark(log, to_text(step%n_modes) &
            //' modes were asked for, the model has '//to_text(n_found))
      if (.not. step%highest_frequency > 0.0_wp) return
      if (modes%frequency(1) > step%highest_frequency) then
         call fail_at(error, simulation%model%source, step%time_place, &
               'the lowest frequency, '//to_text(modes%frequency(1))//', is above the highest ' &
               //'one asked for', 'write a higher one, or the number of modes alone')
         error%status = status_numerical
         return
      end if
      call keep_modes_up_to(modes, step%highest_frequency)
      if (modes%n < n_found) call say(log, '  '//plural(modes%n, 'mode')//' of '// &
            to_text(n_found)//' up to the frequency '//to_text(step%highest_frequency))
   end subroutine choose_modes

   !> The table of modes, effective masses in percent of what can move.
   subroutine report_modes(modes, log)
      type(modes_type), intent(in) :: modes
      type(log_type), intent(inout) :: log
      character(len=80) :: line
      integer :: i

      call say(log, '  '//plural(modes%n, 'mode')//' by '//trim(merge('condensation    ', &
            'Lanczos'' method ', modes%condensed))//', shift '//to_text(modes%shift, 3) &
            //', '//plural(modes%n_factorizations, 'factorization')//', largest residual ' &
            //to_text(maxval(modes%residual), 2))
      call say(log, '  mode     eigenvalue      frequency   effective mass x, y, z, %')
      do i = 1, modes%n
         write (line, '(i6, 2es15.6, 3f9.3)') i, modes%eigenvalue(i), modes%frequency(i), &
               100.0_wp*modes%effective_mass(:, i)/max(modes%moving_mass, tiny(1.0_wp))
         call say(log, trim(line))
      end do
   end subroutine report_modes

end module frequency_run
