!> The velocity jump of an impact: impulses over all rows concerned, capture of slow rebounds, and
!> the acceleration restarted from equilibrium.
module impact_jump
   use kinds, only: wp
   use errors, only: error_type, new_error, status_numerical
   use complementarity, only: solve_complementarity, solve_equality
   use equation_of_motion, only: prepare_mass, solve_mass, force_balance
   use structure, only: inertia_force
   use energy_ledger, only: record_impact
   use constraint_rows, only: row_gaps, row_rates, row_accelerations, row_vector, rate_size, &
         gap_size, wall_rates
   use impact_scene, only: scene_type, contact_motion_type, event_type, record_event, &
         capture_speeds, gap_tolerance, event_impact, event_capture, event_limit
   implicit none
   private

   public :: impact_type, compliance_type, apply_impact, restart_acceleration, project_touching
   public :: mass_compliance, set_rates, follow_wall

   !> Opening rates below this part of the speeds are round-off.
   real(wp), parameter :: thrown_tolerance = 1.0e-9_wp

   !> What happens at one instant.
   type :: impact_type
      logical, allocatable :: new(:)         !! (n_rows) rows that hit
      logical, allocatable :: near(:)        !! (n_rows) rows at the wall that take part if pushed
      logical, allocatable :: forced(:)      !! (n_rows) of these, captured: pressed at rest
      logical :: plastic = .false.           !! every new row is captured: too many events
      real(wp) :: dt = 0.0_wp                !! the whole step, for the capture speed
      real(wp) :: beta = 0.0_wp              !! for the record
      real(wp) :: rate_limit = 0.0_wp        !! smaller rates are round-off
   end type impact_type

   !> Rows that take part, with their mass compliance.
   type :: compliance_type
      integer, allocatable :: rows(:)
      real(wp), allocatable :: x(:, :)       !! (n_freedoms, n) M^-1 Gt
      real(wp), allocatable :: w(:, :)       !! (n, n) G M^-1 Gt
   end type compliance_type

