!> All eigenvalues of K x = lambda M x that are finite, by condensation to the equations with mass:
!> with F the part of (K - sigma M)^-1 that belongs to them, F M z = z/(lambda - sigma).
module condensed_eigen
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use blas_interfaces, only: dsygv
   use skyline_matrix, only: skyline_type, diagonal, multiply
   use skyline_ldlt, only: solve
   implicit none
   private

   public :: condense

   !> Eigenvalues of F M below this part of the largest are those of modes without mass.
   real(wp), parameter :: massless = 1.0e-15_wp

contains

   !> Finds the lowest eigenvalues, as many as asked for or as exist. `info` is LAPACK's.
   subroutine condense(factors, mass, sigma, n_wanted, lambda, x, info)
      type(skyline_type), intent(in) :: factors  !! of K - sigma M, positive definite
      type(skyline_type), intent(in) :: mass
      real(wp), intent(in) :: sigma
      integer, intent(in) :: n_wanted
      real(wp), allocatable, intent(out) :: lambda(:)   !! ascending
      real(wp), allocatable, intent(out) :: x(:, :)     !! (n_eq, size(lambda)) of unit modal mass
      integer, intent(out) :: info
      real(wp), allocatable :: m(:, :), f(:, :), mu(:), work(:)
      integer, allocatable :: rows(:)
      integer :: i, n, n_found, status

      rows = pack([(i, i=1, mass%n)], diagonal(mass) > 0.0_wp)
      n = size(rows)
      allocate (m(n, n), f(n, n), mu(n), work(34*n + 1), stat=status)
      call check_allocation(status)
      do i = 1, n
         call column(rows(i), m(:, i), f(:, i))
      end do
      f = 0.5_wp*(f + transpose(f))
      call dsygv(3, 'V', 'U', n, m, n, f, n, mu, work, size(work), info)
      n_found = 0
      if (info == 0 .and. n > 0) n_found = min(n_wanted, count(mu > n*massless*mu(n)))
      allocate (lambda(n_found), x(mass%n, n_found), stat=status)
      call check_allocation(status)
      do i = 1, n_found
         lambda(i) = sigma + 1.0_wp/mu(n + 1 - i)
         x(:, i) = 0.0_wp
         x(rows, i) = m(:, n + 1 - i)
         x(:, i) = multiply(mass, x(:, i))
         call solve(factors, x(:, i))
         x(:, i) = x(:, i)/sqrt(dot_product(x(:, i), multiply(mass, x(:, i))))
      end do

   contains

      subroutine column(row, of_mass, of_flexibility)
         integer, intent(in) :: row
         real(wp), intent(out) :: of_mass(:), of_flexibility(:)
         real(wp) :: unit(mass%n)

         unit = 0.0_wp
         unit(row) = 1.0_wp
         call solve(factors, unit)
         of_flexibility = unit(rows)
         unit = 0.0_wp
         unit(row) = 1.0_wp
         unit = multiply(mass, unit)
         of_mass = unit(rows)
      end subroutine column

   end subroutine condense

end module condensed_eigen
