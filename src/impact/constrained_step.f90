!> One Newmark step of smooth motion with contact rows held or complementary, and the step of a
!> static problem.
module constrained_step
   use kinds, only: wp
   use cost_account, only: enter, leave, phase_other, phase_contact
   use errors, only: error_type, new_error, status_numerical
   use text, only: to_text
   use dof_map, only: reduce
   use motion_state, only: newmark_type, state_type, correct
   use equation_of_motion, only: system_type, predict_motion, start_near, fixed_force, residual, &
         solve_motion, prepare_motion, settle_massless
   use impact_scene, only: scene_type, contact_motion_type, copy_contact_motion, &
         record_residual, note_contact_force
   use constraint_rows, only: law_motion
   use step_contact, only: contact_step_type, add_contact_forces, smallest_beta
   use row_placement, only: place_rows
   use overlap_force, only: add_overlap_force
   implicit none
   private

   public :: advance_smoothly, solve_statically

   !> How far Newton's method has come in a step.
   type :: progress_type
      real(wp) :: to_displacement = 1.0_wp       !! displacement in a unit of the correction
      real(wp) :: reference = 0.0_wp             !! largest forces met
      real(wp) :: left = huge(1.0_wp)            !! residual of the last iteration
      real(wp) :: correction = huge(1.0_wp)      !! of the last iteration
   end type progress_type

