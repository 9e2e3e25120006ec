!> A sparse matrix over the freedoms of a structure, for products with vectors.
module sparse_operator
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: sparse_operator_type, new_sparse_operator, add_product

   !> Entries by rows, columns ascending; no entry that is zero.
   type :: sparse_operator_type
      integer :: n = 0                           !! rows; none before it is made
      integer, allocatable :: first(:)           !! (n+1) row pointers
      integer, allocatable :: column(:)
      real(wp), allocatable :: entry(:)
   end type sparse_operator_type

contains

   !> The sum of entries given one by one, in any order; those at one place are added up in the
   !> order given.
   pure subroutine new_sparse_operator(self, n, row, column, entry)
      type(sparse_operator_type), intent(out) :: self
      integer, intent(in) :: n
      integer, intent(in) :: row(:), column(:)
      real(wp), intent(in) :: entry(:)
      integer :: next(n + 1), i, k
      integer :: status

      self%n = n
      allocate (self%first(n + 1), self%column(size(row)), self%entry(size(row)), stat=status)
      call check_allocation(status)
      self%first = 0
      do k = 1, size(row)
         self%first(row(k) + 1) = self%first(row(k) + 1) + 1
      end do
      self%first(1) = 1
      do i = 1, n
         self%first(i + 1) = self%first(i) + self%first(i + 1)
      end do
      next = self%first
      do k = 1, size(row)
         self%column(next(row(k))) = column(k)
         self%entry(next(row(k))) = entry(k)
         next(row(k)) = next(row(k)) + 1
      end do
      call merge_entries(self)
   end subroutine new_sparse_operator

   !> Puts the entries of every row in order and adds up those in one column.
   pure subroutine merge_entries(self)
      type(sparse_operator_type), intent(inout) :: self
      integer :: from(self%n + 1), i, k, last

      from = self%first
      last = 0
      do i = 1, self%n
         call sort_row(self%column(from(i):from(i + 1) - 1), self%entry(from(i):from(i + 1) - 1))
         self%first(i) = last + 1
         do k = from(i), from(i + 1) - 1
            if (last >= self%first(i)) then
               if (self%column(last) == self%column(k)) then
                  self%entry(last) = self%entry(last) + self%entry(k)
                  cycle
               end if
            end if
            last = last + 1
            self%column(last) = self%column(k)
            self%entry(last) = self%entry(k)
         end do
      end do
      self%first(self%n + 1) = last + 1
      self%column = self%column(:last)
      self%entry = self%entry(:last)
   end subroutine merge_entries

   !> By insertion, which keeps the order of equals: rows are short.
   pure subroutine sort_row(column, entry)
      integer, intent(inout) :: column(:)
      real(wp), intent(inout) :: entry(:)
      integer :: i, k, c
      real(wp) :: e

      do i = 2, size(column)
         c = column(i)
         e = entry(i)
         do k = i - 1, 1, -1
            if (column(k) <= c) exit
            column(k + 1) = column(k)
            entry(k + 1) = entry(k)
         end do
         column(k + 1) = c
         entry(k + 1) = e
      end do
   end subroutine sort_row

   !> Adds A u to a vector.
   pure subroutine add_product(self, u, vector)
      type(sparse_operator_type), intent(in) :: self
      real(wp), intent(in) :: u(:)               !! (n)
      real(wp), intent(inout) :: vector(:)       !! (n)
      real(wp) :: total
      integer :: i, k

      do i = 1, self%n
         total = 0.0_wp
         do k = self%first(i), self%first(i + 1) - 1
            total = total + self%entry(k)*u(self%column(k))
         end do
         vector(i) = vector(i) + total
      end do
   end subroutine add_product

end module sparse_operator
