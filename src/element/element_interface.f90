!> What the program asks of a group of like elements. Local freedoms are three a node:
!> freedom 3 (i - 1) + j is direction j at the element's node i. Units are the deck's. Elements with
!> a memory (plasticity) get the history of the last accepted state and hand back the updated one:
!> they keep nothing themselves, so a step that is not accepted leaves no trace.
module element_interface
   use kinds, only: wp
   use element_blocks, only: blocks_type
   implicit none
   private

   public :: element_type
   public :: n_recovered, recovered_stress, recovered_strain, recovered_peeq, recovered_energy

   !> Rows of what `recover` gives at a point: six stresses and six strains (11 22 33 12 13 23,
   !> engineering shear strains), equivalent plastic strain, strain energy density.
   integer, parameter :: recovered_stress = 1
   integer, parameter :: recovered_strain = 7
   integer, parameter :: recovered_peeq = 13
   integer, parameter :: recovered_energy = 14
   integer, parameter :: n_recovered = 14

   !> A group of elements of one kind. Its extensions hold the data of every element and
   !> override what they have: an element without stiffness, damping or mass leaves it at zero.
   type, abstract :: element_type
      integer :: n_elements = 0
      integer :: n_nodes = 0                !! nodes of one element
      integer :: n_history = 0              !! history variables of one element
      integer :: n_points = 0               !! points of one element with stresses; 0: none
      integer :: n_stresses = 0             !! components worth printing: 1 axial, 4 plane
      logical :: is_solid = .false.         !! stresses can be averaged at nodes
      !> Smallest eigenvalue of the consistent mass in terms of the lumped one.
      real(wp) :: least_mass_share = 1.0_wp/3.0_wp
      logical :: linear = .true.            !! internal force proportional to displacement
      !> The order of `add_chunk_forces`; elements without it have no chunks.
      type(blocks_type) :: blocks
   contains
      procedure :: uses
      procedure :: stiffness
      procedure :: largest_stiffness
      procedure :: damping
      procedure :: mass
      procedure :: internal_force
      procedure :: add_chunk_forces
      procedure :: strain_energy
      procedure :: plastic_work
      procedure :: recover
      procedure :: point_shares
      procedure :: extrapolation
      procedure :: body_load
      procedure :: edge_load
      procedure :: centrifugal_load
   end type element_type

