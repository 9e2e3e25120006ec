!> Random sparse symmetric matrices, with their dense counterparts.
module random_patterns
   use kinds, only: wp, int64
   use random_numbers, only: random_integer, random_real
   use sparse_matrix, only: pattern_type, new_pattern, pattern_entries
   implicit none
   private

   public :: random_sets, random_pattern, random_values, dense_of

contains

   !> Up to ten sets of up to four of n equations, some of them twice in a set.
   subroutine random_sets(n, first, member)
      integer, intent(in) :: n
      integer, allocatable, intent(out) :: first(:), member(:)
      integer :: i

      allocate (first(random_integer(1, 11)))
      first(1) = 1
      do i = 2, size(first)
         first(i) = first(i - 1) + random_integer(0, 4)
      end do
      allocate (member(first(size(first)) - 1))
      do i = 1, size(member)
         member(i) = random_integer(1, n)
      end do
   end subroutine random_sets

   !> A pattern of n equations.
   subroutine random_pattern(pattern, n)
      type(pattern_type), intent(out) :: pattern
      integer, intent(in) :: n
      integer, allocatable :: first(:), member(:)

      call random_sets(n, first, member)
      call new_pattern(pattern, n, first, member)
   end subroutine random_pattern

   !> Values between -1 and 1 with the given size on the diagonal.
   function random_values(pattern, diagonal) result(values)
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: diagonal(:)
      real(wp) :: values(pattern_entries(pattern))
      integer(int64) :: k

      do k = 1, size(values, kind=int64)
         values(k) = random_real(-1.0_wp, 1.0_wp)
         if (pattern%row(k) == pattern%column(k)) values(k) = diagonal(pattern%row(k))
      end do
   end function random_values

   !> The matrix in full.
   function dense_of(pattern, values) result(a)
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: values(:)
      real(wp) :: a(pattern%n, pattern%n)
      integer(int64) :: k

      a = 0.0_wp
      do k = 1, size(values, kind=int64)
         a(pattern%row(k), pattern%column(k)) = values(k)
         a(pattern%column(k), pattern%row(k)) = values(k)
      end do
   end function dense_of

end module random_patterns
