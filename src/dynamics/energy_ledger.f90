!> Where the energy goes: kinetic and strain energy, damping, impacts and contact, work from
!> outside;
!> what is left over is the balance error of the time integration.
module energy_ledger
   use kinds, only: wp
   use mesh, only: scheme_implicit, scheme_explicit
   use dof_map, only: follow_constraints
   use structure, only: elastic_force, damping_force, inertia_force, count_resisting
   use structure_energy, only: strain_energy, plastic_work, group_strain_energy, &
         group_kinetic_energy
   use external_load, only: load_at
   use motion_state, only: state_type
   use state_archive, only: archive_type
   use cost_account, only: enter, leave, phase_elements
   use equation_of_motion, only: system_type
   use reactions, only: resisting_reactions, impulse_reactions
   implicit none
   private

   public :: ledger_type, open_ledger, record_span, record_impact, close_increment
   public :: take_back_damping, record_works, contact_moves
   public :: record_friction, record_springs
   public :: group_energies, record_found

   !> Energies and works since the start of the run.
   type :: ledger_type
      real(wp) :: kinetic = 0.0_wp
      real(wp) :: strain = 0.0_wp               !! with that of contact springs
      real(wp) :: damping = 0.0_wp
      real(wp) :: plastic = 0.0_wp
      real(wp) :: friction = 0.0_wp
      real(wp) :: impact_loss = 0.0_wp          !! taken by impacts and by contact forces
      real(wp) :: external_work = 0.0_wp
      real(wp) :: total = 0.0_wp                !! kinetic and strain
      real(wp) :: balance_error = 0.0_wp        !! total + losses - external work - initial total
      real(wp) :: initial = 0.0_wp
      real(wp) :: stored(2) = 0.0_wp            !! in contact springs: normal, tangential
      real(wp) :: scale = 0.0_wp                !! largest energy or work met so far
      !> Kinetic and strain energy and plastic work at the end of the increment at hand, where the
      !> step has found them on its way.
      real(wp) :: found(3) = 0.0_wp
      logical :: has_found = .false.
      real(wp) :: time = 0.0_wp                 !! of the energies
   contains
      procedure :: pass_state
   end type ledger_type

