!> Plane strain, plane stress and axisymmetric solids (CPE, CPS, CAX) of 3, 4, 6 and 8 nodes at
!> small displacements, elastic or elastic-plastic. x and y are the plane; an axisymmetric solid has
!> its radius along x and its axis along y, and stands for the full circumference.
module solid
   use kinds, only: wp
   use congruence, only: find_classes
   use elastic, only: plane_stress, axisymmetric, elastic_matrix, thickness_strain
   use memory_shortage, only: check_allocation
   use element_blocks, only: new_blocks
   use element_interface, only: recovered_stress, recovered_strain, recovered_peeq, &
         recovered_energy
   use plane_freedoms, only: in_plane, add_in_direction, spread_in_plane, outer
   use point_law, only: point_law_type
   use law_forces, only: find_law_forces, add_hourglass_forces
   use solid_body, only: solid_body_type
   use solid_geometry, only: solid_shape_type
   use solid_integrals, only: lumped_masses
   use solid_law, only: make_law
   use solid_kinematics, only: kinematics_type, new_kinematics
   use solid_material, only: solid_material_type, hourglass_share
   use stored_stiffness, only: stored_stiffness_type, new_stored_stiffness, keep_stiffness, &
         get_stiffness, add_block_forces
   implicit none
   private

   public :: solid_type, new_solid, solid_material_type, hourglass_share

   !> Congruent elements share a stiffness where blocks have this many at least, on average.
   integer, parameter :: fewest_in_block = 8

   !> Solids of one section. B-bar (mean dilatation, of four-node quadrilaterals in plane strain and
   !> axisymmetry) is off unless the shape asks for it. A history is the law's n_state variables
   !> a point, point after point; an elastic solid has neither.
   type, extends(solid_body_type) :: solid_type
      type(kinematics_type) :: kinematics           !! of every class
      type(stored_stiffness_type) :: stored         !! of an elastic solid
      class(point_law_type), allocatable :: law     !! of a solid that is not elastic
      real(wp) :: elastic(4, 4) = 0.0_wp
   contains
      procedure :: stiffness
      procedure :: internal_force
      procedure :: add_chunk_forces
      procedure :: strain_energy
      procedure :: plastic_work
      procedure :: recover
      procedure :: point_shares
   end type solid_type

