!> The partner that a node has on an edge of a surface: the point X on it and the normal n with
!> which the gap is n . (x - X).
!>
!> Between the ends of an edge X is the closest point and n the outward normal there. At a vertex
!> between two edges, where the closest point is the vertex itself, n points along the line between
!> vertex and node, away from the body: the gap is plus or minus their distance and turns with the
!> node continuously from one edge to the other. For a node that touches a vertex, closer than 1e-6
!> of the edge's length, n is the mean of both normals where the edges differ by less than 45
!> degrees, else that of the edge that faces the node better or, with no difference, on whose side
!> it is. At an open end of a surface n stays that of the edge, and a node beyond the end by more
!> than the target's overhang has no partner there: a tenth of the edge, since bodies of one width
!> that meet do not bulge alike.
module contact_partner
   use kinds, only: wp
   use segment_projection, only: closest_on_edge, edge_frame, edge_functions
   use target_surface, only: edge_coordinates, is_next_to, target_type
   implicit none
   private

   public :: partner_type, query_type
   public :: make_partner, project, neighbour_of

   !> A node closer to a vertex than this share of the edge's length touches it.
   real(wp), parameter, public :: touch_share = 1.0e-6_wp
   !> Cosine of the largest angle between two edges that a mean normal is taken for.
   real(wp), parameter :: kink_limit = 0.7_wp
   !> A surface whose normal has a larger component along the node's than this is its rear.
   real(wp), parameter, public :: facing_limit = 0.1_wp
   !> What is round a corner is no farther along the surface than this times the distance.
   real(wp), parameter :: walk_share = 3.0_wp
   !> Overlaps up to this share of an edge's length are recognised without a path across the edge.
   real(wp), parameter, public :: overlap_share = 0.5_wp

   type :: partner_type
      integer :: edge = 0                        !! of the target, 0: none
      real(wp) :: s = 0.0_wp                     !! place on the edge, -1 to 1
      logical :: at_vertex = .false.             !! X stays at a vertex: slope and bend are 0
      real(wp) :: gap = 0.0_wp                   !! n . (x - X)
      real(wp) :: normal(2) = 0.0_wp             !! n, outward of the target
      real(wp) :: tangent(2) = 0.0_wp            !! (-n_y, n_x)
      real(wp) :: stretch = 0.0_wp               !! J = |dX/ds|
      real(wp) :: bend = 0.0_wp                  !! n . X''/J^2, negative for a convex target
      integer :: n_nodes = 0
      integer :: nodes(3) = 0                    !! of the edge
      real(wp) :: shape(3) = 0.0_wp              !! N_p(s)
      real(wp) :: slope(3) = 0.0_wp              !! dN_p/ds / J
   end type partner_type

   !> What is looked for.
   type :: query_type
      integer :: node = 0
      real(wp) :: before(2) = 0.0_wp, now(2) = 0.0_wp
      real(wp) :: facing(2) = 0.0_wp             !! outward normal at the node, or zero
      real(wp) :: limit = facing_limit           !! of the partner's normal along it
      real(wp) :: share = overlap_share          !! of an edge that may be overlapped
      real(wp) :: reach = 0.0_wp
   end type query_type

