!> SPRING1 (node to ground), SPRING2 (freedom to freedom), SPRINGA (along the line between two
!> nodes, small displacements), linear or by a table of force over elongation.
module spring
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use element_interface, only: element_type
   use axial_kinematics, only: rank_one, elongations, spread
   implicit none
   private

   public :: spring_type, new_spring

   !> Springs that share one law.
   type, extends(element_type) :: spring_type
      real(wp), allocatable :: b(:, :)      !! (3 n_nodes, n_elements) elongation = b . d
      real(wp) :: k = 0.0_wp                !! linear stiffness
      real(wp), allocatable :: u(:), f(:)   !! table of a nonlinear spring, u increasing
      real(wp), allocatable :: energy(:)    !! strain energy at the table's points
   contains
      procedure :: uses
      procedure :: stiffness
      procedure :: largest_stiffness
      procedure :: internal_force
      procedure :: strain_energy
   end type spring_type

contains

   !> A group of linear springs, or of nonlinear ones if a table is given.
   pure subroutine new_spring(self, b, k, u, f)
      type(spring_type), intent(out) :: self
      real(wp), intent(in) :: b(:, :)                !! (3 n_nodes, n_elements)
      real(wp), intent(in) :: k                      !! force over elongation
      real(wp), intent(in), optional :: u(:), f(:)   !! elongations (increasing) and forces

      self%n_nodes = size(b, 1)/3
      self%n_elements = size(b, 2)
      self%b = b
      self%k = k
      if (.not. present(u) .or. .not. present(f)) return
      self%linear = .false.
      self%u = u
      self%f = f
      call integrate_table(self)
   end subroutine new_spring

   !> Energies at the table's points by the trapezoidal rule, zero at zero elongation.
   pure subroutine integrate_table(self)
      type(spring_type), intent(inout) :: self
      integer :: i, status

      allocate (self%energy(size(self%u)), stat=status)
      call check_allocation(status)
      self%energy(1) = 0.0_wp
      do i = 2, size(self%u)
         self%energy(i) = self%energy(i - 1) &
               + (self%u(i) - self%u(i - 1))*(self%f(i) + self%f(i - 1))/2.0_wp
      end do
      self%energy = self%energy - table_energy(self, 0.0_wp)
   end subroutine integrate_table

   !> The freedoms with a share in the elongation.
   pure function uses(self, e) result(used)
      class(spring_type), intent(in) :: self
      integer, intent(in) :: e
      logical :: used(3*self%n_nodes)

      used = abs(self%b(:, e)) > 0.0_wp
   end function uses

   !> k b bt with the tangent k = dF/du.
   pure subroutine stiffness(self, e, d, history, matrix)
      class(spring_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: d(:), history(:)
      real(wp), intent(out) :: matrix(:, :)
      real(wp) :: k, force

      k = self%k
      if (.not. self%linear) call table_law(self, dot_product(self%b(:, e), d), force, k)
      call rank_one(k, self%b(:, e), matrix)
   end subroutine stiffness

   !> k b bt with the steepest slope of the table.
   pure subroutine largest_stiffness(self, e, matrix)
      class(spring_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(out) :: matrix(:, :)
      real(wp) :: k
      integer :: n

      k = self%k
      if (.not. self%linear) then
         n = size(self%u)
         k = maxval((self%f(2:) - self%f(:n - 1))/(self%u(2:) - self%u(:n - 1)))
      end if
      call rank_one(k, self%b(:, e), matrix)
   end subroutine largest_stiffness

   pure subroutine internal_force(self, d, history, force, updated)
      class(spring_type), intent(in) :: self
      real(wp), intent(in) :: d(:, :), history(:, :)
      real(wp), intent(out) :: force(:, :), updated(:, :)
      real(wp) :: elongation(self%n_elements), axial(self%n_elements), k
      integer :: e

      updated = history
      elongation = elongations(self%b, d)
      if (self%linear) then
         axial = self%k*elongation
      else
         do e = 1, self%n_elements
            call table_law(self, elongation(e), axial(e), k)
         end do
      end if
      call spread(self%b, axial, force)
   end subroutine internal_force

   pure function strain_energy(self, d, history) result(energy)
      class(spring_type), intent(in) :: self
      real(wp), intent(in) :: d(:, :), history(:, :)
      real(wp) :: energy
      real(wp) :: elongation(self%n_elements)
      integer :: e

      elongation = elongations(self%b, d)
      if (self%linear) then
         energy = self%k*sum(elongation**2)/2.0_wp
         return
      end if
      energy = 0.0_wp
      do e = 1, self%n_elements
         energy = energy + table_energy(self, elongation(e))
      end do
   end function strain_energy

   !> Force and tangent at an elongation; beyond the table the force stays constant.
   pure subroutine table_law(self, elongation, force, tangent)
      type(spring_type), intent(in) :: self
      real(wp), intent(in) :: elongation
      real(wp), intent(out) :: force, tangent
      integer :: i

      i = piece(self%u, elongation)
      tangent = 0.0_wp
      force = self%f(max(1, i))
      if (i < 1 .or. i >= size(self%u)) return
      tangent = (self%f(i + 1) - self%f(i))/(self%u(i + 1) - self%u(i))
      force = force + tangent*(elongation - self%u(i))
   end subroutine table_law

   !> Integral of the table's force up to an elongation.
   pure function table_energy(self, elongation) result(energy)
      type(spring_type), intent(in) :: self
      real(wp), intent(in) :: elongation
      real(wp) :: energy
      real(wp) :: force, tangent
      integer :: i

      i = max(1, piece(self%u, elongation))
      call table_law(self, elongation, force, tangent)
      energy = self%energy(i) + (elongation - self%u(i))*(self%f(i) + force)/2.0_wp
   end function table_energy

   !> The last i with u(i) <= value, 0 below the table.
   pure function piece(u, value) result(i)
      real(wp), intent(in) :: u(:), value
      integer :: i

      i = count(u <= value)
   end function piece

end module spring
