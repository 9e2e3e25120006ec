!> Energies of a structure and of its groups.
module structure_energy
   use kinds, only: wp
   use element_groups, only: group_type, group_mass
   use structure, only: structure_type, gather, group_history
   implicit none
   private

   public :: strain_energy, group_strain_energy, group_kinetic_energy, plastic_work

contains

   !> Strain energy of all groups.
   pure function strain_energy(self, d, history) result(energy)
      type(structure_type), intent(in) :: self
      real(wp), intent(in) :: d(:)               !! (n_freedoms)
      real(wp), intent(in) :: history(:)         !! (n_history) at d
      real(wp) :: energy
      integer :: g

      energy = 0.0_wp
      do g = 1, size(self%groups)
         energy = energy + group_strain_energy(self%groups(g), d, history)
      end do
   end function strain_energy

   !> Strain energy of one group.
   pure function group_strain_energy(group, d, history) result(energy)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: d(:)               !! (n_freedoms)
      real(wp), intent(in) :: history(:)         !! (n_history) of all elements, at d
      real(wp) :: energy
      real(wp) :: local(size(group%lm, 1), size(group%lm, 2))

      call gather(group, d, local)
      energy = group%element%strain_energy(local, group_history(group, history))
   end function group_strain_energy

   !> Kinetic energy of the mass of one group; of redistributed mass, what its elements now have.
   pure function group_kinetic_energy(group, v) result(energy)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: v(:)               !! (n_freedoms)
      real(wp) :: energy
      real(wp) :: local(size(group%lm, 1), size(group%lm, 2))
      real(wp) :: m(size(group%lm, 1), size(group%lm, 1))
      integer :: e

      call gather(group, v, local)
      energy = 0.0_wp
      do e = 1, size(local, 2)
         call group_mass(group, e, group%lumped, m)
         energy = energy + dot_product(local(:, e), matmul(m, local(:, e)))/2.0_wp
      end do
   end function group_kinetic_energy

   !> Energy taken by plastic deformation, all groups.
   pure function plastic_work(self, history) result(work)
      type(structure_type), intent(in) :: self
      real(wp), intent(in) :: history(:)         !! (n_history)
      real(wp) :: work
      integer :: g

      work = 0.0_wp
      do g = 1, size(self%groups)
         work = work + self%groups(g)%element%plastic_work(group_history(self%groups(g), history))
      end do
   end function plastic_work

end module structure_energy
