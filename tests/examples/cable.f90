!> CABLE: resists being stretched, not being shortened. An example of how an element is added.
module cable
   use kinds, only: wp
   use element_interface, only: element_type
   use axial_kinematics, only: rank_one, elongations, spread
   implicit none
   private

   public :: cable_type, new_cable

   !> Cables that share one stiffness: force = k max(0, elongation).
   type, extends(element_type) :: cable_type
      real(wp), allocatable :: b(:, :)      !! (6, n_elements) elongation = b . d
      real(wp) :: k = 0.0_wp                !! force over elongation
   contains
      procedure :: uses
      procedure :: stiffness
      procedure :: largest_stiffness
      procedure :: internal_force
      procedure :: strain_energy
   end type cable_type

contains

   !> A group of cables.
   pure subroutine new_cable(self, b, k)
      type(cable_type), intent(out) :: self
      real(wp), intent(in) :: b(:, :)       !! (6, n_elements)
      real(wp), intent(in) :: k             !! positive

      self%n_nodes = 2
      self%n_elements = size(b, 2)
      self%linear = .false.
      self%b = b
      self%k = k
   end subroutine new_cable

   !> The freedoms with a share in the elongation.
   pure function uses(self, e) result(used)
      class(cable_type), intent(in) :: self
      integer, intent(in) :: e
      logical :: used(3*self%n_nodes)

      used = abs(self%b(:, e)) > 0.0_wp
   end function uses

   !> k b bt while the cable is stretched, nothing while it is slack.
   pure subroutine stiffness(self, e, d, history, matrix)
      class(cable_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: d(:), history(:)
      real(wp), intent(out) :: matrix(:, :)

      matrix = 0.0_wp
      if (dot_product(self%b(:, e), d) > 0.0_wp) call rank_one(self%k, self%b(:, e), matrix)
   end subroutine stiffness

   !> That of the stretched cable: critical steps must hold for it.
   pure subroutine largest_stiffness(self, e, matrix)
      class(cable_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(out) :: matrix(:, :)

      call rank_one(self%k, self%b(:, e), matrix)
   end subroutine largest_stiffness

   pure subroutine internal_force(self, d, history, force, updated)
      class(cable_type), intent(in) :: self
      real(wp), intent(in) :: d(:, :), history(:, :)
      real(wp), intent(out) :: force(:, :), updated(:, :)

      updated = history
      call spread(self%b, self%k*max(0.0_wp, elongations(self%b, d)), force)
   end subroutine internal_force

   pure function strain_energy(self, d, history) result(energy)
      class(cable_type), intent(in) :: self
      real(wp), intent(in) :: d(:, :), history(:, :)
      real(wp) :: energy

      energy = self%k*sum(max(0.0_wp, elongations(self%b, d))**2)/2.0_wp
   end function strain_energy

end module cable
