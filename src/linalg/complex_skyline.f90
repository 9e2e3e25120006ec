!> Complex symmetric matrix (A = At, not Hermitian) in skyline storage, column by column from the
!> first row to the diagonal; factors L D Lt by Crout's method in place, and solutions. There is no
!> pivoting: the real part is to be positive definite, which keeps the pivots away from zero.
module complex_skyline
   use kinds, only: wp, int64
   use memory_shortage, only: check_allocation
   use blas_interfaces, only: zdotu, zaxpy
   use skyline_matrix, only: profile_type, skyline_type
   implicit none
   private

   public :: complex_skyline_type, new_complex_skyline, column_values

   !> A pivot smaller than this part of the diagonal entry it came from counts as zero.
   real(wp), parameter :: pivot_tolerance = 1.0e-13_wp

   !> Entry (i, j), i <= j, stands at values(diagonal_at(j) - j + i).
   type :: complex_skyline_type
      integer :: n = 0
      integer, allocatable :: top(:)                  !! (n) first row of each column
      integer(int64), allocatable :: diagonal_at(:)   !! (n) address of the diagonal entry
      complex(wp), allocatable :: values(:)
   contains
      procedure :: combine
      procedure :: factorize
      procedure :: solve
      procedure :: is_diagonal
   end type complex_skyline_type

contains

   !> A zero matrix of the given profile.
   pure subroutine new_complex_skyline(self, profile)
      type(complex_skyline_type), intent(out) :: self
      type(profile_type), intent(in) :: profile
      integer :: j, status

      self%n = profile%n
      self%top = profile%first_row
      allocate (self%diagonal_at(self%n), stat=status)
      call check_allocation(status)
      do j = 1, self%n
         self%diagonal_at(j) = j - self%top(j) + 1
         if (j > 1) self%diagonal_at(j) = self%diagonal_at(j) + self%diagonal_at(j - 1)
      end do
      allocate (self%values(last_address(self)), stat=status)
      call check_allocation(status)
      self%values = (0.0_wp, 0.0_wp)
   end subroutine new_complex_skyline

   pure integer(int64) function last_address(self)
      type(complex_skyline_type), intent(in) :: self

      last_address = 0
      if (self%n > 0) last_address = self%diagonal_at(self%n)
   end function last_address

   !> The entries of a real matrix within a profile, in the order of `values`.
   pure subroutine column_values(matrix, profile, values)
      type(skyline_type), intent(in) :: matrix
      type(profile_type), intent(in) :: profile
      real(wp), intent(out) :: values(:)
      integer(int64) :: k
      integer :: i, j

      k = 0
      do j = 1, profile%n
         do i = profile%first_row(j), j
            k = k + 1
            values(k) = matrix%entry(i, j)
         end do
      end do
   end subroutine column_values

   !> The sum of complex multiples of three real matrices, given by `column_values`.
   pure subroutine combine(self, factors, parts)
      class(complex_skyline_type), intent(inout) :: self
      complex(wp), intent(in) :: factors(3)
      real(wp), intent(in) :: parts(:, :)             !! (entries, 3)
      integer(int64) :: k

      do k = 1, size(self%values, kind=int64)
         self%values(k) = factors(1)*parts(k, 1) + factors(2)*parts(k, 2) + factors(3)*parts(k, 3)
      end do
   end subroutine combine

   !> Overwrites the matrix by its factors: L above the diagonal, D on it. Stops at the first
   !> vanishing (or not finite) pivot and names its equation, 0 if there is none.
   pure subroutine factorize(self, zero_pivot)
      class(complex_skyline_type), intent(inout) :: self
      integer, intent(out) :: zero_pivot
      real(wp) :: original, pivot
      integer :: j

      zero_pivot = 0
      do j = 1, self%n
         original = abs(self%values(self%diagonal_at(j)))
         if (self%top(j) < j) call reduce_column(self, j)
         pivot = abs(self%values(self%diagonal_at(j)))
         if (pivot > pivot_tolerance*original .and. pivot <= huge(pivot)) cycle
         zero_pivot = j
         return
      end do
   end subroutine factorize

   !> Turns column j into its part of Lt and its pivot.
   pure subroutine reduce_column(self, j)
      type(complex_skyline_type), intent(inout) :: self
      integer, intent(in) :: j
      integer(int64) :: base_i, base_j
      complex(wp) :: u
      integer :: i, common

      associate (values => self%values, top => self%top(j))
         base_j = self%diagonal_at(j) - j
         do i = top + 1, j - 1
            common = max(top, self%top(i))
            if (common >= i) cycle
            base_i = self%diagonal_at(i) - i
            values(base_j + i) = values(base_j + i) &
                  - zdotu(i - common, values(base_i + common:), 1, values(base_j + common:), 1)
         end do
         do i = top, j - 1
            u = values(base_j + i)
            values(base_j + i) = u/values(self%diagonal_at(i))
            values(base_j + j) = values(base_j + j) - values(base_j + i)*u
         end do
      end associate
   end subroutine reduce_column

   !> Solves A x = b with the factors; b is overwritten by x.
   pure subroutine solve(self, b)
      class(complex_skyline_type), intent(in) :: self   !! as `factorize` left it
      complex(wp), intent(inout), contiguous :: b(:)    !! (n)
      integer(int64) :: start
      integer :: j, top

      do j = 1, self%n
         top = self%top(j)
         if (top == j) cycle
         start = self%diagonal_at(j) - (j - top)
         b(j) = b(j) - zdotu(j - top, self%values(start:), 1, b(top:), 1)
      end do
      do j = 1, self%n
         b(j) = b(j)/self%values(self%diagonal_at(j))
      end do
      do j = self%n, 1, -1
         top = self%top(j)
         if (top == j) cycle
         start = self%diagonal_at(j) - (j - top)
         call zaxpy(j - top, -b(j), self%values(start:), 1, b(top:), 1)
      end do
   end subroutine solve

   !> Whether every column has height one.
   pure logical function is_diagonal(self)
      class(complex_skyline_type), intent(in) :: self

      is_diagonal = last_address(self) == self%n
   end function is_diagonal

end module complex_skyline
