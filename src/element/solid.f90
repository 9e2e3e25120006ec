!> Plane strain, plane stress and axisymmetric solids (CPE, CPS, CAX) of 3, 4, 6 and 8 nodes at
!> small displacements, elastic or elastic-plastic. x and y are the plane; an axisymmetric solid has
!> its radius along x and its axis along y, and stands for the full circumference.
module solid
   use kinds, only: wp
   use elastic, only: plane_stress, elastic_matrix, thickness_strain
   use element_interface, only: element_type, recovered_stress, recovered_strain, &
         recovered_peeq, recovered_energy
   use j2_plastic, only: j2_type, new_j2, n_state, state_peeq, state_work
   use point_fit, only: point_extrapolation
   use quadrature, only: stiffness_rule
   use solid_geometry, only: solid_shape_type
   use solid_integrals, only: mass_matrix, lumped_mass, volume_shares, centrifugal_force, &
         edge_force
   use solid_kinematics, only: kinematics_type, new_kinematics
   use topology, only: count_corners
   implicit none
   private

   public :: solid_type, new_solid, solid_material_type, hourglass_share

   !> Stiffness against hourglass modes of a four-node quadrilateral with one point, as a share of
   !> shear modulus times volume times the gradients squared; it stays elastic.
   real(wp), parameter :: hourglass_share = 0.05_wp

   !> Properties that the solids of a group share.
   type :: solid_material_type
      real(wp) :: young = 0.0_wp
      real(wp) :: poisson = 0.0_wp
      real(wp) :: density = 0.0_wp
      real(wp) :: damping_alpha = 0.0_wp            !! C = alpha M + beta K elastic
      real(wp) :: damping_beta = 0.0_wp
      logical :: plastic = .false.
      logical :: kinematic = .false.
      real(wp), allocatable :: hardening(:, :)      !! (2, n) plastic strain and yield stress
   end type solid_material_type

   !> Solids of one section. B-bar (mean dilatation, of four-node quadrilaterals in plane strain and
   !> axisymmetry) is off unless the shape asks for it. A history is n_state variables a point,
   !> point after point; an elastic solid has none.
   type, extends(element_type) :: solid_type
      type(solid_shape_type) :: shape
      type(solid_material_type) :: material
      type(kinematics_type) :: kinematics
      type(j2_type) :: law                          !! of a plastic solid
      real(wp) :: elastic(4, 4) = 0.0_wp
      real(wp), allocatable :: x(:, :, :)           !! (2, n_nodes, n_elements)
      logical :: lumped = .true.                    !! mass used in Rayleigh damping
   contains
      procedure :: uses
      procedure :: stiffness
      procedure :: damping
      procedure :: mass
      procedure :: internal_force
      procedure :: strain_energy
      procedure :: plastic_work
      procedure :: recover
      procedure :: extrapolation
      procedure :: body_load
      procedure :: edge_load
      procedure :: centrifugal_load
   end type solid_type

