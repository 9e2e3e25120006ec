!> What plane and axisymmetric solids are without their stress: geometry, mass and loads.
module solid_body
   use kinds, only: wp
   use element_interface, only: element_type
   use plane_freedoms, only: on_freedoms, add_in_direction
   use point_fit, only: point_extrapolation
   use quadrature, only: stiffness_rule
   use solid_geometry, only: solid_shape_type
   use solid_integrals, only: mass_matrix, volume_shares, centrifugal_force, &
         edge_force
   use solid_material, only: solid_material_type
   use topology, only: count_corners
   implicit none
   private

   public :: solid_body_type

   !> Solids of one section.
   type, abstract, extends(element_type) :: solid_body_type
      type(solid_shape_type) :: shape
      type(solid_material_type) :: material
      real(wp), allocatable :: x(:, :, :)           !! (2, n_nodes, n_elements)
      integer, allocatable :: class(:)              !! (n_elements) of congruent elements
      real(wp), allocatable :: share(:, :)          !! (n_nodes, n_classes) volume, lumped at nodes
      logical :: lumped = .true.                    !! mass used in Rayleigh damping
   contains
      procedure :: uses
      procedure :: damping
      procedure :: mass
      procedure :: extrapolation
      procedure :: body_load
      procedure :: edge_load
      procedure :: centrifugal_load
   end type solid_body_type

contains

   !> Directions 1 and 2 of every node.
   pure function uses(self, e) result(used)
      class(solid_body_type), intent(in) :: self
      integer, intent(in) :: e
      logical :: used(3*self%n_nodes)

      used = .true.
      used(3::3) = .false.
   end function uses

   !> Rayleigh damping alpha M + beta K of the elastic solid.
   pure subroutine damping(self, e, matrix)
      class(solid_body_type), intent(in) :: self
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
      class(solid_body_type), intent(in) :: self
      integer, intent(in) :: e
      logical, intent(in) :: lumped
      real(wp), intent(out) :: matrix(:, :)
      real(wp) :: part(self%n_nodes, self%n_nodes)
      integer :: i, j

      matrix = 0.0_wp
      if (lumped) then
         do i = 1, self%n_nodes
            do j = 3*i - 2, 3*i - 1
               matrix(j, j) = self%material%density*self%share(i, self%class(e))
            end do
         end do
         return
      end if
      part = self%material%density*mass_matrix(self%shape, self%x(:, :, e))
      do i = 1, 2
         call add_in_direction(i, part, matrix)
      end do
   end subroutine mass

   pure function extrapolation(self) result(matrix)
      class(solid_body_type), intent(in) :: self
      real(wp) :: matrix(self%n_nodes, self%n_points)

      matrix = point_extrapolation(self%shape%topology, &
            stiffness_rule(self%shape%topology, self%shape%reduced))
   end function extrapolation

   pure subroutine body_load(self, e, body, load)
      class(solid_body_type), intent(in) :: self
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
      class(solid_body_type), intent(in) :: self
      integer, intent(in) :: e, edge
      real(wp), intent(in) :: pressure
      real(wp), intent(out) :: load(:)
      logical, intent(out) :: exists

      load = 0.0_wp
      exists = edge >= 1 .and. edge <= count_corners(self%shape%topology)
      if (exists) load = on_freedoms(pressure*edge_force(self%shape, self%x(:, :, e), edge))
   end subroutine edge_load

   pure subroutine centrifugal_load(self, e, omega_squared, point, axis, load)
      class(solid_body_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: omega_squared, point(3), axis(3)
      real(wp), intent(out) :: load(:)

      load = on_freedoms(self%material%density*omega_squared &
            *centrifugal_force(self%shape, self%x(:, :, e), point, axis))
   end subroutine centrifugal_load

end module solid_body
