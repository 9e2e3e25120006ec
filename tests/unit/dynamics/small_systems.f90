!> Small models brought into motion, as a run would do it.
module small_systems
   use kinds, only: wp
   use dof_map, only: number_equations
   use effective_matrix, only: find_profile
   use effective_system, only: new_effective_system
   use equation_of_motion, only: system_type, predict_motion, fixed_force, residual, &
         solve_motion, prepare_motion, prepare_mass, solve_mass, force_balance, impose
   use errors, only: error_type
   use external_load, only: begin_loads
   use model, only: model_type
   use motion_state, only: state_type, newmark_type, correct
   use prescribed_motion, only: begin_motions, start_motions, prescribed_freedoms
   use small_models, only: start_model, add_node, add_spring1, add_spring2, add_mass, add_truss, &
         add_step
   use steps, only: procedure_static
   use structure, only: structure_type, new_structure, inertia_force
   implicit none
   private

   public :: start_system, set_in_motion, advance, row_of_masses, bar, number_all

contains

   !> The system and its state at rest at the start of the model's first step.
   subroutine start_system(system, state, model, error)
      type(system_type), intent(out) :: system
      type(state_type), intent(out) :: state
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer :: n

      call new_structure(system%structure, model, error)
      if (allocated(error)) return
      associate (map => system%structure%map, step => model%steps(1))
         n = map%n_freedoms
         allocate (state%d(n), state%v(n), state%a(n), state%history(system%structure%n_history))
         state%d = 0.0_wp
         state%v = 0.0_wp
         state%a = 0.0_wp
         state%history = 0.0_wp
         system%static = step%procedure == procedure_static
         call begin_motions(system%motions, [model%boundaries, step%boundaries], map%freedom, &
               model%amplitudes, .true., [0.0_wp, step%duration], system%static)
         call number_equations(map, prescribed_freedoms(system%motions, n), model%equations)
         call begin_loads(system%loads, system%structure, model, 1, 0.0_wp)
      end associate
      call find_profile(system%structure, system%profile)
      call new_effective_system(system%matrices)
      allocate (system%massless(system%structure%map%n_eq))
      system%massless = .false.
   end subroutine start_system

   !> d and v at time 0 with the acceleration that balances them.
   subroutine set_in_motion(system, state, d, v, error)
      type(system_type), intent(inout) :: system
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: d(:), v(:)
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: force(size(d))

      state%d = d
      state%v = v
      call start_motions(system%motions, 0.0_wp, d, v)
      call impose(system, state)
      call prepare_mass(system, error)
      if (allocated(error)) return
      force = force_balance(system, state) - inertia_force(system%structure, state%a)
      state%a = state%a + solve_mass(system, force)
      call impose(system, state)
   end subroutine set_in_motion

   !> One step of Newmark's method, by Newton's method if there are nonlinear elements.
   subroutine advance(system, state, dt, error)
      type(system_type), intent(inout) :: system
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      type(newmark_type) :: newmark
      type(state_type) :: trial
      real(wp), dimension(size(state%d)) :: fixed, delta
      integer :: i

      newmark = system%newmark
      call predict_motion(system, state, dt, newmark%beta, trial)
      fixed = fixed_force(system, state, trial)
      do i = 1, 50
         call prepare_motion(system, dt, newmark%beta, trial%d, state%history, error)
         if (allocated(error)) return
         delta = solve_motion(system, residual(system, fixed, state%history, trial))
         if (system%static) then
            trial%d = trial%d + delta
         else
            call correct(newmark, dt, delta, trial)
         end if
         if (system%structure%is_linear .or. norm2(delta) <= 1.0e-13_wp*norm2(trial%a)) exit
      end do
      state = trial
   end subroutine advance

   !> Masses along x with springs between neighbours, k(1) holding the first; a dynamic step of 10.
   function row_of_masses(m, k) result(model)
      real(wp), intent(in) :: m(:), k(:)
      type(model_type) :: model
      integer :: i

      call start_model(model)
      do i = 1, size(m)
         call add_node(model, [real(i, wp), 0.0_wp, 0.0_wp])
      end do
      call add_spring1(model, 1, 1, k(1))
      do i = 2, size(m)
         call add_spring2(model, [i - 1, i], 1, k(i))
      end do
      do i = 1, size(m)
         call add_mass(model, i, m(i))
      end do
      call add_step(model, 10.0_wp)
   end function row_of_masses

   !> Trusses of length dx end to end along x, of E, rho, and Rayleigh's factors, area 1.
   function bar(n_elements, dx, material) result(model)
      integer, intent(in) :: n_elements
      real(wp), intent(in) :: dx, material(4)
      type(model_type) :: model
      integer :: i

      call start_model(model)
      do i = 0, n_elements
         call add_node(model, [dx*real(i, wp), 0.0_wp, 0.0_wp])
      end do
      do i = 1, n_elements
         call add_truss(model, [i, i + 1], 1.0_wp, material)
      end do
      call add_step(model, 10.0_wp)
   end function bar

   !> Makes every freedom an equation.
   subroutine number_all(structure, model)
      type(structure_type), intent(inout) :: structure
      type(model_type), intent(in) :: model

      associate (map => structure%map)
         call number_equations(map, spread(.false., 1, map%n_freedoms), model%equations)
      end associate
   end subroutine number_all

end module small_systems
