!> T2D2 and T3D2: straight two-node bar, linear elastic, small displacements.
module truss
   use kinds, only: wp
   use element_interface, only: element_type, recovered_stress, recovered_strain, recovered_energy
   use axial_kinematics, only: rank_one, elongations, spread
   implicit none
   private

   public :: truss_type, new_truss, truss_material_type

   !> Properties that the trusses of a group share.
   type :: truss_material_type
      real(wp) :: young = 0.0_wp
      real(wp) :: density = 0.0_wp
      real(wp) :: area = 0.0_wp
      real(wp) :: damping_alpha = 0.0_wp    !! C = alpha M + beta K
      real(wp) :: damping_beta = 0.0_wp
   end type truss_material_type

   !> Trusses of one section.
   type, extends(element_type) :: truss_type
      type(truss_material_type) :: material
      real(wp), allocatable :: b(:, :)      !! (6, n_elements) elongation = b . d
      real(wp), allocatable :: length(:)    !! (n_elements)
      logical :: lumped = .true.            !! mass used in Rayleigh damping
   contains
      procedure :: uses
      procedure :: stiffness
      procedure :: damping
      procedure :: mass
      procedure :: internal_force
      procedure :: strain_energy
      procedure :: recover
   end type truss_type

contains

   !> A group of trusses.
   pure subroutine new_truss(self, b, length, material, lumped)
      type(truss_type), intent(out) :: self
      real(wp), intent(in) :: b(:, :)       !! (6, n_elements)
      real(wp), intent(in) :: length(:)     !! (n_elements), positive
      type(truss_material_type), intent(in) :: material
      logical, intent(in) :: lumped         !! the group's mass matrix

      self%n_nodes = 2
      self%n_elements = size(length)
      self%n_points = 1
      self%n_stresses = 1
      self%b = b
      self%length = length
      self%material = material
      self%lumped = lumped
   end subroutine new_truss

   !> The freedoms with a share in the elongation: a truss along x needs x alone.
   pure function uses(self, e) result(used)
      class(truss_type), intent(in) :: self
      integer, intent(in) :: e
      logical :: used(3*self%n_nodes)

      used = abs(self%b(:, e)) > 0.0_wp
   end function uses

   !> E A / L b bt.
   pure subroutine stiffness(self, e, d, history, matrix)
      class(truss_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: d(:), history(:)
      real(wp), intent(out) :: matrix(:, :)

      call rank_one(self%material%young*self%material%area/self%length(e), self%b(:, e), matrix)
   end subroutine stiffness

   !> Rayleigh damping alpha M + beta K.
   pure subroutine damping(self, e, matrix)
      class(truss_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(out) :: matrix(:, :)
      real(wp) :: m(6, 6)

      call rank_one(self%material%damping_beta*self%material%young*self%material%area &
            /self%length(e), self%b(:, e), matrix)
      call self%mass(e, self%lumped, m)
      matrix = matrix + self%material%damping_alpha*m
   end subroutine damping

   !> rho A L, in every direction: half at each node, or (1/3, 1/6) consistent.
   pure subroutine mass(self, e, lumped, matrix)
      class(truss_type), intent(in) :: self
      integer, intent(in) :: e
      logical, intent(in) :: lumped
      real(wp), intent(out) :: matrix(:, :)
      real(wp) :: total, own, other
      integer :: i

      total = self%material%density*self%material%area*self%length(e)
      own = merge(total/2.0_wp, total/3.0_wp, lumped)
      other = merge(0.0_wp, total/6.0_wp, lumped)
      matrix = 0.0_wp
      do i = 1, 3
         matrix(i, i) = own
         matrix(i + 3, i + 3) = own
         matrix(i, i + 3) = other
         matrix(i + 3, i) = other
      end do
   end subroutine mass

   pure subroutine internal_force(self, d, history, force, updated)
      class(truss_type), intent(in) :: self
      real(wp), intent(in) :: d(:, :), history(:, :)
      real(wp), intent(out) :: force(:, :), updated(:, :)

      updated = history
      call spread(self%b, self%material%young*self%material%area*elongations(self%b, d) &
            /self%length, force)
   end subroutine internal_force

   pure function strain_energy(self, d, history) result(energy)
      class(truss_type), intent(in) :: self
      real(wp), intent(in) :: d(:, :), history(:, :)
      real(wp) :: energy

      energy = self%material%young*self%material%area &
            *sum(elongations(self%b, d)**2/self%length)/2.0_wp
   end function strain_energy

   !> Axial stress E strain, strain, strain energy density; axial is direction 1.
   pure subroutine recover(self, e, d, history, values)
      class(truss_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(in) :: d(:), history(:)
      real(wp), intent(out) :: values(:, :)
      real(wp) :: strain

      strain = dot_product(self%b(:, e), d)/self%length(e)
      values = 0.0_wp
      values(recovered_stress, 1) = self%material%young*strain
      values(recovered_strain, 1) = strain
      values(recovered_energy, 1) = self%material%young*strain**2/2.0_wp
   end subroutine recover

end module truss
