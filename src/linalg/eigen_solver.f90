!> The lowest eigenvalues of K x = lambda M x with skyline matrices, K symmetric and M positive
!> semi-definite: equations without mass have infinite eigenvalues, which are left out.
!>
!> Both methods use the factors of K - sigma M. The shift sigma is 0 if K is positive definite;
!> else, as for a body that floats, it is a tenth of the highest wanted eigenvalue below zero, found
!> by starting from a thousandth of trace K / trace M.
module eigen_solver
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use skyline_matrix, only: skyline_type, diagonal, multiply, absolute
   use skyline_ldlt, only: factorize, ldlt_report_type
   use condensed_eigen, only: condense
   use shifted_lanczos, only: lanczos
   implicit none
   private

   public :: eigen_type, find_eigenvalues, small
   public :: outcome_found, outcome_singular, outcome_indefinite, outcome_not_converged

   integer, parameter :: outcome_found = 0
   integer, parameter :: outcome_singular = 1       !! an equation with neither mass nor stiffness
   integer, parameter :: outcome_indefinite = 2     !! K - sigma M is not definite for any sigma
   integer, parameter :: outcome_not_converged = 3

   !> Models with fewer equations with mass are condensed to these.
   integer, parameter :: small = 200
   !> Up to here condensation helps out when Lanczos' method fails.
   integer, parameter :: not_too_large = 3000
   !> Vectors that integers of ARPACK can count the products of.
   integer, parameter :: most_vectors = 40000
   !> Pivots below this part of the diagonal make the shift 0 too risky.
   real(wp), parameter :: safe_pivot = 1.0e-8_wp
   !> Largest |K x - lambda M x| as a part of |K| |x| + |lambda| |M| |x|.
   real(wp), parameter :: residual_tolerance = 1.0e-8_wp

   !> Eigenvalues and vectors, fewer than asked for if no more exist.
   type :: eigen_type
      real(wp), allocatable :: lambda(:)            !! ascending
      real(wp), allocatable :: x(:, :)              !! (n_eq, n) of unit modal mass
      real(wp), allocatable :: residual(:)          !! relative
      real(wp) :: sigma = 0.0_wp
      logical :: condensed = .false.                !! not by Lanczos' method
      integer :: n_factorizations = 0
      integer :: outcome = outcome_found
      integer :: equation = 0                       !! the singular one
   end type eigen_type

