!> The increments of a static or dynamic step, from its start or from where a run has got to in it.
module time_loop
   use kinds, only: wp
   use errors, only: error_type, new_error, status_numerical
   use text, only: to_text
   use clock, only: start_pace
   use cost_account, only: enter, leave, end_increments, phase_build, phase_output
   use steps, only: step_type
   use effective_matrix, only: mark_implicit
   use result_file, only: record_increment, write_system
   use command_line, only: version_text
   use run_log, only: say
   use scene_setup, only: simulation_type
   use step_start, only: start_step
   use increments, only: start_control, take_increment, take_automatic_increment
   use increment_checks, only: check_finite, check_energies
   use twin_motion, only: start_twins, take_fine_increment, compare_twins, step_is_over
   use rehearsal, only: rehearse, report_tolerance
   use run_report, only: report_step
   use course, only: course_type, is_fresh, find_next
   use run_output, only: output_type, publish_after_start, stop_if_asked
   use increment_end, only: finish_increment
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

      if (is_fresh(course)) then
         call enter_step(simulation, course, output, error)
         if (allocated(error)) return
      else
         output%iterations = simulation%scene%n_iterations
      end if
      if (simulation%model%steps(course%step)%direct) then
         call run_fixed(simulation, course, output, error)
      else if (simulation%scene%system%static) then
         call run_automatic(simulation, course, output, error)
      else
         call run_to_tolerance(simulation, course, output, error)
      end if
      call end_increments(simulation%scene%system%cost)
   end subroutine run_step

   !> The start of a step, that of the first one with its records.
   subroutine enter_step(simulation, course, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(in) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      integer :: outer

      call enter(simulation%scene%system%cost, phase_build, outer)
      call start_step(simulation, course%step, error)
      call leave(simulation%scene%system%cost, outer)
      if (allocated(error)) return
      call report_step(simulation, course%step, output%log)
      if (course%step == 1) call record_start(simulation, output, error)
      if (allocated(error)) return
      call start_pace(output%pace)
      call stop_if_asked(output, course%step, 0, simulation%motion%motion%t, error)
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
      call publish_after_start(output, simulation%scene%system%cost, error)
   end subroutine record_start

   !> Increments of one size, the last one shorter where they do not fill the step.
   subroutine run_fixed(simulation, course, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: dt, step_time
      logical :: left

      do
         call find_next(course, simulation%model%steps(course%step), dt, step_time, left)
         if (.not. left) return
         call take_increment(simulation, dt, error)
         if (allocated(error)) return
         call count_increment(simulation, course, step_time, dt)
         call finish_increment(simulation, course, output, error)
         if (allocated(error)) return
      end do
   end subroutine run_fixed

   !> An increment has been taken: the course goes on to its end, the time is counted from the start
   !> of the step.
   pure subroutine count_increment(simulation, course, step_time, dt)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      real(wp), intent(in) :: step_time, dt

      course%increment = course%increment + 1
      course%step_time = step_time
      course%dt = dt
      simulation%motion%motion%t = course%t_start + step_time
   end subroutine count_increment

   !> Static increments chosen by the program.
   subroutine run_automatic(simulation, course, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: dt, step_time

      associate (step => simulation%model%steps(course%step))
         if (is_fresh(course)) call start_control(course%control, step)
         do while (course%step_time < step%duration)
            call check_count(step, course%increment + 1, course%step_time, error)
            if (allocated(error)) return
            call take_automatic_increment(simulation, course%control, &
                  step%duration - course%step_time, dt, error)
            if (allocated(error)) return
            step_time = course%step_time + dt
            if (step%duration - step_time <= 1.0e-12_wp*step%duration) step_time = step%duration
            call count_increment(simulation, course, step_time, dt)
            call finish_increment(simulation, course, output, error)
            if (allocated(error)) return
         end do
      end associate
      call say(output%log, 'step '//to_text(course%step)//': '//to_text(course%increment) &
            //' automatic increments, '//to_text(course%control%n_cut)//' tried in vain')
   end subroutine run_automatic

   !> A dynamic step in increments that keep its error to TOLERANCE.
   subroutine run_to_tolerance(simulation, course, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error

      if (is_fresh(course)) then
         call rehearse(simulation, course%step, output, course%plan, error)
         if (allocated(error)) return
         call start_twins(course%twins, simulation, course%plan%settings)
      end if
      associate (twins => course%twins)
         do while (.not. step_is_over(twins))
            call check_count(simulation%model%steps(course%step), course%increment + 1, &
                  twins%step_time, error)
            if (allocated(error)) return
            call take_fine_increment(twins, simulation, error)
            if (allocated(error)) return
            call compare_twins(twins, simulation)
            call count_increment(simulation, course, twins%step_time, twins%dt)
            call finish_increment(simulation, course, output, error)
            if (allocated(error)) return
         end do
      end associate
      call report_tolerance(course%plan, course%twins, course%step, output%log)
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

end module time_loop
