!> The contact rows on the freedoms of a structure: gaps, their rates and accelerations, contact
!> forces, and how an impact behaves in each row.
module constraint_rows
   use kinds, only: wp
   use errors, only: error_type
   use places, only: fail_at
   use text, only: to_text
   use histories, only: amplitude_type
   use amplitude_value, only: amplitude_at, amplitude_slope
   use model, only: model_type
   use surfaces, only: interaction_type
   use structure, only: structure_type
   use contact_pairs, only: contact_pair_list_type
   use motion_state, only: state_type
   implicit none
   private

   public :: rows_type, new_rows, row_gaps, row_rates, row_accelerations, row_forces, row_vector
   public :: gap_size, rate_size, acceleration_size, wall_rates

   !> G by rows over freedoms, with g = G d + offset + c(t).
   type :: rows_type
      integer :: n = 0
      integer, allocatable :: first(:)           !! (n+1) row pointers
      integer, allocatable :: freedom(:)
      real(wp), allocatable :: coefficient(:)
      real(wp), allocatable :: offset(:)         !! (n) g0
      integer, allocatable :: amplitude(:)       !! (n) of a moving wall, 0: at rest
      real(wp), allocatable :: motion(:)         !! (n) c at amplitude 1
      type(amplitude_type), allocatable :: amplitudes(:)
      logical, allocatable :: sustained(:)       !! (n) no restitution given
      real(wp), allocatable :: restitution(:)    !! (n) e, zero where sustained
      real(wp), allocatable :: capture(:)        !! (n) capture speed, negative: from the step
      integer, allocatable :: node_id(:)         !! (n) the deck's id of the contactor node
      integer, allocatable :: pair(:)            !! (n) index of the pair
      real(wp), allocatable :: normal(:, :)      !! (3, n) of the force on the contactor node
   end type rows_type

