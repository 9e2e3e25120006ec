!> Forces that hold the prescribed freedoms.
module reactions
   use kinds, only: wp
   use structure, only: inertia_force
   use motion_state, only: state_type
   use equation_of_motion, only: system_type, force_balance
   implicit none
   private

   public :: reaction_forces, resisting_reactions, impulse_reactions, reactions_at

contains

   !> R = M a + C v + S(d) - f - contact at prescribed freedoms, zero elsewhere; what dependent
   !> freedoms need comes through the masters they follow.
   function reaction_forces(system, state, contact) result(reaction)
      type(system_type), intent(inout) :: system
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: contact(:)         !! (n_freedoms) contact forces
      real(wp) :: reaction(size(contact))

      reaction = -force_balance(system, state) - contact
      if (.not. system%static) reaction = reaction + inertia_force(system%structure, state%a)
      call keep_prescribed(system, reaction)
   end function reaction_forces

   !> The same without the inertia.
   function resisting_reactions(system, state, contact) result(reaction)
      type(system_type), intent(inout) :: system
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: contact(:)         !! (n_freedoms) contact forces
      real(wp) :: reaction(size(contact))

      reaction = -force_balance(system, state) - contact
      call keep_prescribed(system, reaction)
   end function resisting_reactions

   !> The same of an impact: M (v+ - v-) - contact impulses at prescribed freedoms, zero elsewhere.
   function impulse_reactions(system, change, contact) result(reaction)
      type(system_type), intent(in) :: system
      real(wp), intent(in) :: change(:)          !! (n_freedoms) v+ - v-
      real(wp), intent(in) :: contact(:)         !! (n_freedoms) contact impulses
      real(wp) :: reaction(size(contact))

      reaction = inertia_force(system%structure, change) - contact
      call keep_prescribed(system, reaction)
   end function impulse_reactions

   !> S(d) + C v - f - contact at given freedoms, zero elsewhere: what would hold them.
   function reactions_at(system, state, contact, held) result(reaction)
      type(system_type), intent(inout) :: system
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: contact(:)         !! (n_freedoms) contact forces
      logical, intent(in) :: held(:)             !! (n_freedoms)
      real(wp) :: reaction(size(contact))

      reaction = -force_balance(system, state) - contact
      call gather_reactions(system, reaction)
      where (.not. held) reaction = 0.0_wp
   end function reactions_at

   !> What dependent freedoms need goes to their masters; then only prescribed freedoms have any.
   pure subroutine keep_prescribed(system, reaction)
      type(system_type), intent(in) :: system
      real(wp), intent(inout) :: reaction(:)     !! (n_freedoms)

      call gather_reactions(system, reaction)
      reaction = merge(reaction, 0.0_wp, system%structure%map%prescribed)
   end subroutine keep_prescribed

   pure subroutine gather_reactions(system, reaction)
      type(system_type), intent(in) :: system
      real(wp), intent(inout) :: reaction(:)     !! (n_freedoms)
      integer :: c, i

      associate (map => system%structure%map)
         do c = 1, size(map%dependent)
            do i = map%master_first(c), map%master_first(c + 1) - 1
               reaction(map%master(i)) = reaction(map%master(i)) &
                     + map%master_coefficient(i)*reaction(map%dependent(c))
            end do
         end do
      end associate
   end subroutine gather_reactions

end module reactions
