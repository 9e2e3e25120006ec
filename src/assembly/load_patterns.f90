!> Nodal forces of loads on elements: pressure, body forces, rotation, gravity, ground motion.
module load_patterns
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use histories, only: distributed_load_type, load_pressure, load_body
   use model, only: model_type
   use element_groups, only: group_mass
   use structure, only: structure_type, inertia_force
   implicit none
   private

   public :: distributed_pattern, gravity_pattern, base_pattern

contains

   !> Nodal forces of a distributed load on the elements of its set (0: all).
   function distributed_pattern(structure, model, load) result(pattern)
      type(structure_type), intent(in) :: structure
      type(model_type), intent(in) :: model
      type(distributed_load_type), intent(in) :: load
      real(wp) :: pattern(structure%map%n_freedoms)
      logical :: member(model%elements%n), exists
      real(wp), allocatable :: local(:)
      integer :: g, e, status

      member = load%set == 0
      if (load%set > 0) member(model%element_sets(load%set)%members) = .true.
      pattern = 0.0_wp
      do g = 1, size(structure%groups)
         associate (group => structure%groups(g))
            allocate (local(size(group%lm, 1)), stat=status)
            call check_allocation(status)
            do e = 1, size(group%member)
               if (.not. member(group%member(e))) cycle
               select case (load%kind)
               case (load_pressure)
                  call group%element%edge_load(e, load%edge, load%value, local, exists)
               case (load_body)
                  call group%element%body_load(e, load%body, local)
               case default
                  call group%element%centrifugal_load(e, load%value, load%point, load%axis, local)
               end select
               call scatter_one(group%lm(:, e), local, pattern)
            end do
            deallocate (local)
         end associate
      end do
   end function distributed_pattern

   pure subroutine scatter_one(lm, local, force)
      integer, intent(in) :: lm(:)
      real(wp), intent(in) :: local(:)
      real(wp), intent(inout) :: force(:)
      integer :: i

      do i = 1, size(lm)
         if (lm(i) > 0) force(lm(i)) = force(lm(i)) + local(i)
      end do
   end subroutine scatter_one

   !> M times the acceleration, on the elements of a set (0: all), with the mass that moves: where
   !> contact nodes have lost theirs, what falls freely would be strained by a weight of theirs.
   function gravity_pattern(structure, model, set, acceleration) result(pattern)
      type(structure_type), intent(in) :: structure
      type(model_type), intent(in) :: model
      integer, intent(in) :: set
      real(wp), intent(in) :: acceleration(3)
      real(wp) :: pattern(structure%map%n_freedoms)
      logical :: member(model%elements%n)
      real(wp), allocatable :: m(:, :)
      integer :: g, e, i, status

      member = set == 0
      if (set > 0) member(model%element_sets(set)%members) = .true.
      pattern = 0.0_wp
      do g = 1, size(structure%groups)
         associate (group => structure%groups(g))
            i = size(group%lm, 1)
            allocate (m(i, i), stat=status)
            call check_allocation(status)
            do e = 1, size(group%member)
               if (.not. member(group%member(e))) cycle
               call group_mass(group, e, group%lumped, m)
               m(:, 1) = matmul(m, [(acceleration(modulo(i - 1, 3) + 1), i=1, size(m, 1))])
               do i = 1, size(m, 1)
                  if (group%lm(i, e) == 0) cycle
                  pattern(group%lm(i, e)) = pattern(group%lm(i, e)) + m(i, 1)
               end do
            end do
            deallocate (m)
         end associate
      end do
   end function gravity_pattern

   !> -M r: inertia of a ground acceleration of unit size along one direction.
   function base_pattern(structure, dof, scale) result(pattern)
      type(structure_type), intent(in) :: structure
      integer, intent(in) :: dof
      real(wp), intent(in) :: scale
      real(wp) :: pattern(structure%map%n_freedoms)
      real(wp) :: along(structure%map%n_freedoms)

      along = merge(scale, 0.0_wp, structure%map%dof == dof)
      pattern = -inertia_force(structure, along)
   end function base_pattern

end module load_patterns
