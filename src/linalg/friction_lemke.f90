!> Coulomb's law of plane contacts as a linear complementarity problem (D. E. Stewart, J. C.
!> Trinkle, Int. J. Numer. Meth. Engng 39 (1996) 2673-2691), answered by Lemke's method: the
!> tangential force is p+ - p-, and sigma takes the size of the slip rate,
!>
!>     0 <= x_n    r_n >= 0
!>     0 <= p+     r_t + sigma >= 0
!>     0 <= p-    -r_t + sigma >= 0
!>     0 <= sigma  mu x_n - p+ - p- >= 0          each side zero or its partner.
!>
!> Its matrix is copositive as long as W is positive semidefinite, so Lemke's method ends in an
!> answer. A bilateral x_n is eliminated by r_n = 0; its positive part z, which bounds the friction,
!> has the condition 0 <= z, z - x_n >= 0.
module friction_lemke
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use friction_law, only: friction_problem_type, dependence_tolerance
   use lemke, only: solve_lemke
   use square_systems, only: solve_square
   implicit none
   private

   public :: solve_friction_lemke

   !> Kinds of unknowns.
   integer, parameter :: pressing = 0, forward_force = 1, backward_force = 2, slip_size = 3

contains

   !> Finds forces x. `solved` is false if the bilateral rows have no answer or Lemke's method
   !> ends on a ray.
   pure subroutine solve_friction_lemke(problem, x, solved)
      type(friction_problem_type), intent(in) :: problem
      real(wp), intent(out) :: x(:)              !! (2n)
      logical, intent(out) :: solved
      integer, allocatable :: contact(:), kind(:)
      real(wp), allocatable :: matrix(:, :), rhs(:), z(:), response(:, :), forces(:, :)
      integer :: status

      x = 0.0_wp
      call list_unknowns(problem, contact, kind)
      call bilateral_response(problem, response, solved)
      if (.not. solved) return
      allocate (z(size(kind)), stat=status)
      call check_allocation(status)
      forces = force_of_unknowns(problem, contact, kind)
      call build_problem(problem, contact, kind, forces, response, matrix, rhs)
      call solve_lemke(matrix, rhs, z, solved)
      if (.not. solved) return
      x = matmul(forces, z)
      x = x + matmul(response(:, :size(x)), x) + response(:, size(x) + 1)
   end subroutine solve_friction_lemke

   !> Contact and kind of each unknown.
   pure subroutine list_unknowns(problem, contact, kind)
      type(friction_problem_type), intent(in) :: problem
      integer, allocatable, intent(out) :: contact(:), kind(:)
      logical :: wanted(problem%n, pressing:slip_size)
      integer :: i, k

      wanted(:, pressing) = .not. problem%bilateral .or. problem%friction > 0.0_wp
      do k = forward_force, slip_size
         wanted(:, k) = problem%friction > 0.0_wp .and. problem%sense == 0
      end do
      contact = pack(spread([(i, i=1, problem%n)], 2, 4), wanted)
      kind = pack(spread([(k, k=pressing, slip_size)], 1, problem%n), wanted)
   end subroutine list_unknowns

   !> How the bilateral normal forces follow the other forces (2n columns) and q (last column).
   pure subroutine bilateral_response(problem, response, solved)
      type(friction_problem_type), intent(in) :: problem
      real(wp), allocatable, intent(out) :: response(:, :)     !! (2n, 2n + 1)
      logical, intent(out) :: solved
      integer :: rows(count(problem%bilateral)), i, n
      real(wp) :: answer(size(rows), 2*problem%n + 1)
      integer :: status

      n = problem%n
      rows = pack([(i, i=1, n)], problem%bilateral)
      answer(:, :2*n) = -problem%w(rows, :)
      answer(:, 2*n + 1) = -problem%q(rows)
      call solve_square(problem%w(rows, rows), answer, dependence_tolerance, solved)
      allocate (response(2*n, 2*n + 1), source=0.0_wp, stat=status)
      call check_allocation(status)
      response(rows, :) = answer
   end subroutine bilateral_response

   !> The forces that one of each unknown is, the bilateral normal forces left out.
   pure function force_of_unknowns(problem, contact, kind) result(forces)
      type(friction_problem_type), intent(in) :: problem
      integer, intent(in) :: contact(:), kind(:)
      real(wp) :: forces(2*problem%n, size(kind))
      integer :: i, j, n

      n = problem%n
      forces = 0.0_wp
      do j = 1, size(kind)
         i = contact(j)
         select case (kind(j))
         case (pressing)
            if (.not. problem%bilateral(i)) forces(i, j) = 1.0_wp
            forces(n + i, j) = -problem%friction(i)*problem%sense(i)
         case (forward_force)
            forces(n + i, j) = 1.0_wp
         case (backward_force)
            forces(n + i, j) = -1.0_wp
         case default
            cycle
         end select
      end do
   end function force_of_unknowns

   !> Matrix and right-hand side of the conditions.
   pure subroutine build_problem(problem, contact, kind, forces, response, matrix, rhs)
      type(friction_problem_type), intent(in) :: problem
      integer, intent(in) :: contact(:), kind(:)
      real(wp), intent(in) :: forces(:, :), response(:, :)
      real(wp), allocatable, intent(out) :: matrix(:, :), rhs(:)
      real(wp) :: rate(2*problem%n, size(kind)), rate_alone(2*problem%n)
      real(wp) :: follow(2*problem%n, size(kind))
      integer :: i, j, n, status

      n = problem%n
      follow = matmul(response(:, :2*n), forces)
      rate = matmul(problem%w, forces + follow)
      rate_alone = matmul(problem%w, response(:, 2*n + 1)) + problem%q
      allocate (matrix(size(kind), size(kind)), rhs(size(kind)), source=0.0_wp, stat=status)
      call check_allocation(status)
      do j = 1, size(kind)
         i = contact(j)
         select case (kind(j))
         case (pressing)
            matrix(j, :) = merge(-follow(i, :), rate(i, :), problem%bilateral(i))
            rhs(j) = merge(-response(i, 2*n + 1), rate_alone(i), problem%bilateral(i))
            if (problem%bilateral(i)) matrix(j, j) = matrix(j, j) + 1.0_wp
         case (forward_force)
            matrix(j, :) = rate(n + i, :)
            rhs(j) = rate_alone(n + i)
         case (backward_force)
            matrix(j, :) = -rate(n + i, :)
            rhs(j) = -rate_alone(n + i)
         case default
            cycle
         end select
      end do
      call add_slip_sizes(problem, contact, kind, matrix)
   end subroutine build_problem

   !> The entries that join sigma with the two halves of the tangential force and the normal force.
   pure subroutine add_slip_sizes(problem, contact, kind, matrix)
      type(friction_problem_type), intent(in) :: problem
      integer, intent(in) :: contact(:), kind(:)
      real(wp), intent(inout) :: matrix(:, :)
      integer :: i, j

      do j = 1, size(kind)
         if (kind(j) /= slip_size) cycle
         do i = 1, size(kind)
            if (contact(i) /= contact(j)) cycle
            select case (kind(i))
            case (pressing)
               matrix(j, i) = problem%friction(contact(j))
            case (forward_force, backward_force)
               matrix(j, i) = -1.0_wp
               matrix(i, j) = 1.0_wp
            case default
               cycle
            end select
         end do
      end do
   end subroutine add_slip_sizes

end module friction_lemke