contains

   !> A group of solids; the shapes must be without faults (find_fault).
   pure subroutine new_solid(self, shape, x, material, lumped)
      type(solid_type), intent(out) :: self
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :, :)            !! (2, n_nodes, n_elements)
      type(solid_material_type), intent(in) :: material
      logical, intent(in) :: lumped                 !! the group's mass matrix

      self%shape = shape
      self%material = material
      self%lumped = lumped
      self%x = x
      self%n_nodes = size(x, 2)
      self%n_elements = size(x, 3)
      self%elastic = elastic_matrix(material%young, material%poisson, shape%plane)
      call new_kinematics(self%kinematics, shape, x)
      self%n_points = size(self%kinematics%volume, 1)
      self%n_stresses = 4
      self%is_solid = .true.
      self%linear = .not. material%plastic
      if (.not. material%plastic) return
      self%n_history = n_state*self%n_points
      call new_j2(self%law, [material%young, material%poisson], shape%plane, material%kinematic, &
            material%hardening(1, :), material%hardening(2, :))
   end subroutine new_solid

   !> Directions 1 and 2 of every node.
   pure function uses(self, e) result(used)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e
      logical :: used(3*self%n_nodes)

      used = .true.
      used(3::3) = .false.
   end function uses

   pure subroutine stiffness(self, e, d, history, matrix)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: d(:), history(:)
      real(wp), intent(out) :: matrix(:, :)
      real(wp) :: b(4, 2*self%n_nodes), sum_b(2*self%n_nodes, 2*self%n_nodes), tangent(4, 4)
      real(wp) :: u(2, self%n_nodes), stress(4), updated(n_state)
      integer :: p, i, j

      u = in_plane(d)
      tangent = self%elastic
      sum_b = 0.0_wp
      do p = 1, self%n_points
         b = self%kinematics%strain_matrix(p, e)
         if (self%material%plastic) call self%law%update(self%kinematics%strain_at(p, e, u), &
               history((p - 1)*n_state + 1:p*n_state), stress, updated, tangent)
         sum_b = sum_b + matmul(transpose(b), &
               matmul(self%kinematics%volume(p, e)*tangent, b))
      end do
      matrix = 0.0_wp
      do j = 1, self%n_nodes
         do i = 1, self%n_nodes
            matrix(3*i - 2:3*i - 1, 3*j - 2:3*j - 1) = sum_b(2*i - 1:2*i, 2*j - 1:2*j)
         end do
      end do
      if (size(self%kinematics%hourglass, 2) == 0) return
      do j = 1, 2
         call add_in_direction(j, &
               hourglass_stiffness(self)*outer(self%kinematics%hourglass(:, e)), matrix)
      end do
   end subroutine stiffness

   !> Rayleigh damping alpha M + beta K of the elastic solid.
   pure subroutine damping(self, e, matrix)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(out) :: matrix(:, :)
      real(wp) :: m(size(matrix, 1), size(matrix, 1))

      matrix = 0.0_wp
      if (abs(self%material%damping_beta) > 0.0_wp) then
         call self%largest_stiffness(e, matrix)
         matrix = self%material%damping_beta*matrix
      end if
      if (abs(self%material%damping_alpha) > 0.0_wp) then
         call self%mass(e, self%lumped, m)
         matrix = matrix + self%material%damping_alpha*m
      end if
   end subroutine damping

   pure subroutine mass(self, e, lumped, matrix)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e
      logical, intent(in) :: lumped
      real(wp), intent(out) :: matrix(:, :)
      real(wp) :: share(self%n_nodes), part(self%n_nodes, self%n_nodes)
      integer :: i

      if (lumped) then
         part = 0.0_wp
         share = lumped_mass(self%shape, self%x(:, :, e))
         do i = 1, self%n_nodes
            part(i, i) = share(i)
         end do
      else
         part = mass_matrix(self%shape, self%x(:, :, e))
      end if
      matrix = 0.0_wp
      do i = 1, 2
         call add_in_direction(i, self%material%density*part, matrix)
      end do
   end subroutine mass

   pure subroutine internal_force(self, d, history, force, updated)
      class(solid_type), intent(in) :: self
      real(wp), intent(in) :: d(:, :), history(:, :)
      real(wp), intent(out) :: force(:, :), updated(:, :)
      real(wp) :: u(2, self%n_nodes), f(2, self%n_nodes)
      integer :: e, i

      do e = 1, self%n_elements
         u = in_plane(d(:, e))
         call element_force(self, e, u, history(:, e), f, updated(:, e))
         do i = 1, self%n_nodes
            force(3*i - 2:3*i, e) = [f(:, i), 0.0_wp]
         end do
      end do
   end subroutine internal_force

   !> Forces of one element and its history at displacements u.
   pure subroutine element_force(self, e, u, history, force, updated)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: u(:, :), history(:)
      real(wp), intent(out) :: force(:, :), updated(:)
      real(wp) :: stress(4), tangent(4, 4)
      integer :: p, i, first, last

      force = 0.0_wp
      do p = 1, self%n_points
         if (self%material%plastic) then
            first = (p - 1)*n_state + 1
            last = p*n_state
            call self%law%update(self%kinematics%strain_at(p, e, u), history(first:last), &
                  stress, updated(first:last), tangent)
         else
            stress = matmul(self%elastic, self%kinematics%strain_at(p, e, u))
         end if
         call self%kinematics%add_force(p, e, stress, force)
      end do
      if (size(self%kinematics%hourglass, 2) == 0) return
      associate (h => self%kinematics%hourglass(:, e))
         do i = 1, self%n_nodes
            force(:, i) = force(:, i) + hourglass_stiffness(self)*h(i)*matmul(u, h)
         end do
      end associate
   end subroutine element_force

   !> Half of stress : elastic strain, with what the hourglass modes hold.
   pure function strain_energy(self, d, history) result(energy)
      class(solid_type), intent(in) :: self
      real(wp), intent(in) :: d(:, :), history(:, :)
      real(wp) :: energy
      real(wp) :: u(2, self%n_nodes), strain(4)
      integer :: e, p

      energy = 0.0_wp
      do e = 1, self%n_elements
         u = in_plane(d(:, e))
         do p = 1, self%n_points
            strain = self%kinematics%strain_at(p, e, u) - plastic_strain(self, p, history(:, e))
            energy = energy + self%kinematics%volume(p, e)*energy_density(self, strain)
         end do
         if (size(self%kinematics%hourglass, 2) > 0) energy = energy + hourglass_stiffness(self) &
               *sum(matmul(u, self%kinematics%hourglass(:, e))**2)/2.0_wp
      end do
   end function strain_energy

   pure function plastic_work(self, history) result(work)
      class(solid_type), intent(in) :: self
      real(wp), intent(in) :: history(:, :)
      real(wp) :: work
      integer :: e

      work = 0.0_wp
      if (.not. self%material%plastic) return
      do e = 1, self%n_elements
         work = work + dot_product(self%kinematics%volume(:, e), history(state_work::n_state, e))
      end do
   end function plastic_work

   pure subroutine recover(self, e, d, history, values)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: d(:), history(:)
      real(wp), intent(out) :: values(:, :)
      real(wp) :: u(2, self%n_nodes), strain(4), plastic(4)
      integer :: p

      values = 0.0_wp
      u = in_plane(d)
      do p = 1, self%n_points
         plastic = plastic_strain(self, p, history)
         strain = self%kinematics%strain_at(p, e, u)
         if (self%shape%plane == plane_stress) strain(3) = plastic(3) &
               + thickness_strain(self%material%poisson, strain - plastic)
         values(recovered_stress:recovered_stress + 3, p) = &
               matmul(self%elastic, strain - plastic)
         values(recovered_strain:recovered_strain + 3, p) = strain
         if (self%material%plastic) values(recovered_peeq, p) = &
               history((p - 1)*n_state + state_peeq)
         values(recovered_energy, p) = energy_density(self, strain - plastic)
      end do
   end subroutine recover

   pure function extrapolation(self) result(matrix)
      class(solid_type), intent(in) :: self
      real(wp) :: matrix(self%n_nodes, self%n_points)

      matrix = point_extrapolation(self%shape%topology, &
            stiffness_rule(self%shape%topology, self%shape%reduced))
   end function extrapolation

   pure subroutine body_load(self, e, body, load)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: body(3)
      real(wp), intent(out) :: load(:)
      real(wp) :: share(self%n_nodes)

      share = volume_shares(self%shape, self%x(:, :, e))
      load = 0.0_wp
      load(1::3) = body(1)*share
      load(2::3) = body(2)*share
   end subroutine body_load

   pure subroutine edge_load(self, e, edge, pressure, load, exists)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e, edge
      real(wp), intent(in) :: pressure
      real(wp), intent(out) :: load(:)
      logical, intent(out) :: exists
      real(wp) :: force(2, self%n_nodes)

      load = 0.0_wp
      exists = edge >= 1 .and. edge <= count_corners(self%shape%topology)
      if (.not. exists) return
      force = pressure*edge_force(self%shape, self%x(:, :, e), edge)
      load(1::3) = force(1, :)
      load(2::3) = force(2, :)
   end subroutine edge_load

   pure subroutine centrifugal_load(self, e, omega_squared, point, axis, load)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: omega_squared, point(3), axis(3)
      real(wp), intent(out) :: load(:)
      real(wp) :: force(2, self%n_nodes)

      force = self%material%density*omega_squared &
            *centrifugal_force(self%shape, self%x(:, :, e), point, axis)
      load = 0.0_wp
      load(1::3) = force(1, :)
      load(2::3) = force(2, :)
   end subroutine centrifugal_load

   !> Displacements in the plane, (2, n_nodes), from all of them.
   pure function in_plane(d) result(u)
      real(wp), intent(in) :: d(:)
      real(wp) :: u(2, size(d)/3)

      u(1, :) = d(1::3)
      u(2, :) = d(2::3)
   end function in_plane

   !> Adds a matrix over nodes to the freedoms of one direction.
   pure subroutine add_in_direction(direction, part, matrix)
      integer, intent(in) :: direction
      real(wp), intent(in) :: part(:, :)
      real(wp), intent(inout) :: matrix(:, :)

      matrix(direction::3, direction::3) = matrix(direction::3, direction::3) + part
   end subroutine add_in_direction

   pure function outer(v) result(matrix)
      real(wp), intent(in) :: v(:)
      real(wp) :: matrix(size(v), size(v))

      matrix = matmul(reshape(v, [size(v), 1]), reshape(v, [1, size(v)]))
   end function outer

   pure function hourglass_stiffness(self) result(factor)
      class(solid_type), intent(in) :: self
      real(wp) :: factor

      factor = hourglass_share*self%elastic(4, 4)
   end function hourglass_stiffness

   !> Plastic strain at a point of an element, from the element's history.
   pure function plastic_strain(self, p, history) result(strain)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: p
      real(wp), intent(in) :: history(:)
      real(wp) :: strain(4)

      strain = 0.0_wp
      if (self%material%plastic) strain = history((p - 1)*n_state + 1:(p - 1)*n_state + 4)
   end function plastic_strain

   pure function energy_density(self, strain) result(energy)
      class(solid_type), intent(in) :: self
      real(wp), intent(in) :: strain(4)         !! elastic
      real(wp) :: energy

      energy = dot_product(strain, matmul(self%elastic, strain))/2.0_wp
   end function energy_density

end module solid
