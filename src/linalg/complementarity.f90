!> The linear complementarity problem 0 <= x, W x + q >= 0, x (W x + q) = 0 with W symmetric
!> positive definite: by changing sets of rows at once while that leads on (it does where most rows
!> push), else by the finite active-set method of Lawson and Hanson.
module complementarity
   use kinds, only: wp
   use blas_interfaces, only: dposv
   implicit none
   private

   public :: solve_complementarity, solve_equality

   !> Residuals below this part of the problem's size count as zero.
   real(wp), parameter :: relative_tolerance = 1.0e-12_wp
   !> Residuals as small as this are nothing: their answers underflow, and rows would enter and
   !> leave for ever.
   real(wp), parameter :: least_residual = tiny(1.0_wp)/epsilon(1.0_wp)
   !> A pivot below this part of its diagonal entry means that rows depend on each other.
   real(wp), parameter :: pivot_tolerance = 1.0e-14_wp
   !> Residuals below this part of the right-hand side fulfil dependent equations.
   real(wp), parameter :: dependence_limit = 1.0e-9_wp
   !> What is then added to the diagonal, in parts of its mean.
   real(wp), parameter :: dependence_tolerance = 1.0e-12_wp
   !> Sets that are tried at once before rows go one by one.
   integer, parameter :: max_exchanges = 8

