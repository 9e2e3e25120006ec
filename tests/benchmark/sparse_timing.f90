!> Times of the effective matrix with the sparse solver, through carom's own module and by turns
!> with MUMPS called directly for the same matrix; the best of all rounds kept.
module sparse_timing
   use kinds, only: wp, int64
   use errors, only: error_type
   use clock, only: seconds_now
   use sparse_matrix, only: pattern_type, sparse_report_type, pattern_entries
   use mumps_solver, only: mumps_type, analyse, factorize, solve, discard
   use sparse_effective, only: find_pattern, assemble_sparse
   use scene_setup, only: simulation_type
   use matrix_timing, only: effective_factors
   use direct_mumps, only: direct_type, direct_start, direct_analyse, direct_factorize, &
         direct_solve, direct_end
   implicit none
   private

   public :: sparse_timing_type, time_sparse

   !> Best figures; seconds. The first of each pair is carom's, the second that of MUMPS alone.
   type :: sparse_timing_type
      integer :: n_rounds = 0
      real(wp) :: assemble = huge(1.0_wp)
      real(wp) :: analyse(2) = huge(1.0_wp)
      real(wp) :: factorize(2) = huge(1.0_wp)
      real(wp) :: solve(2) = huge(1.0_wp)
      real(wp) :: entries = 0.0_wp               !! of the factor
      real(wp) :: operations = 0.0_wp            !! of a factorization
      real(wp) :: matrix_entries = 0.0_wp        !! of one triangle
      real(wp) :: difference = 0.0_wp            !! largest between both solutions
   end type sparse_timing_type

contains

   !> Rounds for so many seconds, one at least.
   subroutine time_sparse(self, simulation, seconds, error)
      type(sparse_timing_type), intent(out) :: self
      type(simulation_type), intent(in) :: simulation
      real(wp), intent(in) :: seconds
      type(error_type), allocatable, intent(out) :: error
      type(pattern_type) :: pattern
      type(mumps_type) :: own
      real(wp), allocatable :: values(:), x(:, :), y(:)
      real(wp) :: started, begun
      integer :: i

      begun = seconds_now()
      call find_pattern(simulation%scene%system%structure, pattern)
      self%matrix_entries = real(pattern_entries(pattern), wp)
      do
         started = seconds_now()
         associate (system => simulation%scene%system, state => simulation%motion%motion)
            call assemble_sparse(system%structure, pattern, state%d, state%history, &
                  effective_factors(simulation), values)
         end associate
         self%assemble = min(self%assemble, seconds_now() - started)
         x = reshape([(sin(real(i, wp)), i=1, pattern%n)], [pattern%n, 1])
         y = x(:, 1)
         call time_own(self, own, pattern, values, x, error)
         if (allocated(error)) return
         call discard(own)
         call time_direct(self, pattern, values, y)
         self%difference = max(self%difference, maxval(abs(x(:, 1) - y))/maxval(abs(y)))
         self%n_rounds = self%n_rounds + 1
         if (seconds_now() - begun > seconds) exit
      end do
   end subroutine time_sparse

   !> As a run of carom calls it.
   subroutine time_own(self, own, pattern, values, x, error)
      type(sparse_timing_type), intent(inout) :: self
      type(mumps_type), intent(inout) :: own
      type(pattern_type), intent(in), target :: pattern
      real(wp), intent(in), target :: values(:)
      real(wp), intent(inout), target, contiguous :: x(:, :)
      type(error_type), allocatable, intent(out) :: error
      type(sparse_report_type) :: report, unused
      real(wp) :: times(4)

      times(1) = seconds_now()
      call analyse(own, 1, pattern, report, error)
      if (allocated(error)) return
      times(2) = seconds_now()
      call factorize(own, pattern, values, unused, error)
      if (allocated(error)) return
      times(3) = seconds_now()
      call solve(own, x, error)
      times(4) = seconds_now()
      self%entries = report%entries
      self%operations = report%operations
      call keep_best(self, 1, times)
   end subroutine time_own

   !> With MUMPS alone.
   subroutine time_direct(self, pattern, values, y)
      type(sparse_timing_type), intent(inout) :: self
      type(pattern_type), intent(in), target :: pattern
      real(wp), intent(in), target :: values(:)
      real(wp), intent(inout), target, contiguous :: y(:)
      type(direct_type) :: direct
      real(wp) :: times(4)

      call direct_start(direct, pattern%n, pattern%row, pattern%column, values)
      times(1) = seconds_now()
      call direct_analyse(direct)
      times(2) = seconds_now()
      call direct_factorize(direct)
      times(3) = seconds_now()
      call direct_solve(direct, y)
      times(4) = seconds_now()
      call direct_end(direct)
      call keep_best(self, 2, times)
   end subroutine time_direct

   pure subroutine keep_best(self, i, times)
      type(sparse_timing_type), intent(inout) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: times(4)           !! before and between analysis, factor, solution

      self%analyse(i) = min(self%analyse(i), times(2) - times(1))
      self%factorize(i) = min(self%factorize(i), times(3) - times(2))
      self%solve(i) = min(self%solve(i), times(4) - times(3))
   end subroutine keep_best

end module sparse_timing
