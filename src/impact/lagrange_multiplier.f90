!> Lagrange multipliers with a correction of velocities at impact and release (Hughes, Taylor,
!> Sackman, Curnier and Kanoknukulchai 1976; Taylor and Papadopoulos 1993). Events are at the ends
!> of steps, none is located.
!>
!> Impact: a row that would overlap at the end of a step is closed by a multiplier,
!>
!>     0 <= lambda1,  g1 >= 0,  complementary, on M a1 + C v1 + S(d1) = f1 + Gt lambda1
!>
!> (with friction, Coulomb's law beside it); at beta = 0, where the force of the end cannot move the
!> end, the multiplier acts at the start, 0 <= lambda0, g1(a0 + M^-1 Gt lambda0) >= 0 (Carpenter,
!> Taylor and Katona 1991). Newmark's velocity v1 then depends on where in the step the wall was
!> met. Impulses p correct it, so that all rows in contact have had the impulses x = J + p,
!> J = (1 - gamma) h lambda0 + gamma h lambda1:
!>
!>     0 <= x,  G v+ >= 0,  complementary,  v+ = v1 + M^-1 Gt p,
!>
!> with Coulomb's cone on x. Rows that stay closed have the common velocity (for one row on lumped
!> masses m1, m2: v+ = (m1 v1 + m2 v2)/(m1 + m2)), momentum is kept, kinetic energy never gained.
!> The acceleration of Newmark's step is brought to G a+ = 0 in the same way, a+ = a1 + M^-1 Gt mu.
!>
!> Persistence: with g, G v and G a zero at the start, closed rows are held by the same
!> complementarity on G a1, from which g1 = beta h^2 G a1 and G v1 = gamma h G a1 follow.
!>
!> Release: a row opens in the step in which its multiplier would pull. Its last force is kept in
!> a0 and gives the impulse (1 - gamma) h lambda0: on a lumped bar at one Courant step this is the
!> velocity lambda/(rho c) by which a stressed end that becomes free springs off.
module lagrange_multiplier
   use kinds, only: wp
   use errors, only: error_type
   use complementarity, only: solve_complementarity
   use mesh, only: scheme_implicit, scheme_explicit
   use structure, only: damping_force
   use motion_state, only: state_type
   use equation_of_motion, only: predict_motion
   use energy_ledger, only: record_impact
   use constraint_rows, only: row_gaps, row_rates, slip_rates, gap_size, rate_size, may_hit
   use impact_scene, only: scene_type, contact_motion_type, event_type, record_event, accept_span, &
         note_contact_force, opening_rows, let_go, event_impact, event_capture, gap_tolerance, &
         rate_tolerance
   use impact_method, only: impact_method_type
   use row_compliance, only: compliance_type, mass_compliance, pushed, join_rates, split_forces
   use rough_rows, only: solve_rows
   use contact_impulses, only: carry_acceleration, project_touching, follow_wall
   use impulse_account, only: book_impulse, book_friction, book_reactions, dependent_impulses
   use slip_state, only: review_slip
   use row_following, only: rows_ahead, rows_here, settle_rows
   use first_contacts, only: find_first_contacts
   use constrained_step, only: advance_smoothly
   implicit none
   private

   public :: lagrange_multiplier_type

   !> Contact by multipliers on the gap.
   type, extends(impact_method_type) :: lagrange_multiplier_type
   contains
      procedure :: start
      procedure :: advance
   end type lagrange_multiplier_type

