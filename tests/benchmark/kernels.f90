!> Times the kernels of carom beside what the machine can do, a line `name value` for each figure:
!>
!>     kernels machine THREADS            dgemm, reading and writing memory
!>     kernels read DECK                  reading a deck, building the model
!>     kernels matrix DECK THREADS SEC    the effective matrix of its first step; rounds for SEC
!>                                        seconds, by turns with one thread and with THREADS
!>     kernels sparse DECK SEC            the same matrix with MUMPS, through carom and directly;
!>                                        nothing in a build without MUMPS
program kernels
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use kinds, only: wp, int64
   use errors, only: error_type
   use clock, only: seconds_now
   use threads, only: set_threads
   use skyline_matrix, only: skyline_type, profile_entries, profile_cost, stored_bytes
   use deck_reader, only: read_deck, definition_type
   use scene_setup, only: simulation_type, build_scene, begin_step
   use machine_rates, only: rates_type, new_rates, product_rate, read_rate, triad_rate
   use matrix_timing, only: timing_type, new_timing, time_round, column_operations
   use mumps_solver, only: mumps_available
   use sparse_timing, only: sparse_timing_type, time_sparse
   implicit none

   select case (word(1))
   case ('machine')
      call time_machine(number(2))
   case ('read')
      call time_reading(word(2))
   case ('matrix')
      call time_matrix(word(2), number(3), real(number(4), wp))
   case ('sparse')
      call time_sparse_matrix(word(2), real(number(3), wp))
   case default
      write (error_unit, '(a)') 'kernels machine THREADS | read DECK | matrix DECK THREADS ' &
            //'SECONDS | sparse DECK SECONDS'
      stop 1
   end select