contains

   !> All of it.
   subroutine pass_state(self, archive)
      class(ledger_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%pass('kinetic', self%kinetic)
      call archive%pass('strain', self%strain)
      call archive%pass('damping', self%damping)
      call archive%pass('plastic', self%plastic)
      call archive%pass('friction', self%friction)
      call archive%pass('impact_loss', self%impact_loss)
      call archive%pass('external_work', self%external_work)
      call archive%pass('total', self%total)
      call archive%pass('balance_error', self%balance_error)
      call archive%pass('initial', self%initial)
      call archive%pass('scale', self%scale)
      call archive%pass('has_found', self%has_found)
      call archive%pass('time', self%time)
      call archive%pass_fixed('stored', self%stored)
      call archive%pass_fixed('found', self%found)
   end subroutine pass_state

   !> Starts the account at the first state.
   subroutine open_ledger(self, system, state)
      type(ledger_type), intent(out) :: self
      type(system_type), intent(inout) :: system
      type(state_type), intent(in) :: state

      call close_increment(self, system, state)
      self%initial = self%total
      self%balance_error = 0.0_wp
   end subroutine open_ledger

   !> Works over a span of smooth motion: of loads and prescribed motion from outside and of damping
   !> by the trapezoidal rule, which is exact for Newmark's beta = 1/4, gamma = 1/2; of contact
   !> forces, which begin and end at once, as they change the kinetic energy (`contact_shares`,
   !> `contact_moves`), but for those of contact springs: like elements these hold what the
   !> displacements say.
   subroutine record_span(self, system, from, to, contact_from, contact_to, springs)
      type(ledger_type), intent(inout) :: self
      type(system_type), intent(inout) :: system
      type(state_type), intent(in) :: from, to
      real(wp), intent(in) :: contact_from(:), contact_to(:)   !! (n_freedoms) contact forces
      logical, intent(in), optional :: springs   !! contact forces are those of springs
      real(wp), dimension(size(from%d)) :: delta_d, force, shares, pushed_from, pushed_to
      logical :: by_springs

      delta_d = to%d - from%d
      force = load_at(system%loads, size(force), from%t) + load_at(system%loads, size(force), to%t)
      self%external_work = self%external_work + dot_product(delta_d, force)/2.0_wp
      pushed_from = contact_from
      pushed_to = contact_to
      if (any(abs(contact_from) > 0.0_wp) .or. any(abs(contact_to) > 0.0_wp)) then
         by_springs = .false.
         if (present(springs)) by_springs = springs
         shares = contact_shares(system, by_springs)
         pushed_from = 2.0_wp*(1.0_wp - shares)*contact_from
         pushed_to = 2.0_wp*shares*contact_to
         self%impact_loss = self%impact_loss - dot_product(contact_moves(system, from, to, &
               by_springs), pushed_from + pushed_to)/2.0_wp
      end if
      if (.not. system%static) then
         force = 0.0_wp
         call damping_force(system%structure, scheme_implicit, from%v + to%v, force)
         call damping_force(system%structure, scheme_explicit, from%v + to%v, force)
         self%damping = self%damping + dot_product(delta_d, force)/2.0_wp
      end if
      if (size(system%motions%motions) == 0) return
      call record_reactions(self, system, from, to, pushed_from, pushed_to)
   end subroutine record_span

   !> Share of the contact force at the end of a span in its mean, by freedoms: Newmark's gamma, as
   !> the velocities have it; half without inertia.
   pure function contact_shares(system, springs) result(shares)
      type(system_type), intent(in) :: system
      logical, intent(in) :: springs
      real(wp) :: shares(system%structure%map%n_freedoms)

      shares = 0.5_wp
      if (system%static .or. springs) return
      shares = merge(shares, system%newmark%gamma, is_massless(system))
   end function contact_shares

   !> Way along which contact forces work over a span: h (v0 + v1)/2, so that with the impulse
   !> h ((1 - gamma) F0 + gamma F1) their work is the change of the kinetic energy, exactly, at all
   !> beta and gamma. Springs, freedoms without inertia and those with a given motion go by the
   !> displacements.
   pure function contact_moves(system, from, to, springs) result(moves)
      type(system_type), intent(in) :: system
      type(state_type), intent(in) :: from, to
      logical, intent(in) :: springs             !! contact forces are those of springs
      real(wp) :: moves(size(from%d))

      moves = to%d - from%d
      if (system%static .or. springs) return
      where (.not. (system%structure%map%prescribed .or. is_massless(system)))
         moves = (to%t - from%t)/2.0_wp*(from%v + to%v)
      end where
      call follow_constraints(system%structure%map, moves)
   end function contact_moves

   !> Freedoms without mass.
   pure function is_massless(system) result(massless)
      type(system_type), intent(in) :: system
      logical :: massless(system%structure%map%n_freedoms)
      integer :: f

      massless = .false.
      if (.not. allocated(system%massless)) return
      if (.not. any(system%massless)) return
      associate (map => system%structure%map)
         do f = 1, map%n_freedoms
            if (map%id(map%dof(f), map%node(f)) == 0) cycle
            massless(f) = system%massless(map%id(map%dof(f), map%node(f)))
         end do
      end associate
   end function is_massless

   !> Work of the reactions where a freedom is moved. That of the inertia among them is taken from
   !> the change of the velocities: where the velocity of a moved freedom jumps, as at the points of
   !> an amplitude, no acceleration tells of it. In smooth motion both are the same by Newmark's
   !> rule with beta = 1/4, gamma = 1/2.
   subroutine record_reactions(self, system, from, to, contact_from, contact_to)
      type(ledger_type), intent(inout) :: self
      type(system_type), intent(inout) :: system
      type(state_type), intent(in) :: from, to
      real(wp), intent(in) :: contact_from(:), contact_to(:)
      real(wp), dimension(size(from%d)) :: moved, before, after, none

      moved = merge(to%d - from%d, 0.0_wp, system%structure%map%prescribed)
      if (.not. any(abs(moved) > 0.0_wp .or. (system%structure%map%prescribed .and. &
            abs(from%v + to%v) > 0.0_wp))) return
      none = 0.0_wp
      before = resisting_reactions(system, from, contact_from)
      after = resisting_reactions(system, to, contact_to)
      self%external_work = self%external_work + dot_product(moved, before + after)/2.0_wp
      if (system%static) return
      self%external_work = self%external_work + dot_product(from%v + to%v, &
            impulse_reactions(system, to%v - from%v, none))/2.0_wp
   end subroutine record_reactions

   !> Work of damping forces that the acceleration at the start of a span has left out.
   pure subroutine take_back_damping(self, from, to, left_out)
      type(ledger_type), intent(inout) :: self
      type(state_type), intent(in) :: from, to
      real(wp), intent(in) :: left_out(:)        !! (n_freedoms)

      self%damping = self%damping - dot_product(to%d - from%d, left_out)/2.0_wp
   end subroutine take_back_damping

   !> An impact: what it takes from the bodies and what a moving wall gives.
   pure subroutine record_impact(self, loss, wall_work)
      type(ledger_type), intent(inout) :: self
      real(wp), intent(in) :: loss, wall_work

      self%impact_loss = self%impact_loss + loss
      self%external_work = self%external_work + wall_work
   end subroutine record_impact

   !> Work of friction that has been booked as taken by contact forces.
   pure subroutine record_friction(self, work)
      type(ledger_type), intent(inout) :: self
      real(wp), intent(in) :: work               !! positive where it takes energy

      self%friction = self%friction + work
      self%impact_loss = self%impact_loss - work
   end subroutine record_friction

   !> What contact springs hold after a span: not lost, though their forces' work was booked so.
   pure subroutine record_springs(self, stored)
      type(ledger_type), intent(inout) :: self
      real(wp), intent(in) :: stored(2)          !! normal, tangential

      self%impact_loss = self%impact_loss - (stored(1) - self%stored(1))
      self%friction = self%friction - (stored(2) - self%stored(2))
      self%stored = stored
   end subroutine record_springs

   !> Works over a span of smooth motion that the step itself has added up.
   pure subroutine record_works(self, works)
      type(ledger_type), intent(inout) :: self
      real(wp), intent(in) :: works(2)           !! from outside, damping

      self%external_work = self%external_work + works(1)
      self%damping = self%damping + works(2)
   end subroutine record_works

   !> Works of an increment and energies at its end, found on the way.
   pure subroutine record_found(self, external_work, damping, energies)
      type(ledger_type), intent(inout) :: self
      real(wp), intent(in) :: external_work, damping
      real(wp), intent(in) :: energies(3)        !! kinetic, strain, plastic

      self%external_work = self%external_work + external_work
      self%damping = self%damping + damping
      self%found = energies
      self%has_found = .true.
   end subroutine record_found

   !> Energies at the end of an increment and the balance error.
   subroutine close_increment(self, system, state)
      type(ledger_type), intent(inout) :: self
      type(system_type), intent(inout) :: system
      type(state_type), intent(in) :: state
      integer :: outer

      if (self%has_found) then
         self%kinetic = self%found(1)
         self%strain = self%found(2)
         self%plastic = self%found(3)
         self%has_found = .false.
      else
         call enter(system%cost, phase_elements, outer)
         self%kinetic = dot_product(state%v, inertia_force(system%structure, state%v))/2.0_wp
         call find_stored(system, state, self%strain, self%plastic)
         call leave(system%cost, outer)
      end if
      self%time = state%t
      self%strain = self%strain + sum(self%stored)
      self%total = self%kinetic + self%strain
      self%balance_error = self%total + self%damping + self%plastic + self%friction &
            + self%impact_loss - self%external_work - self%initial
      self%scale = max(self%scale, abs(self%total), abs(self%external_work))
   end subroutine close_increment

   !> Strain energy and plastic work; of a linear structure along with the forces, which are quicker
   !> to find than strains.
   subroutine find_stored(system, state, strain, plastic)
      type(system_type), intent(inout) :: system
      type(state_type), intent(in) :: state
      real(wp), intent(out) :: strain, plastic
      real(wp) :: force(size(state%d)), updated(size(state%history)), energy(2)

      system%cost%energy_updates = system%cost%energy_updates &
            + count_resisting(system%structure, scheme_implicit) &
            + count_resisting(system%structure, scheme_explicit)
      if (.not. system%structure%is_linear) then
         strain = strain_energy(system%structure, state%d, state%history)
         plastic = plastic_work(system%structure, state%history)
         return
      end if
      force = 0.0_wp
      energy = 0.0_wp
      updated = state%history
      call elastic_force(system%structure, scheme_implicit, state%d, state%history, force, &
            updated, energy)
      call elastic_force(system%structure, scheme_explicit, state%d, state%history, force, &
            updated, energy)
      strain = energy(1)
      plastic = energy(2)
   end subroutine find_stored

   !> Kinetic and strain energy of every group, one after the other.
   function group_energies(system, state) result(energies)
      type(system_type), intent(inout) :: system
      type(state_type), intent(in) :: state
      real(wp) :: energies(2*size(system%structure%groups))
      integer :: g

      do g = 1, size(system%structure%groups)
         system%cost%energy_updates = system%cost%energy_updates &
               + size(system%structure%groups(g)%member)
         associate (group => system%structure%groups(g))
            energies(2*g - 1) = group_kinetic_energy(group, state%v)
            energies(2*g) = group_strain_energy(group, state%d, state%history)
         end associate
      end do
   end function group_energies

end module energy_ledger
