!> Small dense systems of equations by LU factors.
module square_systems
   use kinds, only: wp
   use blas_interfaces, only: dgesv, zgesv
   implicit none
   private

   public :: solve_square, solve_complex_square

   !> A pivot below this part of the matrix's largest entry means that rows depend on each other.
   real(wp), parameter :: pivot_tolerance = 1.0e-13_wp

contains

   !> Solves matrix x = rhs for every column; if rows depend on each other, with a part of the
   !> mean of the diagonal's size added to the diagonal, which picks one of the answers. `solved`
   !> is false, and rhs as it was, if that does not help either.
   pure subroutine solve_square(matrix, rhs, dependence, solved)
      real(wp), intent(in) :: matrix(:, :)       !! (n, n)
      real(wp), intent(inout) :: rhs(:, :)       !! (n, m): right-hand sides, then x
      real(wp), intent(in) :: dependence         !! part that is added, 0: singular is unsolved
      logical, intent(out) :: solved
      real(wp) :: shift
      integer :: i

      solved = .true.
      if (size(rhs, 1) == 0) return
      call solve_shifted(matrix, rhs, 0.0_wp, solved)
      if (solved .or. dependence <= 0.0_wp) return
      shift = dependence*sum([(abs(matrix(i, i)), i=1, size(rhs, 1))])/size(rhs, 1)
      if (shift > 0.0_wp) call solve_dependent(matrix, rhs, shift, solved)
   end subroutine solve_square

   !> Solves with the shift, and once more for what it left over of the right-hand sides.
   pure subroutine solve_dependent(matrix, rhs, shift, solved)
      real(wp), intent(in) :: matrix(:, :)
      real(wp), intent(inout) :: rhs(:, :)
      real(wp), intent(in) :: shift
      logical, intent(out) :: solved
      real(wp) :: x(size(rhs, 1), size(rhs, 2)), rest(size(rhs, 1), size(rhs, 2))

      x = rhs
      call solve_shifted(matrix, x, shift, solved)
      if (.not. solved) return
      rest = rhs - matmul(matrix, x)
      call solve_shifted(matrix, rest, shift, solved)
      rhs = x + rest
   end subroutine solve_dependent

   !> LU factors of matrix + shift I; refuses pivots lost in round-off.
   pure subroutine solve_shifted(matrix, rhs, shift, solved)
      real(wp), intent(in) :: matrix(:, :)
      real(wp), intent(inout) :: rhs(:, :)
      real(wp), intent(in) :: shift
      logical, intent(out) :: solved
      real(wp) :: factor(size(rhs, 1), size(rhs, 1)), x(size(rhs, 1), size(rhs, 2)), least
      integer :: pivots(size(rhs, 1)), i, n, info

      n = size(rhs, 1)
      factor = matrix
      do i = 1, n
         factor(i, i) = factor(i, i) + shift
      end do
      x = rhs
      call dgesv(n, size(rhs, 2), factor, n, pivots, x, n, info)
      solved = info == 0
      if (.not. solved) return
      least = minval([(abs(factor(i, i)), i=1, n)])
      solved = least > pivot_tolerance*maxval(abs(matrix))
      if (solved) rhs = x
   end subroutine solve_shifted

   !> The same of a complex system with one right-hand side.
   pure subroutine solve_complex_square(matrix, rhs, dependence, solved)
      complex(wp), intent(in) :: matrix(:, :)    !! (n, n)
      complex(wp), intent(inout) :: rhs(:)       !! right-hand side, then x
      real(wp), intent(in) :: dependence         !! part that is added, 0: singular is unsolved
      logical, intent(out) :: solved
      complex(wp) :: shift, x(size(rhs)), rest(size(rhs))
      integer :: i

      solved = .true.
      if (size(rhs) == 0) return
      call solve_shifted_complex(matrix, rhs, (0.0_wp, 0.0_wp), solved)
      if (solved .or. dependence <= 0.0_wp) return
      shift = dependence*sum([(matrix(i, i), i=1, size(rhs))])/size(rhs)
      x = rhs
      call solve_shifted_complex(matrix, x, shift, solved)
      if (.not. solved) return
      rest = rhs - matmul(matrix, x)
      call solve_shifted_complex(matrix, rest, shift, solved)
      rhs = x + rest
   end subroutine solve_complex_square

   pure subroutine solve_shifted_complex(matrix, rhs, shift, solved)
      complex(wp), intent(in) :: matrix(:, :), shift
      complex(wp), intent(inout) :: rhs(:)
      logical, intent(out) :: solved
      complex(wp) :: factor(size(rhs), size(rhs)), x(size(rhs), 1)
      integer :: pivots(size(rhs)), i, n, info

      n = size(rhs)
      factor = matrix
      do i = 1, n
         factor(i, i) = factor(i, i) + shift
      end do
      x(:, 1) = rhs
      call zgesv(n, 1, factor, n, pivots, x, n, info)
      solved = info == 0
      if (.not. solved) return
      solved = minval([(abs(factor(i, i)), i=1, n)]) > pivot_tolerance*maxval(abs(matrix))
      if (solved) rhs = x(:, 1)
   end subroutine solve_shifted_complex

end module square_systems
