!> One edge of a slave surface against the edges of a target: where the nodes of the target divide
!> it, and which point of the target is opposite to one of its points. Opposite means along the
!> normal of the slave surface, which is continuous: the mean at a vertex between two edges that
!> differ by less than 45 degrees, interpolated in between with the shape functions.
module edge_overlap
   use kinds, only: wp
   use segment_projection, only: closest_on_edge, cut_edge, edge_frame, edge_functions
   use target_surface, only: edge_coordinates, edges_near, target_type
   implicit none
   private

   public :: slave_edge_type, set_slave_edge, find_breaks, find_opposite

   !> Cosine of the largest angle between two edges that a mean normal is taken for.
   real(wp), parameter :: kink_limit = 0.7_wp
   !> A target edge whose normal has a smaller component along the slave's inward one is its rear
   !> or goes on behind a corner: distances along the normal to it would tell of no contact.
   real(wp), parameter :: facing_limit = 0.5_wp
   !> A point that overlaps an edge by more than a shallow share of its own edge's length is in
   !> contact with it if all others are no closer than a share of the overlap.
   real(wp), parameter :: shallow = 1.0e-3_wp
   real(wp), parameter :: closest_share = 0.5_wp
   !> Pieces of an edge shorter than this in s are left out.
   real(wp), parameter :: shortest = 1.0e-12_wp

   type :: slave_edge_type
      integer :: n = 0                           !! number of nodes
      integer :: nodes(3) = 0
      real(wp) :: x(2, 3) = 0.0_wp               !! their positions
      real(wp) :: normal(2, 3) = 0.0_wp          !! inward of the slave, outward of the target
      real(wp) :: range = 0.0_wp                 !! distance in which the target is looked for
   end type slave_edge_type

