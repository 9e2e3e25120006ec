!> What the forces and matrices of elements take of an increment, by counting their numbers.
module element_cost
   use kinds, only: wp
   use mesh, only: scheme_implicit
   use element_groups, only: group_type
   use structure, only: structure_type
   use steps, only: step_type
   implicit none
   private

   public :: group_seconds, pass_seconds

   !> Seconds on a processor of today, each found by a run that does little else.
   real(wp), parameter :: matrix_number = 0.35e-9_wp     !! of an element matrix, in a force
   real(wp), parameter :: small_element = 40.0e-9_wp     !! force of a spring, truss or dashpot
   real(wp), parameter :: stress_point = 70.0e-9_wp      !! plastic stress update
   real(wp), parameter :: tangent_number = 1.0e-9_wp     !! of an element matrix, each point
   real(wp), parameter :: assembled_number = 5.0e-9_wp   !! of an element matrix, put in its place
   !> Iterations of Newton's method an increment.
   real(wp), parameter, public :: iterations = 3.0_wp

contains

   !> Forces once an increment of a linear structure; of another twice an iteration, and the tangent
   !> of implicit elements. HHT needs the forces at the start too, ORDER=4 those of two stages.
   pure real(wp) function group_seconds(group, step, linear) result(seconds)
      type(group_type), intent(in) :: group
      type(step_type), intent(in) :: step
      logical, intent(in) :: linear              !! the structure
      real(wp) :: n_numbers, n_forces, one_force

      seconds = 0.0_wp
      if (.not. group%resists) return
      n_numbers = real(count(group%element%uses(1)), wp)**2
      one_force = force_seconds(group)
      n_forces = 1.0_wp
      if (group%scheme == scheme_implicit) then
         if (.not. linear) n_forces = 2.0_wp*iterations
         if (.not. linear) seconds = seconds + iterations*n_numbers*(assembled_number &
               + tangent_number*real(max(1, group%element%n_points), wp))
         if (step%order == 4) n_forces = n_forces + 1.0_wp
      end if
      if (abs(step%alpha) > 0.0_wp) n_forces = n_forces + 1.0_wp
      seconds = seconds + n_forces*one_force
      ! damping forces, and their work
      if (size(group%damping) > 0) seconds = seconds + (n_forces + 1.0_wp)*matrix_number*n_numbers
      seconds = seconds*real(size(group%member), wp)
   end function group_seconds

   !> The forces of all elements once.
   pure real(wp) function pass_seconds(structure) result(seconds)
      type(structure_type), intent(in) :: structure
      integer :: g

      seconds = 0.0_wp
      do g = 1, size(structure%groups)
         if (structure%groups(g)%resists) seconds = seconds + force_seconds(structure%groups(g)) &
               *real(size(structure%groups(g)%member), wp)
      end do
   end function pass_seconds

   !> The force of one element.
   pure real(wp) function force_seconds(group)
      type(group_type), intent(in) :: group

      if (group%element%n_history > 0) then
         force_seconds = stress_point*real(group%element%n_points, wp)
      else if (group%element%is_solid) then
         force_seconds = matrix_number*real(count(group%element%uses(1)), wp)**2
      else
         force_seconds = small_element
      end if
   end function force_seconds

end module element_cost
