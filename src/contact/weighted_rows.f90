!> Contact rows weighted over the edges of the slave surface: for each of its nodes j
!>
!>    g_j = int w_j (x_s - x_m) . n ds / int w_j ds,
!>
!> w_j linear from node to node, middle nodes included: the shape functions of a quadratic edge are
!> negative in parts, and bodies that just touch would overlap by their averages. x_s on the slave
!> surface, x_m the point of the target opposite to it, n the slave's normal there,
!> outward of the target. The integrals go over the parts of the slave surface that the target is
!> opposite to, divided at the nodes of both, with five Gauss points a piece. A uniform pressure on
!> nonmatching meshes so gives the consistent forces on both.
!>
!> The covered part ends at nodes of the target, and moves with them when the bodies slide: the rate
!> of g_j has w_j (h - g_j) times the speed of each end in it, h the gap there. (Without it a body
!> that tips over the end of another would gain or lose energy.) Friction does without.
!>
!> A node has a row if the covered part has at least 5 % of the whole int w_j and g_j is not more
!> than the reach.
module weighted_rows
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use segment_projection, only: closest_on_edge, cut_edge, edge_functions
   use target_surface, only: edge_coordinates, target_type
   use edge_overlap, only: find_breaks, find_opposite, set_slave_edge, slave_edge_type
   implicit none
   private

   public :: weighted_rows_type, find_weighted_rows

   real(wp), parameter :: least_cover = 0.05_wp
   integer, parameter :: n_points = 5
   real(wp), parameter :: inner = sqrt(5.0_wp - 2.0_wp*sqrt(10.0_wp/7.0_wp))/3.0_wp
   real(wp), parameter :: outer = sqrt(5.0_wp + 2.0_wp*sqrt(10.0_wp/7.0_wp))/3.0_wp
   real(wp), parameter :: inner_weight = (322.0_wp + 13.0_wp*sqrt(70.0_wp))/900.0_wp
   real(wp), parameter :: outer_weight = (322.0_wp - 13.0_wp*sqrt(70.0_wp))/900.0_wp
   real(wp), parameter :: gauss_point(n_points) = [-outer, -inner, 0.0_wp, inner, outer]
   real(wp), parameter :: gauss_weight(n_points) = &
         [outer_weight, inner_weight, 128.0_wp/225.0_wp, inner_weight, outer_weight]

   !> Rows of the nodes that may touch: terms first(i) to first(i + 1) - 1 belong to row i. The
   !> coefficients of a row add up to zero. The rate of the gap is the sum of coefficient . v.
   type :: weighted_rows_type
      integer :: n = 0
      integer, allocatable :: slave_node(:)      !! (n) ascending
      real(wp), allocatable :: gap(:)            !! (n) g_j
      real(wp), allocatable :: weight(:)         !! (n) int w_j covered: force by pressure
      real(wp), allocatable :: normal(:, :)      !! (2, n) mean normal, outward of the target
      integer, allocatable :: first(:)           !! (n + 1)
      integer, allocatable :: node(:)            !! of each term, once in a row
      real(wp), allocatable :: normal_coefficient(:, :)  !! (2, terms)
      real(wp), allocatable :: tangent_coefficient(:, :) !! (2, terms) along (-n_y, n_x)
   end type weighted_rows_type

   !> Sums over the pieces, by the place of the slave node in slave%nodes.
   type :: sums_type
      real(wp), allocatable :: whole(:), weight(:), gap(:), normal(:, :)
      integer :: n = 0                           !! number of terms
      integer, allocatable :: owner(:), node(:)
      real(wp), allocatable :: coefficient(:, :) !! (2, terms) along the normal
      logical, allocatable :: at_end(:)          !! (terms) w_j times the speed of an end, and ..
      real(wp), allocatable :: end_gap(:)        !! (terms) .. the gap there
   end type sums_type

