!> The partner of a node on a surface: the edge, the point X on it and the normal n with which the
!> gap is n . (x - X).
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
module contact_search
   use kinds, only: int64, wp
   use segment_projection, only: closest_on_edge, cut_edge, edge_frame, edge_functions
   use target_surface, only: belongs_to, edge_coordinates, edges_near, is_next_to, mean_normal, &
         target_type
   implicit none
   private

   public :: partner_type, find_partner

   !> Overlaps up to this share of an edge's length are recognised without a path across the edge.
   real(wp), parameter :: overlap_share = 0.5_wp
   !> The same of a surface's own nodes: the other side of a thin part is no partner.
   real(wp), parameter :: own_overlap_share = 0.125_wp
   !> A node closer to a vertex than this share of the edge's length touches it.
   real(wp), parameter :: touch_share = 1.0e-6_wp
   !> Cosine of the largest angle between two edges that a mean normal is taken for.
   real(wp), parameter :: kink_limit = 0.7_wp
   !> A surface whose normal has a larger component along the node's than this is its rear.
   real(wp), parameter :: facing_limit = 0.1_wp

   !> What is round a corner is no farther along the surface than this times the distance.
   real(wp), parameter :: walk_share = 3.0_wp

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
      real(wp) :: share = overlap_share         !! of an edge that may be overlapped
      real(wp) :: reach = 0.0_wp
   end type query_type