contains

   !> Finds the n_wanted lowest eigenvalues.
   subroutine find_eigenvalues(stiffness, mass, n_wanted, self)
      type(skyline_type), intent(in) :: stiffness, mass   !! of one profile
      integer, intent(in) :: n_wanted
      type(eigen_type), intent(out) :: self
      type(skyline_type) :: factors
      integer :: attempt, status
      real(wp) :: highest, before

      allocate (self%lambda(0), self%x(mass%n, 0), self%residual(0), stat=status)
      call check_allocation(status)
      if (.not. any(diagonal(mass) > 0.0_wp) .or. n_wanted < 1) return
      call choose_shift(stiffness, mass, self, factors)
      if (self%outcome /= outcome_found) return
      do attempt = 1, 4
         call solve_shifted(stiffness, mass, n_wanted, factors, self)
         if (self%outcome /= outcome_found) return
         if (.not. self%sigma < 0.0_wp) exit
         highest = maxval(self%lambda)
         if (.not. highest > 0.0_wp) exit
         if (-self%sigma > 0.01_wp*highest .and. -self%sigma < highest) exit
         before = self%sigma
         call try_shift(stiffness, mass, -0.1_wp*highest, self, factors)
         if (self%outcome == outcome_found) cycle
         ! all that is wanted are rigid motions, with eigenvalues that are round-off
         self%sigma = before
         self%outcome = outcome_found
         exit
      end do
      call polish(stiffness, mass, self)
      if (any(self%residual > residual_tolerance)) self%outcome = outcome_not_converged
   end subroutine find_eigenvalues

   !> A shift below all eigenvalues, and the factors there.
   subroutine choose_shift(stiffness, mass, self, factors)
      type(skyline_type), intent(in) :: stiffness, mass
      type(eigen_type), intent(inout) :: self
      type(skyline_type), intent(out) :: factors
      real(wp) :: scale
      integer :: attempt

      call try_shift(stiffness, mass, 0.0_wp, self, factors)
      if (self%outcome == outcome_found) then
         if (all(diagonal(factors) > safe_pivot*diagonal(stiffness))) return
      end if
      scale = sum(abs(diagonal(stiffness)), mask=diagonal(mass) > 0.0_wp)/sum(diagonal(mass))
      if (.not. scale > 0.0_wp) scale = 1.0_wp
      do attempt = 0, 5
         call try_shift(stiffness, mass, -1.0e-3_wp*100.0_wp**attempt*scale, self, factors)
         if (self%outcome == outcome_found) return
      end do
   end subroutine choose_shift

   !> Factorizes K - sigma M, which should be positive definite.
   subroutine try_shift(stiffness, mass, sigma, self, factors)
      type(skyline_type), intent(in) :: stiffness, mass
      real(wp), intent(in) :: sigma
      type(eigen_type), intent(inout) :: self
      type(skyline_type), intent(out) :: factors
      type(ldlt_report_type) :: report

      factors = stiffness
      call factors%add_multiple(-sigma, mass)
      call factorize(factors, report)
      self%n_factorizations = self%n_factorizations + 1
      self%sigma = sigma
      self%equation = report%zero_pivot
      self%outcome = outcome_found
      if (report%n_negative > 0) self%outcome = outcome_indefinite
      if (report%zero_pivot > 0) self%outcome = outcome_singular
   end subroutine try_shift

   !> Lanczos' method with a growing basis until no eigenvalue is missing, or condensation.
   subroutine solve_shifted(stiffness, mass, n_wanted, factors, self)
      type(skyline_type), intent(in) :: stiffness, mass, factors
      integer, intent(in) :: n_wanted
      type(eigen_type), intent(inout) :: self
      real(wp), allocatable :: lambda(:), x(:, :)
      integer :: n_massive, n, n_basis, attempt, info, status

      n_massive = count(diagonal(mass) > 0.0_wp)
      if (n_massive > small .and. n_wanted <= n_massive/2) then
         ! two more than wanted: copies of repeated eigenvalues come late
         n = n_wanted + 2
         n_basis = max(2*n + 1, n + 20)
         do attempt = 1, 3
            if (min(n_basis, n_massive) > most_vectors) exit
            allocate (lambda(n), x(mass%n, n), stat=status)
            call check_allocation(status)
            call lanczos(factors, mass, self%sigma, min(n_basis, n_massive), lambda, x, info)
            self%lambda = lambda(:n_wanted)
            self%x = x(:, :n_wanted)
            if (info == 0) then
               if (is_complete(stiffness, mass, lambda, self)) return
            end if
            deallocate (lambda, x)
            n_basis = 2*n_basis
         end do
         self%outcome = outcome_not_converged
         if (n_massive > not_too_large) return
      end if
      self%condensed = .true.
      call condense(factors, mass, self%sigma, n_wanted, self%lambda, self%x, info)
      self%outcome = merge(outcome_found, outcome_not_converged, info == 0)
   end subroutine solve_shifted

   !> Whether no eigenvalue is missing: by Sylvester's law, K - s M has as many negative pivots as
   !> there are eigenvalues below s, which is taken in the last wide gap.
   logical function is_complete(stiffness, mass, lambda, self)
      type(skyline_type), intent(in) :: stiffness, mass
      real(wp), intent(in) :: lambda(:)
      type(eigen_type), intent(inout) :: self
      type(skyline_type) :: factors
      type(ldlt_report_type) :: report
      integer :: k

      is_complete = .true.
      do k = size(lambda) - 1, 1, -1
         if (lambda(k + 1) - lambda(k) > 1.0e-5_wp*abs(lambda(k + 1) - self%sigma)) exit
      end do
      if (k < 1) return
      factors = stiffness
      call factors%add_multiple(-0.5_wp*(lambda(k) + lambda(k + 1)), mass)
      call factorize(factors, report)
      self%n_factorizations = self%n_factorizations + 1
      is_complete = report%zero_pivot > 0 .or. report%n_negative == k
   end function is_complete

   !> Residuals; of sigma + 1/mu and Rayleigh's quotient the one with less round-off; zero for what
   !> cannot be told from it.
   subroutine polish(stiffness, mass, self)
      type(skyline_type), intent(in) :: stiffness, mass
      type(eigen_type), intent(inout) :: self
      type(skyline_type) :: absolute_stiffness, absolute_mass
      real(wp), dimension(mass%n) :: force, size_of_force
      real(wp) :: noise, noise_of_shift, quotient
      integer :: i, status

      absolute_stiffness = absolute(stiffness)
      absolute_mass = absolute(mass)
      deallocate (self%residual)
      allocate (self%residual(size(self%lambda)), stat=status)
      call check_allocation(status)
      do i = 1, size(self%lambda)
         associate (x => self%x(:, i), lambda => self%lambda(i))
            force = multiply(stiffness, x)
            size_of_force = multiply(absolute_stiffness, abs(x))
            quotient = dot_product(x, force)
            noise = epsilon(noise)*dot_product(abs(x), size_of_force)
            noise_of_shift = epsilon(noise)*(lambda - self%sigma)**2/(self%lambda(1) - self%sigma)
            if (noise < noise_of_shift) lambda = quotient
            if (self%sigma < 0.0_wp .and. abs(quotient) <= 10.0_wp*noise) lambda = 0.0_wp
            size_of_force = size_of_force + abs(lambda)*multiply(absolute_mass, abs(x))
            self%residual(i) = norm2(force - lambda*multiply(mass, x)) &
                  /max(norm2(size_of_force), tiny(1.0_wp))
         end associate
      end do
   end subroutine polish

end module eigen_solver
