!> carom: reads the command, runs it, reports an error and stops with its status.
program carom
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use, intrinsic :: iso_c_binding, only: c_int
   use errors, only: error_type
   use command_line, only: command_type, read_command, usage_text, version_text, &
         command_run, command_check, command_version
   use simulation, only: run_deck, check_deck
   use threads, only: set_threads
   implicit none

   interface
      subroutine exit_process(status) bind(c, name='exit')
         import :: c_int
         implicit none
         integer(c_int), value :: status
      end subroutine exit_process
   end interface

   type(command_type) :: command
   type(error_type), allocatable :: error

   call read_command(command, error)
   if (.not. allocated(error)) then
      select case (command%kind)
      case (command_run)
         call set_threads(command%threads)
         call run_deck(command, error)
      case (command_check)
         call check_deck(command, error)
      case (command_version)
         write (output_unit, '(a)') 'carom '//version_text
      case default
         write (output_unit, '(a)') usage_text()
      end select
   end if
   if (allocated(error)) then
      write (error_unit, '(a)') 'error: '//error%message
      call exit_process(int(error%status, c_int))
   end if
end program carom
