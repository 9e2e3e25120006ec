!> Elements with one deformation: elongation = b . d, force on the freedoms = b F.
module axial_kinematics
   use kinds, only: wp
   implicit none
   private

   public :: one_freedom, two_freedoms, line_of_action, rank_one, elongations, spread

   !> A direction cosine below this counts as zero: the line lies along the other axes.
   real(wp), parameter :: direction_tolerance = 1.0e-12_wp

contains

   !> b of an element that acts on direction dof of its only node.
   pure function one_freedom(dof) result(b)
      integer, intent(in) :: dof
      real(wp) :: b(3)

      b = 0.0_wp
      b(dof) = 1.0_wp
   end function one_freedom

   !> b of the relative displacement: direction dof(1) at node 1 less direction dof(2) at node 2.
   pure function two_freedoms(dof) result(b)
      integer, intent(in) :: dof(2)
      real(wp) :: b(6)

      b = 0.0_wp
      b(dof(1)) = 1.0_wp
      b(3 + dof(2)) = -1.0_wp
   end function two_freedoms

   !> b of the elongation along the line from node 1 to node 2, and its length (0: no line).
   pure subroutine line_of_action(x, b, length)
      real(wp), intent(in) :: x(3, 2)      !! coordinates of the two nodes
      real(wp), intent(out) :: b(6)
      real(wp), intent(out) :: length
      real(wp) :: direction(3)

      b = 0.0_wp
      length = norm2(x(:, 2) - x(:, 1))
      if (.not. length > 0.0_wp) return
      direction = (x(:, 2) - x(:, 1))/length
      where (abs(direction) < direction_tolerance) direction = 0.0_wp
      b(1:3) = -direction
      b(4:6) = direction
   end subroutine line_of_action

   !> factor b bt.
   pure subroutine rank_one(factor, b, matrix)
      real(wp), intent(in) :: factor
      real(wp), intent(in) :: b(:)             !! (n)
      real(wp), intent(out) :: matrix(:, :)    !! (n, n)
      integer :: j

      do j = 1, size(b)
         matrix(:, j) = factor*b*b(j)
      end do
   end subroutine rank_one

   !> b . d of every element.
   pure function elongations(b, d) result(elongation)
      real(wp), intent(in) :: b(:, :), d(:, :)   !! (3 n_nodes, n_elements)
      real(wp) :: elongation(size(b, 2))

      elongation = sum(b*d, dim=1)
   end function elongations

   !> b F of every element.
   pure subroutine spread(b, axial_force, force)
      real(wp), intent(in) :: b(:, :)            !! (3 n_nodes, n_elements)
      real(wp), intent(in) :: axial_force(:)     !! (n_elements)
      real(wp), intent(out) :: force(:, :)       !! (3 n_nodes, n_elements)
      integer :: e

      do e = 1, size(axial_force)
         force(:, e) = b(:, e)*axial_force(e)
      end do
   end subroutine spread

end module axial_kinematics
