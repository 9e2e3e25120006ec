!> One step of the two-stage Gauss method (Runge and Kutta, fourth order, the diagonal Pade step)
!> for a linear system, in second-order form: the two stages are complex conjugates of each other,
!> so that one complex system stands for both. With r = 3 + i sqrt(3), s = r/h, it reads like
!> Newmark's method:
!>
!>     d~ = d0 + v0/s                    (M + C/s + K/s^2) a = f - C v0 - K d~
!>     d1 = d0 + h v0 + 2 h Re(b a/s)    v1 = v0 + 2 h Re(b a)
!>
!> f joins the loads at both Gauss points. It conserves the energy of every free motion, whatever h.
module gauss_step
   use kinds, only: wp
   use errors, only: error_type
   use cost_account, only: enter, leave, phase_solve
   use mesh, only: scheme_implicit
   use dof_map, only: reduce, expand, follow_constraints
   use structure, only: damping_force, inertia_force
   use external_load, only: load_at
   use prescribed_motion, only: impose_motion
   use motion_state, only: state_type
   use equation_of_motion, only: system_type, impose, resist, mark_type, begin_matrix, end_matrix
   use gauss_matrices, only: prepare_gauss, solve_gauss
   use reactions, only: reaction_forces
   implicit none
   private

   public :: start_gauss, free_acceleration, solve_complex, end_gauss, stage_state, step_sum
   public :: span_works, stage_value, prepare_step

   real(wp), parameter :: root = sqrt(3.0_wp)
   !> r: the eigenvalue of the inverse of Gauss' matrix, the other one is its conjugate.
   complex(wp), parameter :: rate = cmplx(3.0_wp, root, wp)
   !> Gauss points as parts of the step, and the first row of Gauss' matrix.
   real(wp), parameter :: point(2) = [0.5_wp - root/6.0_wp, 0.5_wp + root/6.0_wp]
   real(wp), parameter :: first_row(2) = [0.25_wp, 0.25_wp - root/6.0_wp]
   !> The complex value that belongs to r of what has given values at both points, their sum 1; back
   !> from it a value at a point is 2 Re(stage a), the sum over the step 2 h Re(b a).
   complex(wp), parameter :: ratio = cmplx(0.0_wp, root - 2.0_wp, wp)
   complex(wp), parameter :: joint(2) = [1.0_wp/(1.0_wp + ratio), ratio/(1.0_wp + ratio)]
   complex(wp), parameter :: stage(2) = [(1.0_wp + ratio)/2.0_wp, &
         (1.0_wp + ratio)*(0.0_wp, 0.5_wp)*(2.0_wp + root)]
   complex(wp), parameter :: weight = cmplx(0.5_wp, 0.5_wp*root, wp)