contains

   !> Places the rows on the structure's freedoms. A row with none is an error at its deck line.
   subroutine new_rows(self, list, model, structure, error)
      type(rows_type), intent(out) :: self
      type(contact_pair_list_type), intent(in) :: list
      type(model_type), intent(in) :: model
      type(structure_type), intent(in) :: structure
      type(error_type), allocatable, intent(out) :: error
      integer :: i, j, f, n

      self%n = size(list%rows)
      allocate (self%first(self%n + 1), self%freedom(6*self%n), self%coefficient(6*self%n))
      allocate (self%normal(3, self%n))
      n = 0
      do i = 1, self%n
         self%first(i) = n + 1
         do j = 1, list%rows(i)%n_terms
            f = structure%map%freedom(list%rows(i)%term_dof(j), list%rows(i)%term_node(j))
            if (f == 0) cycle
            n = n + 1
            self%freedom(n) = f
            self%coefficient(n) = list%rows(i)%coefficient(j)
         end do
         self%normal(:, i) = list%rows(i)%normal
         if (n >= self%first(i)) cycle
         call fail_at(error, model%source, list%rows(i)%place, 'node ' &
               //to_text(model%nodes%id(list%rows(i)%node)) &
               //' cannot move along the contact normal: it has no freedom there', &
               'give the node a mass or an element, or leave it out of the contact')
         return
      end do
      self%first(self%n + 1) = n + 1
      self%offset = list%rows%offset
      self%amplitude = list%rows%amplitude
      self%motion = list%rows%motion
      self%amplitudes = model%amplitudes
      self%pair = list%rows%pair
      self%node_id = model%nodes%id(list%rows%node)
      call copy_behaviour(self, list, model)
   end subroutine new_rows

   subroutine copy_behaviour(self, list, model)
      type(rows_type), intent(inout) :: self
      type(contact_pair_list_type), intent(in) :: list
      type(model_type), intent(in) :: model
      type(interaction_type) :: interaction
      integer :: i

      allocate (self%sustained(self%n), self%restitution(self%n), self%capture(self%n))
      do i = 1, self%n
         interaction = model%interactions(list%rows(i)%interaction)
         self%sustained(i) = .not. interaction%has_restitution
         self%restitution(i) = merge(interaction%restitution, 0.0_wp, interaction%has_restitution)
         self%capture(i) = merge(interaction%capture, -1.0_wp, interaction%has_capture)
      end do
   end subroutine copy_behaviour

   !> G u of all rows.
   pure function row_products(self, u) result(products)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: u(:)               !! (n_freedoms)
      real(wp) :: products(self%n)
      integer :: i

      do i = 1, self%n
         associate (from => self%first(i), to => self%first(i + 1) - 1)
            products(i) = dot_product(self%coefficient(from:to), u(self%freedom(from:to)))
         end associate
      end do
   end function row_products

   !> Gaps g = G d + g0 + c(t).
   pure function row_gaps(self, state) result(gaps)
      type(rows_type), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp) :: gaps(self%n)

      gaps = row_products(self, state%d) + self%offset + wall_positions(self, state%t)
   end function row_gaps

   !> Gap rates G v + c'(t).
   pure function row_rates(self, state) result(rates)
      type(rows_type), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp) :: rates(self%n)

      rates = row_products(self, state%v) + wall_rates(self, state%t)
   end function row_rates

   !> Gap accelerations G a; a wall moves at piecewise constant speed.
   pure function row_accelerations(self, a) result(accelerations)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: a(:)               !! (n_freedoms)
      real(wp) :: accelerations(self%n)

      accelerations = row_products(self, a)
   end function row_accelerations

   !> c(t) of moving walls.
   pure function wall_positions(self, t) result(positions)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp) :: positions(self%n)
      integer :: i

      positions = 0.0_wp
      do i = 1, self%n
         if (self%amplitude(i) == 0) cycle
         positions(i) = self%motion(i)*amplitude_at(self%amplitudes(self%amplitude(i)), t)
      end do
   end function wall_positions

   !> c'(t) of moving walls, just after t.
   pure function wall_rates(self, t) result(rates)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp) :: rates(self%n)
      integer :: i

      rates = 0.0_wp
      do i = 1, self%n
         if (self%amplitude(i) == 0) cycle
         rates(i) = self%motion(i)*amplitude_slope(self%amplitudes(self%amplitude(i)), t)
      end do
   end function wall_rates

   !> Gt lambda: contact forces (or impulses) on freedoms.
   pure function row_forces(self, lambda, n_freedoms) result(force)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: lambda(:)          !! (n)
      integer, intent(in) :: n_freedoms
      real(wp) :: force(n_freedoms)
      integer :: i, k

      force = 0.0_wp
      do i = 1, self%n
         if (.not. abs(lambda(i)) > 0.0_wp) cycle
         do k = self%first(i), self%first(i + 1) - 1
            force(self%freedom(k)) = force(self%freedom(k)) + lambda(i)*self%coefficient(k)
         end do
      end do
   end function row_forces

   !> Row i of G as a vector of forces.
   pure function row_vector(self, i, n_freedoms) result(force)
      type(rows_type), intent(in) :: self
      integer, intent(in) :: i, n_freedoms
      real(wp) :: force(n_freedoms)
      real(wp) :: unit(self%n)

      unit = 0.0_wp
      unit(i) = 1.0_wp
      force = row_forces(self, unit, n_freedoms)
   end function row_vector

   !> Size of the numbers that gaps are differences of: what round-off is relative to.
   pure function gap_size(self, state, dt) result(size_of_gap)
      type(rows_type), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: dt
      real(wp) :: size_of_gap

      size_of_gap = maxval(absolute_products(self, state%d) + dt*abs(row_rates(self, state)) &
            + abs(self%offset + wall_positions(self, state%t)))
   end function gap_size

   !> Size of the speeds that gap rates are differences of.
   pure function rate_size(self, state) result(size_of_rate)
      type(rows_type), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp) :: size_of_rate

      size_of_rate = maxval(absolute_products(self, state%v) + abs(wall_rates(self, state%t)))
   end function rate_size

   !> Size of the accelerations that gap accelerations are differences of.
   pure function acceleration_size(self, a) result(size_of_acceleration)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: a(:)               !! (n_freedoms)
      real(wp) :: size_of_acceleration

      size_of_acceleration = maxval(absolute_products(self, a))
   end function acceleration_size

   !> |G| |u| of all rows.
   pure function absolute_products(self, u) result(products)
      type(rows_type), intent(in) :: self
      real(wp), intent(in) :: u(:)
      real(wp) :: products(self%n)
      integer :: i

      do i = 1, self%n
         associate (from => self%first(i), to => self%first(i + 1) - 1)
            products(i) = sum(abs(self%coefficient(from:to)*u(self%freedom(from:to))))
         end associate
      end do
   end function absolute_products

end module constraint_rows
