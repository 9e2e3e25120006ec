!> Mass and loads of one plane or axisymmetric solid, with the full rule of the mass; the rotation
!> of CAX8R alone with that of its stiffness.
module solid_integrals
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use elastic, only: axisymmetric
   use quadrature, only: rule_type, mass_rule, stiffness_rule, line_rule
   use solid_geometry, only: solid_shape_type, map_derivatives, depth_at
   use topology, only: quad4, quad8, count_nodes, count_corners, edge_nodes, shape_functions, &
         shape_derivatives, line_functions, line_derivatives
   implicit none
   private

   public :: mass_matrix, lumped_mass, lumped_masses, volume_shares, centrifugal_force, edge_force

contains

   !> Integral of N Nt over the volume.
   pure function mass_matrix(shape, x) result(matrix)
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :)           !! (2, n_nodes)
      real(wp) :: matrix(size(x, 2), size(x, 2))

      matrix = weigh(shape, x, mass_rule(shape%topology))
   end function mass_matrix

   !> Integral of N Nt over the volume by a rule.
   pure function weigh(shape, x, rule) result(matrix)
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :)           !! (2, n_nodes)
      type(rule_type), intent(in) :: rule
      real(wp) :: matrix(size(x, 2), size(x, 2))
      real(wp) :: n(size(x, 2)), volume
      integer :: p, i

      matrix = 0.0_wp
      do p = 1, rule%n
         call sample(shape, x, rule, p, n, volume)
         do i = 1, size(n)
            matrix(:, i) = matrix(:, i) + volume*n(i)*n
         end do
      end do
   end function weigh

   !> The volume shared among the nodes, all shares positive: row sums of the mass matrix, or in
   !> proportion to its diagonal where there are middle nodes (Hinton, Rock and Zienkiewicz).
   pure function lumped_mass(shape, x) result(share)
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :)           !! (2, n_nodes)
      real(wp) :: share(size(x, 2))
      real(wp) :: shares(size(x, 2), 1)

      shares = lumped_masses(shape, reshape(x, [2, size(x, 2), 1]))
      share = shares(:, 1)
   end function lumped_mass

   !> The same of many elements, (n_nodes, elements).
   pure function lumped_masses(shape, x) result(share)
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :, :)        !! (2, n_nodes, elements)
      real(wp) :: share(size(x, 2), size(x, 3))
      type(rule_type) :: rule
      real(wp), allocatable :: n(:, :), dn(:, :, :)
      real(wp) :: volume, total
      integer :: e, p, status

      rule = mass_rule(shape%topology)
      allocate (n(size(x, 2), rule%n), dn(2, size(x, 2), rule%n), stat=status)
      call check_allocation(status)
      do p = 1, rule%n
         n(:, p) = shape_functions(shape%topology, rule%point(:, p))
         dn(:, :, p) = shape_derivatives(shape%topology, rule%point(:, p))
      end do
      do e = 1, size(x, 3)
         share(:, e) = 0.0_wp
         total = 0.0_wp
         do p = 1, rule%n
            volume = rule%weight(p)*jacobian(dn(:, :, p), x(:, :, e)) &
                  *depth_at(shape, dot_product(n(:, p), x(1, :, e)))
            total = total + volume
            if (shape%topology <= quad4) share(:, e) = share(:, e) + volume*n(:, p)
            if (shape%topology > quad4) share(:, e) = share(:, e) + volume*n(:, p)**2
         end do
         if (shape%topology > quad4) share(:, e) = share(:, e)*(total/sum(share(:, e)))
      end do
   end function lumped_masses

   pure function jacobian(dn, x) result(det_j)
      real(wp), intent(in) :: dn(:, :), x(:, :)   !! (2, n_nodes)
      real(wp) :: det_j

      det_j = dot_product(dn(1, :), x(1, :))*dot_product(dn(2, :), x(2, :)) &
            - dot_product(dn(1, :), x(2, :))*dot_product(dn(2, :), x(1, :))
   end function jacobian

   !> Integral of N over the volume: what a force per volume gives the nodes.
   pure function volume_shares(shape, x) result(share)
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :)           !! (2, n_nodes)
      real(wp) :: share(size(x, 2))

      share = sum(mass_matrix(shape, x), 1)
   end function volume_shares

   !> Integral of N times the distance vector from an axis. An axisymmetric solid turns about its
   !> own axis of symmetry, whatever the arguments say.
   pure function centrifugal_force(shape, x, point, axis) result(force)
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :)           !! (2, n_nodes)
      real(wp), intent(in) :: point(3)
      real(wp), intent(in) :: axis(3)           !! unit vector
      real(wp) :: force(2, size(x, 2))
      real(wp) :: distance(3, size(x, 2)), matrix(size(x, 2), size(x, 2))
      integer :: i

      do i = 1, size(x, 2)
         if (shape%plane == axisymmetric) then
            distance(:, i) = [x(1, i), 0.0_wp, 0.0_wp]
         else
            distance(:, i) = [x(:, i), 0.0_wp] - point
            distance(:, i) = distance(:, i) - dot_product(distance(:, i), axis)*axis
         end if
      end do
      ! CAX8R: the rule of the stiffness, as CalculiX does
      if (shape%plane == axisymmetric .and. shape%topology == quad8 .and. shape%reduced) then
         matrix = weigh(shape, x, stiffness_rule(quad8, .true.))
      else
         matrix = mass_matrix(shape, x)
      end if
      force = matmul(distance(1:2, :), matrix)
   end function centrifugal_force

   !> Nodal forces of a unit pressure that pushes on an edge of an element numbered
   !> counterclockwise.
   pure function edge_force(shape, x, edge) result(force)
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :)           !! (2, n_nodes)
      integer, intent(in) :: edge               !! from 1 to the number of corners
      real(wp) :: force(2, size(x, 2))
      integer :: node(1 + count_nodes(shape%topology)/count_corners(shape%topology))
      real(wp) :: n(size(node)), tangent(2), s(size(node)), weight(size(node))
      integer :: p, i

      node = edge_nodes(shape%topology, edge)
      call line_rule(s, weight)
      force = 0.0_wp
      do p = 1, size(s)
         n = line_functions(size(node), s(p))
         tangent = matmul(x(:, node), line_derivatives(size(node), s(p)))
         tangent = tangent*weight(p)*depth_at(shape, dot_product(n, x(1, node)))
         do i = 1, size(node)
            force(1, node(i)) = force(1, node(i)) - n(i)*tangent(2)
            force(2, node(i)) = force(2, node(i)) + n(i)*tangent(1)
         end do
      end do
   end function edge_force

   !> Shape functions and volume at a point of a rule.
   pure subroutine sample(shape, x, rule, p, n, volume)
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :)
      type(rule_type), intent(in) :: rule
      integer, intent(in) :: p
      real(wp), intent(out) :: n(:)
      real(wp), intent(out) :: volume
      real(wp) :: unused(2, size(x, 2)), det_j

      n = shape_functions(shape%topology, rule%point(:, p))
      call map_derivatives(shape%topology, x, rule%point(:, p), unused, det_j)
      volume = rule%weight(p)*det_j*depth_at(shape, dot_product(n, x(1, :)))
   end subroutine sample

end module solid_integrals
