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

   !> R = M a + C v + S(d) - f - contact at prescribed freedoms, zero elsewhere.
   function reaction_forces(system, state, contact) result(reaction)
      type(system_type), intent(in) :: system
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: contact(:)         !! (n_freedoms) contact forces
      real(wp) :: reaction(size(contact))

      reaction = -force_balance(system, state) - contact
      if (.not. system%static) reaction = reaction + inertia_force(system%structure, state%a)
      reaction = merge(reaction, 0.0_wp, system%structure%map%prescribed)
   end function reaction_forces

end module reactions