contains

   !> M a + C v + S(d) = f + Gt lambda over a step dt, for the touching rows
   !> 0 <= lambda, W lambda + G a_free >= 0 (or, given `held`, W lambda + G a_free = 0 on its
   !> rows), with
   !> W = G A^-1 Gt, A = M + gamma h C + beta h^2 K; overlapping rows get their fictitious force
   !> where
   !> the scene has that method. Solved for accelerations: nothing is divided by beta h^2. Errors:
   !> singular matrix, no convergence of nonlinear elements.
   subroutine advance_smoothly(scene, from, dt, beta, to, error, held)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      real(wp), intent(in) :: dt
      real(wp), intent(in) :: beta
      type(contact_motion_type), intent(inout) :: to   !! at the end; its arrays are used again
      type(error_type), allocatable, intent(out) :: error
      logical, intent(in), optional :: held(:)   !! (n_rows) rows held bilaterally, the others free
      type(newmark_type) :: newmark
      type(contact_step_type) :: step
      real(wp), dimension(size(from%motion%d)) :: fixed, psi, delta
      type(progress_type) :: progress
      logical :: converged
      integer :: iteration, outer

      call enter(scene%system%cost, phase_other, outer)
      newmark = scene%system%newmark
      newmark%beta = beta
      call copy_contact_motion(from, to)
      to%jump = 0.0_wp
      to%left_out = 0.0_wp
      call predict_motion(scene%system, from%motion, dt, beta, to%motion)
      fixed = fixed_force(scene%system, from%motion, to%motion)
      call start_near(scene%system, from%motion, dt, beta, to%motion)
      call describe_step(scene, dt, beta, step)
      if (present(held)) step%held = held
      progress%to_displacement = step%to_displacement
      do iteration = 1, scene%system%max_iterations
         psi = residual(scene%system, fixed, from%motion%history, to%motion)
         call prepare_motion(scene%system, dt, beta, to%motion%d, from%motion%history, error)
         if (allocated(error)) return
         delta = solve_motion(scene%system, psi)
         if (may_push(scene, step, to)) call push_apart(scene, step, beta*dt**2, from, to, delta, &
               error)
         if (allocated(error)) return
         call correct(newmark, dt, delta, to%motion)
         call note_contact_force(scene, to)
         converged = scene%system%structure%is_linear
         if (converged) exit
         progress%reference = max(progress%reference, norm2(psi), norm2(fixed))
         call judge(scene, fixed, from, to, delta, progress, converged)
         call record_residual(scene, iteration, &
               progress%left/max(progress%reference, tiny(1.0_wp)))
         if (converged) exit
      end do
      if (.not. converged) call not_converged(scene, to%motion%t, error)
      call settle_massless(scene%system, from%motion, to%motion)
      call leave(scene%system%cost, outer)
   end subroutine advance_smoothly

   !> Whether contact forces may act in a step: rows whose law speaks of the motion alone have none
   !> unless they touch. Without any the forces of the motion are zero.
   function may_push(scene, step, to) result(may)
      type(scene_type), intent(in) :: scene
      type(contact_step_type), intent(in) :: step
      type(contact_motion_type), intent(inout) :: to
      logical :: may

      may = scene%rows%n > 0
      if (.not. may .or. any(scene%rows%law /= law_motion)) return
      may = any(to%touching)
      if (allocated(step%held)) may = any(step%held)
      if (may) return
      to%lambda = 0.0_wp
      to%tau = 0.0_wp
      to%sticking = .false.
   end function may_push

   !> Adds to the motion what contact forces of all kinds do.
   subroutine push_apart(scene, step, beta_dt2, from, to, delta, error)
      type(scene_type), intent(inout) :: scene
      type(contact_step_type), intent(in) :: step
      real(wp), intent(in) :: beta_dt2           !! beta h^2
      type(contact_motion_type), intent(in) :: from
      type(contact_motion_type), intent(inout) :: to
      real(wp), intent(inout) :: delta(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: outer

      call enter(scene%system%cost, phase_contact, outer)
      call add_contact_forces(scene, step, from, to, delta, error)
      if (allocated(error)) return
      if (scene%settings%iterated) call add_overlap_force(scene, beta_dt2, to, delta, error)
      if (allocated(error)) return
      call leave(scene%system%cost, outer)
   end subroutine push_apart

   !> What contact needs to know of a dynamic step.
   subroutine describe_step(scene, dt, beta, step)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: dt, beta
      type(contact_step_type), intent(out) :: step

      step%to_displacement = max(beta, smallest_beta)*dt**2
      step%explicit = .not. beta > 0.0_wp
      step%to_velocity = scene%system%newmark%gamma*dt
   end subroutine describe_step

   !> Newton's method has converged when both the correction and the residual are small, or have
   !> come down to round-off: then they fall no further. Nearly incompressible solids have such
   !> round-off of the residual above the tolerance; under stress at rest the acceleration is
   !> nothing else, and its correction is measured by the displacements.
   subroutine judge(scene, fixed, from, to, delta, progress, converged)
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: fixed(:), delta(:)
      type(contact_motion_type), intent(in) :: from
      type(contact_motion_type), intent(inout) :: to   !! gets the history at its displacements
      type(progress_type), intent(inout) :: progress
      logical, intent(out) :: converged
      real(wp), parameter :: most_round_off = 1.0e-7_wp
      real(wp) :: psi(size(fixed)), motion, tolerance
      type(progress_type) :: before
      logical :: small, unseen

      tolerance = scene%system%tolerance
      before = progress
      motion = norm2(to%motion%a)
      if (scene%system%static) motion = norm2(to%motion%d)
      psi = residual(scene%system, fixed, from%motion%history, to%motion) &
            + to%force
      progress%left = norm2(reduce(scene%system%structure%map, psi))
      progress%correction = norm2(delta)
      small = progress%correction <= tolerance*motion
      unseen = .not. scene%system%static .and. progress%to_displacement*progress%correction &
            <= epsilon(1.0_wp)*norm2(to%motion%d)
      small = small .or. (progress%correction >= 0.5_wp*before%correction .and. &
            progress%to_displacement*progress%correction <= tolerance*norm2(to%motion%d))
      converged = progress%left <= tolerance*progress%reference
      converged = converged .or. (progress%left <= most_round_off*progress%reference .and. &
            progress%left >= 0.5_wp*before%left)
      converged = (converged .and. small) .or. unseen
      converged = converged .or. .not. (motion > 0.0_wp .or. progress%reference > 0.0_wp)
   end subroutine judge

   subroutine not_converged(scene, t, error)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: t
      type(error_type), allocatable, intent(out) :: error

      call new_error(error, status_numerical, 'no convergence in ' &
            //to_text(scene%system%max_iterations)//' iterations at time '//to_text(t) &
            //new_line('a') &
            //'  cure: a smaller increment; else tables without sharp drops of stiffness, ' &
            //'*PLASTIC with some hardening, or another METHOD of *IMPACT')
   end subroutine not_converged

   !> S(d) = f + Gt lambda with 0 <= lambda, g >= 0 on all rows; the motion solution is a
   !> displacement here. Velocities and accelerations are zero.
   subroutine solve_statically(scene, from, dt, to, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      real(wp), intent(in) :: dt
      type(contact_motion_type), intent(out) :: to
      type(error_type), allocatable, intent(out) :: error
      type(contact_step_type) :: step
      real(wp), dimension(size(from%motion%d)) :: fixed, psi, delta
      type(progress_type) :: progress
      logical :: converged
      integer :: iteration

      to = from
      call predict_motion(scene%system, from%motion, dt, 0.25_wp, to%motion)
      to%motion%v = 0.0_wp
      to%motion%a = 0.0_wp
      to%touching = .false.
      step%static = .true.
      fixed = fixed_force(scene%system, from%motion, to%motion)
      call place_rows(scene%rows, scene%geometry, scene%system%structure%map, from%motion, &
            to%motion, huge(1.0_wp))
      do iteration = 1, scene%system%max_iterations
         if (iteration == 1 .and. .not. scene%system%structure%is_linear) then
            psi = first_residual(scene%system, fixed, from%motion, to%motion%d)
            call prepare_motion(scene%system, dt, 0.25_wp, from%motion%d, from%motion%history, &
                  error)
         else
            psi = residual(scene%system, fixed, from%motion%history, to%motion)
            call prepare_motion(scene%system, dt, 0.25_wp, to%motion%d, from%motion%history, error)
         end if
         if (allocated(error)) then
            if (scene%rows%n > 0) error%message = error%message//new_line('a')//'  (contact does ' &
                  //'not hold a body at rest before it is pressed: springs hold it, or a dynamic ' &
                  //'step with *DAMPING brings it to rest)'
            return
         end if
         delta = solve_motion(scene%system, psi)
         call add_contact_forces(scene, step, from, to, delta, error)
         if (allocated(error)) return
         to%motion%d = to%motion%d + delta
         call note_contact_force(scene, to)
         converged = scene%system%structure%is_linear .and. .not. scene%rows%moving
         if (converged) exit
         call place_rows(scene%rows, scene%geometry, scene%system%structure%map, from%motion, &
               to%motion, huge(1.0_wp))
         progress%reference = max(progress%reference, norm2(psi), norm2(fixed))
         call judge(scene, fixed, from, to, delta, progress, converged)
         call record_residual(scene, iteration, &
               progress%left/max(progress%reference, tiny(1.0_wp)))
         if (converged) exit
      end do
      to%touching = to%lambda > 0.0_wp
      if (.not. converged) call not_converged(scene, to%motion%t, error)
   end subroutine solve_statically

   !> Residual of a static step's first iteration, where prescribed freedoms have gone ahead of all
   !> others: their neighbours would yield though nothing does in the end, and Newton's method not
   !> recover. So their jump is taken as linear, by a difference backwards, where what yields is
   !> elastic as the stiffness at the start is.
   function first_residual(system, fixed, from, ahead) result(psi)
      type(system_type), intent(inout) :: system
      real(wp), intent(in) :: fixed(:)
      type(state_type), intent(in) :: from
      real(wp), intent(in) :: ahead(:)           !! displacements, the prescribed ones moved on
      real(wp) :: psi(size(fixed))
      real(wp), parameter :: part = 1.0e-6_wp
      real(wp) :: psi_behind(size(fixed))
      type(state_type) :: start, behind

      start = from
      psi = residual(system, fixed, from%history, start)
      if (all(abs(ahead - from%d) <= 0.0_wp)) return
      behind = from
      behind%d = from%d - part*(ahead - from%d)
      psi_behind = residual(system, fixed, from%history, behind)
      psi = psi - (psi_behind - psi)/part
   end function first_residual

end module constrained_step
