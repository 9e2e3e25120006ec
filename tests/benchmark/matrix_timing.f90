!> Times of the effective matrix of a deck's first step: assembled, factorized, solved with; each in
!> turn with what the machine can do, and the best of all rounds kept.
module matrix_timing
   use kinds, only: wp, int64
   use clock, only: seconds_now
   use threads, only: set_threads
   use skyline_matrix, only: skyline_type, profile_type, multiply
   use skyline_ldlt, only: factorize, solve, ldlt_report_type
   use effective_matrix, only: assemble_effective
   use scene_setup, only: simulation_type
   use machine_rates, only: rates_type, product_rate, read_rate
   implicit none
   private

   public :: timing_type, new_timing, time_round, effective_factors, column_operations

   integer, parameter :: n_solves = 3            !! in a round

   !> Best figures so far with one number of threads; seconds, rates a second.
   type :: timing_type
      integer :: n_threads = 1
      integer :: n_rounds = 0
      real(wp) :: assemble = huge(1.0_wp)
      real(wp) :: factorize = huge(1.0_wp)
      real(wp) :: solve = huge(1.0_wp)
      real(wp) :: product_rate = 0.0_wp          !! operations
      real(wp) :: read_rate = 0.0_wp             !! bytes
      real(wp) :: solution_error = 0.0_wp        !! largest error of a solution that is known
   end type timing_type

contains

   !> No figures yet.
   subroutine new_timing(self, n_threads)
      type(timing_type), intent(out) :: self
      integer, intent(in) :: n_threads

      self%n_threads = n_threads
   end subroutine new_timing

   !> c_m, c_c, c_k of the first step's increments: a = 1 is what is solved for.
   pure function effective_factors(simulation) result(factors)
      type(simulation_type), intent(in) :: simulation
      real(wp) :: factors(3)

      associate (newmark => simulation%scene%system%newmark, step => simulation%model%steps(1))
         factors = [1.0_wp, newmark%gamma*step%dt, newmark%beta*step%dt**2]
      end associate
   end function effective_factors

   !> Assembles, factorizes and solves once with the threads of `self`.
   subroutine time_round(self, simulation, rates, matrix)
      type(timing_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(rates_type), intent(inout) :: rates
      type(skyline_type), intent(inout) :: matrix
      type(ldlt_report_type) :: report
      real(wp), allocatable :: known(:), b(:), x(:)
      real(wp) :: started, rate
      integer :: i

      call set_threads(self%n_threads)
      started = seconds_now()
      associate (system => simulation%scene%system, state => simulation%motion%motion)
         call assemble_effective(system%structure, system%profile, state%d, state%history, &
               effective_factors(simulation), matrix)
      end associate
      self%assemble = min(self%assemble, seconds_now() - started)
      known = [(sin(real(i, wp)), i=1, matrix%n)]
      b = multiply(matrix, known)
      call product_rate(rates, self%n_threads, rate)
      self%product_rate = max(self%product_rate, rate)
      started = seconds_now()
      call factorize(matrix, report)
      self%factorize = min(self%factorize, seconds_now() - started)
      do i = 1, n_solves
         call product_rate(rates, self%n_threads, rate)
         self%product_rate = max(self%product_rate, rate)
         call read_rate(rates, self%n_threads, rate)
         self%read_rate = max(self%read_rate, rate)
         x = b
         started = seconds_now()
         call solve(matrix, x)
         self%solve = min(self%solve, seconds_now() - started)
      end do
      self%solution_error = max(self%solution_error, maxval(abs(x - known)))
      if (report%zero_pivot > 0) self%solution_error = huge(1.0_wp)
      self%n_rounds = self%n_rounds + 1
   end subroutine time_round

   !> Operations a factorization by columns needs within the profile: two for each entry above one
   !> computed that column i and column j share.
   pure function column_operations(profile) result(operations)
      type(profile_type), intent(in) :: profile
      real(wp) :: operations
      integer(int64) :: total
      integer :: i, j

      total = 0
      do j = 1, profile%n
         do i = profile%first_row(j) + 1, j
            total = total + max(0, i - max(profile%first_row(i), profile%first_row(j)))
         end do
      end do
      operations = 2.0_wp*real(total, wp)
   end function column_operations

end module matrix_timing
