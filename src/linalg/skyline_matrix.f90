!> Symmetric matrix in skyline (profile) storage: each column from its first nonzero row down to
!> the diagonal, one column after the other.
module skyline_matrix
   use kinds, only: wp, int64
   use blas_interfaces, only: ddot, daxpy
   implicit none
   private

   public :: skyline_type, new_skyline, profile_type, new_profile, couple
   public :: profile_entries, profile_cost, diagonal, multiply

   !> First row of every column while a profile is being found.
   type :: profile_type
      integer :: n = 0
      integer, allocatable :: first_row(:)       !! (n) row of the topmost entry of column j
   end type profile_type

   !> Entry (i, j), first_row(j) <= i <= j, stands at values(last(j) - (j - i)).
   type :: skyline_type
      integer :: n = 0
      integer, allocatable :: first_row(:)       !! (n)
      integer(int64), allocatable :: last(:)     !! (n) address of the diagonal entry of column j
      real(wp), allocatable :: values(:)
   contains
      procedure :: add
      procedure :: is_diagonal
   end type skyline_type

contains

   !> A diagonal profile of n columns.
   pure subroutine new_profile(self, n)
      type(profile_type), intent(out) :: self
      integer, intent(in) :: n
      integer :: j

      self%n = n
      allocate (self%first_row(n))
      do j = 1, n
         self%first_row(j) = j
      end do
   end subroutine new_profile

   !> Widens the profile so that any two of the given equations are coupled.
   pure subroutine couple(self, equations)
      type(profile_type), intent(inout) :: self
      integer, intent(in) :: equations(:)   !! equation numbers, those below 1 are passed over
      integer :: i, top

      if (.not. any(equations > 0)) return
      top = minval(equations, mask=equations > 0)
      do i = 1, size(equations)
         if (equations(i) < 1) cycle
         self%first_row(equations(i)) = min(self%first_row(equations(i)), top)
      end do
   end subroutine couple

   !> A zero matrix of the given profile.
   pure subroutine new_skyline(self, profile)
      type(skyline_type), intent(out) :: self
      type(profile_type), intent(in) :: profile
      integer :: j
      integer(int64) :: address

      self%n = profile%n
      self%first_row = profile%first_row
      allocate (self%last(self%n))
      address = 0
      do j = 1, self%n
         address = address + j - self%first_row(j) + 1
         self%last(j) = address
      end do
      allocate (self%values(address))
      self%values = 0.0_wp
   end subroutine new_skyline

   !> Adds a value to entry (i, j) and, by symmetry, (j, i); the entry must be in the profile.
   pure subroutine add(self, i, j, value)
      class(skyline_type), intent(inout) :: self
      integer, intent(in) :: i, j
      real(wp), intent(in) :: value
      integer(int64) :: address

      address = self%last(max(i, j)) - abs(j - i)
      self%values(address) = self%values(address) + value
   end subroutine add

   !> Stored entries, the diagonal included.
   pure integer(int64) function profile_entries(self)
      type(profile_type), intent(in) :: self
      integer :: j

      profile_entries = 0
      do j = 1, self%n
         profile_entries = profile_entries + j - self%first_row(j) + 1
      end do
   end function profile_entries

   !> Cost of a factorization: the sum of the squared column heights.
   pure real(wp) function profile_cost(self)
      type(profile_type), intent(in) :: self
      integer :: j

      profile_cost = 0.0_wp
      do j = 1, self%n
         profile_cost = profile_cost + real(j - self%first_row(j) + 1, wp)**2
      end do
   end function profile_cost

   !> The diagonal of a matrix that is not factorized.
   pure function diagonal(self) result(values)
      type(skyline_type), intent(in) :: self
      real(wp) :: values(self%n)

      values = self%values(self%last)
   end function diagonal

   !> A x.
   pure function multiply(self, x) result(y)
      type(skyline_type), intent(in) :: self
      real(wp), intent(in) :: x(self%n)
      real(wp) :: y(self%n)
      integer :: j, top
      integer(int64) :: address

      y = 0.0_wp
      do j = 1, self%n
         top = self%first_row(j)
         address = self%last(j) - (j - top)
         y(j) = y(j) + self%values(self%last(j))*x(j)
         if (top == j) cycle
         y(j) = y(j) + ddot(j - top, self%values(address), 1, x(top), 1)
         call daxpy(j - top, x(j), self%values(address), 1, y(top), 1)
      end do
   end function multiply

   !> Whether every column has height one.
   pure function is_diagonal(self) result(diagonal)
      class(skyline_type), intent(in) :: self
      logical :: diagonal

      diagonal = size(self%values, kind=int64) == int(self%n, int64)
   end function is_diagonal

end module skyline_matrix
