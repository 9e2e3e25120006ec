!> The equation of motion M a + C v + S(d) = f with its implicit and explicit parts, loads and
!> prescribed motion: residual, effective matrix, equilibrium acceleration, reactions.
module equation_of_motion
   use kinds, only: wp, int64
   use cost_account, only: cost_type, enter, leave, charge, phase_elements, phase_solve, &
         phase_factor
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use mesh, only: scheme_implicit, scheme_explicit
   use skyline_matrix, only: profile_type, new_profile
   use dof_map, only: reduce, expand, follow_constraints
   use structure, only: structure_type, elastic_force, damping_force, inertia_force, &
         count_resisting
   use external_load, only: load_set_type, load_at
   use prescribed_motion, only: motion_set_type, impose_motion
   use motion_state, only: state_type, newmark_type, predict, hold, copy_state
   use effective_system, only: effective_system_type
   use gauss_matrices, only: gauss_matrices_type
   implicit none
   private

   public :: system_type
   public :: predict_motion, start_near, fixed_force, residual, solve_motion, prepare_motion
   public :: prepare_mass, solve_mass, solve_together, force_balance, impose
   public :: settle_massless
   public :: rigid_mass, count_updates, resist, mark_type, begin_matrix, end_matrix
   public :: prepare_again

   !> A structure under the loads and conditions of a step, with its matrices.
   type :: system_type
      type(structure_type) :: structure
      type(load_set_type) :: loads
      type(motion_set_type) :: motions
      type(newmark_type) :: newmark
      type(profile_type) :: profile
      type(effective_system_type) :: matrices
      type(gauss_matrices_type) :: gauss         !! those of steps of fourth order
      type(cost_type) :: cost
      logical :: static = .false.
      real(wp) :: tolerance = 1.0e-10_wp         !! of the Newton iteration, relative
      integer :: max_iterations = 50
      logical, allocatable :: massless(:)        !! (n_eq) equations without mass
      real(wp) :: omega_max(2) = 0.0_wp          !! bound on the implicit, explicit frequencies
   end type system_type

   !> Costs before a matrix is made.
   type :: mark_type
      private
      real(wp) :: seconds = 0.0_wp
      integer(int64) :: n_assembled = 0
      integer :: outer = 0
   end type mark_type