contains

   !> A group of solids; the shapes must be without faults (find_fault).
   subroutine new_solid(self, shape, x, material, lumped, law)
      type(solid_type), intent(out) :: self
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :, :)            !! (2, n_nodes, n_elements)
      type(solid_material_type), intent(in) :: material
      logical, intent(in) :: lumped                 !! the group's mass matrix
      class(point_law_type), intent(in), optional :: law   !! in place of the material's
      integer, allocatable :: first(:)
      integer :: i, status

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
      self%share = lumped_masses(shape, x(:, :, first))
      self%n_points = size(self%kinematics%volume, 1)
      self%n_stresses = 4
      ! 1/9 for a square of four nodes, a little less for distorted and axisymmetric elements
      self%least_mass_share = 0.09_wp
      self%is_solid = .true.
      if (present(law)) then
         allocate (self%law, source=law, stat=status)
         call check_allocation(status)
      else
         call make_law(material, shape%plane, self%law)
      end if
      self%linear = .not. allocated(self%law)
      if (self%linear) then
         call store_stiffness(self, size(first))
         return
      end if
      call new_blocks(self%blocks, [(1, i=1, self%n_elements)])
      self%n_history = self%law%n_state*self%n_points
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

   pure subroutine stiffness(self, e, d, history, matrix)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: d(:), history(:)
      real(wp), intent(out) :: matrix(:, :)
      real(wp) :: b(4, 2*self%n_nodes), sum_b(2*self%n_nodes, 2*self%n_nodes), tangent(4, 4)
      real(wp) :: u(2, self%n_nodes), stress(4), updated(self%n_history)
      integer :: p, i, c, first, last

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
         call find_state(self, p, first, last)
         call self%law%update(self%kinematics%strain_at(p, c, u), history(first:last), stress, &
               updated(first:last), tangent)
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

      if (.not. self%linear) then
         call add_law_chunk(self, chunk, ien, u, history, force, updated, energy)
         return
      end if
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

   pure subroutine add_law_chunk(self, chunk, ien, u, history, force, updated, energy)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: chunk
      integer, intent(in), contiguous :: ien(:, :)
      real(wp), intent(in), contiguous :: u(:, :)
      real(wp), intent(in) :: history(self%n_history, self%n_elements)
      real(wp), intent(inout), contiguous :: force(:, :)
      real(wp), intent(inout) :: updated(self%n_history, self%n_elements)
      real(wp), intent(inout) :: energy(2)
      real(wp) :: local(2, self%n_nodes), f(2, self%n_nodes)
      integer :: k, e

      do k = 1, size(ien, 2)
         ! these blocks have the elements in their own order
         e = self%blocks%first(self%blocks%chunk_first(chunk)) + k - 1
         local = u(:, ien(:, k))
         call find_law_forces(self%law, self%kinematics, self%class(e), local, history(:, e), &
               updated(:, e), f, energy)
         if (size(self%kinematics%hourglass, 2) > 0) call add_hourglass_forces( &
               hourglass_stiffness(self), self%kinematics%hourglass(:, self%class(e)), local, f, &
               energy(1))
         force(:, ien(:, k)) = force(:, ien(:, k)) + f
      end do
   end subroutine add_law_chunk

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
         if (.not. self%linear) then
            call find_state(self, p, first, last)
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

   !> What the law, or half of stress : strain, holds, with what the hourglass modes hold.
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
            strain = self%kinematics%strain_at(p, c, u)
            energy = energy + self%kinematics%volume(p, c) &
                  *energy_density(self, p, strain, history(:, e), &
                  stress_at(self, p, strain, history(:, e)))
         end do
         if (size(self%kinematics%hourglass, 2) > 0) energy = energy + hourglass_stiffness(self) &
               *sum(matmul(u, self%kinematics%hourglass(:, c))**2)/2.0_wp
      end do
   end function strain_energy

   pure function plastic_work(self, history) result(work)
      class(solid_type), intent(in) :: self
      real(wp), intent(in) :: history(:, :)
      real(wp) :: work
      real(wp) :: density(self%n_points)
      integer :: e, p, first, last

      work = 0.0_wp
      if (self%linear) return
      do e = 1, self%n_elements
         do p = 1, self%n_points
            call find_state(self, p, first, last)
            density(p) = self%law%dissipated(history(first:last, e))
         end do
         work = work + dot_product(self%kinematics%volume(:, self%class(e)), density)
      end do
   end function plastic_work

   pure subroutine recover(self, e, d, history, values)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: d(:), history(:)
      real(wp), intent(out) :: values(:, :)
      real(wp) :: u(2, self%n_nodes), strain(4), stress(4)
      integer :: p, c, first, last

      c = self%class(e)
      values = 0.0_wp
      u = in_plane(d)
      do p = 1, self%n_points
         strain = self%kinematics%strain_at(p, c, u)
         if (self%shape%plane == plane_stress) strain(3) = strain_across(self, p, strain, history)
         stress = stress_at(self, p, strain, history)
         values(recovered_stress:recovered_stress + 3, p) = stress
         values(recovered_strain:recovered_strain + 3, p) = strain
         values(recovered_energy, p) = energy_density(self, p, strain, history, stress)
         if (self%linear) cycle
         call find_state(self, p, first, last)
         values(recovered_peeq, p) = self%law%plastic_measure(history(first:last))
      end do
   end subroutine recover

   pure function point_shares(self, e) result(shares)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp) :: shares(self%n_points)

      associate (volume => self%kinematics%volume(:, self%class(e)))
         shares = volume/sum(volume)
      end associate
   end function point_shares

   pure function hourglass_stiffness(self) result(factor)
      class(solid_type), intent(in) :: self
      real(wp) :: factor

      factor = hourglass_share*self%elastic(4, 4)
   end function hourglass_stiffness

   !> Where the state of a point is in the history of an element.
   pure subroutine find_state(self, p, first, last)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: p
      integer, intent(out) :: first, last

      first = (p - 1)*self%law%n_state + 1
      last = p*self%law%n_state
   end subroutine find_state

   !> Stress at a point of an element, from the element's history.
   pure function stress_at(self, p, strain, history) result(stress)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: p
      real(wp), intent(in) :: strain(4), history(:)
      real(wp) :: stress(4)
      integer :: first, last

      if (self%linear) then
         stress = matmul(self%elastic, strain)
      else
         call find_state(self, p, first, last)
         stress = self%law%stress_at(strain, history(first:last))
      end if
   end function stress_at

   !> Strain 33 in plane stress.
   pure function strain_across(self, p, strain, history) result(normal)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: p
      real(wp), intent(in) :: strain(4), history(:)
      real(wp) :: normal
      integer :: first, last

      if (self%linear) then
         normal = thickness_strain(self%material%poisson, strain)
      else
         call find_state(self, p, first, last)
         normal = self%law%thickness_strain(strain, history(first:last))
      end if
   end function strain_across

   !> Strain energy a volume.
   pure function energy_density(self, p, strain, history, stress) result(energy)
      class(solid_type), intent(in) :: self
      integer, intent(in) :: p
      real(wp), intent(in) :: strain(4), history(:), stress(4)
      real(wp) :: energy
      integer :: first, last

      if (self%linear) then
         energy = dot_product(strain, stress)/2.0_wp
      else
         call find_state(self, p, first, last)
         energy = self%law%stored_energy(strain, history(first:last), stress)
      end if
   end function energy_density

end module solid
