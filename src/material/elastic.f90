!> Isotropic linear elasticity in a plane. Components are 11 22 33 12 with engineering shear strain.
module elastic
   use kinds, only: wp
   implicit none
   private

   public :: plane_strain, plane_stress, axisymmetric, elastic_matrix, thickness_strain

   !> Numbered as the element kinds of the deck number them. Axisymmetric: 33 is the hoop.
   integer, parameter :: plane_strain = 1, plane_stress = 2, axisymmetric = 3

contains

   !> Stress over strain, (4, 4). In plane stress row and column 33 are zero: 33 is condensed.
   pure function elastic_matrix(young, poisson, plane) result(matrix)
      real(wp), intent(in) :: young
      real(wp), intent(in) :: poisson           !! above -1, below 1/2
      integer, intent(in) :: plane              !! plane_strain, plane_stress or axisymmetric
      real(wp) :: matrix(4, 4)
      real(wp) :: lambda, shear
      integer :: i, n

      shear = young/(2.0_wp*(1.0_wp + poisson))
      if (plane == plane_stress) then
         lambda = young*poisson/(1.0_wp - poisson**2)
         n = 2
      else
         lambda = young*poisson/((1.0_wp + poisson)*(1.0_wp - 2.0_wp*poisson))
         n = 3
      end if
      matrix = 0.0_wp
      matrix(:n, :n) = lambda
      do i = 1, n
         matrix(i, i) = lambda + 2.0_wp*shear
      end do
      matrix(4, 4) = shear
   end function elastic_matrix

   !> Elastic strain 33 without stress 33.
   pure function thickness_strain(poisson, strain) result(normal)
      real(wp), intent(in) :: poisson
      real(wp), intent(in) :: strain(4)         !! elastic; 33 is not looked at
      real(wp) :: normal

      normal = -poisson/(1.0_wp - poisson)*(strain(1) + strain(2))
   end function thickness_strain

end module elastic
