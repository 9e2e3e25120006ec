!> Geometry of one plane or axisymmetric solid: derivatives, volumes, what can be wrong with it.
module solid_geometry
   use kinds, only: wp
   use elastic, only: axisymmetric
   use quadrature, only: rule_type, stiffness_rule, mass_rule
   use topology, only: quad4, node_coordinates, shape_derivatives
   implicit none
   private

   public :: solid_shape_type, map_derivatives, depth_at, find_fault
   public :: fault_none, fault_coincident, fault_radius, fault_clockwise, fault_distorted
   public :: fault_size

   integer, parameter :: fault_none = 0
   integer, parameter :: fault_coincident = 1   !! two nodes at one place
   integer, parameter :: fault_radius = 2       !! axisymmetric with a node at negative x
   integer, parameter :: fault_clockwise = 3    !! inside out everywhere
   integer, parameter :: fault_distorted = 4    !! folded or without area somewhere

   integer, parameter :: fault_size = 5         !! its area is no normal number

   !> Areas of elements beyond these sizes over- or underflow.
   real(wp), parameter :: smallest_extent = 1.0e-151_wp, largest_extent = 1.0e151_wp

   !> What the solids of a group share beside the material.
   type :: solid_shape_type
      integer :: topology = 0                   !! tri3, quad4, tri6 or quad8
      integer :: plane = 0                      !! plane_strain, plane_stress or axisymmetric
      logical :: reduced = .false.              !! reduced quadrature of the stiffness
      logical :: b_bar = .false.                !! volumetric strain averaged; quad4, 33 strained
      real(wp) :: thickness = 1.0_wp            !! of plane solids
   end type solid_shape_type

contains

   !> Derivatives of the shape functions in space at a point, and the Jacobian there. Without an
   !> area the derivatives are zero.
   pure subroutine map_derivatives(topology, x, xi, dn_dx, det_j)
      integer, intent(in) :: topology
      real(wp), intent(in) :: x(:, :)           !! (2, n_nodes)
      real(wp), intent(in) :: xi(2)
      real(wp), intent(out) :: dn_dx(:, :)      !! (2, n_nodes)
      real(wp), intent(out) :: det_j
      real(wp) :: dn(2, size(x, 2)), j(2, 2)

      dn = shape_derivatives(topology, xi)
      j = matmul(dn, transpose(x))
      det_j = j(1, 1)*j(2, 2) - j(1, 2)*j(2, 1)
      dn_dx = 0.0_wp
      if (.not. abs(det_j) > 0.0_wp) return
      dn_dx(1, :) = (j(2, 2)*dn(1, :) - j(1, 2)*dn(2, :))/det_j
      dn_dx(2, :) = (j(1, 1)*dn(2, :) - j(2, 1)*dn(1, :))/det_j
   end subroutine map_derivatives

   !> Extent in the third direction at radius r: the thickness, or the circumference.
   pure function depth_at(shape, r) result(depth)
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: r
      real(wp) :: depth
      real(wp), parameter :: two_pi = 2.0_wp*acos(-1.0_wp)

      depth = shape%thickness
      if (shape%plane == axisymmetric) depth = two_pi*r
   end function depth_at

   !> What makes an element unfit for use: fault_none if nothing does. Its Jacobian must be positive
   !> at all points where it is needed and, of a straight quadrilateral, not negative at corners.
   pure function find_fault(shape, x) result(fault)
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :)           !! (2, n_nodes)
      integer :: fault
      type(rule_type) :: rule
      real(wp) :: extent, smallest, largest, least

      fault = fault_none
      extent = maxval(maxval(x, 2) - minval(x, 2))
      if (extent > largest_extent .or. (extent > 0.0_wp .and. extent < smallest_extent)) then
         fault = fault_size
      else if (closest(x) <= 1.0e-10_wp*extent) then
         fault = fault_coincident
      else if (shape%plane == axisymmetric .and. minval(x(1, :)) < -1.0e-12_wp*extent) then
         fault = fault_radius
      end if
      if (fault /= fault_none) return
      smallest = huge(smallest)
      largest = -huge(largest)
      rule = stiffness_rule(shape%topology, shape%reduced)
      call find_jacobians(shape%topology, x, rule%point, smallest, largest)
      rule = mass_rule(shape%topology)
      call find_jacobians(shape%topology, x, rule%point, smallest, largest)
      if (shape%topology == quad4) then
         least = huge(least)
         call find_jacobians(quad4, x, node_coordinates(quad4), least)
         smallest = min(smallest, least + 2.0e-10_wp*extent**2)
      end if
      if (smallest > 1.0e-10_wp*extent**2) return
      fault = fault_distorted
      if (largest < 0.0_wp) fault = fault_clockwise
   end function find_fault

   !> Distance between the two nodes that are closest.
   pure function closest(x) result(distance)
      real(wp), intent(in) :: x(:, :)
      real(wp) :: distance
      integer :: i, j

      distance = huge(distance)
      do i = 2, size(x, 2)
         do j = 1, i - 1
            distance = min(distance, norm2(x(:, i) - x(:, j)))
         end do
      end do
   end function closest

   !> Lowers and raises the bounds of the Jacobians met by those at some points.
   pure subroutine find_jacobians(topology, x, xi, smallest, largest)
      integer, intent(in) :: topology
      real(wp), intent(in) :: x(:, :)
      real(wp), intent(in) :: xi(:, :)          !! (2, points)
      real(wp), intent(inout) :: smallest
      real(wp), intent(inout), optional :: largest
      real(wp) :: dn(2, size(x, 2)), det_j
      integer :: p

      do p = 1, size(xi, 2)
         dn = shape_derivatives(topology, xi(:, p))
         det_j = dot_product(dn(1, :), x(1, :))*dot_product(dn(2, :), x(2, :)) &
               - dot_product(dn(1, :), x(2, :))*dot_product(dn(2, :), x(1, :))
         smallest = min(smallest, det_j)
         if (present(largest)) largest = max(largest, det_j)
      end do
   end subroutine find_jacobians

end module solid_geometry
