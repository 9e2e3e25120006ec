!> Lemke's method for the linear complementarity problem 0 <= z, M z + q >= 0, z (M z + q) = 0
!> (C. E. Lemke, Management Science 11 (1965) 681-689), by the lexicographic rule, so that
!> it ends also where ties would let it go round in circles.
module lemke
   use kinds, only: wp
   use square_systems, only: solve_square
   implicit none
   private

   public :: solve_lemke

   !> Entries below this no longer serve as pivots; ratios that differ by less are ties.
   real(wp), parameter :: pivot_tolerance = 1.0e-11_wp

contains

   !> Finds a z, for matrices and right-hand sides of the order of one. An answer is certain where
   !> M is copositive and q z >= 0 for all z that solve the problem with q = 0. `solved` is false if
   !> the method ends on a ray.
   pure subroutine solve_lemke(matrix, q, z, solved)
      real(wp), intent(in) :: matrix(:, :)       !! (n, n)
      real(wp), intent(in) :: q(:)               !! (n)
      real(wp), intent(out) :: z(:)              !! (n)
      logical, intent(out) :: solved
      real(wp) :: table(size(q), 2*size(q) + 2)
      integer :: basis(size(q)), n, i, round, entering, leaving, row

      n = size(q)
      z = 0.0_wp
      solved = all(q >= 0.0_wp)
      if (solved) return
      ! columns: w = M z + q, z, the artificial variable, q
      call start_table(matrix, q, table)
      basis = [(i, i=1, n)]
      row = n + 1 - minloc(q(n:1:-1), dim=1)
      entering = 2*n + 1
      do round = 1, 5*n + 50
         leaving = basis(row)
         call exchange(table, row, entering)
         basis(row) = entering
         solved = leaving == 2*n + 1
         if (solved) exit
         entering = merge(leaving + n, leaving - n, leaving <= n)
         row = leaving_row(table, basis, entering)
         if (row == 0) return
      end do
      if (solved) call read_solution(matrix, q, table(:, 2*n + 2), basis, z)
   end subroutine solve_lemke

   !> w - M z - z0 = q with the w as basic variables.
   pure subroutine start_table(matrix, q, table)
      real(wp), intent(in) :: matrix(:, :), q(:)
      real(wp), intent(out) :: table(:, :)
      integer :: n, i

      n = size(q)
      table(:, :n) = 0.0_wp
      do i = 1, n
         table(i, i) = 1.0_wp
      end do
      table(:, n + 1:2*n) = -matrix
      table(:, 2*n + 1) = -1.0_wp
      table(:, 2*n + 2) = q
   end subroutine start_table

   !> Makes a variable basic in a row.
   pure subroutine exchange(table, row, entering)
      real(wp), intent(inout) :: table(:, :)
      integer, intent(in) :: row, entering
      real(wp) :: column(size(table, 1)), pivot, factor
      integer :: j

      column = table(:, entering)
      pivot = column(row)
      column(row) = 0.0_wp
      do j = 1, size(table, 2)
         factor = table(row, j)/pivot
         if (abs(factor) <= 0.0_wp) cycle
         table(:, j) = table(:, j) - factor*column
         table(row, j) = factor
      end do
   end subroutine exchange

   !> The row whose basic variable is the first to reach zero; ties go to the artificial variable,
   !> then by the columns of the inverse of the basis. 0: there is none, the ray is endless.
   pure integer function leaving_row(table, basis, entering) result(row)
      real(wp), intent(in) :: table(:, :)
      integer, intent(in) :: basis(:), entering
      logical :: candidate(size(basis))
      real(wp) :: ratio(size(basis)), least
      integer :: n, j

      n = size(basis)
      candidate = table(:, entering) > pivot_tolerance
      row = 0
      if (.not. any(candidate)) return
      do j = 0, n
         where (candidate) ratio = table(:, merge(2*n + 2, j, j == 0))/table(:, entering)
         least = minval(ratio, mask=candidate)
         where (candidate) candidate = ratio <= least + pivot_tolerance*max(1.0_wp, abs(least))
         row = findloc(candidate .and. basis == 2*n + 1, .true., dim=1)
         if (row > 0) return
         if (count(candidate) == 1) exit
      end do
      row = findloc(candidate, .true., dim=1)
   end function leaving_row

   !> The basic z, solved for anew: the table carries the round-off of all exchanges.
   pure subroutine read_solution(matrix, q, values, basis, z)
      real(wp), intent(in) :: matrix(:, :), q(:), values(:)
      integer, intent(in) :: basis(:)
      real(wp), intent(inout) :: z(:)            !! zero on entry
      real(wp) :: fresh(size(q), 1)
      integer, allocatable :: rows(:)
      logical :: solved
      integer :: i, n

      n = size(q)
      do i = 1, n
         if (basis(i) > n .and. basis(i) <= 2*n) z(basis(i) - n) = max(values(i), 0.0_wp)
      end do
      rows = pack(basis - n, basis > n .and. basis <= 2*n)
      fresh = 0.0_wp
      fresh(:size(rows), 1) = -q(rows)
      call solve_square(matrix(rows, rows), fresh(:size(rows), :), 0.0_wp, solved)
      if (.not. solved) return
      if (misfit(matrix, q, fresh(:size(rows), 1), rows) > misfit(matrix, q, z(rows), rows)) return
      z(rows) = fresh(:size(rows), 1)
   end subroutine read_solution

   !> How far z on some rows is from fulfilling the conditions.
   pure real(wp) function misfit(matrix, q, z_rows, rows)
      real(wp), intent(in) :: matrix(:, :), q(:), z_rows(:)
      integer, intent(in) :: rows(:)
      real(wp) :: z(size(q))

      z = 0.0_wp
      z(rows) = z_rows
      misfit = maxval(abs(min(z, matmul(matrix, z) + q)))
   end function misfit

end module lemke
