!> Contact rows weighted over the edges of the slave surface: for each of its nodes j
!>
!>    g_j = int N_j (x_s - x_m) . n ds / int N_j ds,
!>
!> x_s on the slave surface, x_m the point of the target opposite to it, n the slave's normal there,
!> outward of the target. The integrals go over the parts of the slave surface that the target is
!> opposite to, divided at the nodes of both, with five Gauss points a piece. A uniform pressure on
!> nonmatching meshes so gives the consistent forces on both.
!>
!> A node has a row if the covered part has at least 5 % of the whole int N_j and g_j is not more
!> than the reach.
module weighted_rows
   use kinds, only: wp
   use segment_projection, only: closest_on_edge, cut_edge, edge_frame, edge_functions
   use target_surface, only: edge_coordinates, target_type
   use edge_overlap, only: find_breaks, find_opposite, set_slave_edge, slave_edge_type
   implicit none
   private

   public :: weighted_rows_type, find_weighted_rows

   real(wp), parameter :: least_cover = 0.05_wp
   !> Where normals differ by more than 60 degrees the force is not made larger.
   real(wp), parameter :: least_facing = 0.5_wp
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
      real(wp), allocatable :: weight(:)         !! (n) int N_j covered: force by pressure
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
      integer, allocatable :: place(:)
      real(wp), allocatable :: breaks(:)
      integer :: e, i, n

      n = size(slave%nodes)
      allocate (sums%whole(n), sums%weight(n), sums%gap(n), sums%normal(2, n), source=0.0_wp)
      allocate (sums%owner(16*n), sums%node(16*n), sums%coefficient(2, 16*n))
      allocate (breaks(2*size(target%edges, 2) + 2))
      allocate (place(size(slave%leaving)), source=0)
      place(slave%nodes) = [(i, i=1, n)]
      do e = 1, size(slave%edges, 2)
         call set_slave_edge(edge, slave, e, x_now, reach, target)
         call find_breaks(edge, target, x_now, breaks, n)
         do i = 1, n - 1
            call add_piece(edge, target, x_now, breaks(i:i + 1), place, sums)
         end do
      end do
      call gather_rows(slave, sums, reach, rows)
   end subroutine find_weighted_rows

   !> Adds the integrals over a piece of a slave edge, opposite to one target edge or none.
   pure subroutine add_piece(edge, target, x_now, ends, place, sums)
      type(slave_edge_type), intent(in) :: edge
      type(target_type), intent(in) :: target
      real(wp), intent(in) :: x_now(:, :)
      real(wp), intent(in) :: ends(2)
      integer, intent(in) :: place(:)
      type(sums_type), intent(inout) :: sums
      integer :: opposite, i, j, k
      real(wp) :: s, ds, shape(3), rise(3), normal(2), gap, rate(2)
      real(wp) :: terms(2, 6, 3), x(2, 3), shape_target(3)

      terms = 0.0_wp
      call find_opposite(edge, target, x_now, sum(ends)/2.0_wp, opposite)
      if (opposite > 0) x = edge_coordinates(target, opposite, x_now)
      do i = 1, n_points
         s = (ends(1) + ends(2) + gauss_point(i)*(ends(2) - ends(1)))/2.0_wp
         call edge_functions(edge%n, s, shape, rise)
         ds = gauss_weight(i)*(ends(2) - ends(1))/2.0_wp*norm2(matmul(edge%x, rise))
         do j = 1, edge%n
            k = place(edge%nodes(j))
            sums%whole(k) = sums%whole(k) + ds*shape(j)
         end do
         if (opposite == 0) cycle
         call look_across(edge, x(:, :target%n_edge_nodes(opposite)), shape, normal, gap, &
               shape_target, rate)
         do j = 1, edge%n
            k = place(edge%nodes(j))
            sums%weight(k) = sums%weight(k) + ds*shape(j)
            sums%gap(k) = sums%gap(k) + ds*shape(j)*gap
            sums%normal(:, k) = sums%normal(:, k) + ds*shape(j)*normal
            do k = 1, 3
               terms(:, k, j) = terms(:, k, j) + ds*shape(j)*shape(k)*rate
               terms(:, k + 3, j) = terms(:, k + 3, j) - ds*shape(j)*shape_target(k)*rate
            end do
         end do
      end do
      if (opposite == 0) return
      do j = 1, edge%n
         call add_terms(sums, place(edge%nodes(j)), edge%nodes(:edge%n), terms(:, :3, j))
         call add_terms(sums, place(edge%nodes(j)), &
               target%edges(:target%n_edge_nodes(opposite), opposite), terms(:, 4:, j))
      end do
   end subroutine add_piece

   !> The point of a target edge along the normal n from a point of a slave edge. It slides along
   !> the edge, whose own normal is m: with their relative velocity v the gap changes at the rate
   !> m . v / (n . m).
   pure subroutine look_across(edge, x, shape, normal, gap, shape_target, rate)
      type(slave_edge_type), intent(in) :: edge
      real(wp), intent(in) :: x(:, :)            !! (2, 2 or 3) target edge
      real(wp), intent(in) :: shape(3)           !! of the slave edge at the point
      real(wp), intent(out) :: normal(2), gap, shape_target(3)
      real(wp), intent(out) :: rate(2)           !! m / (n . m)
      logical :: found
      real(wp) :: rise(3), point(2), s, fraction, reach(2)
      real(wp) :: opposite(2), tangent(2), outward(2), stretch, bend

      point = matmul(edge%x, shape)
      normal = matmul(edge%normal, shape)
      normal = normal/norm2(normal)
      reach = 2.0_wp*edge%range*normal
      call cut_edge(x, point + reach, point - reach, s, fraction, found)
      ! Beside the end of the edge by round-off.
      if (.not. found) call closest_on_edge(x, point, s, fraction)
      call edge_functions(size(x, 2), s, shape_target, rise)
      gap = dot_product(normal, point - matmul(x, shape_target(:size(x, 2))))
      call edge_frame(x, s, opposite, tangent, outward, stretch, bend)
      rate = outward/max(dot_product(outward, normal), least_facing)
   end subroutine look_across

   pure subroutine add_terms(sums, owner, nodes, coefficient)
      type(sums_type), intent(inout) :: sums
      integer, intent(in) :: owner, nodes(:)
      real(wp), intent(in) :: coefficient(:, :)
      integer :: n

      n = size(nodes)
      if (sums%n + n > size(sums%owner)) call make_room(sums)
      sums%owner(sums%n + 1:sums%n + n) = owner
      sums%node(sums%n + 1:sums%n + n) = nodes
      sums%coefficient(:, sums%n + 1:sums%n + n) = coefficient(:, :n)
      sums%n = sums%n + n
   end subroutine add_terms

   pure subroutine make_room(sums)
      type(sums_type), intent(inout) :: sums
      integer, allocatable :: owner(:), node(:)
      real(wp), allocatable :: coefficient(:, :)

      allocate (owner(2*size(sums%owner)), node(2*size(sums%owner)))
      allocate (coefficient(2, 2*size(sums%owner)))
      owner(:sums%n) = sums%owner(:sums%n)
      node(:sums%n) = sums%node(:sums%n)
      coefficient(:, :sums%n) = sums%coefficient(:, :sums%n)
      call move_alloc(owner, sums%owner)
      call move_alloc(node, sums%node)
      call move_alloc(coefficient, sums%coefficient)
   end subroutine make_room

   !> Sorts the terms by rows, adds up those of the same node, divides by the weights.
   pure subroutine gather_rows(slave, sums, reach, rows)
      type(target_type), intent(in) :: slave
      type(sums_type), intent(in) :: sums
      real(wp), intent(in) :: reach
      type(weighted_rows_type), intent(out) :: rows
      integer, allocatable :: first(:), order(:), row(:)
      integer :: i, j, n, n_terms

      n = size(slave%nodes)
      call sort_by_owner(sums, n, first, order)
      allocate (row(0))
      row = pack([(i, i=1, n)], sums%weight >= least_cover*sums%whole .and. sums%weight > 0.0_wp &
            .and. sums%gap <= reach*sums%weight)
      rows%n = size(row)
      rows%slave_node = slave%nodes(row)
      rows%weight = sums%weight(row)
      rows%gap = sums%gap(row)/sums%weight(row)
      rows%normal = sums%normal(:, row)
      allocate (rows%first(rows%n + 1), rows%node(sums%n), rows%normal_coefficient(2, sums%n))
      n_terms = 0
      do i = 1, rows%n
         rows%first(i) = n_terms + 1
         rows%normal(:, i) = rows%normal(:, i)/norm2(rows%normal(:, i))
         do j = first(row(i)) + 1, first(row(i) + 1)
            call merge_term(sums%node(order(j)), sums%coefficient(:, order(j))/rows%weight(i), &
                  rows, rows%first(i), n_terms)
         end do
      end do
      rows%first(rows%n + 1) = n_terms + 1
      rows%node = rows%node(:n_terms)
      rows%normal_coefficient = rows%normal_coefficient(:, :n_terms)
      allocate (rows%tangent_coefficient(2, n_terms))
      rows%tangent_coefficient(1, :) = -rows%normal_coefficient(2, :)
      rows%tangent_coefficient(2, :) = rows%normal_coefficient(1, :)
   end subroutine gather_rows

   !> Counting sort: terms order(first(i) + 1:first(i + 1)) belong to node i.
   pure subroutine sort_by_owner(sums, n, first, order)
      type(sums_type), intent(in) :: sums
      integer, intent(in) :: n
      integer, allocatable, intent(out) :: first(:), order(:)
      integer :: i

      allocate (first(n + 1), source=0)
      allocate (order(sums%n))
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

   pure subroutine merge_term(node, coefficient, rows, first, n_terms)
      integer, intent(in) :: node
      real(wp), intent(in) :: coefficient(2)
      type(weighted_rows_type), intent(inout) :: rows
      integer, intent(in) :: first
      integer, intent(inout) :: n_terms
      integer :: i

      do i = first, n_terms
         if (rows%node(i) /= node) cycle
         rows%normal_coefficient(:, i) = rows%normal_coefficient(:, i) + coefficient
         return
      end do
      n_terms = n_terms + 1
      rows%node(n_terms) = node
      rows%normal_coefficient(:, n_terms) = coefficient
   end subroutine merge_term

end module weighted_rows
