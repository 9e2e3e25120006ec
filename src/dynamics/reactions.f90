!> Forces that hold the prescribed freedoms.
module reactions
   use kinds, only: wp
   use structure, only: inertia_force
   use motion_state, only: state_type
   use equation_of_motion, only: system_type, force_balance
   implicit none
   private

   public :: reaction_forces

contains

   !> R = M a + C v + S(d) - f - contact at prescribed freedoms, zero elsewhere; what dependent
   !> freedoms need comes through the masters they follow.
   function reaction_forces(system, state, contact) result(reaction)
      type(system_type), intent(in) :: system
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: contact(:)         !! (n_freedoms) contact forces
      real(wp) :: reaction(size(contact))
      integer :: c, i

      reaction = -force_balance(system, state) - contact
      if (.not. system%static) reaction = reaction + inertia_force(system%structure, state%a)
      associate (map => system%structure%map)
         do c = 1, size(map%dependent)
            do i = map%master_first(c), map%master_first(c + 1) - 1
               reaction(map%master(i)) = reaction(map%master(i)) &
                     + map%master_coefficient(i)*reaction(map%dependent(c))
            end do
         end do
         reaction = merge(reaction, 0.0_wp, map%prescribed)
      end associate
   end function reaction_forces

end module reactions