contains

   !> What touches and closes is stopped, what is pressed is held.
   subroutine start(self, scene, motion, dt, error)
      class(lagrange_multiplier_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error

      call rows_here(scene, motion, dt)
      call find_first_contacts(scene, motion, dt, scene%system%newmark%beta, error)
   end subroutine start

   !> One step: displacements by the multipliers of its end, then the velocities of rows that have
   !> closed, or that a wall has moved.
   subroutine advance(self, scene, motion, dt, error)
      class(lagrange_multiplier_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      type(contact_motion_type) :: next
      logical :: closed(scene%rows%n)

      call rows_ahead(scene, motion, dt, error)
      if (allocated(error)) return
      closed = .false.
      if (.not. scene%system%newmark%beta > 0.0_wp) then
         call close_ahead(scene, motion, dt, closed, error)
         if (allocated(error)) return
      end if
      call advance_smoothly(scene, motion, dt, scene%system%newmark%beta, next, error)
      if (allocated(error)) return
      closed = closed .or. (may_hit(scene%rows) .and. next%lambda > 0.0_wp .and. .not. &
            motion%touching)
      call accept_span(scene, motion, next)
      if (allocated(next%carried)) deallocate (next%carried)
      call let_go(scene, next, opening_rows(scene, motion, next))
      if (any(closed)) then
         call close_rows(scene, motion, next, closed, dt, error)
      else
         call follow_rows(scene, motion, next, dt, error)
      end if
      if (allocated(error)) return
      motion = next
      call project_touching(scene, motion, &
            gap_tolerance*gap_size(scene%rows, motion%motion, dt), &
            rate_tolerance*rate_size(scene%rows, motion%motion), error)
      if (allocated(error)) return
      call settle_rows(scene, motion, dt, error)
   end subroutine advance

   !> At beta = 0: multipliers at the start of the step that keep rows from overlapping at its end.
   subroutine close_ahead(scene, motion, dt, closed, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      logical, intent(out) :: closed(:)          !! (n_rows) that have got one
      type(error_type), allocatable, intent(out) :: error
      type(compliance_type) :: compliance
      type(state_type) :: ahead
      real(wp) :: gaps(scene%rows%n), lambda(scene%rows%n), force(size(motion%motion%a))
      logical :: marked(scene%rows%n), solved

      closed = .false.
      call predict_motion(scene%system, motion%motion, dt, 0.0_wp, ahead)
      gaps = row_gaps(scene%rows, ahead)
      marked = may_hit(scene%rows) .and. .not. motion%touching .and. &
            gaps < -gap_tolerance*gap_size(scene%rows, ahead, dt)
      if (.not. any(marked)) return
      marked = marked .or. motion%touching
      call mass_compliance(scene, marked, compliance, error, .true.)
      if (allocated(error)) return
      lambda = 0.0_wp
      call solve_marked(scene, compliance, gaps(compliance%rows)*2.0_wp/dt**2, lambda, force, &
            solved)
      if (.not. solved) then
         call dependent_impulses(scene, ahead%t, compliance, error)
         return
      end if
      motion%motion%a = motion%motion%a + force
      motion%lambda = motion%lambda + lambda
      closed = lambda > 0.0_wp .and. .not. motion%touching
      call note_contact_force(scene, motion)
   end subroutine close_ahead

   !> Complementary forces of a compliance and the motion they give.
   subroutine solve_marked(scene, compliance, q, lambda, motion, solved)
      type(scene_type), intent(in) :: scene
      type(compliance_type), intent(in) :: compliance
      real(wp), intent(in) :: q(:)               !! (compliance%n)
      real(wp), intent(inout) :: lambda(:)       !! (n_rows)
      real(wp), intent(out) :: motion(:)         !! (n_freedoms)
      logical, intent(out) :: solved
      real(wp) :: x(size(q))

      call solve_complementarity(compliance%w, q, x, solved)
      lambda(compliance%rows) = x
      motion = pushed(scene, compliance, x)
   end subroutine solve_marked

   !> The impulses of a step in which rows have closed, and the motion after it.
   subroutine close_rows(scene, from, to, closed, dt, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      type(contact_motion_type), intent(inout) :: to
      logical, intent(in) :: closed(:)           !! (n_rows)
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      real(wp), dimension(scene%rows%n) :: before, after, slip, whole, impulse, friction
      real(wp) :: v_before(size(to%motion%v))
      logical :: was(scene%rows%n), held(scene%rows%n)

      was = to%touching
      v_before = to%motion%v
      before = row_rates(scene%rows, to%motion)
      slip = slip_rates(scene%rows, to%motion)
      call find_impulses(scene, from, to, was .or. closed, dt, whole, impulse, friction, error)
      if (allocated(error)) return
      after = row_rates(scene%rows, to%motion)
      call book_impulse(scene, to, impulse, before, after)
      call book_friction(scene, to, friction, slip)
      call book_reactions(scene, to, v_before, impulse, friction)
      scene%impulse = scene%impulse + impulse
      held = (was .or. closed) .and. (whole > 0.0_wp .or. &
            after <= rate_tolerance*rate_size(scene%rows, to%motion))
      call let_go(scene, to, was .and. .not. held)
      to%touching = held
      call note_impacts(scene, to, closed, row_rates(scene%rows, from%motion), whole)
      call carry_acceleration(scene, to, error)
      if (allocated(error)) return
      call note_jump(scene, to, to%motion%v - v_before)
   end subroutine close_rows

   !> The acceleration after a jump of velocity lacks the damping of the jump: a force C jump in it.
   subroutine note_jump(scene, motion, jump)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: jump(:)            !! (n_freedoms)

      motion%carried = 0.0_wp*jump
      call damping_force(scene%system%structure, scheme_implicit, jump, motion%carried)
      call damping_force(scene%system%structure, scheme_explicit, jump, motion%carried)
      motion%fresh = .true.
   end subroutine note_jump

   !> Impulses that correct the velocity, and what they make of those of the whole step.
   subroutine find_impulses(scene, from, to, marked, dt, whole, impulse, friction, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      type(contact_motion_type), intent(inout) :: to
      logical, intent(in) :: marked(:)           !! (n_rows) in contact
      real(wp), intent(in) :: dt
      real(wp), intent(out) :: whole(:)          !! (n_rows) normal impulses of the step
      real(wp), intent(out) :: impulse(:), friction(:)   !! (n_rows) corrections
      type(error_type), allocatable, intent(out) :: error
      type(compliance_type) :: compliance
      real(wp), dimension(scene%rows%n) :: rates, slip, tangential
      logical :: solved

      call mass_compliance(scene, marked, compliance, error)
      if (allocated(error)) return
      rates = row_rates(scene%rows, to%motion)
      slip = slip_rates(scene%rows, to%motion)
      associate (late => scene%system%newmark%gamma*dt)
         whole = (dt - late)*from%lambda + late*to%lambda
         tangential = (dt - late)*from%tau + late*to%tau
      end associate
      impulse = 0.0_wp
      friction = 0.0_wp
      call correct_velocity(join_rates(compliance, rates, slip), &
            join_rates(compliance, whole, tangential))
      if (.not. solved) then
         call dependent_impulses(scene, to%motion%t, compliance, error)
         return
      end if
      whole = merge(whole + impulse, 0.0_wp, marked)

   contains

      subroutine correct_velocity(motion, given)
         real(wp), intent(in) :: motion(:), given(:)
         real(wp) :: x(size(given))
         logical :: none(compliance%n)

         none = .false.
         call solve_rows(compliance%w, motion - matmul(compliance%w, given), &
               scene%rows%friction(compliance%rows), none, x, solved)
         call split_forces(compliance, x - given, impulse, friction)
         to%motion%v = to%motion%v + pushed(scene, compliance, x - given)
      end subroutine correct_velocity

   end subroutine find_impulses

   subroutine note_impacts(scene, motion, closed, approach, whole)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      logical, intent(in) :: closed(:)           !! (n_rows)
      real(wp), intent(in) :: approach(:)        !! (n_rows) gap rates at the start of the step
      real(wp), intent(in) :: whole(:)           !! (n_rows) impulses
      type(event_type) :: event
      real(wp) :: after(scene%rows%n)
      integer :: i

      after = row_rates(scene%rows, motion%motion)
      do i = 1, scene%rows%n
         if (.not. closed(i)) cycle
         event = event_type(motion%motion%t, event_impact, i, approach(i), after(i), whole(i), &
               scene%system%newmark%beta)
         call record_event(scene, event)
         event%kind = event_capture
         if (motion%touching(i)) call record_event(scene, event)
      end do
   end subroutine note_impacts

   !> Rows that have stayed closed, on walls whose speed may have changed.
   subroutine follow_rows(scene, from, to, dt, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      type(contact_motion_type), intent(inout) :: to
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      logical :: thrown(scene%rows%n), anew

      to%fresh = .false.
      call follow_wall(scene, to, dt*(from%lambda + to%lambda)/2.0_wp, dt, thrown, error)
      if (allocated(error)) return
      call let_go(scene, to, thrown)
      call review_slip(scene, from, to, anew, error)
      if (allocated(error) .or. .not. (anew .or. any(thrown))) return
      call carry_acceleration(scene, to, error)
      to%fresh = .true.
   end subroutine follow_rows

end module lagrange_multiplier
