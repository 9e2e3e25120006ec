!> What the machine can do, to be measured beside the program's own kernels: matrix products, and
!> the reading and writing of arrays too large for its caches.
module machine_rates
   use kinds, only: wp
   use clock, only: seconds_now
   use blas_interfaces, only: ddot, dgemm
   implicit none
   private

   public :: rates_type, new_rates, product_rate, read_rate, triad_rate

   integer, parameter :: order = 1200            !! of the matrices that are multiplied
   integer, parameter :: length = 32000000       !! of the arrays that are read and written

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

   !> Operations a second of a matrix product, the columns of the result shared among threads.
   subroutine product_rate(self, n_threads, rate)
      type(rates_type), intent(inout) :: self
      integer, intent(in) :: n_threads
      real(wp), intent(out) :: rate
      integer :: first, n, i
      real(wp) :: started

      started = seconds_now()
      n = order/n_threads
      !$omp parallel do num_threads(n_threads) private(first) schedule(static, 1)
      do i = 1, n_threads
         first = 1 + (i - 1)*n
         call dgemm('N', 'N', order, n, order, 1.0_wp, self%a, order, self%b(:, first), order, &
               0.0_wp, self%c(:, first), order)
      end do
      !$omp end parallel do
      rate = 2.0_wp*real(order, wp)**2*real(n*n_threads, wp)/(seconds_now() - started)
   end subroutine product_rate

   !> Bytes a second of reading one array, as the sum of its squares, in equal parts by threads.
   subroutine read_rate(self, n_threads, rate)
      type(rates_type), intent(inout) :: self
      integer, intent(in) :: n_threads
      real(wp), intent(out) :: rate
      integer :: first, n, i
      real(wp) :: started, total

      started = seconds_now()
      n = length/n_threads
      total = 0.0_wp
      !$omp parallel do num_threads(n_threads) private(first) schedule(static, 1) reduction(+:total)
      do i = 1, n_threads
         first = 1 + (i - 1)*n
         total = total + ddot(n, self%x(first:), 1, self%x(first:), 1)
      end do
      !$omp end parallel do
      self%z(1) = total
      rate = 8.0_wp*real(n*n_threads, wp)/(seconds_now() - started)
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
