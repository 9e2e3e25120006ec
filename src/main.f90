!> carom: reads the command, runs it, reports an error and stops with its status. Of several ranks
!> the first does so, the others help it to solve.
program carom
   use, intrinsic :: iso_fortran_env, only: error_unit
   use, intrinsic :: iso_c_binding, only: c_int
   use errors, only: error_type, status_done, status_interrupted
   use command_line, only: command_type, read_command, usage_text, &
         command_run, command_check, command_version, command_reference
   use deck_help, only: print_help
   use program_version, only: version_text
   use simulation, only: run_deck
   use json_text, only: json_type
   use json_report, only: open_report, close_report
   use deck_check, only: check_deck
   use stop_signals, only: catch_signals
   use threads, only: set_threads
   use standard_output, only: print_line, flush_standard_output, check_standard_output
   use limited_start, only: start_without_pool
   use parallel_ranks, only: start_ranks, end_ranks, my_rank
   use mumps_solver, only: serve_rank_zero, dismiss_ranks
   implicit none

   interface
      subroutine exit_process(status) bind(c, name='exit')
         import :: c_int
         implicit none
         integer(c_int), value :: status
      end subroutine exit_process
   end interface

   type(command_type) :: command
   type(json_type) :: report
   type(error_type), allocatable :: error, lost
   integer :: status

   call start_without_pool()
   call start_ranks()
   call read_command(command, error)
   if (command%json) call open_report(report, command)
   if (my_rank() > 0) then
      call set_threads(command%threads)
      if (command%kind == command_run) call catch_signals()
      call serve_rank_zero(status)
      call end_ranks()
      call exit_process(int(status, c_int))
   end if
   if (.not. allocated(error)) then
      select case (command%kind)
      case (command_run)
         call set_threads(command%threads)
         call run_deck(command, report, error)
      case (command_check)
         call set_threads(command%threads)
         call check_deck(command, report, error)
      case (command_reference)
         call print_help(command%topic, error)
      case (command_version)
         call print_line('carom '//version_text())
      case default
         call print_line(usage_text())
      end select
   end if
   if (command%json) then
      call close_report(report, error)
      call print_line(report%text())
   end if
   ! a run's results are in its files, those of all else are what was printed
   if (command%json .or. command%kind /= command_run) call check_standard_output(lost)
   if (allocated(lost) .and. .not. allocated(error)) call move_alloc(lost, error)
   status = status_done
   if (allocated(error)) then
      ! what has been said goes first, where both go to one place
      call flush_standard_output()
      write (error_unit, '(a)') trim(merge('stopped:', 'error:  ', error%status == &
            status_interrupted))//' '//error%message
      status = error%status
   end if
   call dismiss_ranks(status)
   call end_ranks()
   if (status /= status_done) call exit_process(int(status, c_int))
end program carom
