!> Isotropic damage by strain (Simo and Ju, Strain- and stress-based continuum damage models,
!> International Journal of Solids and Structures 23, 1987), with a damage that tends to a limit. An
!> example of how a material is added.
!>
!>     stress = (1 - D) C strain,   r = largest sqrt(strain : C : strain) so far, at least r0,
!>     D(r) = D1 (1 - r0/r)
!>
!> Under one stress the curve has two slopes, E up to a threshold Y = r0 sqrt(E) and (1 - D1) E
!> beyond; when unloaded it goes straight to the origin. C is elastic.
module damage
   use kinds, only: wp
   use elastic, only: elastic_matrix, elastic_thickness => thickness_strain
   use point_law, only: point_law_type
   implicit none
   private

   public :: damage_type, new_damage

   !> What a point remembers: growth of r beyond r0, energy lost a volume, strain (4).
   integer, parameter :: state_growth = 1
   integer, parameter :: state_lost = 2
   integer, parameter :: state_strain = 3
   integer, parameter :: n_state = 6

   !> The law and its numbers.
   type, extends(point_law_type) :: damage_type
      real(wp) :: elastic(4, 4) = 0.0_wp     !! C
      real(wp) :: poisson = 0.0_wp
      real(wp) :: start = 0.0_wp             !! r0
      real(wp) :: limit = 0.0_wp             !! D1
   contains
      procedure :: update
      procedure :: stress_at
      procedure :: thickness_strain
      procedure :: dissipated
   end type damage_type

contains

   pure subroutine new_damage(self, elasticity, plane, threshold, limit)
      type(damage_type), intent(out) :: self
      real(wp), intent(in) :: elasticity(2)  !! Young's modulus, Poisson's ratio
      integer, intent(in) :: plane           !! plane_strain, plane_stress or axisymmetric
      real(wp), intent(in) :: threshold      !! Y, positive
      real(wp), intent(in) :: limit          !! D1, from 0 to below 1

      self%n_state = n_state
      self%plane = plane
      self%elastic = elastic_matrix(elasticity(1), elasticity(2), plane)
      self%poisson = elasticity(2)
      self%start = threshold/sqrt(elasticity(1))
      self%limit = limit
   end subroutine new_damage

   !> Tangent (1 - D) C - (dD/dr)/r s st, s = C strain, while r grows. The energy lost is such that
   !> with the stored one it adds up to the trapezoid of stress : strain, (D1 - D0) e0 : C : e1/2.
   pure subroutine update(self, strain, state, stress, updated, tangent)
      class(damage_type), intent(in) :: self
      real(wp), intent(in) :: strain(4)
      real(wp), intent(in) :: state(self%n_state)
      real(wp), intent(out) :: stress(4)
      real(wp), intent(out) :: updated(self%n_state)
      real(wp), intent(out), optional :: tangent(4, 4)
      real(wp) :: s(4), r, slope
      integer :: j

      s = matmul(self%elastic, strain)
      r = sqrt(max(0.0_wp, dot_product(strain, s)))
      updated(state_growth) = max(state(state_growth), r - self%start)
      associate (d0 => damage_of(self, state(state_growth)), &
            d1 => damage_of(self, updated(state_growth)))
         stress = (1.0_wp - d1)*s
         updated(state_lost) = state(state_lost) &
               + (d1 - d0)*dot_product(state(state_strain:), s)/2.0_wp
         updated(state_strain:) = strain
         if (.not. present(tangent)) return
         tangent = (1.0_wp - d1)*self%elastic
      end associate
      if (updated(state_growth) <= state(state_growth)) return
      slope = self%limit*self%start/r**3
      do j = 1, 4
         tangent(:, j) = tangent(:, j) - slope*s*s(j)
      end do
   end subroutine update

   pure function stress_at(self, strain, state) result(stress)
      class(damage_type), intent(in) :: self
      real(wp), intent(in) :: strain(4)
      real(wp), intent(in) :: state(self%n_state)
      real(wp) :: stress(4)

      stress = (1.0_wp - damage_of(self, state(state_growth)))*matmul(self%elastic, strain)
   end function stress_at

   pure function thickness_strain(self, strain, state) result(number)
      class(damage_type), intent(in) :: self
      real(wp), intent(in) :: strain(4)
      real(wp), intent(in) :: state(self%n_state)
      real(wp) :: number

      number = elastic_thickness(self%poisson, strain)
   end function thickness_strain

   pure function dissipated(self, state) result(energy)
      class(damage_type), intent(in) :: self
      real(wp), intent(in) :: state(self%n_state)
      real(wp) :: energy

      energy = state(state_lost)
   end function dissipated

   !> D at a growth of r.
   pure function damage_of(self, growth) result(damage)
      class(damage_type), intent(in) :: self
      real(wp), intent(in) :: growth
      real(wp) :: damage

      damage = self%limit*growth/(self%start + growth)
   end function damage_of

end module damage
