!> MASS: inertia at a node, the same in every direction.
module point_mass
   use kinds, only: wp
   use element_interface, only: element_type
   implicit none
   private

   public :: point_mass_type, new_point_mass

   !> Masses m, one node each. It needs no freedom: it gives inertia to those that others name.
   type, extends(element_type) :: point_mass_type
      real(wp), allocatable :: m(:)         !! (n_elements)
   contains
      procedure :: mass
   end type point_mass_type

contains

   !> A group of point masses.
   pure subroutine new_point_mass(self, m)
      type(point_mass_type), intent(out) :: self
      real(wp), intent(in) :: m(:)          !! mass of each element

      self%n_elements = size(m)
      self%n_nodes = 1
      self%m = m
   end subroutine new_point_mass

   !> m on the diagonal, lumped or consistent alike.
   pure subroutine mass(self, e, lumped, matrix)
      class(point_mass_type), intent(in) :: self
      integer, intent(in) :: e
      logical, intent(in) :: lumped
      real(wp), intent(out) :: matrix(:, :)
      integer :: i

      matrix = 0.0_wp
      do i = 1, 3
         matrix(i, i) = self%m(e)
      end do
   end subroutine mass

end module point_mass
