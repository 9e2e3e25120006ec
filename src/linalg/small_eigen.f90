!> Largest eigenvalue of small symmetric problems.
module small_eigen
   use kinds, only: wp
   use blas_interfaces, only: dsygv
   implicit none
   private

   public :: largest_eigenvalue

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

end module small_eigen
