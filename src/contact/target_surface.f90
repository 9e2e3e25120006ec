!> The edges that nodes are looked for on: which edge follows which, and where they are now. Bins
!> hold them as they were at the last building; what has moved since, beside the mean translation
!> of the surface, widens the boxes that are asked for, up to a slack.
module target_surface
   use kinds, only: int64, wp
   use state_archive, only: archive_type
   use memory_shortage, only: check_allocation
   use segment_projection, only: edge_frame
   use edge_bins, only: edge_bins_type, find_in_box, new_bins
   implicit none
   private

   public :: target_type, new_target, update_target, edges_near, boxes_apart
   public :: edge_coordinates, mean_normal, belongs_to, is_next_to

   !> An edge moves by no more than this times the largest motion of its nodes.
   real(wp), parameter :: node_share = 1.25_wp

   !> A surface may be closed or open, in several pieces, in any order. Where more than two edges
   !> meet in a node, those listed first are neighbours.
   type :: target_type
      integer, allocatable :: edges(:, :)        !! (3, n): the ends, the middle node or 0
      integer, allocatable :: n_edge_nodes(:)    !! (n) 2 or 3
      integer, allocatable :: next(:)            !! (n) edge that starts where this ends, or 0
      integer, allocatable :: previous(:)        !! (n) edge that ends where this starts, or 0
      integer, allocatable :: element(:)         !! (n) that an edge is a side of, 0: not known
      integer, allocatable :: nodes(:)           !! nodes of the edges, ascending
      integer, allocatable :: leaving(:)         !! (n_nodes) edge a node is first or middle of
      integer, allocatable :: arriving(:)        !! (n_nodes) edge a node is last or middle of
      real(wp) :: overhang = 0.1_wp              !! of an open end that still holds, in edge lengths
      integer(int64) :: n_tests = 0              !! edges that a node was compared with so far
      integer(int64) :: n_builds = 0             !! of the bins
      real(wp) :: motion(2) = 0.0_wp             !! mean displacement of the nodes in the step
      real(wp) :: unrest = 0.0_wp                !! the largest departure of a node from it
      integer, allocatable :: found(:)           !! (n) edges of the last call of edges_near
      integer :: n_found = 0
      type(edge_bins_type), private :: bins
      real(wp), allocatable, private :: built(:, :) !! (2, nodes) where they were at the building
      real(wp), private :: drift(2) = 0.0_wp     !! mean displacement since the building
      real(wp), private :: slack = -1.0_wp       !! motion beside the drift that the bins allow
      real(wp), private :: reach = 0.0_wp        !! that the bins were built for
      real(wp), private :: least_slack = 0.0_wp
      real(wp), private :: cell = 0.0_wp         !! smallest that the bins were built with
   contains
      procedure :: pass_state
   end type target_type

