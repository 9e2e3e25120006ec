!> Coulomb's law of plane contacts as a set of states, one a contact: the linear equations of a
!> set, and what is wrong with their solution. With the normal values first and the tangential ones
!> last, x are the forces (or impulses) and r = W x + q the rates that belong to them.
module friction_law
   use kinds, only: wp
   use square_systems, only: solve_square
   implicit none
   private

   public :: friction_problem_type, new_friction_problem, closed_state, starting_states
   public :: solve_states, revise_states, enforce_bounds, law_violation

   !> States. Open: no force; for a bilateral row the normal equation without friction.
   integer, parameter, public :: open = 0, stick = 2, slip_forward = 1, slip_backward = -1
   !> What counts as zero, in parts of the problem's size.
   real(wp), parameter :: relative_tolerance = 1.0e-12_wp
   !> How far a sticking force may exceed its bound, in parts of what counts as zero.
   real(wp), parameter :: bound_excess = 10.0_wp
   !> What is added to the diagonal of rows that depend on each other, in parts of its mean.
   real(wp), parameter, public :: dependence_tolerance = 1.0e-12_wp
   !> Diagonal entries below this count as this in the comparison of faults.
   real(wp), parameter :: least_diagonal = 1.0e-30_wp

   !> A problem scaled to entries of the order of one.
   type :: friction_problem_type
      integer :: n = 0                           !! contacts
      real(wp), allocatable :: w(:, :)           !! (2n, 2n)
      real(wp), allocatable :: q(:)              !! (2n)
      real(wp), allocatable :: friction(:)       !! (n)
      logical, allocatable :: bilateral(:)       !! (n)
      integer, allocatable :: sense(:)           !! (n)
      real(wp) :: force_scale = 1.0_wp           !! given forces per scaled ones
   end type friction_problem_type