contains

   !> Gap and normal at a place of an edge by the rules above; edge 0 beyond an open end or where
   !> the surface does not face the node.
   pure subroutine make_partner(self, x_now, query, edge, s, s_free, partner)
      type(target_type), intent(in) :: self
      real(wp), intent(in) :: x_now(:, :)
      type(query_type), intent(in) :: query
      integer, intent(in) :: edge
      real(wp), intent(in) :: s, s_free
      type(partner_type), intent(out) :: partner
      integer :: other
      real(wp) :: offset(2), distance, facing

      partner%edge = edge
      partner%s = s
      call set_frame(self, x_now, query, partner, offset)
      distance = partner%stretch*(1.0_wp - abs(s)) + norm2(offset)
      if (distance <= 2.0_wp*touch_share*partner%stretch .or. abs(s_free) > 1.0_wp) then
         other = neighbour_of(self, query, edge, s)
         if (other > 0) call turn_normal(self, x_now, query, other, partner, offset)
         if (lies_beyond(self, x_now, query, other, s_free)) partner%edge = 0
      end if
      partner%gap = dot_product(partner%normal, offset)
      partner%tangent = [-partner%normal(2), partner%normal(1)]
      facing = dot_product(partner%normal, query%facing)
      if (facing > query%limit) partner%edge = 0
      if (facing <= -kink_limit .or. partner%edge == 0) return
      if (is_next_to(self, x_now, edge, query%node, walk_share*norm2(offset))) partner%edge = 0
   end subroutine make_partner

   !> Whether a node is not the vertex's at the end of an edge: there is no other edge and the node
   !> lies beyond the overhang, or the other edge ends still closer to it, perhaps at an open end.
   pure function lies_beyond(self, x_now, query, other, s_free) result(beyond)
      type(target_type), intent(in) :: self
      real(wp), intent(in) :: x_now(:, :)
      type(query_type), intent(in) :: query
      integer, intent(in) :: other               !! edge on the other side of the vertex, or 0
      real(wp), intent(in) :: s_free             !! place on this edge, not limited to its ends
      logical :: beyond
      real(wp) :: s, s_free_other, distance

      if (other == 0) then
         beyond = abs(s_free) > 1.0_wp + 2.0_wp*self%overhang
      else
         beyond = abs(s_free) > 1.0_wp
         if (.not. beyond) return
         call project(self, x_now, query, other, s, s_free_other, distance)
         ! away from the vertex is where one walks on
         beyond = s_free_other*sign(1.0_wp, s_free) > 1.0_wp
      end if
   end function lies_beyond

   !> All that belongs to partner%edge and partner%s but the gap.
   pure subroutine set_frame(self, x_now, query, partner, offset)
      type(target_type), intent(in) :: self
      real(wp), intent(in) :: x_now(:, :)
      type(query_type), intent(in) :: query
      type(partner_type), intent(inout) :: partner
      real(wp), intent(out) :: offset(2)         !! x - X
      real(wp) :: x(2, 3), point(2)

      x = edge_coordinates(self, partner%edge, x_now)
      associate (n => self%n_edge_nodes(partner%edge))
         partner%n_nodes = n
         partner%nodes = self%edges(:, partner%edge)
         call edge_functions(n, partner%s, partner%shape, partner%slope)
         call edge_frame(x(:, :n), partner%s, point, partner%tangent, partner%normal, &
               partner%stretch, partner%bend)
         partner%slope = partner%slope/partner%stretch
      end associate
      offset = query%now - point
   end subroutine set_frame

   !> The normal at a vertex: between the node and the vertex when they are apart, else the mean of
   !> both edges' or that of one.
   pure subroutine turn_normal(self, x_now, query, other, partner, offset)
      type(target_type), intent(in) :: self
      real(wp), intent(in) :: x_now(:, :)
      type(query_type), intent(in) :: query
      integer, intent(in) :: other               !! edge on the other side of the vertex
      type(partner_type), intent(inout) :: partner
      real(wp), intent(inout) :: offset(2)
      type(partner_type) :: beyond
      real(wp) :: own, across, facing, offset_beyond(2)

      beyond%edge = other
      beyond%s = sign(1.0_wp, -partner%s)
      call set_frame(self, x_now, query, beyond, offset_beyond)
      own = dot_product(partner%normal, offset)
      across = dot_product(beyond%normal, offset)
      if (norm2(offset) > 2.0_wp*touch_share*partner%stretch) then
         partner%at_vertex = .true.
         partner%slope = 0.0_wp
         partner%bend = 0.0_wp
         partner%normal = sign(1.0_wp, own + across)*offset/norm2(offset)
      else if (dot_product(partner%normal, beyond%normal) > kink_limit) then
         partner%normal = partner%normal + beyond%normal
         partner%normal = partner%normal/norm2(partner%normal)
      else
         ! The own normal decides, for round-off must not move a node round a corner.
         facing = dot_product(beyond%normal - partner%normal, query%facing)
         if (abs(facing) <= facing_limit) facing = own - across
         if (facing >= 0.0_wp .or. abs(partner%s) < 1.0_wp) return
         partner = beyond
         offset = offset_beyond
      end if
   end subroutine turn_normal

   pure subroutine project(self, x_now, query, edge, s, s_free, distance)
      type(target_type), intent(in) :: self
      real(wp), intent(in) :: x_now(:, :)
      type(query_type), intent(in) :: query
      integer, intent(in) :: edge
      real(wp), intent(out) :: s, s_free, distance
      real(wp) :: x(2, 3), shape(3), rise(3)

      x = edge_coordinates(self, edge, x_now)
      associate (n => self%n_edge_nodes(edge))
         call closest_on_edge(x(:, :n), query%now, s, s_free)
         call edge_functions(n, s, shape, rise)
         distance = norm2(query%now - matmul(x, shape))
      end associate
   end subroutine project

   !> The edge beyond the end that s is nearest to; 0 at an open end or if the node belongs to it.
   pure function neighbour_of(self, query, edge, s) result(other)
      type(target_type), intent(in) :: self
      type(query_type), intent(in) :: query
      integer, intent(in) :: edge
      real(wp), intent(in) :: s
      integer :: other

      other = merge(self%next(edge), self%previous(edge), s > 0.0_wp)
      if (other == 0) return
      if (any(self%edges(:, other) == query%node)) other = 0
   end function neighbour_of

end module contact_partner
