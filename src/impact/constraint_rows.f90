!> The contact rows on the freedoms of a structure: gaps, their rates and accelerations, slip,
!> contact forces, and how an impact behaves in each row.
module constraint_rows
   use kinds, only: wp
   use state_archive, only: archive_type
   use histories, only: amplitude_type
   use amplitude_value, only: amplitude_at, amplitude_slope
   use motion_state, only: state_type
   use row_matrix, only: row_matrix_type, multiply, multiply_absolute, add_transposed, full_row
   implicit none
   private

   public :: rows_type, row_gaps, row_rates, row_accelerations, row_forces, row_vector
   public :: row_curvature, slip_rates, slip_products, slip_vector, contact_forces
   public :: slip_increments, sliding_speeds, wall_work, may_hit, sticks
   public :: gap_size, rate_size, acceleration_size, wall_rates
   public :: law_motion, law_closed, law_penalty, law_overlap

   !> How a row's contact force follows in a step.
   integer, parameter :: law_motion = 0      !! from the acceleration, while the row touches
   integer, parameter :: law_closed = 1      !! gap >= 0, force >= 0 at the end of the step
   integer, parameter :: law_penalty = 2     !! stiffness times overlap at the end of the step
   integer, parameter :: law_overlap = 3     !! the fictitious force

   !> A friction force within this part of its limit slips.
   real(wp), parameter :: slip_tolerance = 1.0e-9_wp

   !> A row that faces nothing has this gap.
   real(wp), parameter, public :: far_gap = 1.0e30_wp

   !> G by rows over freedoms, with g = G d + offset + c(t), and the directions of slip beside it.
   !> Rows of bodies that slide on each other are placed anew in every step (row_placement).
   type :: rows_type
      integer :: n = 0
      type(row_matrix_type) :: along_normal      !! G
      type(row_matrix_type) :: along_tangent     !! T: slip rate of the contactor on its partner
      type(row_matrix_type) :: turning           !! rate at which the partner's normal turns
      real(wp), allocatable :: offset(:)         !! (n) g0
      real(wp), allocatable :: bend(:)           !! (n) curvature of the partner, < 0 if convex
      logical, allocatable :: facing(:)          !! (n) the row has a partner
      integer, allocatable :: amplitude(:)       !! (n) of a moving wall, 0: at rest
      real(wp), allocatable :: wall(:, :)        !! (3, n) displacement of the wall at amplitude 1
      real(wp), allocatable :: motion(:)         !! (n) c at amplitude 1
      real(wp), allocatable :: sliding_motion(:) !! (n) the same of the slip
      type(amplitude_type), allocatable :: amplitudes(:)
      logical, allocatable :: sustained(:)       !! (n) no restitution given
      real(wp), allocatable :: restitution(:)    !! (n) e, zero where sustained
      real(wp), allocatable :: capture(:)        !! (n) capture speed, negative: from the step
      integer, allocatable :: law(:)             !! (n) one of the law_ parameters
      logical, allocatable :: massless(:)        !! (n) the contact nodes have no mass
      real(wp), allocatable :: stiffness(:)      !! (n) penalty
      real(wp), allocatable :: friction(:)       !! (n) Coulomb's mu
      integer, allocatable :: node_id(:)         !! (n) the deck's id of the contactor node
      integer, allocatable :: pair(:)            !! (n) index of the pair
      real(wp), allocatable :: normal(:, :)      !! (3, n) of the force on the contactor node
      real(wp), allocatable :: tangent(:, :)     !! (3, n) of its friction force
      real(wp), allocatable :: weight(:)         !! (n) length a force acts on, 0: not known
      logical :: moving = .false.                !! some rows are placed anew in every step
   contains
      procedure :: pass_state
   end type rows_type

