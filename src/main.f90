!> carom: reads the command, runs it, reports an error and stops with its status. Of several ranks
!> the first does so, the others help it to solve.
program carom
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
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
   type(error_type), allocatable :: error
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
         write (output_unit, '(a)') 'carom '//version_text()
      case default
         write (output_unit, '(a)') usage_text()
      end select
   end if
   status = status_done
   if (allocated(error)) then
      ! what has been said goes first, where both go to one place
      flush (output_unit, iostat=status)
      if (status /= 0) status = error%status
      write (error_unit, '(a)') trim(merge('stopped:', 'error:  ', error%status == &
            status_interrupted))//' '//error%message
      status = error%status
   end if
   if (command%json) then
      call close_report(report, error)
      write (output_unit, '(a)') report%text()
   end if
   call dismiss_ranks(status)
   call end_ranks()
   if (status /= status_done) call exit_process(int(status, c_int))
end program carom
