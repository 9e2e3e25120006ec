!> Plane strain, plane stress and axisymmetric solids (CPE, CPS, CAX) of 3, 4, 6 and 8 nodes at
!> small displacements, elastic or elastic-plastic. x and y are the plane; an axisymmetric solid has
!> its radius along x and its axis along y, and stands for the full circumference.
module solid
   use kinds, only: wp
   use elastic, only: plane_stress, axisymmetric, elastic_matrix, thickness_strain
   use element_interface, only: element_type, recovered_stress, recovered_strain, &
         recovered_peeq, recovered_energy
   use congruence, only: find_classes
   use element_blocks, only: new_blocks
   use j2_plastic, only: j2_type, new_j2, n_state, state_peeq, state_work
   use plane_freedoms, only: in_plane, on_freedoms, add_in_direction, spread_in_plane, outer
   use point_fit, only: point_extrapolation
   use quadrature, only: stiffness_rule
   use solid_geometry, only: solid_shape_type
   use solid_integrals, only: mass_matrix, lumped_mass, volume_shares, centrifugal_force, &
         edge_force
   use solid_material, only: solid_material_type, hourglass_share
   use solid_kinematics, only: kinematics_type, new_kinematics
   use stored_stiffness, only: stored_stiffness_type, new_stored_stiffness, keep_stiffness, &
         get_stiffness, add_block_forces
   use topology, only: count_corners
   implicit none
   private

   public :: solid_type, new_solid, solid_material_type, hourglass_share

   !> Congruent elements share a stiffness where blocks have this many at least, on average.
   integer, parameter :: fewest_in_block = 8

   !> Solids of one section. B-bar (mean dilatation, of four-node quadrilaterals in plane strain and
   !> axisymmetry) is off unless the shape asks for it. A history is n_state variables a point,
   !> point after point; an elastic solid has none.
   type, extends(element_type) :: solid_type
      type(solid_shape_type) :: shape
      type(solid_material_type) :: material
      integer, allocatable :: class(:)              !! (n_elements) of congruent elements
      type(kinematics_type) :: kinematics           !! of every class
      type(stored_stiffness_type) :: stored         !! of an elastic solid
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
      procedure :: add_chunk_forces
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
      integer, allocatable :: first(:)

      self%shape = shape
      self%material = material
      self%lumped = lumped
      self%x = x
      self%n_nodes = size(x, 2)
      self%n_elements = size(x, 3)
      self%elastic = elastic_matrix(material%young, material%poisson, shape%plane)
      ! a shift along the radius changes an axisymmetric element
      call find_classes(x, [shape%plane /= axisymmetric, .true.], self%class, first)
      call new_kinematics(self%kinematics, shape, x(:, :, first))
      self%n_points = size(self%kinematics%volume, 1)
      self%n_stresses = 4
      ! 1/9 for a square of four nodes, a little less for distorted and axisymmetric elements
      self%least_mass_share = 0.09_wp
      self%is_solid = .true.
      self%linear = .not. material%plastic
      if (self%linear) then
         call store_stiffness(self, size(first))
         return
      end if
      self%n_history = n_state*self%n_points
      call new_j2(self%law, [material%young, material%poisson], shape%plane, material%kinematic, &
            material%hardening(1, :), material%hardening(2, :))
   end subroutine new_solid

   !> Keeps the stiffness of every class where blocks are well filled with elements of one, else
   !> that of every element, in blocks as they come.
   pure subroutine store_stiffness(self, n_classes)
      type(solid_type), intent(inout) :: self
      integer, intent(in) :: n_classes
      logical :: shared
      integer :: e, i, n

      call new_blocks(self%blocks, self%class)
      shared = size(self%blocks%first)*fewest_in_block <= self%n_elements + fewest_in_block
      if (.not. shared) call new_blocks(self%blocks, [(1, e=1, self%n_elements)])
      n = merge(n_classes, self%n_elements, shared)
      call new_stored_stiffness(self%stored, self%n_nodes, self%shape%plane /= axisymmetric, &
            shared, n)
      do i = 1, n
         call keep_stiffness(self%stored, i, self%kinematics%stiffness( &
               merge(i, self%class(i), shared), self%elastic, hourglass_stiffness(self)))
      end do
   end subroutine store_stiffness

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
      integer :: p, i, c

      c = self%class(e)
      if (self%linear) then
         call get_stiffness(self%stored, merge(c, e, self%stored%shared), sum_b)
         call spread_in_plane(sum_b, matrix)
         return
      end if
      u = in_plane(d)
      sum_b = 0.0_wp
      do p = 1, self%n_points
         b = self%kinematics%strain_matrix(p, c)
         call self%law%update(self%kinematics%strain_at(p, c, u), &
               history((p - 1)*n_state + 1:p*n_state), stress, updated, tangent)
         sum_b = sum_b + matmul(transpose(b), &
               matmul(self%kinematics%volume(p, c)*tangent, b))
      end do
      call spread_in_plane(sum_b, matrix)
      if (size(self%kinematics%hourglass, 2) == 0) return
      do i = 1, 2
         call add_in_direction(i, &
               hourglass_stiffness(self)*outer(self%kinematics%hourglass(:, c)), matrix)
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

   pure subroutine add_chunk_forces(self, chunk, ien, u, history, force, updated, energy)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: chunk
      integer, intent(in), contiguous :: ien(:, :)
      real(wp), intent(in), contiguous :: u(:, :)
      real(wp), intent(in) :: history(self%n_history, self%n_elements)
      real(wp), intent(inout), contiguous :: force(:, :)
      real(wp), intent(inout) :: updated(self%n_history, self%n_elements)
      real(wp), intent(inout) :: energy(2)
      integer :: b, i, from, to

      associate (blocks => self%blocks)
         from = 1
         do b = blocks%chunk_first(chunk), blocks%chunk_first(chunk + 1) - 1
            to = from + blocks%first(b + 1) - blocks%first(b) - 1
            i = b
            if (self%stored%shared) i = self%class(blocks%order(blocks%first(b)))
            call add_block_forces(self%stored, i, ien(:, from:to), u, force, energy(1))
            from = to + 1
         end do
      end associate
   end subroutine add_chunk_forces

   !> Forces of one element and its history at displacements u.
   pure subroutine element_force(self, e, u, history, force, updated)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: u(:, :), history(:)
      real(wp), intent(out) :: force(:, :), updated(:)
      real(wp) :: stress(4), tangent(4, 4)
      integer :: p, i, c, first, last

      c = self%class(e)
      force = 0.0_wp
      do p = 1, self%n_points
         if (self%material%plastic) then
            first = (p - 1)*n_state + 1
            last = p*n_state
            call self%law%update(self%kinematics%strain_at(p, c, u), history(first:last), &
                  stress, updated(first:last), tangent)
         else
            stress = matmul(self%elastic, self%kinematics%strain_at(p, c, u))
         end if
         call self%kinematics%add_force(p, c, stress, force)
      end do
      if (size(self%kinematics%hourglass, 2) == 0) return
      associate (h => self%kinematics%hourglass(:, c))
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
      integer :: e, p, c

      energy = 0.0_wp
      do e = 1, self%n_elements
         c = self%class(e)
         u = in_plane(d(:, e))
         do p = 1, self%n_points
            strain = self%kinematics%strain_at(p, c, u) - plastic_strain(self, p, history(:, e))
            energy = energy + self%kinematics%volume(p, c)*energy_density(self, strain)
         end do
         if (size(self%kinematics%hourglass, 2) > 0) energy = energy + hourglass_stiffness(self) &
               *sum(matmul(u, self%kinematics%hourglass(:, c))**2)/2.0_wp
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
         work = work + dot_product(self%kinematics%volume(:, self%class(e)), &
               history(state_work::n_state, e))
      end do
   end function plastic_work

   pure subroutine recover(self, e, d, history, values)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: d(:), history(:)
      real(wp), intent(out) :: values(:, :)
      real(wp) :: u(2, self%n_nodes), strain(4), plastic(4)
      integer :: p, c

      c = self%class(e)
      values = 0.0_wp
      u = in_plane(d)
      do p = 1, self%n_points
         plastic = plastic_strain(self, p, history)
         strain = self%kinematics%strain_at(p, c, u)
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

      load = 0.0_wp
      exists = edge >= 1 .and. edge <= count_corners(self%shape%topology)
      if (exists) load = on_freedoms(pressure*edge_force(self%shape, self%x(:, :, e), edge))
   end subroutine edge_load

   pure subroutine centrifugal_load(self, e, omega_squared, point, axis, load)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: omega_squared, point(3), axis(3)
      real(wp), intent(out) :: load(:)

      load = on_freedoms(self%material%density*omega_squared &
            *centrifugal_force(self%shape, self%x(:, :, e), point, axis))
   end subroutine centrifugal_load

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
