!> The next increment of a course, by what controls its size: one size for all, static automatic
!> increments, or a TOLERANCE.
module course_increments
   use kinds, only: wp
   use errors, only: error_type, new_error, status_numerical, status_interrupted
   use state_archive, only: archive_type
   use text, only: to_text, plural
   use steps, only: step_type
   use run_log, only: log_type, say
   use stop_request, only: watch_type
   use scene_setup, only: simulation_type
   use increments, only: start_control, take_increment, take_automatic_increment
   use twin_motion, only: start_twins, take_fine_increment, compare_twins, step_is_over
   use rehearsal, only: rehearse, report_tolerance
   use run_state, only: collect_state, rewind_state
   use course, only: course_type, is_fresh, find_next
   implicit none
   private

   public :: take_next, report_course

contains

   !> Takes an increment of the step in force, if one is left, and counts it.
   subroutine take_next(simulation, course, log, watch, taken, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(log_type), intent(inout) :: log
      type(watch_type), intent(inout) :: watch   !! over rehearsals
      logical, intent(out) :: taken
      type(error_type), allocatable, intent(out) :: error

      if (simulation%model%steps(course%step)%direct) then
         call take_fixed(simulation, course, taken, error)
      else if (simulation%scene%system%static) then
         call take_automatic(simulation, course, taken, error)
      else
         call take_to_tolerance(simulation, course, log, watch, taken, error)
      end if
   end subroutine take_next

   !> Increments of one size, the last one shorter where they do not fill the step.
   subroutine take_fixed(simulation, course, taken, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      logical, intent(out) :: taken
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: dt, step_time

      call find_next(course, simulation%model%steps(course%step), dt, step_time, taken)
      if (.not. taken) return
      call take_increment(simulation, dt, error)
      if (allocated(error)) return
      call count_increment(simulation, course, step_time, dt)
   end subroutine take_fixed

   !> Static increments chosen by the program.
   subroutine take_automatic(simulation, course, taken, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      logical, intent(out) :: taken
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: dt, step_time

      associate (step => simulation%model%steps(course%step))
         taken = course%step_time < step%duration
         if (.not. taken) return
         if (is_fresh(course)) call start_control(course%control, step)
         call check_count(step, course%increment + 1, course%step_time, error)
         if (allocated(error)) return
         call take_automatic_increment(simulation, course%control, &
               step%duration - course%step_time, dt, error)
         if (allocated(error)) return
         step_time = course%step_time + dt
         if (step%duration - step_time <= 1.0e-12_wp*step%duration) step_time = step%duration
      end associate
      call count_increment(simulation, course, step_time, dt)
   end subroutine take_automatic

   !> Increments of a dynamic step that keep its error to TOLERANCE, found by rehearsals before the
   !> first of them.
   subroutine take_to_tolerance(simulation, course, log, watch, taken, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(log_type), intent(inout) :: log
      type(watch_type), intent(inout) :: watch
      logical, intent(out) :: taken
      type(error_type), allocatable, intent(out) :: error

      taken = .true.
      if (is_fresh(course)) then
         call start_to_tolerance(simulation, course, log, watch, error)
         if (allocated(error)) return
      end if
      taken = .not. step_is_over(course%twins)
      if (.not. taken) return
      call check_count(simulation%model%steps(course%step), course%increment + 1, &
            course%step_time, error)
      if (allocated(error)) return
      call take_fine_increment(course%twins, simulation, error)
      if (allocated(error)) return
      call compare_twins(course%twins, simulation)
      call count_increment(simulation, course, course%twins%step_time, course%twins%dt)
   end subroutine take_to_tolerance

   !> The rehearsals of a step. Interrupted, they leave no trace: they will begin anew.
   subroutine start_to_tolerance(simulation, course, log, watch, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(log_type), intent(inout) :: log
      type(watch_type), intent(inout) :: watch
      type(error_type), allocatable, intent(out) :: error
      type(archive_type) :: before
      type(error_type), allocatable :: failure

      call collect_state(simulation, course, before)
      call rehearse(simulation, course%step, log, watch, course%plan, error)
      if (.not. allocated(error)) then
         call start_twins(course%twins, simulation, course%plan%settings)
      else if (error%status == status_interrupted) then
         call rewind_state(simulation, course, before, failure)
         if (allocated(failure)) call move_alloc(failure, error)
      end if
   end subroutine start_to_tolerance

   !> An increment has been taken: the course goes on to its end. Times are counted from the start
   !> of the step, not summed up: no drift over many increments.
   pure subroutine count_increment(simulation, course, step_time, dt)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      real(wp), value :: step_time, dt

      course%increment = course%increment + 1
      course%step_time = step_time
      course%dt = dt
      course%duration = simulation%model%steps(course%step)%duration
      simulation%motion%motion%t = course%t_start + step_time
   end subroutine count_increment

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

   !> How the increments of a step were chosen, at its end.
   subroutine report_course(simulation, course, log)
      type(simulation_type), intent(in) :: simulation
      type(course_type), intent(in) :: course
      type(log_type), intent(inout) :: log

      if (simulation%model%steps(course%step)%direct) return
      if (simulation%scene%system%static) then
         call say(log, 'step '//to_text(course%step)//': '//plural(course%increment, &
               'automatic increment')//', '//to_text(course%control%n_cut)//' tried in vain')
      else
         call report_tolerance(course%plan, course%twins, course%step, log)
      end if
   end subroutine report_course

end module course_increments
