!> Shapes of plane elements as data: three- and six-node triangles, four- and eight-node
!> quadrilaterals. Nodes stand counterclockwise, corners first, then the middle nodes of the edges
!> 1-2, 2-3, ... Triangles have natural coordinates (0,0), (1,0), (0,1), quadrilaterals -1 to 1.
module topology
   use kinds, only: wp
   implicit none
   private

   public :: tri3, quad4, tri6, quad8
   public :: count_nodes, count_corners, node_coordinates, edge_nodes, same_corners
   public :: shape_functions, shape_derivatives, line_functions, line_derivatives

   !> Numbered as the element kinds of the deck number them.
   integer, parameter :: tri3 = 1, quad4 = 2, tri6 = 3, quad8 = 4

   integer, parameter :: nodes_of(4) = [3, 4, 6, 8]
   integer, parameter :: corners_of(4) = [3, 4, 3, 4]

   real(wp), parameter :: triangle_nodes(2, 6) = reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
         0.0_wp, 1.0_wp, 0.5_wp, 0.0_wp, 0.5_wp, 0.5_wp, 0.0_wp, 0.5_wp], [2, 6])
   real(wp), parameter :: quadrilateral_nodes(2, 8) = real(reshape([-1, -1, 1, -1, 1, 1, -1, 1, &
         0, -1, 1, 0, 0, 1, -1, 0], [2, 8]), wp)