contains

   !> Takes an edge as it is now, and finds the edges of the target in its range: the reach, or the
   !> length of the edge if that is more.
   pure subroutine set_slave_edge(self, slave, edge, x_now, reach, target)
      type(slave_edge_type), intent(out) :: self
      type(target_type), intent(in) :: slave     !! its surface
      integer, intent(in) :: edge
      real(wp), intent(in) :: x_now(:, :)        !! (2 or 3, n_nodes)
      real(wp), intent(in) :: reach
      type(target_type), intent(inout) :: target
      integer :: i
      real(wp), parameter :: place(3) = [-1.0_wp, 1.0_wp, 0.0_wp]
      real(wp) :: other(2)

      self%n = slave%n_edge_nodes(edge)
      self%nodes = slave%edges(:, edge)
      self%x = edge_coordinates(slave, edge, x_now)
      self%range = max(reach, norm2(self%x(:, 2) - self%x(:, 1)))
      do i = 1, self%n
         self%normal(:, i) = inward_normal(slave, edge, place(i), x_now)
      end do
      do i = 1, 2
         if (merge(slave%previous(edge), slave%next(edge), i == 1) == 0) cycle
         other = inward_normal(slave, merge(slave%previous(edge), slave%next(edge), i == 1), &
               -place(i), x_now)
         if (dot_product(self%normal(:, i), other) < kink_limit) cycle
         self%normal(:, i) = self%normal(:, i) + other
         self%normal(:, i) = self%normal(:, i)/norm2(self%normal(:, i))
      end do
      call edges_near(target, minval(self%x(:, :self%n), 2), maxval(self%x(:, :self%n), 2), &
            2.0_wp*self%range)
      target%n_tests = target%n_tests + target%n_found
   end subroutine set_slave_edge

   pure function inward_normal(surface, edge, s, x_now) result(normal)
      type(target_type), intent(in) :: surface
      integer, intent(in) :: edge
      real(wp), intent(in) :: s
      real(wp), intent(in) :: x_now(:, :)
      real(wp) :: normal(2)
      real(wp) :: x(2, 3), point(2), tangent(2), stretch, bend

      x = edge_coordinates(surface, edge, x_now)
      call edge_frame(x(:, :surface%n_edge_nodes(edge)), s, point, tangent, normal, stretch, bend)
      normal = -normal
   end function inward_normal

   !> Divides an edge at the ends of the target's edges: breaks(1) = -1 < ... < breaks(n) = 1.
   pure subroutine find_breaks(self, target, x_now, breaks, nodes, n)
      type(slave_edge_type), intent(in) :: self
      type(target_type), intent(in) :: target    !! with the edges of set_slave_edge
      real(wp), intent(in) :: x_now(:, :)
      real(wp), intent(inout) :: breaks(:)       !! with room for two more than twice those edges
      integer, intent(inout) :: nodes(:)         !! the target's there, 0 at the ends of the edge
      integer, intent(out) :: n
      integer :: i, j
      logical :: found
      real(wp) :: s

      breaks(1) = -1.0_wp
      nodes(1) = 0
      n = 1
      do i = 1, target%n_found
         do j = 1, 2
            call place_opposite(self, x_now(1:2, target%edges(j, target%found(i))), s, found)
            if (found) call insert_break(s, target%edges(j, target%found(i)), breaks, nodes, n)
         end do
      end do
      call insert_break(1.0_wp, 0, breaks, nodes, n)
   end subroutine find_breaks

   !> Into ascending order, unless it is there already.
   pure subroutine insert_break(s, node, breaks, nodes, n)
      real(wp), intent(in) :: s
      integer, intent(in) :: node
      real(wp), intent(inout) :: breaks(:)
      integer, intent(inout) :: nodes(:)
      integer, intent(inout) :: n
      integer :: i

      do i = n, 1, -1
         if (abs(breaks(i) - s) <= shortest) return
         if (breaks(i) < s) exit
      end do
      breaks(i + 2:n + 1) = breaks(i + 1:n)
      breaks(i + 1) = s
      nodes(i + 2:n + 1) = nodes(i + 1:n)
      nodes(i + 1) = node
      n = n + 1
   end subroutine insert_break

   !> Where on the inside of an edge the normal goes through a point: Newton's method.
   pure subroutine place_opposite(self, point, s, found)
      type(slave_edge_type), intent(in) :: self
      real(wp), intent(in) :: point(2)
      real(wp), intent(out) :: s
      logical, intent(out) :: found
      integer :: round
      real(wp) :: shape(3), rise(3), offset(2), normal(2), slope(2), turn(2), change

      found = .false.
      s = 0.0_wp
      do round = 1, 30
         call edge_functions(self%n, s, shape, rise)
         offset = matmul(self%x, shape) - point
         slope = matmul(self%x, rise)
         normal = matmul(self%normal, shape)
         turn = matmul(self%normal, rise)
         change = cross(slope, normal) + cross(offset, turn)
         if (.not. abs(change) > 0.0_wp) return
         change = -cross(offset, normal)/change
         s = s + change
         if (abs(s) > 3.0_wp) return
         if (abs(change) <= epsilon(1.0_wp)) exit
      end do
      found = abs(s) < 1.0_wp .and. abs(change) <= 1.0e-9_wp
   end subroutine place_opposite

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(2), b(2)
      real(wp) :: c

      c = a(1)*b(2) - a(2)*b(1)
   end function cross

   !> The target edge that is opposite to a point of a slave edge, the nearest if there are several;
   !> one that overlaps by more than the length of the slave edge is not, nor is one that a point
   !> inside the target would leave it through though another edge is much closer.
   pure subroutine find_opposite(self, target, x_now, s, edge)
      type(slave_edge_type), intent(in) :: self
      type(target_type), intent(in) :: target    !! with the edges of set_slave_edge
      real(wp), intent(in) :: x_now(:, :)
      real(wp), intent(in) :: s
      integer, intent(out) :: edge               !! 0 if there is none in the range
      integer :: i
      logical :: found
      real(wp) :: point(2), normal(2), x(2, 3), place, fraction, least, deep, distance
      real(wp) :: shape(3), rise(3), across(2), along(2), outward(2), stretch, bend, overlap

      edge = 0
      overlap = 0.0_wp
      least = huge(1.0_wp)
      call edge_functions(self%n, s, shape, rise)
      point = matmul(self%x, shape)
      normal = matmul(self%normal, shape)
      normal = normal/norm2(normal)
      deep = min(self%range, norm2(self%x(:, 2) - self%x(:, 1)))
      do i = 1, target%n_found
         associate (n => target%n_edge_nodes(target%found(i)))
            x = edge_coordinates(target, target%found(i), x_now)
            call cut_edge(x(:, :n), point + deep*normal, point - self%range*normal, place, &
                  fraction, found)
            distance = abs(deep - fraction*(deep + self%range))
            if (.not. found .or. distance >= least) cycle
            call edge_frame(x(:, :n), place, across, along, outward, stretch, bend)
         end associate
         if (dot_product(outward, normal) < facing_limit) cycle
         least = distance
         edge = target%found(i)
         overlap = deep - fraction*(deep + self%range)
      end do
      if (overlap <= shallow*norm2(self%x(:, 2) - self%x(:, 1))) return
      if (depth_in(self, target, x_now, point) < closest_share*overlap) edge = 0
   end subroutine find_opposite

   !> How far a point of a slave edge is from the nearest of the edges found, other than its own.
   pure function depth_in(self, target, x_now, point) result(depth)
      type(slave_edge_type), intent(in) :: self
      type(target_type), intent(in) :: target
      real(wp), intent(in) :: x_now(:, :)
      real(wp), intent(in) :: point(2)
      real(wp) :: depth
      integer :: i, j
      real(wp) :: x(2, 3), s, s_free, shape(3), rise(3)

      depth = huge(1.0_wp)
      do i = 1, target%n_found
         associate (edge => target%found(i))
            if (any([(any(self%nodes(:self%n) == target%edges(j, edge)), j=1, 2)])) cycle
            x = edge_coordinates(target, edge, x_now)
            call closest_on_edge(x(:, :target%n_edge_nodes(edge)), point, s, s_free)
            call edge_functions(target%n_edge_nodes(edge), s, shape, rise)
            depth = min(depth, norm2(point - matmul(x, shape)))
         end associate
      end do
   end function depth_in

end module edge_overlap