contains

   !> Takes a problem over and scales it.
   pure subroutine new_friction_problem(self, w, q, friction, bilateral, sense)
      type(friction_problem_type), intent(out) :: self
      real(wp), intent(in) :: w(:, :), q(:), friction(:)
      logical, intent(in) :: bilateral(:)
      integer, intent(in) :: sense(:)
      real(wp) :: rate, compliance
      integer :: i

      self%n = size(friction)
      rate = max(maxval(abs(q)), tiny(1.0_wp))
      compliance = maxval([(abs(w(i, i)), i=1, size(q))])
      if (compliance <= 0.0_wp) compliance = 1.0_wp
      self%w = w/compliance
      self%q = q/rate
      self%friction = friction
      self%bilateral = bilateral
      self%sense = sense
      self%force_scale = rate/compliance
   end subroutine new_friction_problem

   !> The state in which a contact closes: in slip, the way it moves. (Closing in stick is a bad
   !> guess: contacts that wedge each other then open again, and the sets go round in circles.)
   pure integer function closed_state(self, contact, slip_rate) result(state)
      type(friction_problem_type), intent(in) :: self
      integer, intent(in) :: contact
      real(wp), intent(in) :: slip_rate

      state = slip_forward
      if (self%sense(contact) /= 0) then
         state = self%sense(contact)
      else if (self%friction(contact) > 0.0_wp) then
         if (slip_rate < 0.0_wp) state = slip_backward
         if (abs(slip_rate) <= relative_tolerance) state = stick
      end if
   end function closed_state

   !> The states to begin with: what closes without force is closed.
   pure function starting_states(self) result(states)
      type(friction_problem_type), intent(in) :: self
      integer :: states(self%n)
      integer :: i

      states = open
      do i = 1, self%n
         if (.not. self%bilateral(i) .and. self%q(i) >= 0.0_wp) cycle
         states(i) = closed_state(self, i, self%q(self%n + i))
      end do
   end function starting_states

   !> The forces of a set of states.
   pure subroutine solve_states(self, states, x, solved)
      type(friction_problem_type), intent(in) :: self
      integer, intent(in) :: states(:)           !! (n)
      real(wp), intent(out) :: x(:)              !! (2n)
      logical, intent(out) :: solved
      integer :: normal(count(states /= open .or. self%bilateral)), tangent(count(states == stick))
      real(wp) :: matrix(size(normal) + size(tangent), size(normal) + size(tangent))
      real(wp) :: y(size(normal) + size(tangent), 1), ratio(self%n)
      integer :: rows(size(normal) + size(tangent)), i, n

      n = self%n
      normal = pack([(i, i=1, n)], states /= open .or. self%bilateral)
      tangent = pack([(n + i, i=1, n)], states == stick)
      rows = [normal, tangent]
      ! a slipping contact's tangential force in parts of its normal force
      ratio = merge(-self%friction*states, 0.0_wp, abs(states) == 1)
      do i = 1, size(normal)
         matrix(:, i) = self%w(rows, normal(i)) + ratio(normal(i))*self%w(rows, n + normal(i))
      end do
      matrix(:, size(normal) + 1:) = self%w(rows, tangent)
      y(:, 1) = -self%q(rows)
      call solve_square(matrix, y, dependence_tolerance, solved)
      x = 0.0_wp
      if (.not. solved) return
      x(rows) = y(:, 1)
      where (states /= stick) x(n + 1:) = ratio*x(:n)
   end subroutine solve_states

   !> What the solution of a set asks each contact to become, and how far it is from what it was
   !> assumed to be: the square root of an energy, 0 for those that keep their state.
   pure subroutine revise_states(self, x, states, revised, fault)
      type(friction_problem_type), intent(in) :: self
      real(wp), intent(in) :: x(:)               !! (2n), of the states
      integer, intent(in) :: states(:)           !! (n)
      integer, intent(out) :: revised(:)         !! (n)
      real(wp), intent(out) :: fault(:)          !! (n)
      real(wp) :: rate(2*self%n), rate_floor, force_floor, measure(2*self%n)
      logical :: closes
      integer :: i, n

      n = self%n
      rate = matmul(self%w, x) + self%q
      rate_floor = relative_tolerance*problem_rate(self, x)
      force_floor = relative_tolerance*maxval(abs(x))
      measure = sqrt([(max(self%w(i, i), least_diagonal), i=1, 2*n)])
      revised = states
      fault = 0.0_wp
      do i = 1, n
         if (self%bilateral(i) .and. self%friction(i) <= 0.0_wp) cycle
         if (states(i) == open) then
            closes = merge(x(i) > force_floor, rate(i) < -rate_floor, self%bilateral(i))
            if (.not. closes) cycle
            revised(i) = closed_state(self, i, rate(n + i))
            fault(i) = merge(x(i)*measure(i), -rate(i)/measure(i), self%bilateral(i))
         else if (x(i) < -force_floor) then
            revised(i) = open
            fault(i) = -x(i)*measure(i)
         else if (self%friction(i) <= 0.0_wp .or. self%sense(i) /= 0) then
            cycle
         else if (states(i) /= stick .and. states(i)*rate(n + i) < -rate_floor) then
            revised(i) = stick
            fault(i) = abs(rate(n + i))/measure(n + i)
         else if (abs(x(n + i)) > self%friction(i)*x(i) + bound_excess*force_floor) then
            revised(i) = merge(slip_backward, slip_forward, x(n + i) > 0.0_wp)
            fault(i) = (abs(x(n + i)) - self%friction(i)*x(i))*measure(n + i)
         end if
      end do
   end subroutine revise_states

   !> Takes the round-off of a solution off its bounds: no pull, no more friction than the law's.
   pure subroutine enforce_bounds(self, x)
      type(friction_problem_type), intent(in) :: self
      real(wp), intent(inout) :: x(:)            !! (2n)
      real(wp) :: bound(self%n)
      integer :: n

      n = self%n
      where (.not. self%bilateral) x(:n) = max(x(:n), 0.0_wp)
      bound = self%friction*max(x(:n), 0.0_wp)
      x(n + 1:) = max(-bound, min(bound, x(n + 1:)))
   end subroutine enforce_bounds

   !> How far x is from the law, in parts of the problem's size.
   pure real(wp) function law_violation(self, x) result(violation)
      type(friction_problem_type), intent(in) :: self
      real(wp), intent(in) :: x(:)               !! (2n)
      real(wp) :: rate(2*self%n), force(2*self%n), bound, target, miss
      integer :: i, n

      n = self%n
      rate = (matmul(self%w, x) + self%q)/problem_rate(self, x)
      force = x/max(maxval(abs(x)), tiny(1.0_wp))
      violation = 0.0_wp
      do i = 1, n
         bound = self%friction(i)*max(force(i), 0.0_wp)
         miss = merge(abs(rate(i)), abs(min(force(i), rate(i))), self%bilateral(i))
         if (self%sense(i) /= 0) then
            miss = max(miss, abs(force(n + i) + bound*self%sense(i)))
         else
            ! the force is its own projection, after a step against the slip, on what is allowed
            target = max(-bound, min(bound, force(n + i) - rate(n + i)))
            miss = max(miss, abs(force(n + i) - target))
         end if
         violation = max(violation, miss)
      end do
   end function law_violation

   !> The size of the terms of which the rates are the sum.
   pure real(wp) function problem_rate(self, x)
      type(friction_problem_type), intent(in) :: self
      real(wp), intent(in) :: x(:)

      problem_rate = max(maxval(abs(self%q)) + maxval(matmul(abs(self%w), abs(x))), tiny(1.0_wp))
   end function problem_rate

end module friction_law
