!> The run: deck, scene, files, the steps one after the other, and how it ended.
module simulation
   use errors, only: error_type, status_file, status_interrupted
   use text, only: shell_word
   use stop_signals, only: catch_signals
   use file_calls, only: ignore_signals
   use part_file, only: check_output
   use cost_account, only: start_clock, enter, leave, phase_read, phase_build, phase_output
   use steps, only: procedure_frequency
   use hdf5_file, only: hdf5_file_type
   use result_file, only: close_results
   use command_line, only: command_type
   use publishing, only: start_publishing
   use run_log, only: log_type, end_status, close_log, say, note
   use stop_request, only: start_watch, remove_stop_files
   use progress, only: start_progress, end_progress
   use step_tally, only: count_up
   use run_summary, only: report_summary
   use json_text, only: json_type
   use run_json, only: describe_run
   use scene_setup, only: simulation_type, initial_motion
   use frequency_run, only: run_frequency_step
   use scene_advice, only: advice_list_type, advise_end
   use feature_report, only: report_advice
   use deck_check, only: read_model, prepare, report_preview
   use run_report, only: report_model, report_notes
   use course, only: course_type, begin_course
   use run_output, only: output_type
   use run_state, only: restore_state
   use state_keeping, only: keep_before_step, keep_at_end, keep_if_interrupted
   use restart_start, only: restart_type, read_restart, is_finished, open_outputs, begin_again
   use increment_end, only: place_of
   use time_loop, only: run_step
   implicit none
   private

   public :: run_deck

   !> Signals of Linux: a write that fails says so itself.
   integer, parameter :: broken_pipe = 13, file_too_large = 25