contains

   !> Takes the edges of a surface and finds their neighbours. From the first node of an edge to the
   !> second its body is on the left.
   pure subroutine new_target(self, edges, n_nodes, element)
      type(target_type), intent(out) :: self
      integer, intent(in) :: edges(:, :)         !! (3, n): the ends, the middle node or 0
      integer, intent(in) :: n_nodes             !! of the model
      integer, intent(in), optional :: element(:)   !! (n)
      integer :: e, i, n, status

      n = size(edges, 2)
      self%edges = edges
      self%n_edge_nodes = merge(3, 2, edges(3, :) > 0)
      self%element = [(0, e=1, n)]
      if (present(element)) self%element = element
      allocate (self%leaving(n_nodes), self%arriving(n_nodes), source=0, stat=status)
      call check_allocation(status)
      do e = n, 1, -1
         self%leaving(edges(1, e)) = e
         self%arriving(edges(2, e)) = e
         if (edges(3, e) == 0) cycle
         self%leaving(edges(3, e)) = e
         self%arriving(edges(3, e)) = e
      end do
      allocate (self%next(n), self%previous(n), self%found(n), source=0, stat=status)
      call check_allocation(status)
      do e = 1, n
         i = self%leaving(edges(2, e))
         if (self%arriving(edges(2, e)) == e) self%next(e) = i
         i = self%arriving(edges(1, e))
         if (self%leaving(edges(1, e)) == e) self%previous(e) = i
      end do
      self%nodes = pack([(i, i=1, n_nodes)], self%leaving + self%arriving > 0)
      allocate (self%built(2, size(self%nodes)), source=0.0_wp, stat=status)
      call check_allocation(status)
   end subroutine new_target

   !> Takes the positions of a step; to be called whenever they have changed. The bins are built
   !> anew when they no longer hold.
   pure subroutine update_target(self, x_before, x_now, reach)
      type(target_type), intent(inout) :: self
      real(wp), intent(in) :: x_before(:, :), x_now(:, :) !! (2 or 3, n_nodes) at the step's ends
      real(wp), intent(in) :: reach              !! distance that partners will be looked for in
      integer :: i, n
      real(wp) :: moved

      n = size(self%nodes)
      if (n == 0) return
      self%motion = 0.0_wp
      self%drift = 0.0_wp
      do i = 1, n
         self%motion = self%motion + (x_now(1:2, self%nodes(i)) - x_before(1:2, self%nodes(i)))
         self%drift = self%drift + (x_now(1:2, self%nodes(i)) - self%built(:, i))
      end do
      self%motion = self%motion/real(n, wp)
      self%drift = self%drift/real(n, wp)
      self%unrest = 0.0_wp
      moved = 0.0_wp
      do i = 1, n
         associate (now => x_now(1:2, self%nodes(i)), before => x_before(1:2, self%nodes(i)))
            self%unrest = max(self%unrest, norm2(now - before - self%motion))
            moved = max(moved, norm2(now - self%built(:, i) - self%drift))
         end associate
      end do
      ! bins for a wide reach would make every later search a wide one
      if (moved <= self%slack .and. reach <= 2.0_wp*self%reach .and. &
            self%slack <= 4.0_wp*max(reach, self%least_slack)) return
      call build_bins(self, x_now, reach)
   end subroutine update_target

   !> What the bins have been built from and with: they are built again. What is found does not
   !> depend on them, but its order may.
   subroutine pass_state(self, archive)
      class(target_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive
      real(wp) :: x(2, size(self%leaving))

      call archive%pass('built', self%built)
      call archive%pass('cell', self%cell)
      call archive%pass('slack', self%slack)
      if (archive%reading .and. self%slack > 0.0_wp) then
         x = 0.0_wp
         x(:, self%nodes) = self%built
         call build_bins(self, x, self%cell)
      end if
      call archive%pass('n_tests', self%n_tests)
      call archive%pass('n_builds', self%n_builds)
   end subroutine pass_state

   pure subroutine build_bins(self, x_now, reach)
      type(target_type), intent(inout) :: self
      real(wp), intent(in) :: x_now(:, :)
      real(wp), intent(in) :: reach
      real(wp), allocatable :: low(:, :), high(:, :)
      integer :: e, status
      real(wp) :: box(2, 2), least

      allocate (low(2, size(self%edges, 2)), high(2, size(self%edges, 2)), stat=status)
      call check_allocation(status)
      do e = 1, size(self%edges, 2)
         box = edge_box(self, e, x_now)
         low(:, e) = box(:, 1)
         high(:, e) = box(:, 2)
      end do
      least = minval(maxval(high - low, 1))
      self%least_slack = max(least/2.0_wp, 1.0e-6_wp*maxval(high - low))
      self%slack = max(reach, self%least_slack)
      self%reach = max(reach, self%slack)
      self%cell = reach
      call new_bins(self%bins, low, high, reach)
      self%built = x_now(1:2, self%nodes)
      self%drift = 0.0_wp
      self%n_builds = self%n_builds + 1
   end subroutine build_bins

   !> Edges that may come closer to a box than a reach, now or on their way during the step relative
   !> to the mean motion: found(:n_found).
   pure subroutine edges_near(self, low, high, reach)
      type(target_type), intent(inout) :: self
      real(wp), intent(in) :: low(2), high(2)    !! in the positions now
      real(wp), intent(in) :: reach

      self%n_found = 0
      if (size(self%nodes) == 0) return
      call find_in_box(self%bins, low - self%drift, high - self%drift, &
            reach + node_share*(self%slack + self%unrest), self%found, self%n_found)
   end subroutine edges_near

   !> True if an edge has a node, or is a side of an element that has it on the surface.
   pure function belongs_to(self, edge, node) result(belongs)
      type(target_type), intent(in) :: self
      integer, intent(in) :: edge, node
      logical :: belongs

      belongs = any(self%edges(:, edge) == node)
      if (belongs .or. self%element(edge) == 0) return
      if (self%leaving(node) > 0) belongs = self%element(self%leaving(node)) == self%element(edge)
      if (self%arriving(node) > 0) belongs = belongs .or. &
            self%element(self%arriving(node)) == self%element(edge)
   end function belongs_to

   !> True if an edge follows or precedes one with the node, at once or after edges of no more than
   !> a length.
   pure function is_next_to(self, x, edge, node, length) result(is)
      type(target_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)            !! (2 or 3, n_nodes)
      integer, intent(in) :: edge, node
      real(wp), intent(in) :: length
      logical :: is

      is = .false.
      if (self%leaving(node) + self%arriving(node) == 0) return
      is = is_along(self%next) .or. is_along(self%previous)

   contains

      pure function is_along(neighbour) result(found)
         integer, intent(in) :: neighbour(:)
         logical :: found
         integer :: other
         real(wp) :: walked

         found = .false.
         walked = 0.0_wp
         other = neighbour(edge)
         do while (other > 0 .and. other /= edge .and. walked <= length)
            associate (nodes => self%edges(:, other))
               found = any(nodes == node)
               if (found) return
               walked = walked + norm2(x(1:2, nodes(2)) - x(1:2, nodes(1)))
            end associate
            other = neighbour(other)
         end do
      end function is_along

   end function is_next_to

   !> True if nodes cannot come closer to the surface than a reach during a step: the boxes of both
   !> sets of positions do not meet. Needs no update_target.
   pure function boxes_apart(self, nodes, x_before, x_now, reach) result(apart)
      type(target_type), intent(in) :: self
      integer, intent(in) :: nodes(:)
      real(wp), intent(in) :: x_before(:, :), x_now(:, :) !! (2 or 3, n_nodes)
      real(wp), intent(in) :: reach
      logical :: apart
      real(wp) :: low(2), high(2), own_low(2), own_high(2), box(2, 2)
      integer :: i

      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      do i = 1, size(nodes)
         low = min(low, x_before(1:2, nodes(i)), x_now(1:2, nodes(i)))
         high = max(high, x_before(1:2, nodes(i)), x_now(1:2, nodes(i)))
      end do
      own_low = huge(1.0_wp)
      own_high = -huge(1.0_wp)
      do i = 1, size(self%edges, 2)
         box = edge_box(self, i, x_before)
         own_low = min(own_low, box(:, 1))
         own_high = max(own_high, box(:, 2))
         box = edge_box(self, i, x_now)
         own_low = min(own_low, box(:, 1))
         own_high = max(own_high, box(:, 2))
      end do
      apart = any(low - reach > own_high .or. high + reach < own_low)
   end function boxes_apart

   !> Lower and upper corner of a box around an edge: a curved one lies in the triangle of its
   !> control points.
   pure function edge_box(self, edge, x) result(box)
      type(target_type), intent(in) :: self
      integer, intent(in) :: edge
      real(wp), intent(in) :: x(:, :)            !! (2 or 3, n_nodes)
      real(wp) :: box(2, 2)
      real(wp) :: corner(2, 3)

      corner = edge_coordinates(self, edge, x)
      if (self%n_edge_nodes(edge) == 3) then
         corner(:, 3) = 2.0_wp*corner(:, 3) - (corner(:, 1) + corner(:, 2))/2.0_wp
      end if
      box(:, 1) = minval(corner, 2)
      box(:, 2) = maxval(corner, 2)
   end function edge_box

   !> Outward unit normal of a surface at a node, the mean of the edges'; zero if the node is not on
   !> it or at the tip of a crack, where they are opposite.
   pure function mean_normal(self, x, node) result(normal)
      type(target_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)            !! (2 or 3, n_nodes)
      integer, intent(in) :: node
      real(wp) :: normal(2)

      normal = normal_at(self, x, self%leaving(node), node) &
            + normal_at(self, x, self%arriving(node), node)
      if (norm2(normal) > 0.1_wp) then
         normal = normal/norm2(normal)
      else
         normal = 0.0_wp
      end if
   end function mean_normal

   !> Of one edge at one of its nodes, zero for edge 0.
   pure function normal_at(self, x, edge, node) result(normal)
      type(target_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: edge, node
      real(wp) :: normal(2)
      real(wp) :: x_edge(2, 3), point(2), tangent(2), stretch, bend, s

      normal = 0.0_wp
      if (edge == 0) return
      s = 0.0_wp
      if (self%edges(1, edge) == node) s = -1.0_wp
      if (self%edges(2, edge) == node) s = 1.0_wp
      x_edge = edge_coordinates(self, edge, x)
      call edge_frame(x_edge(:, :self%n_edge_nodes(edge)), s, point, tangent, normal, stretch, bend)
   end function normal_at

   !> Positions of the nodes of an edge; only the first n_edge_nodes columns count.
   pure function edge_coordinates(self, edge, x) result(x_edge)
      type(target_type), intent(in) :: self
      integer, intent(in) :: edge
      real(wp), intent(in) :: x(:, :)            !! (2 or 3, n_nodes)
      real(wp) :: x_edge(2, 3)

      x_edge(:, 1) = x(1:2, self%edges(1, edge))
      x_edge(:, 2) = x(1:2, self%edges(2, edge))
      x_edge(:, 3) = x_edge(:, 1)
      if (self%n_edge_nodes(edge) == 3) x_edge(:, 3) = x(1:2, self%edges(3, edge))
   end function edge_coordinates

end module target_surface
