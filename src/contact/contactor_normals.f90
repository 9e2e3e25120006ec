!> Outward normals at the nodes of a surface.
module contactor_normals
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: find_normals

contains

   !> Mean outward unit normals of nodes from the edges around them; zero for nodes without any.
   pure subroutine find_normals(edges, nodes, x, normals)
      integer, intent(in) :: edges(:, :)         !! (3, n) nodes, bodies on the left
      integer, intent(in) :: nodes(:)            !! ascending, all that the edges have
      real(wp), intent(in) :: x(:, :)            !! (3, n_nodes) positions
      real(wp), allocatable, intent(out) :: normals(:, :)   !! (2, size(nodes))
      real(wp) :: along(2)
      integer :: e, i, k, status

      allocate (normals(2, size(nodes)), stat=status)
      call check_allocation(status)
      normals = 0.0_wp
      do e = 1, size(edges, 2)
         along = x(:2, edges(2, e)) - x(:2, edges(1, e))
         do i = 1, 3
            if (edges(i, e) == 0) cycle
            k = place_of(nodes, edges(i, e))
            normals(:, k) = normals(:, k) + [along(2), -along(1)]/norm2(along)
         end do
      end do
      do k = 1, size(normals, 2)
         if (norm2(normals(:, k)) > 0.0_wp) normals(:, k) = normals(:, k)/norm2(normals(:, k))
      end do
   end subroutine find_normals

   !> Where a node stands in an ascending list.
   pure function place_of(nodes, node) result(k)
      integer, intent(in) :: nodes(:), node
      integer :: k
      integer :: low, high

      low = 1
      high = size(nodes)
      do while (low < high)
         k = (low + high)/2
         if (nodes(k) < node) then
            low = k + 1
         else
            high = k
         end if
      end do
      k = low
   end function place_of

end module contactor_normals
