!> Contact forces and impulses on the mass: the acceleration of equilibrium with rows held, rows put
!> back on their partners, gap rates set.
module contact_impulses
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use complementarity, only: solve_complementarity, solve_equality
   use mesh, only: scheme_implicit, scheme_explicit
   use motion_state, only: state_type
   use equation_of_motion, only: prepare_mass, solve_mass, force_balance, prepare_motion, &
         solve_motion
   use structure, only: inertia_force, damping_force
   use structure_energy, only: strain_energy
   use external_load, only: load_at
   use energy_ledger, only: record_impact
   use constraint_rows, only: row_gaps, row_rates, row_accelerations, row_curvature, &
         slip_products, rate_size, gap_size, contact_forces, law_penalty
   use impact_scene, only: scene_type, contact_motion_type, note_contact_force, gap_tolerance, &
         merge_gap_tolerance
   use row_compliance, only: compliance_type, mass_compliance, pushed, join_rates, split_forces
   use rough_rows, only: solve_rows
   use slip_state, only: slip_senses, sliding_senses, mark_sticking
   use contact_room, only: no_room
   use impulse_account, only: book_impulse, book_reactions, dependent_impulses
   implicit none
   private

   public :: restart_acceleration, hold_acceleration, carry_acceleration
   public :: project_touching, gaps_to_close, has_jumped, set_rates, follow_wall

   !> Opening rates below this part of the speeds are round-off.
   real(wp), parameter :: thrown_tolerance = 1.0e-9_wp
   !> Gaps of weighted rows jump when parts of a surface come to face each other, or cease to.
   !> One of more than this part of the size has, and is not closed: that would move bodies apart
   !> that did not hit, and give them energy.
   real(wp), parameter :: largest_shift = 1.0e-4_wp

