!> Sides of plane and axisymmetric elements. Side i goes from corner i to the next corner, so that
!> the body lies on the left of who walks along it. One number stands for a side of an element.
module element_sides
   use memory_shortage, only: check_allocation
   use mesh, only: element_table_type, is_solid_kind, solid_topology
   implicit none
   private

   public :: side_finder_type, new_side_finder, is_built, find_sides
   public :: most_sides, count_sides, side_nodes, side_key, key_element, key_side

   integer, parameter :: most_sides = 4

   !> Of tri3, quad4, tri6 and quad8, in the order of their numbers.
   integer, parameter :: corners_of(4) = [3, 4, 3, 4]
   logical, parameter :: has_middle_nodes(4) = [.false., .false., .true., .true.]

   !> The sides of all solids, grouped by the lower of the indices of their ends.
   type :: side_finder_type
      private
      integer, allocatable :: first(:)   !! (n_nodes+1) sides of node i: keys(first(i):first(i+1)-1)
      integer, allocatable :: keys(:)
   end type side_finder_type

contains

   !> 3 or 4; 0 for an element that is no solid.
   pure elemental function count_sides(kind) result(n)
      integer, intent(in) :: kind
      integer :: n

      n = 0
      if (is_solid_kind(kind)) n = corners_of(solid_topology(kind))
   end function count_sides

   !> Nodes of a side: its ends, then the middle node or 0.
   pure function side_nodes(elements, e, side) result(nodes)
      type(element_table_type), intent(in) :: elements
      integer, intent(in) :: e, side
      integer :: nodes(3)
      integer :: offset, n_corners

      offset = elements%first(e) - 1
      n_corners = count_sides(elements%kind(e))
      nodes(1) = elements%nodes(offset + side)
      nodes(2) = elements%nodes(offset + modulo(side, n_corners) + 1)
      nodes(3) = 0
      if (.not. has_middle_nodes(solid_topology(elements%kind(e)))) return
      nodes(3) = elements%nodes(offset + n_corners + side)
   end function side_nodes

   !> The number of a side of an element.
   pure elemental function side_key(e, side) result(key)
      integer, intent(in) :: e, side
      integer :: key

      key = most_sides*(e - 1) + side
   end function side_key

   !> The element whose side has this number.
   pure elemental function key_element(key) result(e)
      integer, intent(in) :: key
      integer :: e

      e = (key - 1)/most_sides + 1
   end function key_element

   !> Which side of its element has this number.
   pure elemental function key_side(key) result(side)
      integer, intent(in) :: key
      integer :: side

      side = modulo(key - 1, most_sides) + 1
   end function key_side

   !> Gathers the sides of all solids, by a counting sort.
   pure subroutine new_side_finder(self, elements, n_nodes)
      type(side_finder_type), intent(out) :: self
      type(element_table_type), intent(in) :: elements
      integer, intent(in) :: n_nodes
      integer, allocatable :: next(:)
      integer :: e, side, node, nodes(3), status

      allocate (next(n_nodes + 1), source=0, stat=status)
      call check_allocation(status)
      do e = 1, elements%n
         do side = 1, count_sides(elements%kind(e))
            nodes = side_nodes(elements, e, side)
            node = minval(nodes(:2))
            next(node) = next(node) + 1
         end do
      end do
      allocate (self%first(n_nodes + 1), self%keys(sum(next)), stat=status)
      call check_allocation(status)
      self%first(1) = 1
      do node = 1, n_nodes
         self%first(node + 1) = self%first(node) + next(node)
      end do
      next = self%first
      do e = 1, elements%n
         do side = 1, count_sides(elements%kind(e))
            nodes = side_nodes(elements, e, side)
            node = minval(nodes(:2))
            self%keys(next(node)) = side_key(e, side)
            next(node) = next(node) + 1
         end do
      end do
   end subroutine new_side_finder

   !> Whether the sides have been gathered.
   pure function is_built(self) result(built)
      type(side_finder_type), intent(in) :: self
      logical :: built

      built = allocated(self%first)
   end function is_built

   !> The numbers of all sides between two nodes, whatever their direction, ascending by element.
   !> Sides whose middle nodes differ are not the same; one without a middle node fits any.
   pure subroutine find_sides(self, elements, nodes, keys)
      type(side_finder_type), intent(in) :: self
      type(element_table_type), intent(in) :: elements
      integer, intent(in) :: nodes(3)                !! the ends, the middle node or 0
      integer, allocatable, intent(out) :: keys(:)
      integer :: i, n, low, side(3), status

      low = minval(nodes(:2))
      allocate (keys(self%first(low + 1) - self%first(low)), stat=status)
      call check_allocation(status)
      n = 0
      do i = self%first(low), self%first(low + 1) - 1
         side = side_nodes(elements, key_element(self%keys(i)), key_side(self%keys(i)))
         if (maxval(side(:2)) /= maxval(nodes(:2))) cycle
         if (side(3) /= nodes(3) .and. side(3) > 0 .and. nodes(3) > 0) cycle
         n = n + 1
         keys(n) = self%keys(i)
      end do
      keys = keys(:n)
   end subroutine find_sides

end module element_sides
