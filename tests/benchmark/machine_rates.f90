!> What the machine can do, to be measured beside the program's own kernels: matrix products, and
!> the reading and writing of arrays too large for its caches.
module machine_rates
   use kinds, only: wp
   use clock, only: seconds_now
   use blas_interfaces, only: ddot
   implicit none
   private

   public :: rates_type, new_rates, product_rate, read_rate, triad_rate

   integer, parameter :: order = 1200            !! of the matrices that are multiplied
   integer, parameter :: length = 32000000       !! of the arrays that are read and written

   interface
      subroutine dgemm(transa, transb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
         import :: wp
         implicit none
         character(len=1), intent(in) :: transa, transb
         integer, intent(in) :: m, n, k, lda, ldb, ldc
         real(wp), intent(in) :: alpha, a(lda, k), b(ldb, n), beta
         real(wp), intent(inout) :: c(ldc, n)
      end subroutine dgemm
   end interface

   !> The arrays the rates are measured with.
   type :: rates_type
      real(wp), allocatable :: a(:, :), b(:, :), c(:, :)   !! (order, order)
      real(wp), allocatable :: x(:), y(:), z(:)            !! (length)
   end type rates_type

contains

   !> Arrays that have been touched, so that their memory is there.
   subroutine new_rates(self)
      type(rates_type), intent(out) :: self

      allocate (self%a(order, order), self%b(order, order), self%c(order, order))
      allocate (self%x(length), self%y(length), self%z(length))
      self%a = 1.0_wp
      self%b = 0.5_wp
      self%c = 0.0_wp
      self%x = 1.0_wp
      self%y = 0.5_wp
      self%z = 0.0_wp
   end subroutine new_rates

   !> Operations a second of one dgemm with the threads now set.
   subroutine product_rate(self, rate)
      type(rates_type), intent(inout) :: self
      real(wp), intent(out) :: rate
      real(wp) :: started

      started = seconds_now()
      call dgemm('N', 'N', order, order, order, 1.0_wp, self%a, order, self%b, order, 0.0_wp, &
            self%c, order)
      rate = 2.0_wp*real(order, wp)**3/(seconds_now() - started)
   end subroutine product_rate

   !> Bytes a second of reading one array, as the sum of its squares.
   subroutine read_rate(self, rate)
      type(rates_type), intent(inout) :: self
      real(wp), intent(out) :: rate
      real(wp) :: started

      started = seconds_now()
      self%z(1) = ddot(length, self%x, 1, self%x, 1)
      rate = 8.0_wp*real(length, wp)/(seconds_now() - started)
   end subroutine read_rate

   !> Bytes a second of z = x + 2 y, those read and those written.
   subroutine triad_rate(self, rate)
      type(rates_type), intent(inout) :: self
      real(wp), intent(out) :: rate
      real(wp) :: started

      started = seconds_now()
      self%z = self%x + 2.0_wp*self%y
      rate = 24.0_wp*real(length, wp)/(seconds_now() - started)
   end subroutine triad_rate

end module machine_rates