contains

   pure function count_nodes(topology) result(n)
      integer, intent(in) :: topology
      integer :: n

      n = nodes_of(topology)
   end function count_nodes

   !> Corners, and edges.
   pure function count_corners(topology) result(n)
      integer, intent(in) :: topology
      integer :: n

      n = corners_of(topology)
   end function count_corners

   !> tri3 or quad4: the topology without middle nodes.
   pure function same_corners(topology) result(simple)
      integer, intent(in) :: topology
      integer :: simple

      simple = corners_of(topology) - 2
   end function same_corners

   !> Natural coordinates of the nodes.
   pure function node_coordinates(topology) result(xi)
      integer, intent(in) :: topology
      real(wp) :: xi(2, nodes_of(topology))

      if (corners_of(topology) == 3) then
         xi = triangle_nodes(:, :nodes_of(topology))
      else
         xi = quadrilateral_nodes(:, :nodes_of(topology))
      end if
   end function node_coordinates

   !> Nodes of an edge, the two ends first, then the middle node if there is one.
   pure function edge_nodes(topology, edge) result(nodes)
      integer, intent(in) :: topology
      integer, intent(in) :: edge               !! from 1; edge i starts at corner i
      integer :: nodes(1 + nodes_of(topology)/corners_of(topology))

      nodes(1) = edge
      nodes(2) = modulo(edge, corners_of(topology)) + 1
      if (size(nodes) == 3) nodes(3) = corners_of(topology) + edge
   end function edge_nodes

   !> Shape functions at natural coordinates.
   pure function shape_functions(topology, xi) result(n)
      integer, intent(in) :: topology
      real(wp), intent(in) :: xi(2)
      real(wp) :: n(nodes_of(topology))
      real(wp) :: l(3)

      select case (topology)
      case (tri3)
         n = [1.0_wp - xi(1) - xi(2), xi(1), xi(2)]
      case (quad4)
         n = (1.0_wp + xi(1)*quadrilateral_nodes(1, :4)) &
               *(1.0_wp + xi(2)*quadrilateral_nodes(2, :4))/4.0_wp
      case (tri6)
         l = [1.0_wp - xi(1) - xi(2), xi(1), xi(2)]
         n = [l*(2.0_wp*l - 1.0_wp), 4.0_wp*l*cshift(l, 1)]
      case default
         n = quad8_functions(xi)
      end select
   end function shape_functions

   !> Their derivatives along the natural coordinates.
   pure function shape_derivatives(topology, xi) result(dn)
      integer, intent(in) :: topology
      real(wp), intent(in) :: xi(2)
      real(wp) :: dn(2, nodes_of(topology))
      real(wp), parameter :: dl(2, 3) = reshape([-1.0_wp, -1.0_wp, 1.0_wp, 0.0_wp, &
            0.0_wp, 1.0_wp], [2, 3])
      real(wp) :: l(3)
      integer :: i, j

      select case (topology)
      case (tri3)
         dn = dl
      case (quad4)
         associate (x => quadrilateral_nodes(1, :4), y => quadrilateral_nodes(2, :4))
            dn(1, :) = x*(1.0_wp + xi(2)*y)/4.0_wp
            dn(2, :) = y*(1.0_wp + xi(1)*x)/4.0_wp
         end associate
      case (tri6)
         l = [1.0_wp - xi(1) - xi(2), xi(1), xi(2)]
         do i = 1, 3
            j = modulo(i, 3) + 1
            dn(:, i) = (4.0_wp*l(i) - 1.0_wp)*dl(:, i)
            dn(:, 3 + i) = 4.0_wp*(dl(:, i)*l(j) + l(i)*dl(:, j))
         end do
      case default
         dn = quad8_derivatives(xi)
      end select
   end function shape_derivatives

   pure function quad8_functions(xi) result(n)
      real(wp), intent(in) :: xi(2)
      real(wp) :: n(8)
      real(wp) :: a(8), b(8)

      a = xi(1)*quadrilateral_nodes(1, :)
      b = xi(2)*quadrilateral_nodes(2, :)
      n(:4) = (1.0_wp + a(:4))*(1.0_wp + b(:4))*(a(:4) + b(:4) - 1.0_wp)/4.0_wp
      n(5:7:2) = (1.0_wp - xi(1)**2)*(1.0_wp + b(5:7:2))/2.0_wp
      n(6:8:2) = (1.0_wp + a(6:8:2))*(1.0_wp - xi(2)**2)/2.0_wp
   end function quad8_functions

   pure function quad8_derivatives(xi) result(dn)
      real(wp), intent(in) :: xi(2)
      real(wp) :: dn(2, 8)
      real(wp) :: a(8), b(8)

      a = xi(1)*quadrilateral_nodes(1, :)
      b = xi(2)*quadrilateral_nodes(2, :)
      associate (x => quadrilateral_nodes(1, :), y => quadrilateral_nodes(2, :))
         dn(1, :4) = x(:4)*(1.0_wp + b(:4))*(2.0_wp*a(:4) + b(:4))/4.0_wp
         dn(2, :4) = y(:4)*(1.0_wp + a(:4))*(a(:4) + 2.0_wp*b(:4))/4.0_wp
         dn(1, 5:7:2) = -xi(1)*(1.0_wp + b(5:7:2))
         dn(2, 5:7:2) = (1.0_wp - xi(1)**2)*y(5:7:2)/2.0_wp
         dn(1, 6:8:2) = x(6:8:2)*(1.0_wp - xi(2)**2)/2.0_wp
         dn(2, 6:8:2) = -xi(2)*(1.0_wp + a(6:8:2))
      end associate
   end function quad8_derivatives

   !> Shape functions of an edge of two or three nodes, ends first, at s from -1 to 1.
   pure function line_functions(n_nodes, s) result(n)
      integer, intent(in) :: n_nodes
      real(wp), intent(in) :: s
      real(wp) :: n(n_nodes)

      if (n_nodes == 2) then
         n = [1.0_wp - s, 1.0_wp + s]/2.0_wp
      else
         n = [s*(s - 1.0_wp)/2.0_wp, s*(s + 1.0_wp)/2.0_wp, 1.0_wp - s**2]
      end if
   end function line_functions

   pure function line_derivatives(n_nodes, s) result(dn)
      integer, intent(in) :: n_nodes
      real(wp), intent(in) :: s
      real(wp) :: dn(n_nodes)

      if (n_nodes == 2) then
         dn = [-0.5_wp, 0.5_wp]
      else
         dn = [s - 0.5_wp, s + 0.5_wp, -2.0_wp*s]
      end if
   end function line_derivatives

end module topology
