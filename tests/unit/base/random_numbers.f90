!> Random numbers for the tests, the same in every run.
module random_numbers
   use kinds, only: wp
   implicit none
   private

   public :: seed_random, random_integer, random_real, random_vector, random_matrix, random_spd

contains

   !> Starts the sequence that belongs to a number.
   subroutine seed_random(number)
      integer, intent(in) :: number
      integer, allocatable :: seed(:)
      integer :: n, i
      real(wp) :: unused

      call random_seed(size=n)
      seed = [(1000*number + 37*i, i=1, n)]
      call random_seed(put=seed)
      do i = 1, 10
         call random_number(unused)
      end do
   end subroutine seed_random

   !> Any of low, low + 1, ..., high.
   integer function random_integer(low, high)
      integer, intent(in) :: low, high
      real(wp) :: x

      call random_number(x)
      random_integer = low + min(int(x*real(high - low + 1, wp)), high - low)
   end function random_integer

   !> Uniform between low and high.
   real(wp) function random_real(low, high)
      real(wp), intent(in) :: low, high

      call random_number(random_real)
      random_real = low + (high - low)*random_real
   end function random_real

   !> n numbers uniform between -1 and 1.
   function random_vector(n) result(x)
      integer, intent(in) :: n
      real(wp) :: x(n)

      call random_number(x)
      x = 2.0_wp*x - 1.0_wp
   end function random_vector

   !> (m, n) numbers uniform between -1 and 1.
   function random_matrix(m, n) result(x)
      integer, intent(in) :: m, n
      real(wp) :: x(m, n)

      call random_number(x)
      x = 2.0_wp*x - 1.0_wp
   end function random_matrix

   !> A symmetric positive definite matrix with eigenvalues of at least 0.01.
   function random_spd(n) result(a)
      integer, intent(in) :: n
      real(wp) :: a(n, n)
      real(wp) :: root(n, n)
      integer :: i

      root = random_matrix(n, n)
      a = matmul(root, transpose(root))
      do i = 1, n
         a(i, i) = a(i, i) + 0.01_wp
      end do
   end function random_spd

end module random_numbers
