!> A step of smooth motion by the two-stage Gauss method with the touching rows held: G d = const is
!> kept by complex forces, so that what moves freely does so with fourth order. At its end the
!> acceleration and the contact forces are those of equilibrium.
module fourth_order_step
   use kinds, only: wp, int64
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use square_systems, only: solve_complex_square
   use motion_state, only: state_type
   use structure, only: inertia_force
   use energy_ledger, only: record_works
   use gauss_step, only: start_gauss, free_acceleration, solve_complex, end_gauss, step_sum, &
         stage_value, span_works
   use compliance_store, only: complex_columns_type
   use constraint_rows, only: row_vector, row_forces, row_accelerations
   use impact_scene, only: scene_type, contact_motion_type, gap_tolerance
   use step_contact, only: dependent_rows
   use contact_impulses, only: restart_acceleration
   implicit none
   private

   public :: find_columns, smooth_step_type, step_smoothly, accept_step, stage_forces

   !> What is added to the diagonal where rows depend on each other, in parts of its mean; what is
   !> left of their motion must be below that part of it.
   real(wp), parameter :: dependence = 1.0e-12_wp
   real(wp), parameter :: dependence_limit = 1.0e-9_wp

   !> Where a step leads to and what it has found on its way.
   type :: smooth_step_type
      real(wp) :: dt = 0.0_wp
      type(contact_motion_type) :: to
      type(state_type) :: start
      complex(wp), allocatable :: a(:)           !! (n_freedoms) acceleration
      complex(wp), allocatable :: lambda(:)      !! (n_rows) contact forces
   end type smooth_step_type

