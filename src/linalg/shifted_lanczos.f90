!> The eigenvalues of K x = lambda M x nearest to a shift sigma below all of them, by the implicitly
!> restarted Lanczos method of ARPACK on (K - sigma M)^-1 M in the product of M (its mode 3).
module shifted_lanczos
   use kinds, only: wp, int64
   use memory_shortage, only: check_allocation
   use arpack_interfaces, only: dsaupd, dseupd
   use skyline_matrix, only: skyline_type, multiply
   use skyline_ldlt, only: solve
   implicit none
   private

   public :: lanczos

   integer, parameter :: max_restarts = 1000
   integer, parameter :: start_given = 1, shift_invert = 3
   integer, parameter :: multiply_and_solve = -1, solve_only = 1, done = 99

contains

   !> Finds size(lambda) eigenvalues. `info` is ARPACK's: 0 when all have converged.
   subroutine lanczos(factors, mass, sigma, n_basis, lambda, x, info)
      type(skyline_type), intent(in) :: factors  !! of K - sigma M
      type(skyline_type), intent(in) :: mass
      real(wp), intent(in) :: sigma
      integer, intent(in) :: n_basis             !! Lanczos vectors, more than eigenvalues
      real(wp), intent(out) :: lambda(:)         !! ascending
      real(wp), intent(out) :: x(:, :)           !! (n_eq, n) of unit modal mass
      integer, intent(out) :: info
      real(wp), allocatable :: basis(:, :), work(:), small_work(:), residual(:)
      integer :: ido, settings(11), at(11), n, n_wanted, status
      real(wp) :: tolerance
      logical :: chosen(n_basis)

      n = factors%n
      n_wanted = size(lambda)
      allocate (basis(n, n_basis), work(3*n), small_work(n_basis*(n_basis + 8)), stat=status)
      call check_allocation(status)
      basis = 0.0_wp
      work = 0.0_wp
      small_work = 0.0_wp
      residual = start_vector(n)
      settings = 0
      settings([1, 3, 7]) = [1, max_restarts, shift_invert]
      at = 0
      tolerance = 0.0_wp
      info = start_given
      ido = 0
      do
         call dsaupd(ido, 'G', n, 'LM', n_wanted, tolerance, residual, n_basis, basis, n, &
               settings, at, work, small_work, size(small_work), info)
         if (ido == done) exit
         call answer(factors, mass, ido, at, work)
      end do
      if (info /= 0) return
      lambda = 0.0_wp
      x = 0.0_wp
      chosen = .true.
      call dseupd(.true., 'A', chosen, lambda, x, n, sigma, 'G', n, 'LM', n_wanted, tolerance, &
            residual, n_basis, basis, n, settings, at, work, small_work, size(small_work), info)
      if (info == 0 .and. settings(5) < n_wanted) info = 1
   end subroutine lanczos

   !> The product or the solution that ARPACK asks for, from one part of `work` to another.
   subroutine answer(factors, mass, ido, at, work)
      type(skyline_type), intent(in) :: factors, mass
      integer, intent(in) :: ido, at(:)
      real(wp), intent(inout) :: work(:)
      real(wp) :: y(factors%n)

      select case (ido)
      case (multiply_and_solve)
         y = multiply(mass, work(at(1):at(1) + size(y) - 1))
         call solve(factors, y)
      case (solve_only)
         y = work(at(3):at(3) + size(y) - 1)
         call solve(factors, y)
      case default
         y = multiply(mass, work(at(1):at(1) + size(y) - 1))
      end select
      work(at(2):at(2) + size(y) - 1) = y
   end subroutine answer

   !> The same in every run, with a share of every mode: a linear congruential sequence.
   pure function start_vector(n) result(x)
      integer, intent(in) :: n
      real(wp) :: x(n)
      integer(int64) :: state
      integer :: i

      state = 12345
      do i = 1, n
         state = modulo(1664525*state + 1013904223, 2_int64**32)
         x(i) = real(state, wp)/2.0_wp**31 - 1.0_wp
      end do
   end function start_vector

end module shifted_lanczos
