!> Steps of a wholly explicit system: Newmark's method with beta = 0 on a diagonal mass, where no
!> constraint couples freedoms and those prescribed stand still. It is the general step without what
!> such a system does not need, each vector touched as seldom as can be.
module explicit_motion
   use kinds, only: wp
   use state_archive, only: archive_type
   use mesh, only: scheme_implicit, scheme_explicit
   use structure, only: elastic_force, damping_force, count_resisting
   use external_load, only: load_at
   use prescribed_motion, only: are_at_rest
   use motion_state, only: state_type, exchange
   use cost_account, only: enter, leave, phase_elements
   use memory_shortage, only: check_allocation
   use equation_of_motion, only: system_type, count_updates
   use energy_ledger, only: ledger_type, record_found
   implicit none
   private

   public :: explicit_motion_type, new_explicit_motion, advance_explicitly, go_on_explicitly

   !> Freedoms whose energies are added up at once: sums do not depend on the number of threads.
   integer, parameter :: run_length = 4096

   !> Freedoms from which on threads are worth their waking up.
   integer, parameter :: fewest_for_threads = 16384

   !> What stays the same over the increments of a step, and work space.
   type :: explicit_motion_type
      logical :: ready = .false.                 !! made for the step at hand
      logical :: usable = .false.                !! the system is one of those above
      logical :: damped = .false.
      real(wp), allocatable :: inverse(:)        !! (n_freedoms) 1/mass, 0 where prescribed
      real(wp), allocatable :: force(:)          !! (n_freedoms) f - S - C v, then work space
      real(wp), allocatable :: load(:)           !! (n_freedoms) at the start of an increment
      real(wp), allocatable :: change(:)         !! (n_freedoms) of d in an increment, if damped
      real(wp), allocatable :: history(:)        !! (n_history) work space
   contains
      procedure :: pass_state
   end type explicit_motion_type