contains

   !> A word of the command line.
   function word(i)
      integer, intent(in) :: i
      character(len=:), allocatable :: word
      integer :: length

      call get_command_argument(i, length=length)
      allocate (character(len=length) :: word)
      call get_command_argument(i, word)
   end function word

   !> A number of the command line.
   integer function number(i)
      integer, intent(in) :: i
      character(len=:), allocatable :: text
      integer :: status

      text = word(i)
      read (text, *, iostat=status) number
      if (status /= 0) error stop 'kernels: a number is missing'
   end function number

   !> Writes one figure.
   subroutine show(name, value, n_threads)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: value
      integer, intent(in), optional :: n_threads

      if (present(n_threads)) then
         write (output_unit, '(a, i0, a, es16.9)') name//'_', n_threads, 't ', value
      else
         write (output_unit, '(a, es16.9)') name//' ', value
      end if
      flush (output_unit)
   end subroutine show

   !> Ends the program if there is an error.
   subroutine insist(error)
      type(error_type), allocatable, intent(in) :: error

      if (.not. allocated(error)) return
      write (error_unit, '(a)') 'error: '//error%message
      stop 2
   end subroutine insist

   !> The best of five, with one thread and with more.
   subroutine time_machine(most_threads)
      integer, intent(in) :: most_threads
      type(rates_type) :: rates
      real(wp) :: best(3), rate
      integer :: n_threads, i

      call new_rates(rates)
      do n_threads = 1, most_threads, max(1, most_threads - 1)
         call set_threads(n_threads)
         best = 0.0_wp
         do i = 1, 5
            call product_rate(rates, n_threads, rate)
            best(1) = max(best(1), rate)
            call read_rate(rates, n_threads, rate)
            best(2) = max(best(2), rate)
            call triad_rate(rates, rate)
            best(3) = max(best(3), rate)
         end do
         call show('dgemm_flops', best(1), n_threads)
         call show('read_bytes', best(2), n_threads)
         if (n_threads == 1) call show('triad_bytes', best(3), n_threads)
      end do
   end subroutine time_machine

   !> Reads a deck and builds its first step.
   subroutine time_reading(path)
      character(len=*), intent(in) :: path
      type(simulation_type) :: simulation
      integer(int64) :: bytes

      inquire (file=path, size=bytes)
      call show('bytes', real(bytes, wp))
      call prepare(simulation, path)
   end subroutine time_reading

   subroutine prepare(simulation, path)
      type(simulation_type), intent(out) :: simulation
      character(len=*), intent(in) :: path
      type(definition_type) :: definitions(0)
      type(error_type), allocatable :: error
      real(wp) :: started

      started = seconds_now()
      call read_deck(simulation%model, path, definitions, error)
      call insist(error)
      call show('read_seconds', seconds_now() - started)
      started = seconds_now()
      call build_scene(simulation, error)
      call insist(error)
      call show('build_seconds', seconds_now() - started)
      started = seconds_now()
      call begin_step(simulation, 1, error)
      call insist(error)
      call show('begin_seconds', seconds_now() - started)
   end subroutine prepare

   !> At least one round with each number of threads, then until the time is used up.
   subroutine time_matrix(path, most_threads, seconds)
      character(len=*), intent(in) :: path
      integer, intent(in) :: most_threads
      real(wp), intent(in) :: seconds
      type(simulation_type) :: simulation
      type(rates_type) :: rates
      type(skyline_type) :: matrix
      type(timing_type) :: timings(2)
      real(wp) :: started
      integer :: i, n_kinds

      call prepare(simulation, path)
      call new_rates(rates)
      n_kinds = merge(2, 1, most_threads > 1)
      call new_timing(timings(1), 1)
      call new_timing(timings(2), most_threads)
      started = seconds_now()
      do
         do i = 1, n_kinds
            call time_round(timings(i), simulation, rates, matrix)
         end do
         if (seconds_now() - started > seconds) exit
      end do
      associate (profile => simulation%scene%system%profile)
         call show('equations', real(profile%n, wp))
         call show('profile_entries', real(profile_entries(profile), wp))
         call show('profile_cost', profile_cost(profile))
         call show('factor_operations', column_operations(profile))
         call show('stored_bytes', real(stored_bytes(matrix), wp))
      end associate
      do i = 1, n_kinds
         call show_timing(timings(i))
      end do
   end subroutine time_matrix

   subroutine show_timing(timing)
      type(timing_type), intent(in) :: timing

      call show('rounds', real(timing%n_rounds, wp), timing%n_threads)
      call show('assemble_seconds', timing%assemble, timing%n_threads)
      call show('factor_seconds', timing%factorize, timing%n_threads)
      call show('solve_seconds', timing%solve, timing%n_threads)
      call show('dgemm_flops', timing%product_rate, timing%n_threads)
      call show('read_bytes', timing%read_rate, timing%n_threads)
      call show('solution_error', timing%solution_error, timing%n_threads)
   end subroutine show_timing

   !> Rounds for so many seconds with MUMPS.
   subroutine time_sparse_matrix(path, seconds)
      character(len=*), intent(in) :: path
      real(wp), intent(in) :: seconds
      type(simulation_type) :: simulation
      type(sparse_timing_type) :: timing
      type(error_type), allocatable :: error

      if (.not. mumps_available()) return
      call set_threads(1)
      call prepare(simulation, path)
      call time_sparse(timing, simulation, seconds, error)
      call insist(error)
      call show('mumps_rounds', real(timing%n_rounds, wp))
      call show('mumps_matrix_entries', timing%matrix_entries)
      call show('mumps_bytes', 8.0_wp*timing%entries)
      call show('mumps_operations', timing%operations)
      call show('mumps_assemble_seconds', timing%assemble)
      call show('mumps_analyse_seconds', timing%analyse(1))
      call show('mumps_factor_seconds', timing%factorize(1))
      call show('mumps_solve_seconds', timing%solve(1))
      call show('direct_analyse_seconds', timing%analyse(2))
      call show('direct_factor_seconds', timing%factorize(2))
      call show('direct_solve_seconds', timing%solve(2))
      call show('mumps_difference', timing%difference)
   end subroutine time_sparse_matrix

end program kernels