contains

   !> 0 <= p, (G M^-1 Gt) p + G v- + e G v- >= 0 over new and touching rows together (e on the new
   !> ones); v+ = v- + M^-1 Gt p, displacements as they are. New rows that would rebound slower than
   !> the capture speed get e = 0 and touch from then on. Books energy and events.
   subroutine apply_impact(scene, motion, impact, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(impact_type), intent(in) :: impact
      type(error_type), allocatable, intent(out) :: error
      type(compliance_type) :: compliance
      real(wp), dimension(scene%rows%n) :: before, after, impulse
      logical :: held(scene%rows%n), was(scene%rows%n)

      was = motion%touching
      before = row_rates(scene%rows, motion%motion)
      call mass_compliance(scene, was .or. impact%new .or. impact%near, compliance, error)
      if (allocated(error)) return
      call find_impulse(scene, motion, impact, compliance, before, impulse, held, error)
      if (allocated(error)) return
      after = row_rates(scene%rows, motion%motion)
      ! a row that touched and was thrown open by the jump touches no more
      motion%touching = held .and. .not. (was .and. .not. impact%forced .and. &
            after > impact%rate_limit)
      call book_impulse(scene, motion, impulse, before, after)
      call project_touching(scene, motion, 0.0_wp, 0.0_wp, error)
      if (allocated(error)) return
      call restart_acceleration(scene, motion, error)
      if (allocated(error)) return
      scene%impulse = scene%impulse + impulse
      call note_events(scene, motion, impact, was, impulse, before)
   end subroutine apply_impact

   !> Impulses and the velocity after them; repeated while a new row rebounds too slowly.
   subroutine find_impulse(scene, motion, impact, compliance, before, impulse, held, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(impact_type), intent(in) :: impact
      type(compliance_type), intent(in) :: compliance
      real(wp), intent(in) :: before(:)          !! (n_rows) gap rates
      real(wp), intent(out) :: impulse(:)        !! (n_rows)
      logical, intent(out) :: held(:)            !! (n_rows) rows that touch afterwards
      type(error_type), allocatable, intent(out) :: error
      real(wp), dimension(scene%rows%n) :: e, after, limits
      real(wp) :: v_before(size(motion%motion%v)), q(size(compliance%rows)), &
            p(size(compliance%rows))
      logical :: slow(scene%rows%n), solved

      v_before = motion%motion%v
      e = merge(scene%rows%restitution, 0.0_wp, impact%new .and. .not. impact%plastic)
      do
         q = before(compliance%rows) &
               + e(compliance%rows)*min(0.0_wp, before(compliance%rows))
         call solve_complementarity(compliance%w, q, p, solved)
         if (.not. solved) then
            call dependent_impulses(error)
            return
         end if
         motion%motion%v = v_before + matmul(compliance%x, p)
         after = row_rates(scene%rows, motion%motion)
         held = motion%touching .or. impact%forced .or. (impact%new .and. impact%plastic)
         held = held .or. (impact%new .and. .not. e > 0.0_wp .and. after <= impact%rate_limit)
         held(compliance%rows) = held(compliance%rows) .or. &
               (impact%near(compliance%rows) .and. p > 0.0_wp)
         call hold_acceleration(scene, motion, held, error)
         if (allocated(error)) return
         limits = max(capture_speeds(scene, motion%motion%a, impact%dt), impact%rate_limit)
         slow = impact%new .and. .not. impact%forced .and. e > 0.0_wp .and. after <= limits
         if (.not. any(slow)) exit
         where (slow) e = 0.0_wp
      end do
      impulse = 0.0_wp
      impulse(compliance%rows) = p
   end subroutine find_impulse

   subroutine dependent_impulses(error)
      type(error_type), allocatable, intent(out) :: error

      call new_error(error, status_numerical, &
            'an impact has no answer: a contact row has no mass '// &
            'behind it, or rows depend on each other'//new_line('a')// &
            '  cure: give every contact node a mass, and let none touch the same wall twice')
   end subroutine dependent_impulses

   !> M^-1 Gt and G M^-1 Gt of the marked rows.
   subroutine mass_compliance(scene, marked, compliance, error)
      type(scene_type), intent(inout) :: scene
      logical, intent(in) :: marked(:)
      type(compliance_type), intent(out) :: compliance
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: products(scene%rows%n)
      integer :: i, j, n

      n = scene%system%structure%map%n_freedoms
      compliance%rows = pack([(i, i=1, scene%rows%n)], marked)
      allocate (compliance%x(n, size(compliance%rows)))
      allocate (compliance%w(size(compliance%rows), size(compliance%rows)))
      call prepare_mass(scene%system, error)
      if (allocated(error)) return
      do j = 1, size(compliance%rows)
         compliance%x(:, j) = solve_mass(scene%system, row_vector(scene%rows, &
               compliance%rows(j), n))
         products = row_accelerations(scene%rows, compliance%x(:, j))
         compliance%w(:, j) = products(compliance%rows)
      end do
      compliance%w = (compliance%w + transpose(compliance%w))/2.0_wp
   end subroutine mass_compliance

   !> The acceleration of equilibrium with the touching rows held bilaterally: a force of either
   !> sign.
   !> (With its sign enforced here, energy would be pumped in.)
   subroutine restart_acceleration(scene, motion, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(error_type), allocatable, intent(out) :: error

      call hold_acceleration(scene, motion, motion%touching, error)
   end subroutine restart_acceleration

   subroutine hold_acceleration(scene, motion, held, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      logical, intent(in) :: held(:)
      type(error_type), allocatable, intent(out) :: error
      type(compliance_type) :: compliance
      real(wp) :: force(size(motion%motion%a)), a_rows(scene%rows%n)
      real(wp), allocatable :: lambda(:)
      logical :: solved

      call mass_compliance(scene, held, compliance, error)
      if (allocated(error)) return
      motion%motion%a = merge(motion%motion%a, 0.0_wp, scene%system%structure%map%prescribed)
      force = force_balance(scene%system, motion%motion) &
            - inertia_force(scene%system%structure, motion%motion%a)
      motion%motion%a = motion%motion%a + solve_mass(scene%system, force)
      motion%lambda = 0.0_wp
      if (size(compliance%rows) == 0) return
      allocate (lambda(size(compliance%rows)))
      a_rows = row_accelerations(scene%rows, motion%motion%a)
      call solve_equality(compliance%w, a_rows(compliance%rows), lambda, solved)
      if (.not. solved) then
         call dependent_impulses(error)
         return
      end if
      motion%lambda(compliance%rows) = lambda
      motion%motion%a = motion%motion%a + matmul(compliance%x, lambda)
   end subroutine hold_acceleration

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
      real(wp) :: p(count(motion%touching)), limit
      logical :: solved

      thrown = .false.
      if (.not. any(motion%touching)) return
      rates = row_rates(scene%rows, motion%motion)
      limit = thrown_tolerance*rate_size(scene%rows, motion%motion) &
            + gap_tolerance*gap_size(scene%rows, motion%motion, dt)/dt
      if (.not. any(motion%touching .and. abs(rates) > limit)) return
      call mass_compliance(scene, motion%touching, compliance, error)
      if (allocated(error)) return
      available = max(0.0_wp, span_impulse)
      ! at rest all rates are round-off of what the contact impulses have held back
      limit = limit + thrown_tolerance*maxval(abs(matmul(compliance%w, available(compliance%rows))))
      if (.not. any(motion%touching .and. abs(rates) > limit)) return
      call solve_complementarity(compliance%w, rates(compliance%rows) &
            - matmul(compliance%w, available(compliance%rows)), p, solved)
      if (.not. solved) then
         call dependent_impulses(error)
         return
      end if
      impulse = 0.0_wp
      impulse(compliance%rows) = p - available(compliance%rows)
      motion%motion%v = motion%motion%v + matmul(compliance%x, impulse(compliance%rows))
      after = row_rates(scene%rows, motion%motion)
      call book_impulse(scene, motion, impulse, rates, after)
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
      real(wp) :: p(count(motion%touching))
      logical :: solved

      if (.not. any(motion%touching)) return
      gaps = merge(row_gaps(scene%rows, motion%motion), 0.0_wp, motion%touching)
      rates = merge(row_rates(scene%rows, motion%motion), 0.0_wp, motion%touching)
      if (maxval(abs(gaps)) <= gap_limit .and. maxval(abs(rates)) <= rate_limit) return
      call mass_compliance(scene, motion%touching, compliance, error)
      if (allocated(error)) return
      if (maxval(abs(gaps)) > gap_limit) then
         call solve_equality(compliance%w, gaps(compliance%rows), p, solved)
         motion%motion%d = motion%motion%d + matmul(compliance%x, p)
      end if
      if (maxval(abs(rates)) <= rate_limit) return
      rates = 0.0_wp
      call set_rates(scene, motion, motion%touching, rates, impulse, error)
   end subroutine project_touching

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
      real(wp) :: p(count(marked))
      logical :: solved

      impulse = 0.0_wp
      call mass_compliance(scene, marked, compliance, error)
      if (allocated(error)) return
      before = row_rates(scene%rows, motion%motion)
      call solve_equality(compliance%w, before(compliance%rows) - target_rate(compliance%rows), p, &
            solved)
      if (.not. solved) then
         call dependent_impulses(error)
         return
      end if
      motion%motion%v = motion%motion%v + matmul(compliance%x, p)
      impulse(compliance%rows) = p
      after = row_rates(scene%rows, motion%motion)
      call book_impulse(scene, motion, impulse, before, after)
      scene%impulse = scene%impulse + impulse
   end subroutine set_rates

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

   subroutine note_events(scene, motion, impact, was, impulse, before)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(impact_type), intent(in) :: impact
      logical, intent(in) :: was(:)
      real(wp), intent(in) :: impulse(:), before(:)
      type(event_type) :: event
      real(wp) :: after(scene%rows%n)
      integer :: i

      after = row_rates(scene%rows, motion%motion)
      do i = 1, scene%rows%n
         event = event_type(motion%motion%t, event_impact, i, before(i), after(i), impulse(i), &
               impact%beta)
         if (impact%new(i)) call record_event(scene, event)
         event%kind = event_capture
         if (impact%plastic) event%kind = event_limit
         if (motion%touching(i) .and. .not. was(i)) call record_event(scene, event)
      end do
   end subroutine note_events

end module impact_jump