contains

   !> A whole run. Files are made only after the deck has been found sound.
   subroutine run_deck(command, report, error)
      type(command_type), intent(in) :: command
      type(json_type), intent(inout) :: report   !! open; gets what is known of the run
      type(error_type), allocatable, intent(out) :: error
      type(simulation_type) :: simulation
      type(output_type) :: output
      type(restart_type) :: restart
      type(course_type) :: course
      integer :: outer

      associate (cost => simulation%scene%system%cost)
         call start_clock(cost)
         output%log%terminal = .not. command%quiet
         call catch_signals()
         call ignore_signals([broken_pipe, file_too_large])
         call start_publishing(output%publishing)
         call start_watch(output%watch, command%deck, command%time_limit, output%publishing%last)
         if (.not. allocated(command%restart)) call check_output(command%output, &
               command%overwrite, error)
         if (allocated(error)) return
         call enter(cost, phase_read, outer)
         call read_model(simulation%model, command, output%preview, error)
         if (.not. allocated(error)) call read_restart(restart, command, simulation%model, error)
         call leave(cost, outer)
         if (allocated(error)) return
         if (is_finished(restart, simulation%model)) then
            call say(output%log, 'nothing is left to do: '''//restart%path//''' is complete')
            return
         end if
         call enter(cost, phase_build, outer)
         call prepare(simulation, output%log, .false., output%preview, error)
         if (allocated(error)) return
         output%end_time = simulation%motion%motion%t
         call rebuild(simulation, error)
         if (restart%wanted .and. .not. allocated(error)) call restore_state(simulation, course, &
               restart%archive, error)
         call leave(cost, outer)
         if (.not. allocated(error)) then
            call enter(cost, phase_output, outer, .true.)
            call open_outputs(restart, command, simulation, output, error)
            call leave(cost, outer)
         end if
      end associate
      if (allocated(error)) then
         call simulation%scene%system%matrices%release()
         return
      end if
      call run_steps(simulation, command, restart, course, output, error)
      call finish_run(simulation, command, course, output, report, error)
   end subroutine run_deck

   !> What follows the last increment, however it ended: the state kept, files closed, the summary.
   subroutine finish_run(simulation, command, course, output, report, error)
      type(simulation_type), intent(inout) :: simulation
      type(command_type), intent(in) :: command
      type(course_type), intent(inout) :: course
      type(output_type), intent(inout) :: output
      type(json_type), intent(inout) :: report
      type(error_type), allocatable, intent(inout) :: error
      type(advice_list_type) :: lessons
      type(error_type), allocatable :: close_error, ignored

      call keep_if_interrupted(simulation, course, output, error)
      call tell_how_to_go_on(command, error)
      call remove_stop_files(output%watch)
      call end_progress(output%log%progress, .not. allocated(error), place_of(simulation, course))
      ! status lines come before the state that goes on behind them; what fails is told at the end
      call end_status(output%log, ignored)
      call close_results(output%results, simulation%scene, close_error)
      call merge_errors(error, close_error, output%results%file)
      call report_summary(simulation, output%tally, output%preview%memory, output%log)
      if (.not. allocated(error)) call advise_end(lessons, simulation)
      call report_advice(lessons, output%log)
      if (command%json) call describe_run(report, simulation, output, lessons)
      call end_log(output%log, error)
      call simulation%scene%system%matrices%release()
   end subroutine finish_run

   !> What stopped the run, and what became of its results. A file that could not be written is told
   !> in the words of its closing, which knows how that ended.
   subroutine merge_errors(error, close_error, file)
      type(error_type), allocatable, intent(inout) :: error, close_error
      type(hdf5_file_type), intent(in) :: file   !! of the results, closed
      character(len=:), allocatable :: remark
      logical :: superseded

      superseded = .not. allocated(error)
      if (.not. superseded) superseded = error%status == status_interrupted .or. &
            (error%status == status_file .and. file%saved)
      if (superseded .and. allocated(close_error)) call move_alloc(close_error, error)
      remark = file%remark()
      if (.not. allocated(error) .or. len(remark) == 0) return
      error%message = error%message//new_line('a')//'  results: '//remark
   end subroutine merge_errors

   !> The cure of an interruption.
   subroutine tell_how_to_go_on(command, error)
      type(command_type), intent(in) :: command
      type(error_type), allocatable, intent(inout) :: error
      integer :: i

      if (.not. allocated(error)) return
      if (error%status /= status_interrupted) return
      error%message = error%message//new_line('a')//'  to go on: carom run ' &
            //shell_word(command%deck)//' --restart '//shell_word(command%output)
      do i = 1, size(command%definitions)
         error%message = error%message//' --define '//shell_word(command%definitions(i)%name &
               //'='//command%definitions(i)%value)
      end do
   end subroutine tell_how_to_go_on

   !> Ends the log and closes it.
   subroutine end_log(log, error)
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: close_error

      call report_end(log, error)
      call close_log(log, close_error)
      if (.not. allocated(error) .and. allocated(close_error)) call move_alloc(close_error, error)
   end subroutine end_log

   !> The last line of the log: how the run ended; what a message says beyond its first line, as the
   !> cure, goes before. The terminal gets the message from the main program.
   subroutine report_end(log, error)
      type(log_type), intent(in) :: log
      type(error_type), allocatable, intent(in) :: error
      integer :: cut

      if (.not. allocated(error)) then
         call say(log, 'completed')
         return
      end if
      cut = index(error%message//new_line('a'), new_line('a'))
      if (cut < len(error%message)) call note(log, error%message(cut + 1:))
      call note(log, 'stopped: '//error%message(:cut - 1))
   end subroutine report_end

   !> Back to the start of the run after the rehearsal of its steps.
   subroutine rebuild(simulation, error)
      type(simulation_type), intent(inout) :: simulation
      type(error_type), allocatable, intent(out) :: error

      deallocate (simulation%scene%system%motions%motions, simulation%scene%system%loads%loads)
      call initial_motion(simulation, error)
   end subroutine rebuild

   !> All steps, or those that a restart has left.
   subroutine run_steps(simulation, command, restart, course, output, error)
      type(simulation_type), intent(inout) :: simulation
      type(command_type), intent(in) :: command
      type(restart_type), intent(inout) :: restart
      type(course_type), intent(inout) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      call report_model(simulation, output%log)
      call report_preview(output%preview, simulation, .false., output%log)
      call report_notes(simulation, output%log)
      if (restart%wanted) then
         call simulation%scene%system%cost%pass_times(restart%archive)
         call begin_again(restart, simulation, course, output, error)
         if (allocated(error)) return
      end if
      call start_progress(output%log%progress, .not. output%log%terminal, simulation%model%steps)
      do i = max(1, course%step), size(simulation%model%steps)
         if (simulation%model%steps(i)%procedure == procedure_frequency) then
            call keep_before_step(simulation, course, output, error)
            if (allocated(error)) return
         end if
         if (i > course%step) call begin_course(course, i, simulation%motion%motion%t)
         if (simulation%model%steps(i)%procedure == procedure_frequency) then
            call run_frequency_step(simulation, i, output%results, output%log, error)
         else
            call run_step(simulation, course, output, error)
         end if
         call count_up(output%tally, simulation, i)
         if (allocated(error)) return
      end do
      call keep_at_end(simulation, course, output, error)
   end subroutine run_steps

end module simulation
