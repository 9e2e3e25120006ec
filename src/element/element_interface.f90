!> What the program asks of a group of like elements. Local freedoms are three a node:
!> freedom 3 (i - 1) + j is direction j at the element's node i. Units are the deck's.
module element_interface
   use kinds, only: wp
   implicit none
   private

   public :: element_type

   !> A group of elements of one kind. Its extensions hold the data of every element and
   !> override what they have: an element without stiffness, damping or mass leaves it at zero.
   type, abstract :: element_type
      integer :: n_elements = 0
      integer :: n_nodes = 0                !! nodes of one element
      logical :: linear = .true.            !! internal force proportional to displacement
      logical :: has_stress = .false.       !! stress, strain and energy can be recorded
   contains
      procedure :: uses
      procedure :: stiffness
      procedure :: largest_stiffness
      procedure :: damping
      procedure :: mass
      procedure :: internal_force
      procedure :: strain_energy
      procedure :: stress
   end type element_type

contains

   !> Local freedoms that element e needs; none unless overridden.
   pure function uses(self, e) result(used)
      class(element_type), intent(in) :: self
      integer, intent(in) :: e
      logical :: used(3*self%n_nodes)

      used = .false.
   end function uses

   !> Tangent stiffness of element e at displacements d.
   pure subroutine stiffness(self, e, d, matrix)
      class(element_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: d(:)              !! (3 n_nodes)
      real(wp), intent(out) :: matrix(:, :)     !! (3 n_nodes, 3 n_nodes)

      matrix = 0.0_wp
   end subroutine stiffness

   !> The stiffest tangent that element e can have, for bounds on frequencies.
   pure subroutine largest_stiffness(self, e, matrix)
      class(element_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(out) :: matrix(:, :)     !! (3 n_nodes, 3 n_nodes)
      real(wp) :: d(size(matrix, 1))

      d = 0.0_wp
      call self%stiffness(e, d, matrix)
   end subroutine largest_stiffness

   !> Viscous damping matrix of element e, its own dashpot and Rayleigh parts.
   pure subroutine damping(self, e, matrix)
      class(element_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(out) :: matrix(:, :)     !! (3 n_nodes, 3 n_nodes)

      matrix = 0.0_wp
   end subroutine damping

   !> Mass matrix of element e, lumped (diagonal) or consistent.
   pure subroutine mass(self, e, lumped, matrix)
      class(element_type), intent(in) :: self
      integer, intent(in) :: e
      logical, intent(in) :: lumped
      real(wp), intent(out) :: matrix(:, :)     !! (3 n_nodes, 3 n_nodes)

      matrix = 0.0_wp
   end subroutine mass

   !> Elastic forces of all elements of the group.
   pure subroutine internal_force(self, d, force)
      class(element_type), intent(in) :: self
      real(wp), intent(in) :: d(:, :)           !! (3 n_nodes, n_elements)
      real(wp), intent(out) :: force(:, :)      !! (3 n_nodes, n_elements)

      force = 0.0_wp
   end subroutine internal_force

   !> Strain energy of all elements of the group together.
   pure function strain_energy(self, d) result(energy)
      class(element_type), intent(in) :: self
      real(wp), intent(in) :: d(:, :)           !! (3 n_nodes, n_elements)
      real(wp) :: energy

      energy = 0.0_wp
   end function strain_energy

   !> Axial stress, axial strain and strain energy density (in this order) of element e.
   pure function stress(self, e, d) result(values)
      class(element_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: d(:)              !! (3 n_nodes)
      real(wp) :: values(3)

      values = 0.0_wp
   end function stress

end module element_interface
