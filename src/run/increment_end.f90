!> The end of an increment: energies, checks, records, progress.
module increment_end
   use kinds, only: wp
   use errors, only: error_type
   use text, only: to_text
   use cost_account, only: next_increment
   use steps, only: step_type
   use energy_ledger, only: close_increment
   use impact_scene, only: scene_type, event_impact
   use result_file, only: record_increment
   use run_log, only: log_type, note, write_status, has_line
   use progress, only: place_type, show_progress
   use increment_notices, only: notice_trouble
   use shape_watch, only: watch_shapes
   use contact_gain, only: warn_of_gain
   use stop_request, only: keep_watch, look_for_stop, stop_run
   use scene_setup, only: simulation_type
   use increment_checks, only: check_finite, check_energies, check_interpolation, check_balance, &
         needs_energies
   use course, only: course_type, place_name
   use run_output, only: output_type
   use state_keeping, only: publish_increment
   implicit none
   private

   public :: finish_increment, stop_if_asked, count_events, place_of

contains

   !> After every increment that is accepted: the simulation is at the end of it, and the course
   !> counts it.
   subroutine finish_increment(simulation, course, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error

      call keep_watch(output%watch)
      call record(simulation, course, output, error)
      if (allocated(error)) return
      call next_increment(simulation%scene%system%cost)
      call check_end(simulation, course, error)
      if (allocated(error)) return
      ! all of the increment is recorded: from here a run can be taken up again
      call publish_increment(simulation, course, output, error)
      if (allocated(error)) return
      call stop_if_asked(simulation, course, output, error)
   end subroutine finish_increment

   !> Stops the run before the next increment if something asks for it.
   subroutine stop_if_asked(simulation, course, output, error)
      type(simulation_type), intent(in) :: simulation
      type(course_type), intent(in) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error   !! status_interrupted
      logical :: asked

      call look_for_stop(output%watch, asked)
      if (.not. asked .or. is_last(simulation%model%steps, course)) return
      call stop_run(output%watch, place_name(course), simulation%motion%motion%t, error)
   end subroutine stop_if_asked

   !> Whether the run is over.
   pure logical function is_last(steps, course)
      type(step_type), intent(in) :: steps(:)
      type(course_type), intent(in) :: course

      is_last = course%step == size(steps) .and. course%step_time >= steps(size(steps))%duration
   end function is_last

   !> Energies, results, status and progress.
   subroutine record(simulation, course, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      integer :: n_events
      logical :: last

      associate (scene => simulation%scene, motion => simulation%motion, &
            step => simulation%model%steps(course%step))
         call check_finite(motion%motion, scene%ledger, course%dt, error)
         if (allocated(error)) return
         last = course%step_time >= step%duration
         if (last .or. needs_energies(step%requests, course%increment)) call close_increment( &
               scene%ledger, scene%system, motion%motion)
         call check_energies(scene%ledger, motion%motion%t, course%dt, error)
         if (allocated(error)) return
         n_events = scene%n_events
         call count_events(simulation)
         call record_increment(output%results, scene, simulation%contact, motion, step%requests, &
               course%increment, last, error)
         if (allocated(error)) return
         call write_status(output%log, [course%step, course%increment, &
               int(scene%n_iterations - output%iterations), n_events], &
               [course%step_time, motion%motion%t, course%dt])
         if (has_line(course%increment) .and. .not. scene%system%structure%is_linear) then
            call note_residuals(scene, course%increment, output%log)
         end if
         output%iterations = scene%n_iterations
         if (output%watch%pace%fresh .and. output%log%progress%shown) then
            call show_progress(output%log%progress, output%watch%pace%now, &
                  place_of(simulation, course))
         end if
         call notice_trouble(output%seen, simulation, course, output%log)
         if (last .or. motion%motion%t >= output%shape%next) call watch_shapes(output%shape, &
               simulation, step%duration, last, output%log)
         if (last) call warn_of_gain(scene, motion%motion%t, output%gain_told, output%log)
      end associate
   end subroutine record

   !> Where the run is, for the line of progress.
   pure function place_of(simulation, course) result(place)
      type(simulation_type), intent(in) :: simulation
      type(course_type), intent(in) :: course
      type(place_type) :: place

      place%step = max(1, course%step)
      place%increment = course%increment
      associate (duration => simulation%model%steps(place%step)%duration)
         if (duration > 0.0_wp) place%share = course%step_time/duration
      end associate
      place%has_contact = simulation%scene%rows%n > 0
      place%n_impacts = simulation%n_events(event_impact)
      place%n_touching = simulation%touching
   end function place_of

   !> What stops a run with the results of the increment written.
   subroutine check_end(simulation, course, error)
      type(simulation_type), intent(in) :: simulation
      type(course_type), intent(in) :: course
      type(error_type), allocatable, intent(out) :: error

      associate (scene => simulation%scene, t => simulation%motion%motion%t)
         if (scene%settings%anchored) then
            call check_interpolation(scene%ledger, t, error)
            if (allocated(error)) return
         end if
         call check_balance(scene%ledger, simulation%model%steps(course%step), t, error)
      end associate
   end subroutine check_end

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
      self%touching = n_touching
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

end module increment_end
