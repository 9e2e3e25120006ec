!> Signals that ask the program to stop: SIGINT, SIGTERM and SIGHUP. The first one is noted, for the
!> run to look at between two increments; a second one ends the process at once.
module stop_signals
   use, intrinsic :: iso_c_binding, only: c_int, c_long, c_size_t, c_intptr_t, c_char, c_funptr, &
         c_funloc, c_null_funptr
   use kinds, only: wp
   use clock, only: seconds_now
   use errors, only: status_interrupted
   implicit none
   private

   public :: catch_signals, signal_came, signal_name

   !> What has been caught.
   type :: caught_type
      integer(c_int) :: signal = 0               !! number of the first signal
      real(wp) :: time = 0.0_wp                  !! of the clock, seconds
   end type caught_type

   !> Numbers of the signals, the same on all systems with signals of these names.
   integer(c_int), parameter :: hang_up = 1, interrupt = 2, terminate = 15
   !> Signals so near to the first one, in seconds, are the same request: `timeout` and some batch
   !> systems send theirs to the process and to its group.
   real(wp), parameter :: same_request = 0.1_wp
   integer(c_int), parameter :: standard_error = 2
   character(len=*), parameter :: first_answer = new_line('a') &
         //'carom: stops after the increment at hand, with the state saved; ' &
         //'a second signal stops at once'//new_line('a')
   character(len=*), parameter :: second_answer = new_line('a')//'carom: stopped at once' &
         //new_line('a')

   ! The one variable of a module: a handler has no other way to tell.
   type(caught_type), volatile :: caught

   interface
      function set_handler(number, handler) bind(c, name='signal') result(before)
         import :: c_int, c_funptr
         implicit none
         integer(c_int), value :: number
         type(c_funptr), value :: handler
         type(c_funptr) :: before
      end function set_handler

      function write_bytes(descriptor, text, length) bind(c, name='write') result(written)
         import :: c_int, c_char, c_size_t, c_long
         implicit none
         integer(c_int), value :: descriptor
         character(kind=c_char), intent(in) :: text(*)
         integer(c_size_t), value :: length
         integer(c_long) :: written
      end function write_bytes

      subroutine leave_process(status) bind(c, name='_exit')
         import :: c_int
         implicit none
         integer(c_int), value :: status
      end subroutine leave_process
   end interface

contains

   !> From here on signals are noted. SIGHUP stays ignored where it is, as under nohup. SIGINT does
   !> not: shells ignore it for what they run in the background, where only `kill` sends it.
   subroutine catch_signals()
      integer(c_intptr_t), parameter :: ignored = 1
      type(c_funptr) :: before

      before = set_handler(interrupt, c_funloc(note_signal))
      before = set_handler(terminate, c_funloc(note_signal))
      before = set_handler(hang_up, transfer(ignored, c_null_funptr))
      if (transfer(before, ignored) /= ignored) before = set_handler(hang_up, &
            c_funloc(note_signal))
   end subroutine catch_signals

   !> Whether a signal has asked to stop.
   logical function signal_came()
      signal_came = caught%signal /= 0
   end function signal_came

   !> The name of the signal that came first.
   function signal_name() result(name)
      character(len=:), allocatable :: name

      select case (caught%signal)
      case (hang_up)
         name = 'SIGHUP'
      case (interrupt)
         name = 'SIGINT'
      case (terminate)
         name = 'SIGTERM'
      case default
         name = 'no signal'
      end select
   end function signal_name

   !> The handler. It may be called within any other procedure and uses only what is safe there.
   subroutine note_signal(number) bind(c)
      integer(c_int), value :: number
      integer(c_long) :: written

      if (caught%signal == 0) then
         caught%time = seconds_now()
         caught%signal = number
         written = write_bytes(standard_error, first_answer, len(first_answer, c_size_t))
      else if (.not. abs(seconds_now() - caught%time) < same_request) then
         written = write_bytes(standard_error, second_answer, len(second_answer, c_size_t))
         call leave_process(int(status_interrupted, c_int))
      end if
   end subroutine note_signal

end module stop_signals