contains

   !> What placing the rows anew changes; nothing where they do not move.
   subroutine pass_state(self, archive)
      class(rows_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      if (.not. self%moving) return
      call archive%enter('along_normal')
      call self%along_normal%pass_state(archive)
      call archive%leave()
      call archive%enter('along_tangent')
      call self%along_tangent%pass_state(archive)
      call archive%leave()
      call archive%enter('turning')
      call self%turning%pass_state(archive)
      call archive%leave()
      call archive%pass('offset', self%offset)
      call archive%pass('bend', self%bend)
      call archive%pass('facing', self%facing)
      call archive%pass('motion', self%motion)
      call archive%pass('sliding_motion', self%sliding_motion)
      call archive%pass('normal', self%normal)
      call archive%pass('tangent', self%tangent)
      call archive%pass('weight', self%weight)
   end subroutine pass_state

   !> Rows whose impacts are jumps of velocity, and that have a partner to hit: a node without mass
   !> has no velocity to jump.
   pure function may_hit(self) result(may)
      type(rows_type), intent(in) :: self
      logical :: may(self%n)

      may = self%law == law_motion .or. (self%law == law_closed .and. .not. self%massless)
      may = may .and. self%facing
   end function may_hit

   !> Rows pressed with friction forces below their limits.
   pure function sticks(self, lambda, tau) result(stuck)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: lambda(:), tau(:)  !! (n)
      logical :: stuck(self%n)

      stuck = lambda > 0.0_wp .and. self%friction > 0.0_wp .and. &
            abs(tau) < self%friction*lambda*(1.0_wp - slip_tolerance)
   end function sticks

   !> Gaps g = G d + g0 + c(t).
   pure function row_gaps(self, state) result(gaps)
      type(rows_type), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp) :: gaps(self%n)

      gaps = multiply(self%along_normal, state%d) + self%offset &
            + wall_positions(self, self%motion, state%t)
   end function row_gaps

   !> Gap rates G v + c'(t).
   pure function row_rates(self, state) result(rates)
      type(rows_type), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp) :: rates(self%n)

      rates = multiply(self%along_normal, state%v) + wall_rates(self, state%t)
   end function row_rates

   !> G a: gap accelerations but for `row_curvature`; a wall moves at piecewise constant speed.
   pure function row_accelerations(self, a) result(accelerations)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: a(:)               !! (n_freedoms)
      real(wp) :: accelerations(self%n)

      accelerations = multiply(self%along_normal, a)
   end function row_accelerations

   !> (dG/dt) v, the part of the gap acceleration that comes from sliding at v_t along an edge whose
   !> normal turns: -2 v_t (n . dv/dx) - (n . x'') v_t^2.
   pure function row_curvature(self, state) result(accelerations)
      type(rows_type), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp) :: accelerations(self%n)
      real(wp) :: slip(self%n)

      accelerations = 0.0_wp
      if (.not. self%moving) return
      slip = slip_rates(self, state)
      accelerations = -slip*(2.0_wp*multiply(self%turning, state%v) + self%bend*slip)
   end function row_curvature

   !> T v + s'(t): speed at which the contactor slides on its partner, with walls as they move just
   !> after the state's time.
   pure function slip_rates(self, state) result(rates)
      type(rows_type), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp) :: rates(self%n)

      rates = multiply(self%along_tangent, state%v) + sliding_speeds(self, state%t)
   end function slip_rates

   !> s'(t), the part of slip rates that moving walls have, just after t.
   pure function sliding_speeds(self, t) result(speeds)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp) :: speeds(self%n)

      speeds = wall_speeds(self, self%sliding_motion, t)
   end function sliding_speeds

   !> T u of all rows.
   pure function slip_products(self, u) result(products)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: u(:)               !! (n_freedoms)
      real(wp) :: products(self%n)

      products = multiply(self%along_tangent, u)
   end function slip_products

   !> Slip of the contactors on their partners between two states.
   pure function slip_increments(self, from, to) result(slip)
      type(rows_type), intent(in) :: self
      type(state_type), intent(in) :: from, to
      real(wp) :: slip(self%n)

      slip = multiply(self%along_tangent, to%d - from%d) &
            + wall_positions(self, self%sliding_motion, to%t) &
            - wall_positions(self, self%sliding_motion, from%t)
   end function slip_increments

   !> Work that moving walls do on what touches them between two states, by mean contact and
   !> friction forces.
   pure function wall_work(self, from, to, lambda, tau) result(work)
      type(rows_type), intent(in) :: self
      type(state_type), intent(in) :: from, to
      real(wp), intent(in) :: lambda(:), tau(:)  !! (n)
      real(wp) :: work

      work = -dot_product(lambda, wall_positions(self, self%motion, to%t) &
            - wall_positions(self, self%motion, from%t)) &
            - dot_product(tau, wall_positions(self, self%sliding_motion, to%t) &
            - wall_positions(self, self%sliding_motion, from%t))
   end function wall_work

   !> c(t) of moving walls.
   pure function wall_positions(self, motion, t) result(positions)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: motion(:)          !! (n) position at amplitude 1
      real(wp), intent(in) :: t
      real(wp) :: positions(self%n)
      integer :: i

      positions = 0.0_wp
      do i = 1, self%n
         if (self%amplitude(i) == 0) cycle
         positions(i) = motion(i)*amplitude_at(self%amplitudes(self%amplitude(i)), t)
      end do
   end function wall_positions

   !> c'(t) of moving walls, just after t.
   pure function wall_rates(self, t) result(rates)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp) :: rates(self%n)

      rates = wall_speeds(self, self%motion, t)
   end function wall_rates

   pure function wall_speeds(self, motion, t) result(speeds)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: motion(:)          !! (n) position at amplitude 1
      real(wp), intent(in) :: t
      real(wp) :: speeds(self%n)
      integer :: i

      speeds = 0.0_wp
      do i = 1, self%n
         if (self%amplitude(i) == 0) cycle
         speeds(i) = motion(i)*amplitude_slope(self%amplitudes(self%amplitude(i)), t)
      end do
   end function wall_speeds

   !> Gt lambda: normal contact forces (or impulses) on freedoms.
   pure function row_forces(self, lambda, n_freedoms) result(force)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: lambda(:)          !! (n)
      integer, intent(in) :: n_freedoms
      real(wp) :: force(n_freedoms)

      force = 0.0_wp
      call add_transposed(self%along_normal, lambda, force)
   end function row_forces

   !> Gt lambda + Tt tau: contact forces with friction.
   pure function contact_forces(self, lambda, tau, n_freedoms) result(force)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: lambda(:), tau(:)  !! (n)
      integer, intent(in) :: n_freedoms
      real(wp) :: force(n_freedoms)

      force = row_forces(self, lambda, n_freedoms)
      call add_transposed(self%along_tangent, tau, force)
   end function contact_forces

   !> Row i of G as a vector of forces.
   pure function row_vector(self, i, n_freedoms) result(force)
      type(rows_type), intent(in) :: self
      integer, intent(in) :: i, n_freedoms
      real(wp) :: force(n_freedoms)

      force = full_row(self%along_normal, i, n_freedoms)
   end function row_vector

   !> Row i of T as a vector of forces.
   pure function slip_vector(self, i, n_freedoms) result(force)
      type(rows_type), intent(in) :: self
      integer, intent(in) :: i, n_freedoms
      real(wp) :: force(n_freedoms)

      force = full_row(self%along_tangent, i, n_freedoms)
   end function slip_vector

   !> Size of the numbers that gaps are differences of: what round-off is relative to.
   pure function gap_size(self, state, dt) result(size_of_gap)
      type(rows_type), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: dt
      real(wp) :: size_of_gap

      size_of_gap = max(0.0_wp, maxval(multiply_absolute(self%along_normal, state%d) &
            + dt*abs(row_rates(self, state)) &
            + abs(self%offset + wall_positions(self, self%motion, state%t)), mask=self%facing))
   end function gap_size

   !> Size of the speeds that gap rates are differences of.
   pure function rate_size(self, state) result(size_of_rate)
      type(rows_type), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp) :: size_of_rate

      size_of_rate = max(0.0_wp, maxval(multiply_absolute(self%along_normal, state%v) &
            + abs(wall_rates(self, state%t)), mask=self%facing))
   end function rate_size

   !> Size of the accelerations that gap accelerations are differences of.
   pure function acceleration_size(self, a) result(size_of_acceleration)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: a(:)               !! (n_freedoms)
      real(wp) :: size_of_acceleration

      size_of_acceleration = max(0.0_wp, maxval(multiply_absolute(self%along_normal, a), &
            mask=self%facing))
   end function acceleration_size

end module constraint_rows