contains

   !> The start of a step, and the complex acceleration of prescribed freedoms. Displacements that
   !> are prescribed along straight lines have velocities that jump at their corners: that of this
   !> step counts.
   subroutine start_gauss(system, from, dt, start, a)
      type(system_type), intent(in) :: system
      type(state_type), intent(in) :: from
      real(wp), intent(in) :: dt
      type(state_type), intent(out) :: start
      complex(wp), intent(out) :: a(:)           !! (n_freedoms) zero where free
      real(wp), dimension(size(a)) :: d, v, v_first
      real(wp) :: acceleration(size(a), 2)
      integer :: i

      start = from
      a = (0.0_wp, 0.0_wp)
      if (size(system%motions%motions) == 0) return
      d = 0.0_wp
      v = 0.0_wp
      acceleration = 0.0_wp
      do i = 2, 1, -1
         call impose_motion(system%motions, from%t + point(i)*dt, d, v, acceleration(:, i))
      end do
      v_first = v - dt*matmul(acceleration, first_row)
      where (system%structure%map%prescribed)
         start%v = v_first
         a = joint(1)*acceleration(:, 1) + joint(2)*acceleration(:, 2)
      end where
      call follow_constraints(system%structure%map, start%v)
      call follow_complex(system, a)
   end subroutine start_gauss

   subroutine follow_complex(system, u)
      type(system_type), intent(in) :: system
      complex(wp), intent(inout) :: u(:)
      real(wp) :: parts(size(u), 2)

      if (size(system%structure%map%dependent) == 0) return
      parts(:, 1) = real(u, wp)
      parts(:, 2) = aimag(u)
      call follow_constraints(system%structure%map, parts(:, 1))
      call follow_constraints(system%structure%map, parts(:, 2))
      u = cmplx(parts(:, 1), parts(:, 2), wp)
   end subroutine follow_complex

   !> Adds to the acceleration of prescribed freedoms that of the free ones, without contact forces.
   !> Error: singular matrix.
   subroutine free_acceleration(system, start, dt, whole, a, error)
      type(system_type), intent(inout) :: system
      type(state_type), intent(in) :: start
      real(wp), intent(in) :: dt
      logical, intent(in) :: whole               !! the whole step, not a part of one
      complex(wp), intent(inout) :: a(:)         !! (n_freedoms)
      type(error_type), allocatable, intent(out) :: error
      complex(wp), dimension(size(a)) :: v, force
      complex(wp) :: s
      integer :: i

      s = rate/dt
      v = start%v + a/s
      force = -resistance(system, start, start%d + v/s, v, a)
      do i = 1, 2
         force = force + joint(i)*load_at(system%loads, size(a), start%t + point(i)*dt)
      end do
      call prepare_step(system, dt, whole, error)
      if (allocated(error)) return
      a = a + solve_complex(system, force)
   end subroutine free_acceleration

   !> Makes the matrix of a step ready; books what that takes.
   subroutine prepare_step(system, dt, whole, error)
      type(system_type), intent(inout) :: system
      real(wp), intent(in) :: dt
      logical, intent(in) :: whole
      type(error_type), allocatable, intent(out) :: error
      type(mark_type) :: mark

      call begin_matrix(system, mark)
      call prepare_gauss(system%gauss, system%matrices, system%structure, system%profile, rate/dt, &
            dt, whole, error)
      call end_matrix(system, mark)
   end subroutine prepare_step

   !> K d + C v + M a.
   function resistance(system, start, d, v, a) result(force)
      type(system_type), intent(inout) :: system
      type(state_type), intent(in) :: start
      complex(wp), intent(in) :: d(:), v(:), a(:)   !! (n_freedoms)
      complex(wp) :: force(size(a))
      type(state_type) :: part
      real(wp) :: parts(size(a), 2)

      part = start
      part%d = real(d, wp)
      part%v = real(v, wp)
      call resist(system, scheme_implicit, part, start%history, parts(:, 1))
      part%d = aimag(d)
      part%v = aimag(v)
      call resist(system, scheme_implicit, part, start%history, parts(:, 2))
      if (any(abs(a) > 0.0_wp)) then
         parts(:, 1) = parts(:, 1) + inertia_force(system%structure, real(a, wp))
         parts(:, 2) = parts(:, 2) + inertia_force(system%structure, aimag(a))
      end if
      force = cmplx(parts(:, 1), parts(:, 2), wp)
   end function resistance

   !> Complex acceleration under complex forces, with the matrix last prepared.
   function solve_complex(system, force) result(a)
      type(system_type), intent(inout) :: system
      complex(wp), intent(in) :: force(:)        !! (n_freedoms)
      complex(wp) :: a(size(force))
      complex(wp) :: b(system%structure%map%n_eq)
      integer :: outer

      b = cmplx(reduce(system%structure%map, real(force, wp)), &
            reduce(system%structure%map, aimag(force)), wp)
      call enter(system%cost, phase_solve, outer)
      call solve_gauss(system%gauss, system%matrices, b)
      call leave(system%cost, outer)
      a = cmplx(expand(system%structure%map, real(b, wp)), &
            expand(system%structure%map, aimag(b)), wp)
   end function solve_complex

   !> Displacement and velocity at the end of the step.
   subroutine end_gauss(system, start, dt, a, to)
      type(system_type), intent(in) :: system
      type(state_type), intent(in) :: start
      real(wp), intent(in) :: dt
      complex(wp), intent(in) :: a(:)            !! (n_freedoms)
      type(state_type), intent(inout) :: to

      to%t = start%t + dt
      to%d = start%d + dt*start%v + dt*step_sum(a*(dt/rate))
      to%v = start%v + dt*step_sum(a)
      call impose(system, to)
   end subroutine end_gauss

   !> Mean over the step of what has the complex value a at its Gauss points.
   elemental real(wp) function step_sum(a)
      complex(wp), intent(in) :: a

      step_sum = 2.0_wp*real(weight*a, wp)
   end function step_sum

   !> The value at a Gauss point.
   elemental real(wp) function stage_value(i, a)
      integer, intent(in) :: i                   !! 1 or 2
      complex(wp), intent(in) :: a

      stage_value = 2.0_wp*real(stage(i)*a, wp)
   end function stage_value

   !> The motion at a Gauss point: of second order only, but just what the step's sums are made of.
   subroutine stage_state(start, dt, a, i, state)
      type(state_type), intent(in) :: start
      real(wp), intent(in) :: dt
      complex(wp), intent(in) :: a(:)            !! (n_freedoms)
      integer, intent(in) :: i                   !! 1 or 2
      type(state_type), intent(out) :: state
      complex(wp) :: s

      s = rate/dt
      state%t = start%t + point(i)*dt
      state%history = start%history
      state%a = stage_value(i, a)
      state%v = start%v + stage_value(i, a/s)
      state%d = start%d + stage_value(i, (start%v + a/s)/s)
   end subroutine stage_state

   !> Works over the step: of loads and of what moves prescribed freedoms, and of damping. The sums
   !> over the Gauss points balance the energies at the ends exactly.
   subroutine span_works(system, start, dt, a, contact, works)
      type(system_type), intent(inout) :: system
      type(state_type), intent(in) :: start
      real(wp), intent(in) :: dt
      complex(wp), intent(in) :: a(:)            !! (n_freedoms)
      complex(wp), intent(in) :: contact(:)      !! (n_freedoms) contact forces
      real(wp), intent(out) :: works(2)          !! from outside, damping
      type(state_type) :: at
      real(wp) :: force(size(a))
      logical :: moved
      integer :: i

      works = 0.0_wp
      do i = 1, 2
         call stage_state(start, dt, a, i, at)
         force = 0.0_wp
         call damping_force(system%structure, scheme_implicit, at%v, force)
         works(2) = works(2) + dt/2.0_wp*dot_product(force, at%v)
         force = load_at(system%loads, size(a), at%t)
         moved = any(abs(at%v) > 0.0_wp .and. system%structure%map%prescribed)
         if (moved) force = force + reaction_forces(system, at, stage_value(i, contact))
         works(1) = works(1) + dt/2.0_wp*dot_product(force, at%v)
      end do
   end subroutine span_works

end module gauss_step
