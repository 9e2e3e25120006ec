!> The increments of a static or dynamic step, from its start or from where a run has got to in it.
module time_loop
   use kinds, only: wp
   use errors, only: error_type
   use cost_account, only: enter, leave, end_increments, phase_build, phase_output
   use effective_matrix, only: mark_implicit
   use result_file, only: record_increment, write_system
   use program_version, only: version_text
   use scene_setup, only: simulation_type
   use step_start, only: start_step
   use stop_request, only: start_looking
   use increment_checks, only: check_finite, check_energies
   use run_report, only: report_step
   use course, only: course_type
   use course_increments, only: take_next, report_course
   use run_output, only: output_type, publish_after_start
   use step_tally, only: note_start
   use increment_notices, only: look_at_counters
   use increment_end, only: finish_increment, stop_if_asked
   implicit none
   private

   public :: run_step

contains

   !> The step of a course, all increments that are left of it by its control of their sizes.
   subroutine run_step(simulation, course, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      logical :: taken

      if (.not. course%entered) then
         call enter_step(simulation, course, output, error)
         if (allocated(error)) return
      else
         output%iterations = simulation%scene%n_iterations
      end if
      call look_at_counters(output%seen, simulation, course)
      call start_looking(output%watch)
      call stop_if_asked(simulation, course, output, error)
      if (allocated(error)) return
      do
         call take_next(simulation, course, output%log, output%watch, taken, error)
         if (allocated(error) .or. .not. taken) exit
         call finish_increment(simulation, course, output, error)
         if (allocated(error)) exit
      end do
      call end_increments(simulation%scene%system%cost)
      if (.not. allocated(error)) call report_course(simulation, course, output%log)
   end subroutine run_step

   !> The start of a step, that of the first one with its records.
   subroutine enter_step(simulation, course, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      integer :: outer

      call enter(simulation%scene%system%cost, phase_build, outer)
      call start_step(simulation, course%step, error)
      call leave(simulation%scene%system%cost, outer)
      if (allocated(error)) return
      if (course%step == 1) call note_start(output%tally, simulation%scene%ledger)
      call report_step(simulation, course%step, output%log)
      if (course%step == 1) call record_start(simulation, output, error)
      course%entered = .not. allocated(error)
   end subroutine enter_step

   !> The system of equations and the initial state.
   subroutine record_start(simulation, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: implicit_equation(:)
      integer :: outer

      call enter(simulation%scene%system%cost, phase_output, outer, .true.)
      call mark_implicit(simulation%scene%system%structure, implicit_equation)
      call write_system(output%results, simulation%scene, version_text(), implicit_equation, error)
      call leave(simulation%scene%system%cost, outer)
      if (allocated(error)) return
      call check_finite(simulation%motion%motion, simulation%scene%ledger, 0.0_wp, error)
      if (allocated(error)) return
      call check_energies(simulation%scene%ledger, simulation%motion%motion%t, 0.0_wp, error)
      if (allocated(error)) return
      call record_increment(output%results, simulation%scene, simulation%contact, &
            simulation%motion, simulation%model%steps(1)%requests, 0, .false., error)
      if (allocated(error)) return
      call publish_after_start(output, simulation%scene%system%cost, error)
   end subroutine record_start

end module time_loop