contains

   !> What is not found again from the system; `go_on_explicitly` finds the rest.
   subroutine pass_state(self, archive)
      class(explicit_motion_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%pass('ready', self%ready)
      call archive%pass('usable', self%usable)
      call archive%pass('damped', self%damped)
      call archive%pass('load', self%load)
   end subroutine pass_state

   !> Looks at the system at the start of a step or later in it.
   subroutine new_explicit_motion(self, system, state)
      type(explicit_motion_type), intent(out) :: self
      type(system_type), intent(in) :: system
      type(state_type), intent(in) :: state
      integer :: g, status

      self%ready = .true.
      self%usable = is_explicit(system)
      if (self%usable) self%usable = are_at_rest(system%motions, state%d, state%v, state%a)
      if (.not. self%usable) return
      do g = 1, size(system%structure%groups)
         self%damped = self%damped .or. size(system%structure%groups(g)%damping) > 0
      end do
      allocate (self%load(merge(size(state%d), 0, size(system%loads%loads) > 0)), stat=status)
      call check_allocation(status)
      if (size(self%load) > 0) self%load = load_at(system%loads, size(self%load), state%t)
      call go_on_explicitly(self, system, state)
   end subroutine new_explicit_motion

   !> All but the loads at the start of the increment to come, which are known.
   subroutine go_on_explicitly(self, system, state)
      type(explicit_motion_type), intent(inout) :: self
      type(system_type), intent(in) :: system
      type(state_type), intent(in) :: state
      integer :: status

      if (allocated(self%inverse)) deallocate (self%inverse, self%force, self%change)
      if (.not. self%usable) return
      associate (mass => system%structure%lumped_mass)
         allocate (self%inverse(size(mass)), self%force(size(mass)), stat=status)
         call check_allocation(status)
         where (system%structure%map%prescribed .or. .not. mass > 0.0_wp)
            self%inverse = 0.0_wp
         else where
            self%inverse = 1.0_wp/mass
         end where
         allocate (self%change(merge(size(mass), 0, self%damped)), stat=status)
         call check_allocation(status)
      end associate
      self%history = state%history
   end subroutine go_on_explicitly

   !> Whether nothing of the system is implicit, coupled or without mass.
   function is_explicit(system) result(explicit)
      type(system_type), intent(in) :: system
      logical :: explicit

      explicit = .false.
      if (system%static .or. system%newmark%beta > 0.0_wp) return
      if (abs(system%newmark%alpha) > 0.0_wp) return
      if (system%structure%has_consistent_mass) return
      if (size(system%structure%map%dependent) > 0) return
      if (any(system%massless)) return
      explicit = count_resisting(system%structure, scheme_implicit) == 0
   end function is_explicit

   !> One increment. d1 = d + h v + h^2/2 a,  v~ = v + h (1 - gamma) a,
   !> M a1 = f1 - S(d1) - C v~,  v1 = v~ + gamma h a1  (Hughes and Liu with beta = 0).
   subroutine advance_explicitly(self, system, ledger, state, dt)
      type(explicit_motion_type), intent(inout) :: self
      type(system_type), intent(inout) :: system
      type(ledger_type), intent(inout) :: ledger
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: dt
      real(wp) :: energy(3), work, lost
      integer :: outer

      work = 0.0_wp
      lost = 0.0_wp
      if (self%damped) self%change = dt*state%v + dt**2/2.0_wp*state%a
      if (self%damped) call add_damping_work(self, system, state%v, lost)
      if (size(self%load) > 0) call load_increment(self, system, state, dt, work)
      call predict(dt, system%newmark%gamma, state, self%force)
      energy = 0.0_wp
      call enter(system%cost, phase_elements, outer)
      call count_updates(system, scheme_explicit)
      call elastic_force(system%structure, scheme_explicit, state%d, state%history, self%force, &
            self%history, energy(2:3))
      call exchange(state%history, self%history)
      if (self%damped) call damping_force(system%structure, scheme_explicit, state%v, self%force)
      call leave(system%cost, outer)
      if (size(self%load) > 0) self%force = self%force - self%load
      call correct(self%inverse, system%structure%lumped_mass, self%force, &
            system%newmark%gamma*dt, state, energy(1))
      if (self%damped) call add_damping_work(self, system, state%v, lost)
      state%t = state%t + dt
      call record_found(ledger, work, lost, energy)
   end subroutine advance_explicitly

   !> Loads at the end of an increment, and their work over it by the trapezoidal rule.
   subroutine load_increment(self, system, state, dt, work)
      type(explicit_motion_type), intent(inout) :: self
      type(system_type), intent(in) :: system
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: dt
      real(wp), intent(out) :: work
      real(wp) :: before(size(self%load))

      before = self%load
      self%load = load_at(system%loads, size(self%load), state%t + dt)
      work = dot_product(dt*state%v + dt**2/2.0_wp*state%a, before + self%load)/2.0_wp
   end subroutine load_increment

   !> Half of what dampers take over an increment: their force at one of its ends times the change.
   subroutine add_damping_work(self, system, v, lost)
      type(explicit_motion_type), intent(inout) :: self
      type(system_type), intent(in) :: system
      real(wp), intent(in) :: v(:)
      real(wp), intent(inout) :: lost

      self%force = 0.0_wp
      call damping_force(system%structure, scheme_explicit, v, self%force)
      lost = lost + dot_product(self%change, self%force)/2.0_wp
   end subroutine add_damping_work

   !> d and v go to their predictors, the force to zero.
   subroutine predict(dt, gamma, state, force)
      real(wp), intent(in) :: dt, gamma
      type(state_type), intent(inout) :: state
      real(wp), intent(out) :: force(:)
      real(wp) :: half, rest
      integer :: i

      half = dt**2/2.0_wp
      rest = dt*(1.0_wp - gamma)
      associate (d => state%d, v => state%v, a => state%a)
         !$omp parallel do simd schedule(static) if (size(force) > fewest_for_threads)
         do i = 1, size(force)
            d(i) = d(i) + dt*v(i) + half*a(i)
            v(i) = v(i) + rest*a(i)
            force(i) = 0.0_wp
         end do
      end associate
   end subroutine predict

   !> a = -force/mass and v corrected; the kinetic energy on the way.
   subroutine correct(inverse, mass, force, factor, state, kinetic)
      real(wp), intent(in) :: inverse(:), mass(:), force(:)
      real(wp), intent(in) :: factor              !! gamma h
      type(state_type), intent(inout) :: state
      real(wp), intent(out) :: kinetic
      real(wp) :: part((size(force) + run_length - 1)/run_length), sum_of_run
      integer :: i, j

      associate (v => state%v, a => state%a)
         !$omp parallel do schedule(static) private(i, sum_of_run) if (size(part) > 4)
         do j = 1, size(part)
            sum_of_run = 0.0_wp
            !$omp simd reduction(+:sum_of_run)
            do i = (j - 1)*run_length + 1, min(size(force), j*run_length)
               a(i) = -inverse(i)*force(i)
               v(i) = v(i) + factor*a(i)
               sum_of_run = sum_of_run + mass(i)*v(i)*v(i)
            end do
            part(j) = sum_of_run
         end do
      end associate
      kinetic = sum(part)/2.0_wp
   end subroutine correct

end module explicit_motion