contains

   !> Local freedoms that element e needs; none unless overridden.
   pure function uses(self, e) result(used)
      class(element_type), intent(in) :: self
      integer, intent(in) :: e
      logical :: used(3*self%n_nodes)

      used = .false.
   end function uses

   !> Tangent stiffness of element e at displacements d (consistent with the stress update).
   pure subroutine stiffness(self, e, d, history, matrix)
      class(element_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: d(:)              !! (3 n_nodes)
      real(wp), intent(in) :: history(:)        !! (n_history) of the last accepted state
      real(wp), intent(out) :: matrix(:, :)     !! (3 n_nodes, 3 n_nodes)

      matrix = 0.0_wp
   end subroutine stiffness

   !> The stiffest tangent that element e can have, for bounds on frequencies.
   pure subroutine largest_stiffness(self, e, matrix)
      class(element_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(out) :: matrix(:, :)     !! (3 n_nodes, 3 n_nodes)
      real(wp) :: d(size(matrix, 1)), history(self%n_history)

      d = 0.0_wp
      history = 0.0_wp
      call self%stiffness(e, d, history, matrix)
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

   !> Elastic (or elastic-plastic) forces of all elements of the group, and their history after
   !> going from the last accepted state to displacements d.
   pure subroutine internal_force(self, d, history, force, updated)
      class(element_type), intent(in) :: self
      real(wp), intent(in) :: d(:, :)           !! (3 n_nodes, n_elements)
      real(wp), intent(in) :: history(:, :)     !! (n_history, n_elements) last accepted
      real(wp), intent(out) :: force(:, :)      !! (3 n_nodes, n_elements)
      real(wp), intent(out) :: updated(:, :)    !! (n_history, n_elements) at d

      force = 0.0_wp
      updated = history
   end subroutine internal_force

   !> The same forces of the elements of one chunk, in the plane and added at nodes that are
   !> numbered for the chunk; its strain energy and plastic work at d added up. Elements are in the
   !> order of the chunk, but histories in that of the group.
   pure subroutine add_chunk_forces(self, chunk, ien, u, history, force, updated, energy)
      class(element_type), intent(in) :: self
      integer, intent(in) :: chunk
      integer, intent(in), contiguous :: ien(:, :)        !! (n_nodes, elements of the chunk)
      real(wp), intent(in), contiguous :: u(:, :)         !! (2, nodes of the chunk)
      real(wp), intent(in) :: history(self%n_history, self%n_elements)   !! last accepted
      real(wp), intent(inout), contiguous :: force(:, :)  !! (2, nodes of the chunk)
      real(wp), intent(inout) :: updated(self%n_history, self%n_elements)
      real(wp), intent(inout) :: energy(2)      !! strain energy, plastic work
   end subroutine add_chunk_forces

   !> Elastic strain energy of all elements of the group together.
   pure function strain_energy(self, d, history) result(energy)
      class(element_type), intent(in) :: self
      real(wp), intent(in) :: d(:, :)           !! (3 n_nodes, n_elements)
      real(wp), intent(in) :: history(:, :)     !! (n_history, n_elements) at d
      real(wp) :: energy

      energy = 0.0_wp
   end function strain_energy

   !> Energy taken by plastic deformation so far, all elements of the group together.
   pure function plastic_work(self, history) result(work)
      class(element_type), intent(in) :: self
      real(wp), intent(in) :: history(:, :)     !! (n_history, n_elements)
      real(wp) :: work

      work = 0.0_wp
   end function plastic_work

   !> Stresses, strains and the rest at the points of element e.
   pure subroutine recover(self, e, d, history, values)
      class(element_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: d(:)              !! (3 n_nodes)
      real(wp), intent(in) :: history(:)        !! (n_history) at d
      real(wp), intent(out) :: values(:, :)     !! (n_recovered, n_points)

      values = 0.0_wp
   end subroutine recover

   !> Shares of the points in the volume of element e: weights of a mean over it.
   pure function point_shares(self, e) result(shares)
      class(element_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp) :: shares(self%n_points)

      shares = 1.0_wp/max(1, self%n_points)
   end function point_shares

   !> Matrix that carries values at the points to values at the nodes.
   pure function extrapolation(self) result(matrix)
      class(element_type), intent(in) :: self
      real(wp) :: matrix(self%n_nodes, self%n_points)

      matrix = 0.0_wp
      if (self%n_points > 0) matrix = 1.0_wp/self%n_points
   end function extrapolation

   !> Nodal forces of a force per volume, the same everywhere in element e.
   pure subroutine body_load(self, e, body, load)
      class(element_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: body(3)           !! force per volume
      real(wp), intent(out) :: load(:)          !! (3 n_nodes)

      load = 0.0_wp
   end subroutine body_load

   !> Nodal forces of a pressure on an edge of element e (positive towards the element). `exists` is
   !> false where the element has no such edge.
   pure subroutine edge_load(self, e, edge, pressure, load, exists)
      class(element_type), intent(in) :: self
      integer, intent(in) :: e
      integer, intent(in) :: edge               !! 1 to 4, numbered as P1 to P4 in the deck
      real(wp), intent(in) :: pressure
      real(wp), intent(out) :: load(:)          !! (3 n_nodes)
      logical, intent(out) :: exists

      load = 0.0_wp
      exists = .false.
   end subroutine edge_load

   !> Nodal forces of a rotation about an axis: density times omega^2 times the distance from it.
   pure subroutine centrifugal_load(self, e, omega_squared, point, axis, load)
      class(element_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: omega_squared
      real(wp), intent(in) :: point(3)          !! on the axis
      real(wp), intent(in) :: axis(3)           !! unit vector
      real(wp), intent(out) :: load(:)          !! (3 n_nodes)

      load = 0.0_wp
   end subroutine centrifugal_load

end module element_interface
