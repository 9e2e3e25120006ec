!> Keeps the state of a run in its results, for --restart to go on from.
module state_keeping
   use kinds, only: wp
   use errors, only: error_type, status_file, status_interrupted
   use clock, only: seconds_now
   use cost_account, only: enter, leave, phase_output
   use state_archive, only: archive_type
   use memory_shortage, only: check_allocation
   use restart_group, only: write_state, remove_state
   use result_file, only: flush_results
   use result_extents, only: extents_type, measure_results
   use publishing, only: is_affordable, is_due, publish_now
   use stop_request, only: start_looking
   use scene_setup, only: simulation_type
   use course, only: course_type
   use run_state, only: collect_state
   use run_output, only: output_type, publish_now_and_then
   use step_tally, only: count_up
   implicit none
   private

   public :: keep_restart_state, publish_increment, keep_before_step, keep_at_end, &
         keep_if_interrupted, keep_after_error

contains

   !> Writes the state into the results, where it is published with them.
   subroutine keep_restart_state(simulation, course, output, error)
      type(simulation_type), intent(inout) :: simulation   !! as it was
      type(course_type), intent(inout) :: course           !! as it was
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      type(archive_type) :: archive
      integer :: outer

      if (.not. course%entered) return
      if (allocated(output%aside%archive)) deallocate (output%aside%archive)
      associate (cost => simulation%scene%system%cost)
         call enter(cost, phase_output, outer, .true.)
         call flush_results(output%results, error)
         if (.not. allocated(error)) then
            call collect_all(simulation, course, output, archive)
            call write_state(output%results%restart, output%results%file, archive, error)
            ! it is worth a file where nothing else is recorded before the modes
            output%results%has_records = output%results%has_records .or. .not. allocated(error)
         end if
         call leave(cost, outer)
      end associate
      output%state_due = .false.
   end subroutine keep_restart_state

   !> The state of the simulation, of the results and of the log.
   subroutine collect_all(simulation, course, output, archive)
      type(simulation_type), intent(inout) :: simulation   !! as it was
      type(course_type), intent(inout) :: course           !! as it was
      type(output_type), intent(inout) :: output
      type(archive_type), intent(out) :: archive
      type(extents_type) :: extents

      call collect_state(simulation, course, archive)
      call measure_results(extents, output%results)
      call extents%pass_state(archive)
      call output%results%pass_state(archive)
      call output%log%pass_state(archive)
      call count_up(output%tally, simulation, course%step)
      call output%tally%pass_state(archive, simulation)
      call simulation%scene%system%cost%pass_times(archive)
   end subroutine collect_all

   !> Collects the state at the end of a step, which is not written now, for an error in the steps
   !> that follow. Of many short steps some are passed over.
   subroutine set_aside(simulation, course, output)
      type(simulation_type), intent(inout) :: simulation   !! as it was
      type(course_type), intent(inout) :: course           !! as it was
      type(output_type), intent(inout) :: output
      real(wp) :: start
      integer :: outer, status

      associate (aside => output%aside, cost => simulation%scene%system%cost)
         if (.not. is_affordable(output%publishing, aside%spent + aside%price)) return
         call enter(cost, phase_output, outer, .true.)
         start = seconds_now()
         if (allocated(aside%archive)) deallocate (aside%archive)
         allocate (aside%archive, stat=status)
         call check_allocation(status)
         call collect_all(simulation, course, output, aside%archive)
         aside%price = seconds_now() - start
         aside%spent = aside%spent + aside%price
         call leave(cost, outer)
      end associate
   end subroutine set_aside

   !> After an increment: keeps the state if *RESTART asks for it, and lets others see the results
   !> now and then. A state that is due is put off where keeping all would take long.
   subroutine publish_increment(simulation, course, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: start
      logical :: ended, puts_off

      associate (step => simulation%model%steps(course%step), cost => simulation%scene%system%cost)
         ended = course%step_time >= step%duration
         if (step%restart_frequency > 0) then
            output%state_due = output%state_due .or. ended &
                  .or. modulo(course%increment, step%restart_frequency) == 0
         end if
         if (output%state_due) then
            puts_off = .not. output%watch%pace%fresh
            if (.not. puts_off) puts_off = .not. is_due(output%publishing, 0.0_wp)
            if (puts_off) then
               if (ended .and. course%step < size(simulation%model%steps)) call set_aside( &
                     simulation, course, output)
               return
            end if
            start = seconds_now()
            call keep_restart_state(simulation, course, output, error)
            if (.not. allocated(error)) call publish_now(output%publishing, output%results, &
                  output%log, cost, error, start)
            output%watch%saving = output%publishing%price
            call start_looking(output%watch)
         else
            call publish_now_and_then(output, cost, error)
         end if
      end associate
   end subroutine publish_increment

   !> A run that is interrupted always keeps its state.
   subroutine keep_if_interrupted(simulation, course, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(inout) :: error   !! why the run ends, if it fails
      type(error_type), allocatable :: write_error

      if (.not. allocated(error)) return
      if (error%status /= status_interrupted) return
      call keep_restart_state(simulation, course, output, write_error)
      if (allocated(write_error)) call move_alloc(write_error, error)
   end subroutine keep_if_interrupted

   !> A run that an error ends keeps the state that was set aside. Where a file could not be written
   !> the state before stays: rows up to the one set aside may be missing.
   subroutine keep_after_error(simulation, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(in) :: error   !! why the run ends, if it fails
      type(error_type), allocatable :: write_error
      integer :: outer

      if (.not. (allocated(error) .and. allocated(output%aside%archive))) return
      if (error%status == status_file) return
      associate (cost => simulation%scene%system%cost)
         call enter(cost, phase_output, outer, .true.)
         call flush_results(output%results, write_error)
         if (.not. allocated(write_error)) call write_state(output%results%restart, &
               output%results%file, output%aside%archive, write_error)
         output%results%has_records = output%results%has_records .or. .not. allocated(write_error)
         call leave(cost, outer)
      end associate
   end subroutine keep_after_error

   !> What was put off, at the end of a step behind which no state can be kept.
   subroutine keep_before_step(simulation, course, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error

      if (output%state_due) call keep_restart_state(simulation, course, output, error)
   end subroutine keep_before_step

   !> At the end of the run: the last state, if *RESTART asks for it; else what is left of another
   !> run goes, which would be of no use.
   subroutine keep_at_end(simulation, course, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error

      if (any(simulation%model%steps%restart_frequency > 0)) then
         if (output%state_due) call keep_restart_state(simulation, course, output, error)
      else
         call remove_state(output%results%file, error)
      end if
   end subroutine keep_at_end

end module state_keeping
