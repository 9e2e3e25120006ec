!> Impulses at the ends of steps (in the manner of Moreau, Unilateral contact and dry friction in
!> finite freedom dynamics, 1988). An example of how an impact method is added.
!>
!> A step is first taken without contact. Rows that overlap at its end get impulses p by
!>
!>     0 <= p,  G v+ + e min(0, G v0) >= 0,  complementary,   v+ = v1 + M^-1 Gt p,
!>
!> with friction by Coulomb's law beside them; v0 is the velocity at the start of the step, v1 the
!> one at its end without contact. A force p/h through the step would also have moved the bodies:
!> d+ = d1 + h/2 M^-1 Gt p. No impact time is looked for, nothing touches for longer than a step,
!> and an overlap of the order of h v is left: first order in h.
module impulse_method
   use kinds, only: wp
   use errors, only: error_type
   use energy_ledger, only: record_impact
   use external_load, only: load_at
   use structure_energy, only: strain_energy
   use constraint_rows, only: row_gaps, row_rates, slip_rates, may_hit
   use impact_scene, only: scene_type, contact_motion_type, event_type, record_event, accept_span, &
         event_impact
   use impact_method, only: impact_method_type
   use row_compliance, only: compliance_type, mass_compliance, pushed, join_rates, split_forces
   use rough_rows, only: solve_rows
   use contact_impulses, only: restart_acceleration
   use impulse_account, only: book_impulse, book_friction, book_reactions, dependent_impulses
   use row_following, only: rows_ahead, rows_here
   use constrained_step, only: advance_smoothly
   implicit none
   private

   public :: impulse_method_type

   !> Contact by one impulse a step.
   type, extends(impact_method_type) :: impulse_method_type
   contains
      procedure :: start
      procedure :: advance
   end type impulse_method_type

contains

   !> Nothing is in contact before the first overlap.
   subroutine start(self, scene, motion, dt, error)
      class(impulse_method_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error

      motion%touching = .false.
      call rows_here(scene, motion, dt)
      call restart_acceleration(scene, motion, error)
   end subroutine start

   !> One step, then its impulses.
   subroutine advance(self, scene, motion, dt, error)
      class(impulse_method_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      type(contact_motion_type) :: next
      real(wp) :: approach(scene%rows%n)
      logical :: hit(scene%rows%n)

      call rows_ahead(scene, motion, dt, error)
      if (allocated(error)) return
      approach = row_rates(scene%rows, motion%motion)
      call advance_smoothly(scene, motion, dt, scene%system%newmark%beta, next, error)
      if (allocated(error)) return
      call accept_span(scene, motion, next)
      hit = may_hit(scene%rows) .and. row_gaps(scene%rows, next%motion) < 0.0_wp
      if (any(hit)) call throw_back(scene, next, approach, hit, dt, error)
      if (allocated(error)) return
      motion = next
   end subroutine advance

   !> The impulses of a step, what they do to velocities and displacements, and their account.
   subroutine throw_back(scene, motion, approach, hit, dt, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: approach(:)        !! (n_rows) gap rates at the start of the step
      logical, intent(in) :: hit(:)              !! (n_rows)
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      type(compliance_type) :: compliance
      real(wp), dimension(scene%rows%n) :: before, slip, aim, impulse, friction
      real(wp), dimension(size(motion%motion%v)) :: v_before, change
      logical :: solved

      call mass_compliance(scene, hit, compliance, error)
      if (allocated(error)) return
      v_before = motion%motion%v
      before = row_rates(scene%rows, motion%motion)
      slip = slip_rates(scene%rows, motion%motion)
      aim = before + scene%rows%restitution*min(0.0_wp, approach)
      call find_impulses(scene, compliance, join_rates(compliance, aim, slip), impulse, friction, &
            change, solved)
      if (.not. solved) then
         call dependent_impulses(scene, motion%motion%t, compliance, error)
         return
      end if
      motion%motion%v = v_before + change
      motion%jump = change
      call book_impulse(scene, motion, impulse, before, row_rates(scene%rows, motion%motion))
      call book_friction(scene, motion, friction, slip)
      call book_reactions(scene, motion, v_before, impulse, friction)
      call shift(scene, motion, dt/2.0_wp*change)
      scene%impulse = scene%impulse + impulse
      call note_events(scene, motion, impulse, approach)
      call restart_acceleration(scene, motion, error)
   end subroutine throw_back

   !> Impulses of rows whose rates are to become complementary, and what velocity they make.
   subroutine find_impulses(scene, compliance, aim, impulse, friction, change, solved)
      type(scene_type), intent(in) :: scene
      type(compliance_type), intent(in) :: compliance
      real(wp), intent(in) :: aim(:)             !! rates without impulses
      real(wp), intent(out) :: impulse(:), friction(:)   !! (n_rows)
      real(wp), intent(out) :: change(:)         !! (n_freedoms)
      logical, intent(out) :: solved
      real(wp) :: p(size(aim))
      logical :: held(compliance%n)

      held = .false.
      impulse = 0.0_wp
      friction = 0.0_wp
      call solve_rows(compliance%w, aim, scene%rows%friction(compliance%rows), held, p, solved)
      if (.not. solved) return
      call split_forces(compliance, p, impulse, friction)
      change = pushed(scene, compliance, p)
   end subroutine find_impulses

   !> Moves the bodies; what that does to their energy counts as lost in impacts.
   subroutine shift(scene, motion, change)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: change(:)          !! (n_freedoms) of displacement
      real(wp) :: gain, work

      associate (structure => scene%system%structure, state => motion%motion)
         work = dot_product(load_at(scene%system%loads, size(change), state%t), change)
         gain = -strain_energy(structure, state%d, state%history)
         state%d = state%d + change
         gain = gain + strain_energy(structure, state%d, state%history)
      end associate
      call record_impact(scene%ledger, work - gain, work)
   end subroutine shift

   subroutine note_events(scene, motion, impulse, approach)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(in) :: impulse(:), approach(:)   !! (n_rows)
      real(wp) :: after(scene%rows%n)
      integer :: i

      after = row_rates(scene%rows, motion%motion)
      do i = 1, scene%rows%n
         if (impulse(i) > 0.0_wp) call record_event(scene, event_type(motion%motion%t, &
               event_impact, i, approach(i), after(i), impulse(i), scene%system%newmark%beta))
      end do
   end subroutine note_events

end module impulse_method
