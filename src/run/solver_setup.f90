!> SOLVER of a step: what there will be to factorize and solve, and who is to do it.
module solver_setup
   use kinds, only: wp
   use errors, only: error_type
   use places, only: source_type, fail_at
   use steps, only: step_type, procedure_frequency, solver_skyline, solver_mumps
   use mumps_solver, only: mumps_available
   use solver_choice, only: work_type
   use equation_of_motion, only: system_type
   implicit none
   private

   public :: begin_matrices

   !> Iterations of Newton's method that an increment of a nonlinear model is taken to need.
   integer, parameter :: iterations = 3

contains

   !> Drops the matrices of the step before and chooses the solver for the work of this one: one
   !> factorization of K* and one of M if the structure is linear, else some iterations an
   !> increment; impacts are not foreseen. Error: SOLVER=MUMPS without MUMPS.
   subroutine begin_matrices(system, step, source, error)
      type(system_type), intent(inout) :: system   !! profile and conditions of the step in force
      type(step_type), intent(in) :: step
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      type(work_type) :: work

      if (step%solver == solver_mumps .and. .not. mumps_available()) then
         call fail_at(error, source, step%solver_place, &
               'SOLVER=MUMPS, but this program was built without MUMPS', 'take SOLVER=AUTO or ' &
               //'SKYLINE, or build with the CMake option CAROM_MUMPS=ON')
         return
      end if
      work%wanted = step%solver
      if (step%order == 4) work%wanted = solver_skyline
      work%n_solves = 1.0_wp
      if (step%procedure == procedure_frequency) then
         work%wanted = solver_skyline
      else
         work%n_solves = max(1.0_wp, step%duration/step%dt)
      end if
      if (.not. system%structure%is_linear) then
         work%n_solves = real(iterations, wp)*work%n_solves
         work%n_factorizations = work%n_solves
      else if (.not. system%static) then
         work%n_factorizations = 2.0_wp
      end if
      call system%matrices%begin(system%structure, system%profile, work, error)
   end subroutine begin_matrices

end module solver_setup