contains

   !> The motion after dt. Errors: singular matrix, held rows that depend on each other.
   subroutine step_smoothly(scene, from, dt, step, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      real(wp), intent(in) :: dt
      type(smooth_step_type), intent(out) :: step
      type(error_type), allocatable, intent(out) :: error
      integer :: status

      step%dt = dt
      allocate (step%a(size(from%motion%d)), stat=status)
      call check_allocation(status)
      allocate (step%lambda(scene%rows%n), source=(0.0_wp, 0.0_wp), stat=status)
      call check_allocation(status)
      call start_gauss(scene%system, from%motion, dt, step%start, step%a)
      call free_acceleration(scene%system, step%start, dt, is_whole(scene, dt), step%a, error)
      if (allocated(error)) return
      if (any(from%touching)) call hold_rows(scene, from, step, error)
      if (allocated(error)) return
      step%to = from
      call end_gauss(scene%system, step%start, dt, step%a, step%to%motion)
      step%to%jump = 0.0_wp
      step%to%left_out = 0.0_wp
      step%to%fresh = .false.
      call restart_acceleration(scene, step%to, error)
   end subroutine step_smoothly

   !> Forces that hold the touching rows: W lambda = -G a.
   subroutine hold_rows(scene, from, step, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      type(smooth_step_type), intent(inout) :: step
      type(error_type), allocatable, intent(out) :: error
      complex(wp) :: forces(count(from%touching)), motion(scene%rows%n)
      real(wp) :: at_rest
      logical :: solved
      integer :: i

      ! what moves rows by so little in the step is round-off
      at_rest = gap_tolerance*scene%geometry%size
      call find_columns(scene, pack([(i, i=1, scene%rows%n)], from%touching), step%dt)
      motion = row_products(scene, step%a)
      associate (held => scene%held)
         forces = -motion(held%rows)
         call solve_complex_square(held%w, forces, dependence, solved)
         if (solved) solved = all(abs(matmul(held%w, forces) + motion(held%rows)) <= &
               dependence_limit*maxval(abs(motion)) + at_rest/step%dt**2)
         if (.not. solved) then
            call dependent_rows(scene, from%motion%t, error)
            return
         end if
         step%lambda(held%rows) = forces
         do i = 1, size(forces)
            step%a = step%a + held%x(:, i)*forces(i)
         end do
      end associate
   end subroutine hold_rows

   !> X = A^-1 Gt and W = G X of the rows, unless they are at hand.
   subroutine find_columns(scene, rows, dt)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: rows(:)
      real(wp), intent(in) :: dt
      type(complex_columns_type) :: held
      complex(wp) :: motion(scene%rows%n)
      integer :: j, n_freedoms, status

      if (is_at_hand(scene%held, scene%system%matrices%generation, rows, dt)) return
      n_freedoms = scene%system%structure%map%n_freedoms
      allocate (held%x(n_freedoms, size(rows)), held%w(size(rows), size(rows)), stat=status)
      call check_allocation(status)
      do j = 1, size(rows)
         held%x(:, j) = solve_complex(scene%system, &
               cmplx(row_vector(scene%rows, rows(j), n_freedoms), kind=wp))
         motion = row_products(scene, held%x(:, j))
         held%w(:, j) = motion(rows)
      end do
      held%rows = rows
      held%dt = dt
      held%generation = scene%system%matrices%generation
      scene%held = held
   end subroutine find_columns

   pure logical function is_at_hand(held, generation, rows, dt)
      type(complex_columns_type), intent(in) :: held
      integer(int64), intent(in) :: generation
      integer, intent(in) :: rows(:)
      real(wp), intent(in) :: dt

      is_at_hand = .false.
      if (held%generation /= generation .or. abs(held%dt - dt) > 0.0_wp) return
      if (size(held%rows) /= size(rows)) return
      is_at_hand = all(held%rows == rows)
   end function is_at_hand

   !> G a of all rows.
   pure function row_products(scene, a) result(products)
      type(scene_type), intent(in) :: scene
      complex(wp), intent(in) :: a(:)            !! (n_freedoms)
      complex(wp) :: products(scene%rows%n)

      products = cmplx(row_accelerations(scene%rows, real(a, wp)), &
            row_accelerations(scene%rows, aimag(a)), wp)
   end function row_products

   !> Whether a step is the deck's: its factors are needed again.
   pure logical function is_whole(scene, dt)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: dt

      is_whole = .not. abs(dt - scene%whole_step) > 0.0_wp
   end function is_whole

   !> Takes a step as it is: its works and contact impulses are booked. Prescribed velocities that
   !> jump at corners of their amplitudes take the energy for it from outside.
   subroutine accept_step(scene, from, step)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      type(smooth_step_type), intent(in) :: step
      complex(wp) :: contact(size(step%a))
      real(wp) :: works(2)

      contact = cmplx(row_forces(scene%rows, real(step%lambda, wp), size(step%a)), &
            row_forces(scene%rows, aimag(step%lambda), size(step%a)), wp)
      call span_works(scene%system, step%start, step%dt, step%a, contact, works)
      works(1) = works(1) + gain(scene, from%motion%v, step%start%v) &
            + gain(scene, step%start%v + step%dt*step_sum(step%a), step%to%motion%v)
      call record_works(scene%ledger, works)
      scene%impulse = scene%impulse + step%dt*step_sum(step%lambda)
   end subroutine accept_step

   !> Kinetic energy gained where prescribed velocities jump.
   function gain(scene, before, after)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: before(:), after(:)   !! (n_freedoms)
      real(wp) :: gain
      real(wp) :: change(size(before))

      gain = 0.0_wp
      change = after - before
      if (.not. any(abs(change) > 0.0_wp)) return
      gain = dot_product(inertia_force(scene%system%structure, change), after + before)/2.0_wp
   end function gain

   !> Contact forces at the Gauss points of a step, the first and the second.
   pure function stage_forces(step) result(forces)
      type(smooth_step_type), intent(in) :: step
      real(wp) :: forces(size(step%lambda), 2)

      forces(:, 1) = stage_value(1, step%lambda)
      forces(:, 2) = stage_value(2, step%lambda)
   end function stage_forces

end module fourth_order_step
