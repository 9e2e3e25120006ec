!> Largest eigenvalue of small symmetric problems.
module small_eigen
   use kinds, only: wp
   use blas_interfaces, only: dsygv
   implicit none
   private

   public :: largest_eigenvalue, has_larger_eigenvalue

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

   !> Whether K x = lambda diag(m) x has an eigenvalue over a limit, round-off (1e-12 of the limit)
   !> apart: it has none if limit diag(m) - K is positive definite, which takes much less than the
   !> eigenvalues to find out.
   pure function has_larger_eigenvalue(k, m, limit) result(larger)
      real(wp), intent(in) :: k(:, :)      !! (n, n) symmetric
      real(wp), intent(in) :: m(:)         !! (n) positive
      real(wp), intent(in) :: limit
      logical :: larger
      real(wp), parameter :: round_off = 1.0e-12_wp
      real(wp) :: a(size(m), size(m)), factor
      integer :: i, j, n

      n = size(m)
      a = -k
      do i = 1, n
         a(i, i) = a(i, i) + (1.0_wp + round_off)*limit*m(i)
      end do
      larger = .true.
      do j = 1, n
         if (.not. a(j, j) > 0.0_wp) return
         do i = j + 1, n
            factor = a(i, j)/a(j, j)
            a(i:, i) = a(i:, i) - factor*a(i:, j)
         end do
      end do
      larger = .false.
   end function has_larger_eigenvalue

end module small_eigen
