!> What impulses at contact rows do to the account of energies, and the error where there are none.
module impulse_account
   use kinds, only: wp
   use errors, only: error_type, new_error, status_numerical
   use text, only: to_text
   use energy_ledger, only: record_impact, record_friction
   use reactions, only: impulse_reactions
   use constraint_rows, only: slip_rates, wall_rates, contact_forces
   use impact_scene, only: scene_type, contact_motion_type
   use row_compliance, only: compliance_type
   implicit none
   private

   public :: book_impulse, book_friction, book_reactions, dependent_impulses

contains

   !> Energy: the bodies gain p . (r- + r+)/2 less what the wall's own motion does; with the gap
   !> rate
   !> r = G v + c', the wall gives -p . c'.
   subroutine book_impulse(scene, motion, impulse, before, after)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(in) :: impulse(:), before(:), after(:)   !! (n_rows)

      call record_impact(scene%ledger, -dot_product(impulse, before + after)/2.0_wp, &
            -dot_product(impulse, wall_rates(scene%rows, motion%motion%t)))
   end subroutine book_impulse

   !> Energy that friction impulses take: the bodies lose -p_t . (s- + s+)/2 with the slip rates s.
   subroutine book_friction(scene, motion, impulse, before)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(in) :: impulse(:)         !! (n_rows) along the tangents
      real(wp), intent(in) :: before(:)          !! (n_rows) slip rates before
      real(wp) :: work

      if (.not. any(abs(impulse) > 0.0_wp)) return
      work = -dot_product(impulse, before + slip_rates(scene%rows, motion%motion))/2.0_wp
      call record_friction(scene%ledger, work)
      call record_impact(scene%ledger, work, 0.0_wp)
   end subroutine book_friction

   !> Work of what moves prescribed freedoms on while impulses act on them: R . v at their velocity,
   !> which no impulse changes.
   subroutine book_reactions(scene, motion, v_before, impulse, friction)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion    !! after the impulses
      real(wp), intent(in) :: v_before(:)                !! (n_freedoms)
      real(wp), intent(in) :: impulse(:), friction(:)    !! (n_rows) along normals and tangents
      real(wp) :: reaction(size(v_before))

      if (size(scene%system%motions%motions) == 0) return
      reaction = impulse_reactions(scene%system, motion%motion%v - v_before, &
            contact_forces(scene%rows, impulse, friction, size(v_before)))
      call record_impact(scene%ledger, 0.0_wp, dot_product(reaction, motion%motion%v))
   end subroutine book_reactions

   !> Impulses or forces that do not exist, or are not the only ones.
   subroutine dependent_impulses(scene, t, compliance, error)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: t
      type(compliance_type), intent(in) :: compliance   !! of the mass
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: most_named = 5
      character(len=:), allocatable :: nodes
      integer :: i

      nodes = ''
      do i = 1, min(compliance%n, most_named)
         if (i > 1) nodes = nodes//', '
         nodes = nodes//to_text(scene%rows%node_id(compliance%rows(i)))
      end do
      if (compliance%n > most_named) nodes = nodes//', ...'
      call new_error(error, status_numerical, &
            'contact at time '//to_text(t)//' has no answer: of the contact rows of node '// &
            nodes//' one has no mass behind it, or they depend on each other'//new_line('a')// &
            '  cure: give every contact node a mass, let none touch the same wall twice, '// &
            'and hold none along the normal'//both_passes(scene))
   end subroutine dependent_impulses

   !> What else to do where rows of both passes of a pair with friction are there.
   function both_passes(scene) result(text)
      type(scene_type), intent(in) :: scene
      character(len=:), allocatable :: text

      text = ''
      if (any(scene%rows%friction > 0.0_wp) .and. scene%rows%moving) text = '; with friction and ' &
            //'PASSES=2, take one pass, a smaller increment or METHOD=LAGRANGE'
   end function both_passes

end module impulse_account
