!> Largest eigenvalue of small symmetric problems.
module small_eigen
   use kinds, only: wp
   use blas_interfaces, only: dsygv
   implicit none
   private

   public :: largest_eigenvalue, eigenvalue_bound

contains

   !> Largest lambda of K x = lambda diag(m) x, by LAPACK.
   pure function largest_eigenvalue(k, m) result(lambda)
      real(wp), intent(in) :: k(:, :)      !! (n, n) symmetric
      real(wp), intent(in) :: m(:)         !! (n) positive
      real(wp) :: lambda
      real(wp) :: a(size(m), size(m)), b(size(m), size(m)), w(size(m)), work(8*size(m) + 1)
      integer :: i, info

      lambda = 0.0_wp
      if (size(m) == 0) return
      a = k
      b = 0.0_wp
      do i = 1, size(m)
         b(i, i) = m(i)
      end do
      call dsygv(1, 'N', 'U', size(m), a, size(m), b, size(m), w, work, size(work), info)
      if (info == 0) lambda = w(size(m))
   end function largest_eigenvalue

   !> A bound on the same eigenvalue, K positive semidefinite, not far above it: the root of the sum
   !> of eighth powers of all, from two squarings of M^-1/2 K M^-1/2.
   pure function eigenvalue_bound(k, m) result(bound)
      real(wp), intent(in) :: k(:, :)      !! (n, n) symmetric
      real(wp), intent(in) :: m(:)         !! (n) positive
      real(wp) :: bound
      real(wp), parameter :: round_off = 1.0e-10_wp
      real(wp) :: a(size(m), size(m)), b(size(m), size(m)), root(size(m)), trace
      integer :: i

      root = 1.0_wp/sqrt(m)
      trace = 0.0_wp
      do i = 1, size(m)
         a(:, i) = k(:, i)*root*root(i)
         trace = trace + a(i, i)
      end do
      bound = 0.0_wp
      if (.not. trace > 0.0_wp) return
      a = a/trace
      b = matmul(a, a)
      a = matmul(b, b)
      bound = trace*(sum(a**2)**0.125_wp + round_off)
   end function eigenvalue_bound

end module small_eigen
