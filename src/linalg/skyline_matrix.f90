!> Symmetric matrix in skyline (profile) storage: each column from its first nonzero row down to
!> the diagonal, by panels of columns.
module skyline_matrix
   use kinds, only: wp, int64
   use memory_shortage, only: check_allocation
   use panel_layout, only: panel_layout_type, new_panel_layout
   use panel_kernels, only: multiply_panel
   use column_ldlt, only: multiply_columns
   implicit none
   private

   public :: skyline_type, new_skyline, profile_type, new_profile, couple, fill_column
   public :: profile_entries, profile_cost, diagonal, multiply, combine, absolute, stored_bytes

   !> Entries from which threads share the work on them.
   integer(int64), parameter :: worth_threads = 1000000_int64

   !> First row of every column while a profile is being found.
   type :: profile_type
      integer :: n = 0
      integer, allocatable :: first_row(:)       !! (n) row of the topmost entry of column j
      logical, allocatable :: coupled(:)         !! (n) whether column or row j has other entries
   end type profile_type

   !> Entry (i, j) stands at values(layout%address(i, j)).
   type :: skyline_type
      integer :: n = 0
      type(panel_layout_type) :: layout
      real(wp), allocatable :: values(:)
   contains
      procedure :: add
      procedure :: add_multiple
      procedure :: entry => entry_of
      procedure :: is_diagonal
   end type skyline_type

contains

   !> A diagonal profile of n columns.
   pure subroutine new_profile(self, n)
      type(profile_type), intent(out) :: self
      integer, intent(in) :: n
      integer :: j, status

      self%n = n
      allocate (self%first_row(n), self%coupled(n), stat=status)
      call check_allocation(status)
      self%coupled = .false.
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
      if (maxval(equations) == top) return
      do i = 1, size(equations)
         if (equations(i) < 1) cycle
         self%first_row(equations(i)) = min(self%first_row(equations(i)), top)
         self%coupled(equations(i)) = .true.
      end do
   end subroutine couple

   !> Widens a column of the profile so that it is full from row `top` on.
   pure subroutine fill_column(self, column, top)
      type(profile_type), intent(inout) :: self
      integer, intent(in) :: column, top

      if (top >= column) return
      self%first_row(column) = min(self%first_row(column), top)
      self%coupled(top:column) = .true.
   end subroutine fill_column

   !> A zero matrix of the given profile.
   pure subroutine new_skyline(self, profile, panels_from)
      type(skyline_type), intent(out) :: self
      type(profile_type), intent(in) :: profile
      real(wp), intent(in), optional :: panels_from   !! mean height of columns, to force a layout
      integer :: status

      self%n = profile%n
      call new_panel_layout(self%layout, profile%first_row, profile%coupled, panels_from)
      allocate (self%values(self%layout%n_entries), stat=status)
      call check_allocation(status)
      self%values = 0.0_wp
   end subroutine new_skyline

   !> Adds a value to entry (i, j) and, by symmetry, (j, i); the entry must be in the profile.
   pure subroutine add(self, i, j, value)
      class(skyline_type), intent(inout) :: self
      integer, intent(in) :: i, j
      real(wp), intent(in) :: value
      integer(int64) :: address

      address = self%layout%address(i, j)
      self%values(address) = self%values(address) + value
   end subroutine add

   !> Adds a multiple of another matrix of the same profile.
   subroutine add_multiple(self, factor, other)
      class(skyline_type), intent(inout) :: self
      real(wp), intent(in) :: factor
      type(skyline_type), intent(in) :: other
      integer(int64) :: k

      !$omp parallel do if (size(self%values, kind=int64) > worth_threads)
      do k = 1, size(self%values, kind=int64)
         self%values(k) = self%values(k) + factor*other%values(k)
      end do
      !$omp end parallel do
   end subroutine add_multiple

   !> The sum of multiples of three matrices of one profile.
   subroutine combine(self, factors, parts)
      type(skyline_type), intent(inout) :: self
      real(wp), intent(in) :: factors(3)
      type(skyline_type), intent(in) :: parts(3)
      integer(int64) :: k
      integer :: status

      self%n = parts(1)%n
      self%layout = parts(1)%layout
      if (allocated(self%values)) then
         if (size(self%values, kind=int64) /= self%layout%n_entries) deallocate (self%values)
      end if
      if (.not. allocated(self%values)) then
         allocate (self%values(self%layout%n_entries), stat=status)
         call check_allocation(status)
      end if
      !$omp parallel do if (size(self%values, kind=int64) > worth_threads)
      do k = 1, size(self%values, kind=int64)
         self%values(k) = factors(1)*parts(1)%values(k) + factors(2)*parts(2)%values(k) &
               + factors(3)*parts(3)%values(k)
      end do
      !$omp end parallel do
   end subroutine combine

   !> The matrix of the absolute values.
   pure function absolute(self) result(matrix)
      type(skyline_type), intent(in) :: self
      type(skyline_type) :: matrix

      matrix = self
      matrix%values = abs(matrix%values)
   end function absolute

   !> Entry (i, j), zero outside the profile. Of factors: D on the diagonal, L off it.
   pure real(wp) function entry_of(self, i, j)
      class(skyline_type), intent(in) :: self
      integer, intent(in) :: i, j
      integer(int64) :: address

      address = self%layout%address(i, j)
      entry_of = 0.0_wp
      if (address > 0) entry_of = self%values(address)
   end function entry_of

   !> Memory of the matrix with its layout.
   pure integer(int64) function stored_bytes(self)
      type(skyline_type), intent(in) :: self

      stored_bytes = self%layout%bytes() + storage_size(self%values)/8 &
            *size(self%values, kind=int64)
   end function stored_bytes

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

      values = self%values(self%layout%diagonal_at)
   end function diagonal

   !> A x.
   pure function multiply(self, x) result(y)
      type(skyline_type), intent(in) :: self
      real(wp), intent(in) :: x(self%n)
      real(wp) :: y(self%n)
      real(wp), dimension(self%layout%n_coupled) :: inner_x, inner_y
      integer :: j, p

      if (self%layout%by_columns) then
         call multiply_columns(self%layout, self%values, x, y)
         return
      end if
      y = self%values(self%layout%diagonal_at)*x
      if (self%layout%n_coupled == 0) return
      inner_x = pack(x, self%layout%number > 0)
      inner_y = 0.0_wp
      do p = 1, self%layout%n_panels
         call multiply_panel(self%layout, p, self%values, inner_x, inner_y)
      end do
      do j = 1, self%n
         if (self%layout%number(j) > 0) y(j) = y(j) + inner_y(self%layout%number(j))
      end do
   end function multiply

   !> Whether every column has height one.
   pure function is_diagonal(self) result(diagonal)
      class(skyline_type), intent(in) :: self
      logical :: diagonal

      diagonal = self%layout%n_entries == self%n
   end function is_diagonal

end module skyline_matrix
