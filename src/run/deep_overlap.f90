!> Contact nodes that lie so deep inside their partner's body that contact, which looks for sides
!> near a node, does not see the overlap.
module deep_overlap
   use kinds, only: wp
   use disjoint_sets, only: join, top_of
   use model, only: model_type
   use element_sides, only: count_sides, side_nodes
   use edge_bins, only: edge_bins_type, find_in_box, new_bins
   use contact_pairs, only: contact_row_type, row_surface
   use segment_projection, only: closest_on_edge, edge_frame
   implicit none
   private

   public :: find_deep_nodes

   !> Nodes closer to a side than this part of its length are left to contact itself.
   real(wp), parameter :: seen_share = 0.4_wp
   !> Sine of the angle below which a point is on a line.
   real(wp), parameter :: on_side = 1.0e-9_wp
   real(wp), parameter :: pi = acos(-1.0_wp)

contains

   !> Marks the rows whose node is inside the body that the sides of its partner belong to: seen
   !> from there, the corners of the elements around it go once round. An element that has the node
   !> does not count.
   subroutine find_deep_nodes(model, rows, x, deep)
      type(model_type), intent(in) :: model
      type(contact_row_type), intent(in) :: rows(:)
      real(wp), intent(in) :: x(:, :)            !! (3, n_nodes) at the start
      logical, intent(out) :: deep(:)            !! (n_rows)
      type(edge_bins_type) :: bins
      integer :: body(model%elements%n), found(model%elements%n), n_found, i, k, surface
      logical :: partner(model%elements%n)
      real(wp) :: low(2, model%elements%n), high(2, model%elements%n), turn

      deep = .false.
      if (.not. any(rows%kind == row_surface)) return
      call find_bodies(model, body)
      call find_boxes(model, x, low, high)
      call new_bins(bins, low, high, 0.0_wp)
      surface = 0
      do i = 1, size(rows)
         if (rows(i)%kind /= row_surface) cycle
         if (surface /= master_of(model, rows(i))) then
            surface = master_of(model, rows(i))
            call mark_bodies(body, model%surfaces(surface)%edge_element, partner)
         end if
         associate (point => x(:2, rows(i)%node))
            call find_in_box(bins, point, point, 0.0_wp, found, n_found)
            turn = 0.0_wp
            do k = 1, n_found
               if (.not. partner(found(k))) cycle
               turn = turn + turn_around(model, x, found(k), rows(i)%node)
            end do
            if (turn < 1.5_wp*pi) cycle
            deep(i) = is_far(model%surfaces(surface)%edges, x, point)
         end associate
      end do
   end subroutine find_deep_nodes

   pure function master_of(model, row) result(surface)
      type(model_type), intent(in) :: model
      type(contact_row_type), intent(in) :: row
      integer :: surface

      surface = model%pairs(row%model_pair)%target
      if (row%pass == 2) surface = model%pairs(row%model_pair)%contactor
   end function master_of

   !> Numbers of the bodies that elements belong to: those with a node in common are of one.
   pure subroutine find_bodies(model, body)
      type(model_type), intent(in) :: model
      integer, intent(out) :: body(:)            !! (n_elements)
      integer :: root(model%nodes%n), e, i

      root = [(i, i=1, size(root))]
      do e = 1, model%elements%n
         do i = model%elements%first(e) + 1, model%elements%first(e + 1) - 1
            call join(root, model%elements%nodes(i - 1), model%elements%nodes(i))
         end do
      end do
      do e = 1, model%elements%n
         body(e) = top_of(root, model%elements%nodes(model%elements%first(e)))
      end do
   end subroutine find_bodies

   pure subroutine mark_bodies(body, elements, marked)
      integer, intent(in) :: body(:), elements(:)
      logical, intent(out) :: marked(:)          !! (n_elements)
      logical :: wanted(maxval(body))

      wanted = .false.
      wanted(body(elements)) = .true.
      marked = wanted(body)
   end subroutine mark_bodies

   !> Boxes around the elements; those without sides have theirs at one of their nodes.
   pure subroutine find_boxes(model, x, low, high)
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: x(:, :)
      real(wp), intent(out) :: low(:, :), high(:, :)   !! (2, n_elements)
      integer :: e, side, nodes(3)

      do e = 1, model%elements%n
         low(:, e) = x(:2, model%elements%nodes(model%elements%first(e)))
         high(:, e) = low(:, e)
         do side = 1, count_sides(model%elements%kind(e))
            nodes = side_nodes(model%elements, e, side)
            low(:, e) = min(low(:, e), x(:2, nodes(1)), x(:2, max(nodes(1), nodes(3))))
            high(:, e) = max(high(:, e), x(:2, nodes(1)), x(:2, max(nodes(1), nodes(3))))
         end do
      end do
   end subroutine find_boxes

   !> The angle by which the sides of an element, straight between their nodes, go round a node:
   !> 2 pi inside, half of it on a side, the angle between the sides at a corner, 0 outside.
   pure function turn_around(model, x, e, node) result(turn)
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: e, node
      real(wp) :: turn
      integer :: side, nodes(3)

      turn = 0.0_wp
      do side = 1, count_sides(model%elements%kind(e))
         nodes = side_nodes(model%elements, e, side)
         if (any(nodes == node)) then
            turn = 0.0_wp
            return
         end if
         if (nodes(3) == 0) nodes(3) = nodes(2)
         turn = turn + angle_between(x(:2, nodes(1)) - x(:2, node), x(:2, nodes(3)) - x(:2, node)) &
               + angle_between(x(:2, nodes(3)) - x(:2, node), x(:2, nodes(2)) - x(:2, node))
      end do
   end function turn_around

   !> From a to b, in (-pi, pi); zero if one of them is, or for a point between both on a line.
   pure function angle_between(a, b) result(angle)
      real(wp), intent(in) :: a(2), b(2)
      real(wp) :: angle
      real(wp) :: across, along

      angle = 0.0_wp
      across = a(1)*b(2) - a(2)*b(1)
      along = dot_product(a, b)
      if (abs(across) <= on_side*norm2(a)*norm2(b) .and. along <= 0.0_wp) return
      angle = atan2(across, along)
   end function angle_between

   !> Whether a point is far from all sides of a surface.
   pure function is_far(edges, x, point) result(far)
      integer, intent(in) :: edges(:, :)         !! (3, n)
      real(wp), intent(in) :: x(:, :)
      real(wp), intent(in) :: point(2)
      logical :: far
      integer :: e, n
      real(wp) :: s, s_free, place(2), tangent(2), normal(2), stretch, bend

      far = .false.
      do e = 1, size(edges, 2)
         n = merge(3, 2, edges(3, e) > 0)
         call closest_on_edge(x(:2, edges(:n, e)), point, s, s_free)
         call edge_frame(x(:2, edges(:n, e)), s, place, tangent, normal, stretch, bend)
         if (norm2(point - place) < 2.0_wp*seen_share*stretch) return
      end do
      far = .true.
   end function is_far

end module deep_overlap
