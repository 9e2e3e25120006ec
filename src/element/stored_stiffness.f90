!> Stiffness matrices of plane elements kept without what a shift makes redundant, and the forces of
!> blocks of elements from them. A matrix is kept once a class of congruent elements, or once an
!> element where few are congruent. In a direction in which a shift makes no force only differences
!> to the last node's displacement count: that freedom is left out, its row and column being less
!> the sum of the others.
module stored_stiffness
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use element_blocks, only: block_size
   implicit none
   private

   public :: stored_stiffness_type, new_stored_stiffness, keep_stiffness, get_stiffness
   public :: add_block_forces

   !> Freedom 2 (i - 1) + j is direction j of node i; the first m are kept.
   type :: stored_stiffness_type
      integer :: n_nodes = 0
      integer :: m = 0                           !! freedoms kept of 2 n_nodes
      logical :: shared = .false.
      logical :: shiftable_x = .true.            !! a shift along y makes never a force
      real(wp), allocatable :: table(:, :, :)    !! (m, m, n_classes) if shared, else empty
      real(wp), allocatable :: lanes(:, :, :)    !! (block_size, m (m + 1)/2, n_blocks) if not
   end type stored_stiffness_type

contains

   !> Room for the matrices of n classes, or of n elements in blocks.
   pure subroutine new_stored_stiffness(self, n_nodes, shiftable_x, shared, n)
      type(stored_stiffness_type), intent(out) :: self
      integer, intent(in) :: n_nodes
      logical, intent(in) :: shiftable_x, shared
      integer, intent(in) :: n
      integer :: status

      self%n_nodes = n_nodes
      self%shared = shared
      self%shiftable_x = shiftable_x
      self%m = 2*n_nodes - merge(2, 1, shiftable_x)
      allocate (self%table(self%m, self%m, merge(n, 0, shared)), stat=status)
      call check_allocation(status)
      allocate (self%lanes(block_size, self%m*(self%m + 1)/2, &
            merge(0, (n + block_size - 1)/block_size, shared)), stat=status)
      call check_allocation(status)
   end subroutine new_stored_stiffness

   !> Keeps the symmetric matrix of class or element i.
   pure subroutine keep_stiffness(self, i, matrix)
      type(stored_stiffness_type), intent(inout) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: matrix(:, :)       !! (2 n_nodes, 2 n_nodes)
      integer :: row, column, block, lane

      if (self%shared) then
         self%table(:, :, i) = matrix(:self%m, :self%m)
         return
      end if
      block = (i - 1)/block_size + 1
      lane = i - (block - 1)*block_size
      do column = 1, self%m
         do row = 1, column
            self%lanes(lane, place(row, column), block) = matrix(row, column)
         end do
      end do
   end subroutine keep_stiffness

   !> Where an entry of the upper triangle is kept.
   pure function place(row, column) result(p)
      integer, intent(in) :: row, column
      integer :: p

      p = column*(column - 1)/2 + row
   end function place

   !> The matrix of class or element i, whole.
   pure subroutine get_stiffness(self, i, matrix)
      type(stored_stiffness_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp), intent(out) :: matrix(:, :)      !! (2 n_nodes, 2 n_nodes)
      integer :: row, column, n

      n = 2*self%n_nodes
      associate (m => self%m)
         do column = 1, m
            do row = 1, column
               matrix(row, column) = kept_entry(self, i, row, column)
               matrix(column, row) = matrix(row, column)
            end do
         end do
         do row = m + 1, n
            do column = 1, m
               matrix(row, column) = -sum(matrix(2 - modulo(row, 2):m:2, column))
               matrix(column, row) = matrix(row, column)
            end do
         end do
         do column = m + 1, n
            do row = m + 1, n
               matrix(row, column) = -sum(matrix(2 - modulo(row, 2):m:2, column))
            end do
         end do
      end associate
   end subroutine get_stiffness

   pure function kept_entry(self, i, row, column) result(value)
      type(stored_stiffness_type), intent(in) :: self
      integer, intent(in) :: i, row, column
      real(wp) :: value
      integer :: block

      if (self%shared) then
         value = self%table(row, column, i)
      else
         block = (i - 1)/block_size + 1
         value = self%lanes(i - (block - 1)*block_size, place(row, column), block)
      end if
   end function kept_entry

   !> Adds the forces of a block of elements to those at their nodes and their strain energy to a
   !> sum. i is the class of all its elements, or the number of the block.
   pure subroutine add_block_forces(self, i, ien, u, force, energy)
      type(stored_stiffness_type), intent(in) :: self
      integer, intent(in) :: i
      integer, intent(in), contiguous :: ien(:, :)       !! (n_nodes, elements of the block)
      real(wp), intent(in), contiguous :: u(:, :)        !! (2, nodes)
      real(wp), intent(inout), contiguous :: force(:, :) !! (2, nodes)
      real(wp), intent(inout) :: energy
      real(wp) :: d(block_size, self%m), f(block_size, self%m)
      integer :: n, e, j
      real(wp) :: work(block_size)

      n = size(ien, 2)
      call gather_block(self%shiftable_x, ien, u, d)
      if (self%shared .and. self%m == 6) then
         call multiply_shared_6(n, self%table(:, :, i), d, f)
      else if (self%shared) then
         call multiply_shared(n, self%m, self%table(:, :, i), d, f)
      else if (self%m == 6) then
         call multiply_lanes_6(n, self%lanes(:, :, i), d, f)
      else
         call multiply_lanes(n, self%m, self%lanes(:, :, i), d, f)
      end if
      work = 0.0_wp
      do j = 1, self%m
         !$omp simd
         do e = 1, n
            work(e) = work(e) + d(e, j)*f(e, j)
         end do
      end do
      energy = energy + sum(work)/2.0_wp
      call scatter_block(self%shiftable_x, ien, f, force)
   end subroutine add_block_forces

   !> Displacements less those of the last node where only differences count.
   pure subroutine gather_block(shiftable_x, ien, u, d)
      logical, intent(in) :: shiftable_x
      integer, intent(in), contiguous :: ien(:, :)
      real(wp), intent(in), contiguous :: u(:, :)
      real(wp), intent(out), contiguous :: d(:, :)
      real(wp) :: last(2)
      integer :: e, i, n

      n = size(ien, 1)
      do e = 1, size(ien, 2)
         last = u(:, ien(n, e))
         if (.not. shiftable_x) then
            d(e, 2*n - 1) = last(1)
            last(1) = 0.0_wp
         end if
         do i = 1, n - 1
            d(e, 2*i - 1) = u(1, ien(i, e)) - last(1)
            d(e, 2*i) = u(2, ien(i, e)) - last(2)
         end do
      end do
   end subroutine gather_block

   !> Forces to nodes; the last node gets what balances those of the others.
   pure subroutine scatter_block(shiftable_x, ien, f, force)
      logical, intent(in) :: shiftable_x
      integer, intent(in), contiguous :: ien(:, :)
      real(wp), intent(in), contiguous :: f(:, :)
      real(wp), intent(inout), contiguous :: force(:, :)
      real(wp) :: total(2)
      integer :: e, i, n

      n = size(ien, 1)
      do e = 1, size(ien, 2)
         total = 0.0_wp
         do i = 1, n - 1
            force(1, ien(i, e)) = force(1, ien(i, e)) + f(e, 2*i - 1)
            force(2, ien(i, e)) = force(2, ien(i, e)) + f(e, 2*i)
            total(1) = total(1) + f(e, 2*i - 1)
            total(2) = total(2) + f(e, 2*i)
         end do
         if (.not. shiftable_x) total(1) = -f(e, 2*n - 1)
         force(:, ien(n, e)) = force(:, ien(n, e)) - total
      end do
   end subroutine scatter_block

   !> f = K d for every element, the same K of order 6.
   pure subroutine multiply_shared_6(n, k, d, f)
      integer, intent(in) :: n
      real(wp), intent(in) :: k(6, 6)
      real(wp), intent(in) :: d(block_size, 6)
      real(wp), intent(out) :: f(block_size, 6)
      integer :: e, i

      do i = 1, 6
         !$omp simd
         do e = 1, n
            f(e, i) = k(1, i)*d(e, 1) + k(2, i)*d(e, 2) + k(3, i)*d(e, 3) + k(4, i)*d(e, 4) &
                  + k(5, i)*d(e, 5) + k(6, i)*d(e, 6)
         end do
      end do
   end subroutine multiply_shared_6

   !> f = K d for every element, the same K.
   pure subroutine multiply_shared(n, m, k, d, f)
      integer, intent(in) :: n, m
      real(wp), intent(in) :: k(m, m)
      real(wp), intent(in) :: d(block_size, m)
      real(wp), intent(out) :: f(block_size, m)
      integer :: e, i, j

      do i = 1, m
         !$omp simd
         do e = 1, n
            f(e, i) = k(m, i)*d(e, m)
         end do
         do j = 1, m - 3, 3
            !$omp simd
            do e = 1, n
               f(e, i) = f(e, i) + (k(j, i)*d(e, j) + k(j + 1, i)*d(e, j + 1) &
                     + k(j + 2, i)*d(e, j + 2))
            end do
         end do
         do j = m - modulo(m - 1, 3), m - 1
            !$omp simd
            do e = 1, n
               f(e, i) = f(e, i) + k(j, i)*d(e, j)
            end do
         end do
      end do
   end subroutine multiply_shared

   !> f = K d, every element with its own symmetric K of order 6.
   pure subroutine multiply_lanes_6(n, k, d, f)
      integer, intent(in) :: n
      real(wp), intent(in) :: k(block_size, 21)
      real(wp), intent(in) :: d(block_size, 6)
      real(wp), intent(out) :: f(block_size, 6)
      integer :: e

      !$omp simd
      do e = 1, n
         f(e, 1) = k(e, 1)*d(e, 1) + k(e, 2)*d(e, 2) + k(e, 4)*d(e, 3) + k(e, 7)*d(e, 4) &
               + k(e, 11)*d(e, 5) + k(e, 16)*d(e, 6)
         f(e, 2) = k(e, 2)*d(e, 1) + k(e, 3)*d(e, 2) + k(e, 5)*d(e, 3) + k(e, 8)*d(e, 4) &
               + k(e, 12)*d(e, 5) + k(e, 17)*d(e, 6)
         f(e, 3) = k(e, 4)*d(e, 1) + k(e, 5)*d(e, 2) + k(e, 6)*d(e, 3) + k(e, 9)*d(e, 4) &
               + k(e, 13)*d(e, 5) + k(e, 18)*d(e, 6)
         f(e, 4) = k(e, 7)*d(e, 1) + k(e, 8)*d(e, 2) + k(e, 9)*d(e, 3) + k(e, 10)*d(e, 4) &
               + k(e, 14)*d(e, 5) + k(e, 19)*d(e, 6)
         f(e, 5) = k(e, 11)*d(e, 1) + k(e, 12)*d(e, 2) + k(e, 13)*d(e, 3) + k(e, 14)*d(e, 4) &
               + k(e, 15)*d(e, 5) + k(e, 20)*d(e, 6)
         f(e, 6) = k(e, 16)*d(e, 1) + k(e, 17)*d(e, 2) + k(e, 18)*d(e, 3) + k(e, 19)*d(e, 4) &
               + k(e, 20)*d(e, 5) + k(e, 21)*d(e, 6)
      end do
   end subroutine multiply_lanes_6

   !> f = K d, every element with its own symmetric K.
   pure subroutine multiply_lanes(n, m, k, d, f)
      integer, intent(in) :: n, m
      real(wp), intent(in) :: k(block_size, m*(m + 1)/2)
      real(wp), intent(in) :: d(block_size, m)
      real(wp), intent(out) :: f(block_size, m)
      integer :: e, i, j, p

      p = 0
      do j = 1, m
         f(:n, j) = 0.0_wp
         do i = 1, j - 1
            p = p + 1
            !$omp simd
            do e = 1, n
               f(e, i) = f(e, i) + k(e, p)*d(e, j)
               f(e, j) = f(e, j) + k(e, p)*d(e, i)
            end do
         end do
         p = p + 1
         !$omp simd
         do e = 1, n
            f(e, j) = f(e, j) + k(e, p)*d(e, j)
         end do
      end do
   end subroutine multiply_lanes

end module stored_stiffness
