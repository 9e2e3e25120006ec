!> Finds the partner of a node on a surface, by the rules of `contact_partner`: the edge that its
!> path crosses, or the closest.
module contact_search
   use kinds, only: wp
   use segment_projection, only: closest_on_edge, cut_edge, edge_frame, edge_functions
   use target_surface, only: belongs_to, edge_coordinates, edges_near, mean_normal, target_type
   use contact_partner, only: facing_limit, make_partner, neighbour_of, partner_type, project, &
         query_type, touch_share
   implicit none
   private

   public :: find_partner

   !> `overlap_share` of a surface's own nodes: the other side of a thin part is no partner.
   real(wp), parameter :: own_overlap_share = 0.125_wp

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

end module contact_search