contains

   !> Rows of a slave surface against a target that has been updated with x_now.
   pure subroutine find_weighted_rows(slave, target, x_now, reach, rows)
      type(target_type), intent(in) :: slave     !! only its edges and neighbours are used
      type(target_type), intent(inout) :: target
      real(wp), intent(in) :: x_now(:, :)        !! (2 or 3, n_nodes)
      real(wp), intent(in) :: reach
      type(weighted_rows_type), intent(out) :: rows
      type(sums_type) :: sums
      type(slave_edge_type) :: edge
      integer, allocatable :: place(:), ends(:)
      real(wp), allocatable :: breaks(:)
      integer :: e, i, n, status

      n = size(slave%nodes)
      allocate (sums%whole(n), sums%weight(n), sums%gap(n), sums%normal(2, n), source=0.0_wp, &
            stat=status)
      call check_allocation(status)
      allocate (sums%owner(16*n), sums%node(16*n), sums%coefficient(2, 16*n), stat=status)
      call check_allocation(status)
      allocate (sums%at_end(16*n), sums%end_gap(16*n), stat=status)
      call check_allocation(status)
      allocate (breaks(2*size(target%edges, 2) + 2), ends(2*size(target%edges, 2) + 2), stat=status)
      call check_allocation(status)
      allocate (place(size(slave%leaving)), source=0, stat=status)
      call check_allocation(status)
      place(slave%nodes) = [(i, i=1, n)]
      do e = 1, size(slave%edges, 2)
         call set_slave_edge(edge, slave, e, x_now, reach, target)
         call find_breaks(edge, target, x_now, breaks, ends, n)
         do i = 1, n - 1
            if (edge%n == 3 .and. breaks(i) < 0.0_wp .and. breaks(i + 1) > 0.0_wp) then
               call add_piece(edge, target, x_now, [breaks(i), 0.0_wp], [ends(i), 0], &
                     place, sums)
               call add_piece(edge, target, x_now, [0.0_wp, breaks(i + 1)], &
                     [0, ends(i + 1)], place, sums)
            else
               call add_piece(edge, target, x_now, breaks(i:i + 1), ends(i:i + 1), &
                     place, sums)
            end if
         end do
      end do
      call gather_rows(slave, sums, reach, rows)
   end subroutine find_weighted_rows

   !> Adds the integrals over a piece of a slave edge, opposite to one target edge or none.
   pure subroutine add_piece(edge, target, x_now, ends, end_nodes, place, sums)
      type(slave_edge_type), intent(in) :: edge
      type(target_type), intent(in) :: target
      real(wp), intent(in) :: x_now(:, :)
      real(wp), intent(in) :: ends(2)
      integer, intent(in) :: end_nodes(2)        !! of the target that the piece ends at, or 0
      integer, intent(in) :: place(:)
      type(sums_type), intent(inout) :: sums
      integer :: opposite, i, j, k
      real(wp) :: s, ds, shape(3), share(3), rise(3), normal(2), growth(2), gap
      real(wp) :: terms(2, 6, 3), x(2, 3), shape_target(3)

      terms = 0.0_wp
      call find_opposite(edge, target, x_now, sum(ends)/2.0_wp, opposite)
      if (opposite > 0) x = edge_coordinates(target, opposite, x_now)
      do i = 1, n_points
         s = (ends(1) + ends(2) + gauss_point(i)*(ends(2) - ends(1)))/2.0_wp
         call edge_functions(edge%n, s, shape, rise)
         share = weights_at(edge%n, s)
         ds = gauss_weight(i)*(ends(2) - ends(1))/2.0_wp*norm2(matmul(edge%x, rise))
         do j = 1, edge%n
            k = place(edge%nodes(j))
            sums%whole(k) = sums%whole(k) + ds*share(j)
         end do
         if (opposite == 0) cycle
         call look_across(edge, x(:, :target%n_edge_nodes(opposite)), shape, normal, gap, &
               shape_target, growth)
         do j = 1, edge%n
            k = place(edge%nodes(j))
            sums%weight(k) = sums%weight(k) + ds*share(j)
            sums%gap(k) = sums%gap(k) + ds*share(j)*gap
            sums%normal(:, k) = sums%normal(:, k) + ds*share(j)*normal
            do k = 1, 3
               terms(:, k, j) = terms(:, k, j) + ds*share(j)*shape(k)*growth
               terms(:, k + 3, j) = terms(:, k + 3, j) - ds*share(j)*shape_target(k)*growth
            end do
         end do
      end do
      if (opposite == 0) return
      do j = 1, edge%n
         call add_terms(sums, place(edge%nodes(j)), edge%nodes(:edge%n), terms(:, :3, j))
         call add_terms(sums, place(edge%nodes(j)), &
               target%edges(:target%n_edge_nodes(opposite), opposite), terms(:, 4:, j))
      end do
      do i = 1, 2
         if (end_nodes(i) > 0) call add_rim(edge, x(:, :target%n_edge_nodes(opposite)), ends(i), &
               2*i - 3, end_nodes(i), x_now(1:2, end_nodes(i)), place, sums)
      end do
   end subroutine add_piece

   !> w_j of the nodes of an edge.
   pure function weights_at(n, s) result(weights)
      integer, intent(in) :: n
      real(wp), intent(in) :: s
      real(wp) :: weights(3)

      weights = [(1.0_wp - s)/2.0_wp, (1.0_wp + s)/2.0_wp, 0.0_wp]
      if (n == 3) weights = [max(0.0_wp, -s), max(0.0_wp, s), 1.0_wp - abs(s)]
   end function weights_at

   !> What the gap gets when a piece becomes longer at an end: it moves along the slave edge by
   !> ds = m . (u_p - u_s)/(m . dx_s/ds), m across the normal, with the target's node p there.
   pure subroutine add_rim(edge, x, s, side, node, point, place, sums)
      type(slave_edge_type), intent(in) :: edge
      real(wp), intent(in) :: x(:, :)            !! (2, 2 or 3) target edge opposite to the piece
      real(wp), intent(in) :: s                  !! the end
      integer, intent(in) :: side                !! -1: where the piece begins, 1: where it ends
      integer, intent(in) :: node                !! of the target
      real(wp), intent(in) :: point(2)           !! where that is
      integer, intent(in) :: place(:)
      type(sums_type), intent(inout) :: sums
      real(wp) :: shape(3), rise(3), weights(3), normal(2), gap, shape_target(3), growth(2)
      real(wp) :: along(2), across(2), turn(2), speed, terms(2, 4)
      integer :: j, k

      call edge_functions(edge%n, s, shape, rise)
      weights = weights_at(edge%n, s)
      call look_across(edge, x, shape, normal, gap, shape_target, growth)
      along = matmul(edge%x, rise)
      across = [normal(2), -normal(1)]
      turn = matmul(edge%normal, rise)/norm2(matmul(edge%normal, shape))
      speed = dot_product(along, across) &
            + dot_product(matmul(edge%x, shape) - point, [turn(2), -turn(1)])
      if (speed <= 0.5_wp*norm2(along)) return
      do k = 1, edge%n
         terms(:, k) = -shape(k)*across
      end do
      terms(:, edge%n + 1) = across
      terms(:, :edge%n + 1) = side*norm2(along)/speed*terms(:, :edge%n + 1)
      do j = 1, edge%n
         call add_terms(sums, place(edge%nodes(j)), [edge%nodes(:edge%n), node], &
               weights(j)*terms(:, :edge%n + 1), gap)
      end do
   end subroutine add_rim

   !> The point of a target edge along the normal from a point of a slave edge. Where the target's
   !> normal m differs from the slave's normal n, the point opposite to it wanders along the target
   !> when both slide, and the gap grows by m . (v_s - v_m)/(m . n).
   pure subroutine look_across(edge, x, shape, normal, gap, shape_target, growth)
      type(slave_edge_type), intent(in) :: edge
      real(wp), intent(in) :: x(:, :)            !! (2, 2 or 3) target edge
      real(wp), intent(in) :: shape(3)           !! of the slave edge at the point
      real(wp), intent(out) :: normal(2), gap, shape_target(3)
      real(wp), intent(out) :: growth(2)         !! m/(m . n)
      logical :: found
      real(wp) :: rise(3), point(2), s, fraction, reach(2), along(2), slant

      point = matmul(edge%x, shape)
      normal = matmul(edge%normal, shape)
      normal = normal/norm2(normal)
      reach = 2.0_wp*edge%range*normal
      call cut_edge(x, point + reach, point - reach, s, fraction, found)
      ! Beside the end of the edge by round-off.
      if (.not. found) call closest_on_edge(x, point, s, fraction)
      call edge_functions(size(x, 2), s, shape_target, rise)
      gap = dot_product(normal, point - matmul(x, shape_target(:size(x, 2))))
      along = matmul(x, rise(:size(x, 2)))
      slant = along(2)*normal(1) - along(1)*normal(2)
      growth = [along(2), -along(1)]
      if (abs(slant) > 0.5_wp*norm2(along)) then
         growth = growth/slant
      else
         growth = normal
      end if
   end subroutine look_across

   pure subroutine add_terms(sums, owner, nodes, coefficient, end_gap)
      type(sums_type), intent(inout) :: sums
      integer, intent(in) :: owner, nodes(:)
      real(wp), intent(in) :: coefficient(:, :)
      real(wp), intent(in), optional :: end_gap
      integer :: n

      n = size(nodes)
      if (sums%n + n > size(sums%owner)) call make_room(sums)
      sums%owner(sums%n + 1:sums%n + n) = owner
      sums%node(sums%n + 1:sums%n + n) = nodes
      sums%coefficient(:, sums%n + 1:sums%n + n) = coefficient(:, :n)
      sums%at_end(sums%n + 1:sums%n + n) = present(end_gap)
      sums%end_gap(sums%n + 1:sums%n + n) = 0.0_wp
      if (present(end_gap)) sums%end_gap(sums%n + 1:sums%n + n) = end_gap
      sums%n = sums%n + n
   end subroutine add_terms

   pure subroutine make_room(sums)
      type(sums_type), intent(inout) :: sums
      integer, allocatable :: owner(:), node(:)
      real(wp), allocatable :: coefficient(:, :), end_gap(:)
      logical, allocatable :: at_end(:)
      integer :: status

      allocate (owner(2*size(sums%owner)), node(2*size(sums%owner)), stat=status)
      call check_allocation(status)
      allocate (coefficient(2, 2*size(sums%owner)), end_gap(2*size(sums%owner)), stat=status)
      call check_allocation(status)
      allocate (at_end(2*size(sums%owner)), stat=status)
      call check_allocation(status)
      at_end(:sums%n) = sums%at_end(:sums%n)
      end_gap(:sums%n) = sums%end_gap(:sums%n)
      owner(:sums%n) = sums%owner(:sums%n)
      node(:sums%n) = sums%node(:sums%n)
      coefficient(:, :sums%n) = sums%coefficient(:, :sums%n)
      call move_alloc(owner, sums%owner)
      call move_alloc(node, sums%node)
      call move_alloc(coefficient, sums%coefficient)
      call move_alloc(at_end, sums%at_end)
      call move_alloc(end_gap, sums%end_gap)
   end subroutine make_room

   !> Sorts the terms by rows, adds up those of the same node, divides by the weights.
   pure subroutine gather_rows(slave, sums, reach, rows)
      type(target_type), intent(in) :: slave
      type(sums_type), intent(in) :: sums
      real(wp), intent(in) :: reach
      type(weighted_rows_type), intent(out) :: rows
      integer, allocatable :: first(:), order(:), row(:)
      integer :: i, j, n, n_terms, status
      real(wp) :: normal(2), tangent(2)

      n = size(slave%nodes)
      call sort_by_owner(sums, n, first, order)
      allocate (row(0), stat=status)
      call check_allocation(status)
      row = pack([(i, i=1, n)], sums%weight >= least_cover*sums%whole .and. sums%weight > 0.0_wp &
            .and. sums%gap <= reach*sums%weight)
      rows%n = size(row)
      rows%slave_node = slave%nodes(row)
      rows%weight = sums%weight(row)
      rows%gap = sums%gap(row)/sums%weight(row)
      rows%normal = sums%normal(:, row)
      allocate (rows%first(rows%n + 1), rows%node(sums%n), rows%normal_coefficient(2, sums%n), &
            stat=status)
      call check_allocation(status)
      allocate (rows%tangent_coefficient(2, sums%n), stat=status)
      call check_allocation(status)
      n_terms = 0
      do i = 1, rows%n
         rows%first(i) = n_terms + 1
         rows%normal(:, i) = rows%normal(:, i)/norm2(rows%normal(:, i))
         do j = first(row(i)) + 1, first(row(i) + 1)
            associate (k => order(j))
               normal = sums%coefficient(:, k)/rows%weight(i)
               tangent = [-normal(2), normal(1)]
               if (sums%at_end(k)) tangent = 0.0_wp
               if (sums%at_end(k)) normal = (sums%end_gap(k) - rows%gap(i))*normal
               call merge_term(sums%node(k), normal, tangent, rows, rows%first(i), n_terms)
            end associate
         end do
      end do
      rows%first(rows%n + 1) = n_terms + 1
      rows%node = rows%node(:n_terms)
      rows%normal_coefficient = rows%normal_coefficient(:, :n_terms)
      rows%tangent_coefficient = rows%tangent_coefficient(:, :n_terms)
   end subroutine gather_rows

   !> Counting sort: terms order(first(i) + 1:first(i + 1)) belong to node i.
   pure subroutine sort_by_owner(sums, n, first, order)
      type(sums_type), intent(in) :: sums
      integer, intent(in) :: n
      integer, allocatable, intent(out) :: first(:), order(:)
      integer :: i, status

      allocate (first(n + 1), source=0, stat=status)
      call check_allocation(status)
      allocate (order(sums%n), stat=status)
      call check_allocation(status)
      do i = 1, sums%n
         first(sums%owner(i)) = first(sums%owner(i)) + 1
      end do
      do i = 2, n
         first(i) = first(i) + first(i - 1)
      end do
      first(n + 1) = sums%n
      do i = sums%n, 1, -1
         order(first(sums%owner(i))) = i
         first(sums%owner(i)) = first(sums%owner(i)) - 1
      end do
   end subroutine sort_by_owner

   pure subroutine merge_term(node, normal, tangent, rows, first, n_terms)
      integer, intent(in) :: node
      real(wp), intent(in) :: normal(2), tangent(2)
      type(weighted_rows_type), intent(inout) :: rows
      integer, intent(in) :: first
      integer, intent(inout) :: n_terms
      integer :: i

      do i = first, n_terms
         if (rows%node(i) /= node) cycle
         rows%normal_coefficient(:, i) = rows%normal_coefficient(:, i) + normal
         rows%tangent_coefficient(:, i) = rows%tangent_coefficient(:, i) + tangent
         return
      end do
      n_terms = n_terms + 1
      rows%node(n_terms) = node
      rows%normal_coefficient(:, n_terms) = normal
      rows%tangent_coefficient(:, n_terms) = tangent
   end subroutine merge_term

end module weighted_rows