contains

   !> Predictors at the end of a step, prescribed and dependent freedoms in their places.
   subroutine predict_motion(self, state, dt, beta, trial)
      type(system_type), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: dt
      real(wp), intent(in) :: beta               !! of this step, the impact step may have its own
      type(state_type), intent(inout) :: trial   !! its arrays are used again
      type(newmark_type) :: newmark

      if (self%static) then
         call copy_state(state, trial)
         trial%t = state%t + dt
      else
         newmark = self%newmark
         newmark%beta = beta
         call predict(newmark, state, dt, trial)
      end if
      call impose(self, trial)
   end subroutine predict_motion

   !> The state that Newton's method starts from, after `predict_motion`. Where omega h is large the
   !> acceleration throws the predictor (omega h)^2 times as far as a freedom ever gets, and the
   !> velocity omega h times as far; what is corrected from there has the round-off of that
   !> distance. Such freedoms start from where they are.
   subroutine start_near(self, state, dt, beta, trial)
      type(system_type), intent(in) :: self
      type(state_type), intent(in) :: state      !! at the start of the step
      real(wp), intent(in) :: dt
      real(wp), intent(in) :: beta
      type(state_type), intent(inout) :: trial
      real(wp), parameter :: far = 16.0_wp
      type(newmark_type) :: newmark
      real(wp) :: thrown(size(state%d))
      logical :: held(size(state%d))

      if (.not. beta > 0.0_wp) return
      thrown = (0.5_wp - beta)*dt**2*abs(state%a)
      held = thrown > far*(abs(state%d) + dt*abs(state%v))
      if (self%omega_max(scheme_implicit)*dt > far) held = held .or. &
            thrown + dt*abs(state%v) > far*abs(state%d)
      if (.not. any(held)) return
      held = held .and. .not. self%structure%map%prescribed
      newmark = self%newmark
      newmark%beta = beta
      call hold(newmark, state, dt, held, trial)
      call impose(self, trial)
   end subroutine start_near

   !> Puts prescribed freedoms where they have to be at the state's time, dependent ones after them.
   subroutine impose(self, state)
      type(system_type), intent(in) :: self
      type(state_type), intent(inout) :: state

      call impose_motion(self%motions, state%t, state%d, state%v, state%a)
      if (size(self%structure%map%dependent) == 0) return
      call follow_constraints(self%structure%map, state%d)
      call follow_constraints(self%structure%map, state%v)
      call follow_constraints(self%structure%map, state%a)
   end subroutine impose

   !> The part of the residual that does not change in the iteration (HHT alpha, 0 without):
   !> (1 + alpha) (f1 - S_E(d~, v~)) - alpha (f0 - S(d0, v0)).
   function fixed_force(self, state, predictor) result(force)
      type(system_type), intent(inout) :: self
      type(state_type), intent(in) :: state      !! at the start of the step
      type(state_type), intent(inout) :: predictor   !! gets the history of explicit elements
      real(wp) :: force(self%structure%map%n_freedoms)
      real(wp) :: resistance(size(force)), alpha

      alpha = merge(0.0_wp, self%newmark%alpha, self%static)
      call resist(self, scheme_explicit, predictor, state%history, resistance)
      force = load_at(self%loads, size(force), predictor%t) - resistance
      if (.not. abs(alpha) > 0.0_wp) return
      force = (1.0_wp + alpha)*force - alpha*force_balance(self, state)
   end function fixed_force

   !> psi = fixed - (1 + alpha) S_I(d, v) - M a, on freedoms.
   function residual(self, fixed, history, trial) result(psi)
      type(system_type), intent(inout) :: self
      real(wp), intent(in) :: fixed(:)           !! from `fixed_force`
      real(wp), intent(in), contiguous :: history(:)   !! at the start of the step
      type(state_type), intent(inout) :: trial   !! gets the history of implicit elements
      real(wp) :: psi(size(fixed))

      call resist(self, scheme_implicit, trial, history, psi)
      psi = fixed - (1.0_wp + merge(0.0_wp, self%newmark%alpha, self%static))*psi
      if (self%static .or. .not. any(abs(trial%a) > 0.0_wp)) return
      psi = psi - inertia_force(self%structure, trial%a)
   end function residual

   !> S(d) + C v of the groups of a scheme; no damping in a static step.
   !> The elements' history goes from the one given to that of the state.
   subroutine resist(self, scheme, state, history, force)
      type(system_type), intent(inout) :: self
      integer, intent(in) :: scheme
      type(state_type), intent(inout) :: state
      real(wp), intent(in), contiguous :: history(:)   !! last accepted
      real(wp), intent(out), contiguous :: force(:)    !! (n_freedoms)
      integer :: outer

      force = 0.0_wp
      if (count_resisting(self%structure, scheme) == 0) return
      call enter(self%cost, phase_elements, outer)
      call count_updates(self, scheme)
      call elastic_force(self%structure, scheme, state%d, history, force, state%history)
      if (.not. self%static) call damping_force(self%structure, scheme, state%v, force)
      call leave(self%cost, outer)
   end subroutine resist

   !> Counts the elements of a scheme whose forces are worked out once.
   pure subroutine count_updates(self, scheme)
      type(system_type), intent(inout) :: self
      integer, intent(in) :: scheme

      self%cost%element_updates = self%cost%element_updates &
            + count_resisting(self%structure, scheme)
   end subroutine count_updates

   !> Freedoms without mass are where forces balance; Newmark's rule knows no velocity of theirs. At
   !> beta = 1/4 it is 2 (d1 - d0)/dt - v0, which swings for ever while the acceleration grows with
   !> the steps, and at a smaller beta both grow without bound. Gives them the mean velocity of the
   !> step and no acceleration; nothing else of the motion depends on these but damping.
   pure subroutine settle_massless(self, from, to)
      type(system_type), intent(in) :: self
      type(state_type), intent(in) :: from       !! at the start of a step or part of one
      type(state_type), intent(inout) :: to      !! at its end
      integer :: f

      if (self%static .or. .not. to%t > from%t .or. .not. any(self%massless)) return
      associate (map => self%structure%map)
         do f = 1, map%n_freedoms
            if (map%id(map%dof(f), map%node(f)) == 0) cycle
            if (.not. self%massless(map%id(map%dof(f), map%node(f)))) cycle
            to%v(f) = (to%d(f) - from%d(f))/(to%t - from%t)
            to%a(f) = 0.0_wp
         end do
         call follow_constraints(map, to%v)
         call follow_constraints(map, to%a)
      end associate
   end subroutine settle_massless

   !> f - C v - S(d) at a state, all groups.
   function force_balance(self, state) result(force)
      type(system_type), intent(inout) :: self
      type(state_type), intent(in) :: state
      type(state_type) :: at
      real(wp) :: force(self%structure%map%n_freedoms)
      real(wp), dimension(size(force)) :: implicit_part, explicit_part

      at = state
      call resist(self, scheme_implicit, at, state%history, implicit_part)
      call resist(self, scheme_explicit, at, state%history, explicit_part)
      force = load_at(self%loads, size(force), state%t) - implicit_part - explicit_part
   end function force_balance

   !> The mass that each freedom has in a translation of all: M times one in its direction. Its sum
   !> with the velocities is the linear momentum, whatever the mass matrix.
   function rigid_mass(self) result(mass)
      type(system_type), intent(in) :: self
      real(wp) :: mass(self%structure%map%n_freedoms)
      real(wp) :: moved(self%structure%map%n_freedoms)
      integer :: i

      mass = 0.0_wp
      do i = 1, 3
         moved = merge(1.0_wp, 0.0_wp, self%structure%map%dof == i)
         mass = mass + moved*inertia_force(self%structure, moved)
      end do
   end function rigid_mass

   !> Makes M + (1 + alpha)(gamma h C + beta h^2 K) ready, or K in a static step.
   subroutine prepare_motion(self, dt, beta, d, history, error)
      type(system_type), intent(inout) :: self
      real(wp), intent(in) :: dt, beta
      real(wp), intent(in) :: d(:)               !! where the tangent is taken
      real(wp), intent(in) :: history(:)         !! last accepted
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: factors(3)

      factors = [1.0_wp, self%newmark%gamma*dt, beta*dt**2]
      factors(2:3) = (1.0_wp + self%newmark%alpha)*factors(2:3)
      if (self%static) factors = [0.0_wp, 0.0_wp, 1.0_wp]
      if (.not. self%structure%is_linear) call self%matrices%forget()
      call prepare(self, self%profile, d, history, factors, error)
   end subroutine prepare_motion

   !> Makes a matrix ready that has been there before: M or one of `prepare_motion`.
   subroutine prepare_again(self, factors, state, error)
      type(system_type), intent(inout) :: self
      real(wp), intent(in) :: factors(3)         !! c_m, c_c, c_k
      type(state_type), intent(in) :: state      !! any, the matrix does not depend on it
      type(error_type), allocatable, intent(out) :: error

      if (any(factors(2:3) > 0.0_wp)) then
         call prepare(self, self%profile, state%d, state%history, factors, error)
      else
         call prepare_mass(self, error)
      end if
   end subroutine prepare_again

   !> Makes a matrix ready; books what that takes.
   subroutine prepare(self, profile, d, history, factors, error)
      type(system_type), intent(inout) :: self
      type(profile_type), intent(in) :: profile
      real(wp), intent(in) :: d(:), history(:), factors(3)
      type(error_type), allocatable, intent(out) :: error
      type(mark_type) :: mark

      call begin_matrix(self, mark)
      call self%matrices%prepare(self%structure, profile, d, history, factors, error)
      call end_matrix(self, mark)
   end subroutine prepare

   !> Before a matrix is assembled and factorized: marks the costs so far.
   subroutine begin_matrix(self, mark)
      type(system_type), intent(inout) :: self
      type(mark_type), intent(out) :: mark

      call enter(self%cost, phase_elements, mark%outer)
      mark%seconds = self%matrices%factor_seconds
      mark%n_assembled = self%matrices%n_assembled
   end subroutine begin_matrix

   !> After it: books the factorization and the elements.
   subroutine end_matrix(self, mark)
      type(system_type), intent(inout) :: self
      type(mark_type), intent(in) :: mark

      call charge(self%cost, phase_factor, self%matrices%factor_seconds - mark%seconds)
      self%cost%element_updates = self%cost%element_updates + self%matrices%n_assembled &
            - mark%n_assembled
      call leave(self%cost, mark%outer)
   end subroutine end_matrix

   !> Motion of the freedoms (acceleration, or displacement in a static step) under forces on them,
   !> with the matrix last prepared.
   function solve_motion(self, force) result(motion)
      type(system_type), intent(inout) :: self
      real(wp), intent(in) :: force(:)           !! (n_freedoms)
      real(wp) :: motion(size(force))
      real(wp) :: b(self%structure%map%n_eq)
      integer :: outer

      b = reduce(self%structure%map, force)
      call enter(self%cost, phase_solve, outer)
      call self%matrices%solve(b)
      call leave(self%cost, outer)
      motion = expand(self%structure%map, b)
   end function solve_motion

   !> Makes M ready, massless equations with a unit diagonal.
   subroutine prepare_mass(self, error)
      type(system_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      real(wp), parameter :: mass_alone(3) = [1.0_wp, 0.0_wp, 0.0_wp]
      real(wp) :: d(self%structure%map%n_freedoms), history(self%structure%n_history)
      type(profile_type) :: diagonal

      d = 0.0_wp
      history = 0.0_wp
      if (self%structure%has_consistent_mass .or. size(self%structure%map%dependent) > 0) then
         call prepare(self, self%profile, d, history, mass_alone, error)
      else
         ! lumped mass couples nothing
         call new_profile(diagonal, self%profile%n)
         call prepare(self, diagonal, d, history, mass_alone, error)
      end if
   end subroutine prepare_mass

   !> M^-1 force on freedoms, nothing on massless ones. `prepare_mass` comes first.
   function solve_mass(self, force) result(motion)
      type(system_type), intent(inout) :: self
      real(wp), intent(in) :: force(:)           !! (n_freedoms)
      real(wp) :: motion(size(force))
      real(wp) :: b(self%structure%map%n_eq)
      integer :: outer

      b = reduce(self%structure%map, force)
      where (self%massless) b = 0.0_wp
      call enter(self%cost, phase_solve, outer)
      call self%matrices%solve(b)
      call leave(self%cost, outer)
      motion = expand(self%structure%map, b)
   end function solve_mass

   !> `solve_motion` (or, on the mass, `solve_mass`) for several forces at once.
   subroutine solve_together(self, on_mass, forces)
      type(system_type), intent(inout) :: self
      logical, intent(in) :: on_mass
      real(wp), intent(inout) :: forces(:, :)    !! (n_freedoms, n), then the motions
      real(wp), allocatable :: b(:, :)
      integer :: j, outer, status

      allocate (b(self%structure%map%n_eq, size(forces, 2)), stat=status)
      call check_allocation(status)
      do j = 1, size(b, 2)
         b(:, j) = reduce(self%structure%map, forces(:, j))
         if (on_mass) where (self%massless) b(:, j) = 0.0_wp
      end do
      call enter(self%cost, phase_solve, outer)
      call self%matrices%solve_many(b)
      call leave(self%cost, outer)
      do j = 1, size(b, 2)
         forces(:, j) = expand(self%structure%map, b(:, j))
      end do
   end subroutine solve_together

end module equation_of_motion
