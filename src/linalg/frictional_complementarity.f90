!> Plane contact with Coulomb friction: forces x and rates r = W x + q, normal ones first, so that
!>
!>     0 <= x_n, r_n >= 0, x_n r_n = 0           (bilateral: r_n = 0, x_n of either sign)
!>     |x_t| <= mu max(0, x_n), with -mu max(0, x_n) sign(r_t) wherever there is slip.
!>
!> An answer exists for W positive definite; with large friction there may be several. States are
!> tried until one set fits; where the sets go round in circles, Lemke's method answers.
module frictional_complementarity
   use kinds, only: wp
   use friction_law, only: friction_problem_type, new_friction_problem, starting_states, &
         solve_states, revise_states, enforce_bounds, law_violation
   use friction_lemke, only: solve_friction_lemke
   implicit none
   private

   public :: solve_friction, solve_friction_states

   !> Rounds after which the sets of states are given up.
   integer, parameter :: max_rounds = 100
   !> What is further from the law than this part of the problem's size is no answer.
   real(wp), parameter :: law_limit = 1.0e-10_wp

contains

   !> Finds forces that fulfil the law. Of W only x W x > 0 is asked: its normal rows need not
   !> be symmetric with the tangential ones. Rows that depend on each other share their force.
   !> `solved` is false if nothing that fulfils the law was found.
   pure subroutine solve_friction(w, q, friction, bilateral, sense, x, solved)
      real(wp), intent(in) :: w(:, :)            !! (2n, 2n)
      real(wp), intent(in) :: q(:)               !! (2n)
      real(wp), intent(in) :: friction(:)        !! (n) mu >= 0
      logical, intent(in) :: bilateral(:)        !! (n)
      integer, intent(in) :: sense(:)            !! (n) 0: by the law; +-1: x_t = -mu x_n sense
      real(wp), intent(out) :: x(:)              !! (2n)
      logical, intent(out) :: solved
      type(friction_problem_type) :: problem

      x = 0.0_wp
      solved = .true.
      if (size(friction) == 0) return
      call new_friction_problem(problem, w, q, friction, bilateral, sense)
      call solve_friction_states(problem, x, solved)
      if (.not. solved) call solve_friction_lemke(problem, x, solved)
      call enforce_bounds(problem, x)
      if (solved) solved = law_violation(problem, x) <= law_limit
      x = problem%force_scale*x
   end subroutine solve_friction

   !> Tries sets of states: changes all wrong ones at once, after a repeated set the worst alone.
   !> `solved` is false if that has no end. Forces are the problem's scaled ones.
   pure subroutine solve_friction_states(problem, x, solved)
      type(friction_problem_type), intent(in) :: problem
      real(wp), intent(out) :: x(:)              !! (2n)
      logical, intent(out) :: solved
      integer :: history(problem%n, max_rounds), states(problem%n), revised(problem%n)
      integer :: round, previous, worst
      real(wp) :: fault(problem%n)
      logical :: alone

      states = starting_states(problem)
      alone = .false.
      do round = 1, max_rounds
         history(:, round) = states
         call solve_states(problem, states, x, solved)
         if (.not. solved) return
         call revise_states(problem, x, states, revised, fault)
         solved = all(fault <= 0.0_wp)
         if (solved) exit
         do previous = 1, round - 1
            if (all(history(:, previous) == states)) alone = .true.
         end do
         worst = maxloc(fault, dim=1)
         if (alone) then
            states(worst) = revised(worst)
         else
            states = revised
         end if
      end do
      if (.not. solved) return
      solved = law_violation(problem, x) <= law_limit
   end subroutine solve_friction_states

end module frictional_complementarity
