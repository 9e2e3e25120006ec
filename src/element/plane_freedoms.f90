!> Directions 1 and 2 of element vectors and matrices that have three freedoms a node.
module plane_freedoms
   use kinds, only: wp
   implicit none
   private

   public :: in_plane, on_freedoms, add_in_direction, spread_in_plane, outer

contains

   !> Displacements in the plane, (2, n_nodes), from all of them.
   pure function in_plane(d) result(u)
      real(wp), intent(in) :: d(:)
      real(wp) :: u(2, size(d)/3)

      u(1, :) = d(1::3)
      u(2, :) = d(2::3)
   end function in_plane

   !> Forces in the plane, (2, n_nodes), as forces on all freedoms.
   pure function on_freedoms(f) result(force)
      real(wp), intent(in) :: f(:, :)
      real(wp) :: force(3*size(f, 2))

      force(1::3) = f(1, :)
      force(2::3) = f(2, :)
      force(3::3) = 0.0_wp
   end function on_freedoms

   !> Adds a matrix over nodes to the freedoms of one direction.
   pure subroutine add_in_direction(direction, part, matrix)
      integer, intent(in) :: direction
      real(wp), intent(in) :: part(:, :)         !! (n_nodes, n_nodes)
      real(wp), intent(inout) :: matrix(:, :)    !! (3 n_nodes, 3 n_nodes)

      matrix(direction::3, direction::3) = matrix(direction::3, direction::3) + part
   end subroutine add_in_direction

   !> A matrix on two freedoms a node as one on three.
   pure subroutine spread_in_plane(part, matrix)
      real(wp), intent(in) :: part(:, :)         !! (2 n_nodes, 2 n_nodes)
      real(wp), intent(out) :: matrix(:, :)      !! (3 n_nodes, 3 n_nodes)
      integer :: i, j

      matrix = 0.0_wp
      do j = 1, size(part, 2)/2
         do i = 1, size(part, 1)/2
            matrix(3*i - 2:3*i - 1, 3*j - 2:3*j - 1) = part(2*i - 1:2*i, 2*j - 1:2*j)
         end do
      end do
   end subroutine spread_in_plane

   !> v vt.
   pure function outer(v) result(matrix)
      real(wp), intent(in) :: v(:)
      real(wp) :: matrix(size(v), size(v))
      integer :: i

      do i = 1, size(v)
         matrix(:, i) = v*v(i)
      end do
   end function outer

end module plane_freedoms