contains

   !> The acceleration of equilibrium with the touching rows held bilaterally: a force of either
   !> sign.
   !> (With its sign enforced here, energy would be pumped in.)
   subroutine restart_acceleration(scene, motion, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(error_type), allocatable, intent(out) :: error

      call hold_acceleration(scene, motion, motion%touching, error)
   end subroutine restart_acceleration

   !> The same with any rows held. Contact springs push as they are. What dampers make of a jump in
   !> velocity is found on the effective matrix of a step, M + gamma h C + beta h^2 K: it tends to
   !> that on the mass with h, but a force that dies away within the step does not swing on.
   subroutine hold_acceleration(scene, motion, held, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      logical, intent(in) :: held(:)
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: force(size(motion%motion%a))
      type(state_type) :: calm

      call prepare_mass(scene%system, error)
      if (allocated(error)) return
      calm = motion%motion
      calm%v = calm%v - motion%jump
      motion%motion%a = merge(motion%motion%a, 0.0_wp, scene%system%structure%map%prescribed)
      call find_spring_forces(scene, motion)
      force = force_balance(scene%system, calm) &
            - inertia_force(scene%system%structure, motion%motion%a) &
            + contact_forces(scene%rows, motion%lambda, motion%tau, size(force))
      motion%motion%a = motion%motion%a + solve_mass(scene%system, force)
      call damp_jump(scene, motion, error)
      if (allocated(error)) return
      call add_holding_forces(scene, motion, held, error)
   end subroutine hold_acceleration

   !> Adds the acceleration by the damping forces of a jump in velocity.
   subroutine damp_jump(scene, motion, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(error_type), allocatable, intent(out) :: error
      real(wp), dimension(size(motion%jump)) :: force, a

      motion%left_out = 0.0_wp
      if (.not. any(abs(motion%jump) > 0.0_wp)) return
      force = 0.0_wp
      call damping_force(scene%system%structure, scheme_implicit, motion%jump, force)
      call damping_force(scene%system%structure, scheme_explicit, motion%jump, force)
      if (.not. any(abs(force) > 0.0_wp)) return
      if (scene%dt > 0.0_wp) then
         call prepare_motion(scene%system, scene%dt, scene%system%newmark%beta, motion%motion%d, &
               motion%motion%history, error)
         if (allocated(error)) return
         a = -solve_motion(scene%system, force)
      else
         a = -solve_mass(scene%system, force)
      end if
      motion%motion%a = motion%motion%a + a
      motion%left_out = force + inertia_force(scene%system%structure, a)
   end subroutine damp_jump

   !> The acceleration at hand, with other contact forces: those that hold the touching rows instead
   !> of those it was found with. Unlike a restart it leaves out what damping makes of a jump in
   !> velocity: with stiff dashpots and large steps that force would swing and grow.
   subroutine carry_acceleration(scene, motion, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(error_type), allocatable, intent(out) :: error

      call prepare_mass(scene%system, error)
      if (allocated(error)) return
      motion%motion%a = motion%motion%a - solve_mass(scene%system, motion%force)
      motion%lambda = 0.0_wp
      motion%tau = 0.0_wp
      call add_holding_forces(scene, motion, motion%touching, error)
   end subroutine carry_acceleration

   !> Forces that hold rows bilaterally, with friction as they slide, added to the acceleration.
   subroutine add_holding_forces(scene, motion, held, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      logical, intent(in) :: held(:)
      type(error_type), allocatable, intent(out) :: error
      type(compliance_type) :: compliance
      real(wp), allocatable :: forces(:)
      integer :: sense(scene%rows%n), sliding(scene%rows%n)

      call mass_compliance(scene, held, compliance, error)
      if (allocated(error)) return
      if (compliance%n > 0) then
         sense = slip_senses(scene, motion)
         call find_holding_forces(scene, motion, compliance, sense, forces, error)
         if (allocated(error)) return
         sliding = sliding_senses(scene, motion, compliance)
         if (any(sliding /= 0)) then
            call find_holding_forces(scene, motion, compliance, sense + sliding, forces, error)
            if (allocated(error)) return
         end if
         motion%motion%a = motion%motion%a + pushed(scene, compliance, forces)
      end if
      call mark_sticking(scene, motion, held, compliance)
      call note_contact_force(scene, motion)
   end subroutine add_holding_forces

   !> The forces that hold the rows of a compliance.
   subroutine find_holding_forces(scene, motion, compliance, sense, forces, error)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(compliance_type), intent(in) :: compliance   !! on the mass
      integer, intent(in) :: sense(:)            !! (n_rows) of the slip, 0: by the law
      real(wp), allocatable, intent(out) :: forces(:)
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: q(size(compliance%w, 1))
      logical :: bilateral(compliance%n), solved
      integer :: status

      q = join_rates(compliance, row_accelerations(scene%rows, motion%motion%a) &
            + row_curvature(scene%rows, motion%motion), slip_products(scene%rows, motion%motion%a))
      bilateral = .true.
      allocate (forces(size(q)), stat=status)
      call check_allocation(status)
      call solve_rows(compliance%w, q, scene%rows%friction(compliance%rows), bilateral, forces, &
            solved, sense(compliance%rows))
      if (.not. solved) then
         call dependent_impulses(scene, motion%motion%t, compliance, error)
         return
      end if
      call split_forces(compliance, forces, motion%lambda, motion%tau)
   end subroutine find_holding_forces

   !> Forces of contact springs where they are, stiffness times overlap; their friction as it was,
   !> within its limit now. Nothing in other rows.
   subroutine find_spring_forces(scene, motion)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp) :: limit(scene%rows%n)

      motion%lambda = scene%rows%stiffness*max(0.0_wp, -row_gaps(scene%rows, motion%motion))
      motion%lambda = merge(motion%lambda, 0.0_wp, scene%rows%law == law_penalty)
      limit = scene%rows%friction*motion%lambda
      motion%tau = max(-limit, min(limit, motion%tau))
   end subroutine find_spring_forces

   !> Gap rates of touching rows after a span in which the wall's own speed has changed: impulses
   !> that bring them to zero, 0 <= p + I, G v + W p >= 0, complementary. A row takes back no more
   !> than the contact impulse I of the span; what still opens then is thrown off by the wall.
   subroutine follow_wall(scene, motion, span_impulse, dt, thrown, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: span_impulse(:)    !! (n_rows) I
      real(wp), intent(in) :: dt                 !! the whole step, for round-off
      logical, intent(out) :: thrown(:)          !! (n_rows)
      type(error_type), allocatable, intent(out) :: error
      type(compliance_type) :: compliance
      real(wp), dimension(scene%rows%n) :: rates, available, impulse, after
      real(wp) :: p(count(motion%touching)), limit, v_before(size(motion%motion%v))
      logical :: solved

      thrown = .false.
      if (.not. any(motion%touching)) return
      rates = row_rates(scene%rows, motion%motion)
      limit = thrown_tolerance*rate_size(scene%rows, motion%motion) &
            + gap_tolerance*gap_size(scene%rows, motion%motion, dt)/dt
      if (.not. any(motion%touching .and. abs(rates) > limit)) return
      call mass_compliance(scene, motion%touching, compliance, error, .true.)
      if (allocated(error)) return
      available = max(0.0_wp, span_impulse)
      ! at rest all rates are round-off of what the contact impulses have held back
      limit = limit + thrown_tolerance*maxval(abs(matmul(compliance%w, available(compliance%rows))))
      if (.not. any(motion%touching .and. abs(rates) > limit)) return
      call solve_complementarity(compliance%w, rates(compliance%rows) &
            - matmul(compliance%w, available(compliance%rows)), p, solved)
      if (.not. solved) then
         call dependent_impulses(scene, motion%motion%t, compliance, error)
         return
      end if
      impulse = 0.0_wp
      impulse(compliance%rows) = p - available(compliance%rows)
      v_before = motion%motion%v
      motion%motion%v = v_before + pushed(scene, compliance, impulse(compliance%rows))
      after = row_rates(scene%rows, motion%motion)
      call book_impulse(scene, motion, impulse, rates, after)
      call book_reactions(scene, motion, v_before, impulse, 0.0_wp*impulse)
      scene%impulse = scene%impulse + impulse
      thrown = motion%touching .and. after > limit
   end subroutine follow_wall

   !> Puts touching rows back on gap zero and gap rate zero where they are off by more than the
   !> limits, by the smallest mass-weighted change.
   subroutine project_touching(scene, motion, gap_limit, rate_limit, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: gap_limit, rate_limit
      type(error_type), allocatable, intent(out) :: error
      type(compliance_type) :: compliance
      real(wp), dimension(scene%rows%n) :: gaps, rates, impulse
      real(wp) :: p(count(motion%touching)), length
      logical :: solved

      if (.not. any(motion%touching)) return
      length = max(gap_size(scene%rows, motion%motion, scene%dt), scene%geometry%size, &
            maxval(abs(motion%motion%d)))
      gaps = gaps_to_close(scene, motion)
      rates = merge(row_rates(scene%rows, motion%motion), 0.0_wp, motion%touching)
      if (maxval(abs(gaps)) <= gap_limit .and. maxval(abs(rates)) <= rate_limit) return
      call mass_compliance(scene, motion%touching, compliance, error, .true.)
      if (allocated(error)) return
      if (maxval(abs(gaps)) > gap_limit) then
         call solve_equality(compliance%w, gaps(compliance%rows), p, solved)
         call shift(scene, motion, pushed(scene, compliance, p))
         call check_room(scene, motion, length, error)
         if (allocated(error)) return
      end if
      if (maxval(abs(rates)) <= rate_limit) return
      rates = 0.0_wp
      call set_rates(scene, motion, motion%touching, rates, impulse, error)
   end subroutine project_touching

   !> Rows that no motion can open together, as of a mass between two walls that have met, leave an
   !> overlap: the motion cannot go on. (Gaps of bodies that slide on each other are not exact.)
   subroutine check_room(scene, motion, length, error)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(in) :: length             !! what round-off of gaps is relative to
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: gaps(scene%rows%n), limit
      integer :: worst

      gaps = gaps_to_close(scene, motion)
      worst = minloc(gaps, dim=1)
      limit = merge_gap_tolerance*length
      if (scene%rows%moving) limit = largest_shift*length
      if (gaps(worst) >= -limit) return
      call no_room(scene%rows%node_id(worst), motion%motion%t, -gaps(worst), error)
   end subroutine check_room

   !> Gaps of touching rows that are to be zero.
   function gaps_to_close(scene, motion) result(gaps)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp) :: gaps(scene%rows%n)

      gaps = merge(row_gaps(scene%rows, motion%motion), 0.0_wp, &
            motion%touching .and. scene%rows%facing)
      where (has_jumped(scene, gaps)) gaps = 0.0_wp
   end function gaps_to_close

   !> Rows whose gaps while they touch tell of a jump.
   pure function has_jumped(scene, gaps) result(jumped)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: gaps(:)            !! (n_rows)
      logical :: jumped(size(gaps))

      jumped = scene%rows%weight > 0.0_wp .and. abs(gaps) > largest_shift*scene%geometry%size &
            .and. scene%rows%moving
   end function has_jumped

   !> Moves the bodies; what that does to their energy is booked where they slide on each other. (On
   !> fixed rows it is round-off.)
   subroutine shift(scene, motion, change)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: change(:)          !! (n_freedoms) of displacement
      real(wp) :: gain, work

      if (.not. scene%rows%moving) then
         motion%motion%d = motion%motion%d + change
         return
      end if
      associate (structure => scene%system%structure, state => motion%motion)
         work = dot_product(load_at(scene%system%loads, size(change), state%t), change)
         gain = -strain_energy(structure, state%d, state%history)
         state%d = state%d + change
         gain = gain + strain_energy(structure, state%d, state%history)
      end associate
      call record_impact(scene%ledger, work - gain, work)
   end subroutine shift

   !> Applies the impulses that give the marked rows the gap rates asked for.
   subroutine set_rates(scene, motion, marked, target_rate, impulse, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      logical, intent(in) :: marked(:)           !! (n_rows)
      real(wp), intent(in) :: target_rate(:)     !! (n_rows)
      real(wp), intent(out) :: impulse(:)        !! (n_rows)
      type(error_type), allocatable, intent(out) :: error
      type(compliance_type) :: compliance
      real(wp), dimension(scene%rows%n) :: before, after
      real(wp) :: p(count(marked)), v_before(size(motion%motion%v))
      logical :: solved

      impulse = 0.0_wp
      call mass_compliance(scene, marked, compliance, error, .true.)
      if (allocated(error)) return
      before = row_rates(scene%rows, motion%motion)
      call solve_equality(compliance%w, before(compliance%rows) - target_rate(compliance%rows), p, &
            solved)
      if (.not. solved) then
         call dependent_impulses(scene, motion%motion%t, compliance, error)
         return
      end if
      v_before = motion%motion%v
      motion%motion%v = v_before + pushed(scene, compliance, p)
      impulse(compliance%rows) = p
      after = row_rates(scene%rows, motion%motion)
      call book_impulse(scene, motion, impulse, before, after)
      call book_reactions(scene, motion, v_before, impulse, 0.0_wp*impulse)
      scene%impulse = scene%impulse + impulse
   end subroutine set_rates

end module contact_impulses