contains

   !> Finds the unique x. `solved` is false if W is not positive definite on the active rows.
   pure subroutine solve_complementarity(w, q, x, solved)
      real(wp), intent(in) :: w(:, :)       !! (n, n)
      real(wp), intent(in) :: q(:)          !! (n)
      real(wp), intent(out) :: x(:)         !! (n)
      logical, intent(out) :: solved
      logical :: active(size(q))
      real(wp) :: residual(size(q)), trial(size(q)), threshold
      integer :: entering, sweep

      call exchange_sets(w, q, x, solved)
      if (solved) return
      x = 0.0_wp
      solved = .true.
      active = .false.
      threshold = max(relative_tolerance*maxval(abs(q)), least_residual)
      do sweep = 1, 10*size(q) + 10
         residual = matmul(w, x) + q
         if (.not. any(residual < -threshold .and. .not. active)) return
         entering = minloc(residual, dim=1, mask=.not. active)
         active(entering) = .true.
         do
            call solve_active(w, q, active, trial, solved)
            if (.not. solved) return
            if (all(trial > 0.0_wp .or. .not. active)) exit
            call step_to_bound(trial, x, active)
         end do
         x = trial
      end do
      solved = .false.
   end subroutine solve_complementarity

   !> Tries all rows first, then drops all those that would pull and takes all those back that would
   !> overlap, as long as there are ever fewer of both (block pivoting by Kostreva). `solved` is
   !> false if that ends without the answer, or if rows depend on each other.
   pure subroutine exchange_sets(w, q, x, solved)
      real(wp), intent(in) :: w(:, :), q(:)
      real(wp), intent(out) :: x(:)
      logical, intent(out) :: solved
      logical, dimension(size(q)) :: active, wrong
      real(wp) :: residual(size(q)), threshold
      integer :: all_rows(size(q)), i, fewest

      all_rows = [(i, i=1, size(q))]
      active = .true.
      fewest = size(q) + 1
      threshold = max(relative_tolerance*maxval(abs(q)), least_residual)
      do i = 1, max_exchanges
         call solve_rows_held(w, q, pack(all_rows, active), x, solved)
         if (.not. solved) return
         residual = matmul(w, x) + q
         wrong = active .and. .not. x > relative_tolerance*maxval(x)
         wrong = wrong .or. (.not. active .and. residual < -threshold)
         if (.not. any(wrong)) return
         solved = .false.
         if (count(wrong) >= fewest) return
         fewest = count(wrong)
         active = active .neqv. wrong
      end do
   end subroutine exchange_sets

   !> Solves W x + q = 0, every row held whatever the sign of x. Of the many answers for rows that
   !> depend on each other, one without negative x is preferred.
   pure subroutine solve_equality(w, q, x, solved)
      real(wp), intent(in) :: w(:, :), q(:)
      real(wp), intent(out) :: x(:)
      logical, intent(out) :: solved
      logical :: active(size(q))

      x = -q
      solved = size(q) == 0
      if (solved) return
      call solve_definite(w, x, 0.0_wp, solved)
      if (solved) return
      call solve_complementarity(w, q, x, solved)
      if (solved) solved = all(abs(matmul(w, x) + q) <= dependence_limit*max(maxval(abs(q)), &
            tiny(1.0_wp)))
      if (solved) return
      active = .true.
      call solve_active(w, q, active, x, solved)
   end subroutine solve_equality

   !> x from the active rows as equations, zero elsewhere. Rows that depend on each other (a chain
   !> squeezed between two walls) leave W singular: then a part of its trace on the diagonal picks
   !> one of the answers, which all give the same motion.
   pure subroutine solve_active(w, q, active, x, solved)
      real(wp), intent(in) :: w(:, :), q(:)
      logical, intent(in) :: active(:)
      real(wp), intent(out) :: x(:)
      logical, intent(out) :: solved
      integer :: rows(count(active)), i
      real(wp) :: matrix(count(active), count(active)), rhs(count(active)), shift

      x = 0.0_wp
      solved = .true.
      if (size(rows) == 0) return
      rows = pack([(i, i=1, size(q))], active)
      matrix = w(rows, rows)
      rhs = -q(rows)
      call solve_definite(matrix, rhs, 0.0_wp, solved)
      if (.not. solved .and. all([(matrix(i, i) > 0.0_wp, i=1, size(rows))])) then
         shift = dependence_tolerance*sum([(matrix(i, i), i=1, size(rows))])/size(rows)
         call solve_definite(matrix, rhs, shift, solved)
      end if
      if (solved) x(rows) = rhs
   end subroutine solve_active

   !> x from some rows as equations, zero elsewhere; not solved if they depend on each other.
   pure subroutine solve_rows_held(w, q, rows, x, solved)
      real(wp), intent(in) :: w(:, :), q(:)
      integer, intent(in) :: rows(:)
      real(wp), intent(out) :: x(:)
      logical, intent(out) :: solved
      real(wp) :: rhs(size(rows))

      x = 0.0_wp
      solved = .true.
      if (size(rows) == 0) return
      rhs = -q(rows)
      call solve_definite(w(rows, rows), rhs, 0.0_wp, solved)
      if (solved) x(rows) = rhs
   end subroutine solve_rows_held

   !> Cholesky's method on matrix + shift I; refuses pivots lost in round-off.
   pure subroutine solve_definite(matrix, rhs, shift, solved)
      real(wp), intent(in) :: matrix(:, :)
      real(wp), intent(inout) :: rhs(:)          !! right-hand side, then solution if `solved`
      real(wp), intent(in) :: shift
      logical, intent(out) :: solved
      real(wp) :: factor(size(rhs), size(rhs)), b(size(rhs), 1)
      integer :: i, info

      factor = matrix
      do i = 1, size(rhs)
         factor(i, i) = factor(i, i) + shift
      end do
      b(:, 1) = rhs
      call dposv('U', size(rhs), 1, factor, size(rhs), b, size(rhs), info)
      solved = info == 0
      do i = 1, size(rhs)
         if (solved) solved = factor(i, i)**2 > pivot_tolerance*(matrix(i, i) + shift)
      end do
      if (solved) rhs = b(:, 1)
   end subroutine solve_definite

   !> Goes from x towards the trial until a component reaches zero, and drops that component.
   pure subroutine step_to_bound(trial, x, active)
      real(wp), intent(in) :: trial(:)
      real(wp), intent(inout) :: x(:)
      logical, intent(inout) :: active(:)
      real(wp) :: fraction
      integer :: i, blocking

      fraction = 2.0_wp
      blocking = 0
      do i = 1, size(x)
         if (.not. active(i) .or. trial(i) > 0.0_wp) cycle
         if (x(i) >= fraction*(x(i) - trial(i))) cycle
         fraction = x(i)/(x(i) - trial(i))
         blocking = i
      end do
      if (blocking == 0) blocking = minloc(trial, dim=1, mask=active)
      fraction = min(fraction, 1.0_wp)
      where (active) x = x + fraction*(trial - x)
      x(blocking) = 0.0_wp
      active(blocking) = .false.
   end subroutine step_to_bound

end module complementarity