contains

   !> Finds the partner of a node: where its path relative to the edges crosses one from its outer
   !> to its inner side, the first edge crossed, or one near it that is closer at the end; else the
   !> closest edge, when a gap is not more than the reach and an overlap not more than the reach and
   !> half the length of the edge (an eighth, if the node is the surface's own), or than twice the
   !> relative motion. Edges with this node are never
   !> partners, nor are those of elements with it. Edges round a corner from its own, no farther
   !> along the surface than three times the distance, are if they oppose it, as at the tip of a
   !> crack. The target must have been updated with the same positions.
   pure subroutine find_partner(self, x_before, x_now, node, reach, allowed_normal, partner)
      type(target_type), intent(inout) :: self
      real(wp), intent(in) :: x_before(:, :), x_now(:, :) !! (2 or 3, n_nodes) at the step's ends
      integer, intent(in) :: node
      real(wp), intent(in) :: reach
      real(wp), intent(in) :: allowed_normal(2)  !! outward at the node, or zero if unknown
      type(partner_type), intent(out) :: partner !! edge 0 if there is none
      type(query_type) :: query
      type(partner_type) :: trial
      integer :: i, crossed
      real(wp) :: path(2), least, deep, far, distance, first, fraction

      query = query_type(node=node, before=x_before(1:2, node), now=x_now(1:2, node), &
            facing=allowed_normal, reach=reach)
      if (self%leaving(node) + self%arriving(node) > 0) then
         query%limit = -facing_limit
         query%share = own_overlap_share
         if (.not. any(abs(allowed_normal) > 0.0_wp)) query%facing = mean_normal(self, x_now, node)
      end if
      path = query%now - query%before - self%motion
      call edges_near(self, min(query%now, query%now - path), max(query%now, query%now - path), &
            max(reach, 2.0_wp*(norm2(path) + self%unrest)))
      least = huge(1.0_wp)
      deep = huge(1.0_wp)
      far = huge(1.0_wp)
      first = huge(1.0_wp)
      crossed = 0
      do i = 1, self%n_found
         if (belongs_to(self, self%found(i), node)) cycle
         self%n_tests = self%n_tests + 1
         distance = least
         call compare(self, x_before, x_now, query, self%found(i), trial, distance, fraction)
         if (fraction < first) then
            first = fraction
            crossed = self%found(i)
         end if
         if (trial%edge < 0 .and. trial%gap > 0.0_wp) far = min(far, distance)
         if (trial%edge < 0 .and. trial%gap < 0.0_wp) deep = min(deep, distance)
         if (trial%edge <= 0) cycle
         ! Of edges that meet in the closest point the first of the surface, as bins have no order.
         if (distance >= least .and. partner%edge < trial%edge) cycle
         least = distance
         partner = trial
      end do
      ! Deep inside no other side of the body is seen from outside, nor one from inside far outside.
      if (partner%gap > deep .or. -partner%gap > far) partner = partner_type()
      if (crossed == 0) return
      if (.not. cuts_corner(self, x_before, x_now, query, crossed, partner)) then
         call project_along(self, x_now, query, crossed, trial)
         if (trial%edge > 0) partner = trial
      end if
      if (partner%edge > 0 .and. partner%gap < 0.0_wp) return
      call enter_edge(self, x_before, x_now, query, crossed, trial)
      if (trial%edge > 0) partner = trial
   end subroutine find_partner

   !> The partner where a node enters a body that it leaves again in the same step; edge 0 for one
   !> that touches the edge at the start.
   pure subroutine enter_edge(self, x_before, x_now, query, edge, partner)
      type(target_type), intent(in) :: self
      real(wp), intent(in) :: x_before(:, :), x_now(:, :)
      type(query_type), intent(in) :: query
      integer, intent(in) :: edge
      type(partner_type), intent(out) :: partner
      integer :: n
      real(wp) :: x(2, 3), change(2, 3), shape(3), rise(3), s, fraction, path(2)

      n = self%n_edge_nodes(edge)
      x = edge_coordinates(self, edge, x_now)
      change = x - edge_coordinates(self, edge, x_before)
      s = 0.0_wp
      call cross_edge(x(:, :n), change, query, s, fraction)
      if (fraction > 1.0_wp) return
      call edge_functions(n, s, shape, rise)
      path = query%now - query%before - matmul(change, shape)
      if (fraction*norm2(path) <= touch_share*norm2(x(:, 2) - x(:, 1))) return
      call make_partner(self, x_now, query, edge, s, s, partner)
      if (partner%gap >= 0.0_wp) partner%edge = 0
   end subroutine enter_edge

   !> True if the closest point is so near along the surface to the edge that was crossed that the
   !> node has only cut the corner between them: no further than three times its path.
   pure function cuts_corner(self, x_before, x_now, query, crossed, partner) result(cuts)
      type(target_type), intent(in) :: self
      real(wp), intent(in) :: x_before(:, :), x_now(:, :)
      type(query_type), intent(in) :: query
      integer, intent(in) :: crossed
      type(partner_type), intent(in) :: partner
      logical :: cuts
      integer :: after, before, i
      real(wp) :: ahead, behind, limit, path(2)

      cuts = .false.
      if (partner%edge == 0) return
      path = query%now - query%before
      do i = 1, partner%n_nodes
         path = path - partner%shape(i)*(x_now(1:2, partner%nodes(i)) &
               - x_before(1:2, partner%nodes(i)))
      end do
      limit = 3.0_wp*norm2(path)
      after = partner%edge
      before = partner%edge
      ahead = partner%stretch*(1.0_wp - partner%s)
      behind = partner%stretch*(1.0_wp + partner%s)
      do i = 1, size(self%next)
         cuts = after == crossed .or. before == crossed
         if (cuts) return
         if (ahead > limit) after = 0
         if (behind > limit) before = 0
         if (after > 0) after = self%next(after)
         if (before > 0) before = self%previous(before)
         if (after + before == 0) return
         if (after > 0) ahead = ahead + edge_chord(self, x_now, after)
         if (before > 0) behind = behind + edge_chord(self, x_now, before)
      end do
   end function cuts_corner

   pure function edge_chord(self, x_now, edge) result(length)
      type(target_type), intent(in) :: self
      real(wp), intent(in) :: x_now(:, :)
      integer, intent(in) :: edge
      real(wp) :: length

      length = norm2(x_now(1:2, self%edges(2, edge)) - x_now(1:2, self%edges(1, edge)))
   end function edge_chord

   !> One edge: the partner that it would be by its closest point, with edge 0 if it is none or
   !> farther than a distance, a negative one if the gap or the overlap is too large, and the
   !> fraction of the step after which the node crosses it, huge if it does not.
   pure subroutine compare(self, x_before, x_now, query, edge, trial, distance, fraction)
      type(target_type), intent(in) :: self
      real(wp), intent(in) :: x_before(:, :), x_now(:, :)
      type(query_type), intent(in) :: query
      integer, intent(in) :: edge
      type(partner_type), intent(out) :: trial
      real(wp), intent(inout) :: distance        !! limit, then that of the closest point
      real(wp), intent(out) :: fraction
      integer :: n
      real(wp) :: x(2, 3), change(2, 3), shape(3), rise(3), s, s_free, s_cross, path(2), limit

      fraction = huge(1.0_wp)
      n = self%n_edge_nodes(edge)
      x = edge_coordinates(self, edge, x_now)
      change = x - edge_coordinates(self, edge, x_before)
      call closest_on_edge(x(:, :n), query%now, s, s_free)
      call edge_functions(n, s, shape, rise)
      limit = distance
      distance = norm2(query%now - matmul(x, shape))
      path = query%now - query%before - matmul(change, shape)
      if (distance <= norm2(path) + self%unrest) then
         s_cross = s
         call cross_edge(x(:, :n), change, query, s_cross, fraction)
      end if
      if (distance > limit) return
      limit = 2.0_wp*norm2(path)
      if (distance > max(query%reach, limit)) return
      call make_partner(self, x_now, query, edge, s, s_free, trial)
      if (trial%edge == 0) return
      limit = max(limit, min(query%reach, 2.0_wp*query%share*trial%stretch))
      if (trial%gap > query%reach .or. -trial%gap > limit) trial%edge = -edge
   end subroutine compare

   !> The fraction of the step after which a node crosses an edge inward, both moving straight; the
   !> path is that relative to the point of the edge where it crosses.
   pure subroutine cross_edge(x, change, query, s, fraction)
      real(wp), intent(in) :: x(:, :)            !! (2, 2 or 3) edge now
      real(wp), intent(in) :: change(2, 3)       !! its displacements in the step
      type(query_type), intent(in) :: query
      real(wp), intent(inout) :: s               !! where to begin, then where it crosses
      real(wp), intent(out) :: fraction
      integer :: round
      logical :: found
      real(wp) :: start(2), when, shape(3), rise(3)
      real(wp) :: point(2), tangent(2), normal(2), stretch, bend

      fraction = huge(1.0_wp)
      do round = 1, 3
         call edge_functions(size(x, 2), s, shape, rise)
         start = query%before + matmul(change, shape)
         call cut_edge(x, start, query%now, s, when, found)
         if (.not. found) return
      end do
      call edge_frame(x, s, point, tangent, normal, stretch, bend)
      if (dot_product(normal, query%now - start) >= 0.0_wp) return
      if (dot_product(normal, query%facing) > query%limit) return
      fraction = when
   end subroutine cross_edge

   !> The partner on an edge that was crossed, or on those that follow it when they are closer.
   pure subroutine project_along(self, x_now, query, crossed, partner)
      type(target_type), intent(in) :: self
      real(wp), intent(in) :: x_now(:, :)
      type(query_type), intent(in) :: query
      integer, intent(in) :: crossed
      type(partner_type), intent(out) :: partner
      integer :: step, edge, other
      real(wp) :: s, s_free, distance, s_other, s_free_other, distance_other

      edge = crossed
      call project(self, x_now, query, edge, s, s_free, distance)
      do step = 1, size(self%next)
         if (abs(s_free) <= 1.0_wp) exit
         other = neighbour_of(self, query, edge, s_free)
         if (other == 0) exit
         call project(self, x_now, query, other, s_other, s_free_other, distance_other)
         if (distance_other >= distance) exit
         edge = other
         s = s_other
         s_free = s_free_other
         distance = distance_other
      end do
      call make_partner(self, x_now, query, edge, s, s_free, partner)
   end subroutine project_along

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

end module contact_search
