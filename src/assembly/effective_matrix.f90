!> The effective stiffness as a skyline matrix: its profile and its values. The profile follows the
!> implicit elements alone; a freedom of explicit elements only has a column of height one.
module effective_matrix
   use kinds, only: wp
   use mesh, only: scheme_implicit
   use skyline_matrix, only: profile_type, new_profile, couple, skyline_type, new_skyline
   use element_groups, only: group_type, group_mass
   use dof_map, only: dof_map_type
   use structure, only: structure_type, gather, group_history
   implicit none
   private

   public :: find_profile, assemble_effective, assemble_sum, mark_implicit
   public :: couples_equations, equations_of, has_implicit_matrix

contains

   !> First rows of the columns of K*.
   pure subroutine find_profile(structure, profile)
      type(structure_type), intent(in) :: structure
      type(profile_type), intent(out) :: profile
      integer :: g, e, f

      call new_profile(profile, structure%map%n_eq)
      do f = 1, structure%map%n_freedoms
         associate (map => structure%map)
            call couple(profile, map%equation(map%first(f):map%first(f + 1) - 1))
         end associate
      end do
      do g = 1, size(structure%groups)
         associate (group => structure%groups(g))
            if (.not. couples_equations(group)) cycle
            do e = 1, size(group%lm, 2)
               call couple(profile, equations_of(structure%map, group%lm(:, e)))
            end do
         end associate
      end do
   end subroutine find_profile

   !> Marks the equations that an implicit element touches.
   pure subroutine mark_implicit(structure, implicit_equation)
      type(structure_type), intent(in) :: structure
      logical, allocatable, intent(out) :: implicit_equation(:)   !! (n_eq)
      integer :: g, e

      allocate (implicit_equation(structure%map%n_eq))
      implicit_equation = .false.
      do g = 1, size(structure%groups)
         associate (group => structure%groups(g))
            if (.not. has_implicit_matrix(group)) cycle
            do e = 1, size(group%lm, 2)
               implicit_equation(equations_of(structure%map, group%lm(:, e))) = .true.
            end do
         end associate
      end do
   end subroutine mark_implicit

   !> Whether a group adds stiffness or damping to the effective matrix: it is implicit and more
   !> than
   !> mere mass.
   pure function has_implicit_matrix(group) result(has)
      type(group_type), intent(in) :: group
      logical :: has

      has = group%scheme == scheme_implicit .and. any(group%element%uses(1))
   end function has_implicit_matrix

   !> Whether a group fills entries of the effective matrix beside the diagonal.
   pure function couples_equations(group) result(couples)
      type(group_type), intent(in) :: group
      logical :: couples

      couples = has_implicit_matrix(group) .or. .not. group%lumped
   end function couples_equations

   !> The equations behind some freedoms, constraints followed.
   pure function equations_of(map, freedoms) result(equations)
      type(dof_map_type), intent(in) :: map
      integer, intent(in) :: freedoms(:)
      integer, allocatable :: equations(:)
      integer :: i, n, n_behind

      n = 0
      do i = 1, size(freedoms)
         if (freedoms(i) > 0) n = n + map%first(freedoms(i) + 1) - map%first(freedoms(i))
      end do
      allocate (equations(n))
      n = 0
      do i = 1, size(freedoms)
         if (freedoms(i) == 0) cycle
         n_behind = map%first(freedoms(i) + 1) - map%first(freedoms(i))
         equations(n + 1:n + n_behind) = map%equation(map%first(freedoms(i)):map%first(freedoms(i) &
               + 1) - 1)
         n = n + n_behind
      end do
   end function equations_of

   !> c_mass M + c_damping C + c_stiffness K, damping and tangent stiffness of implicit groups only.
   !> Without stiffness and damping, massless equations get a unit diagonal.
   pure subroutine assemble_effective(structure, profile, d, history, factors, matrix)
      type(structure_type), intent(in) :: structure
      type(profile_type), intent(in) :: profile
      real(wp), intent(in) :: d(:)               !! (n_freedoms) where the tangent is taken
      real(wp), intent(in) :: history(:)         !! (n_history) last accepted
      real(wp), intent(in) :: factors(3)         !! c_mass, c_damping, c_stiffness
      type(skyline_type), intent(out) :: matrix
      integer :: j

      call assemble_sum(structure, profile, d, history, factors, matrix)
      if (abs(factors(2)) + abs(factors(3)) > 0.0_wp) return
      do j = 1, matrix%n
         if (.not. matrix%entry(j, j) > 0.0_wp) call matrix%add(j, j, 1.0_wp - matrix%entry(j, j))
      end do
   end subroutine assemble_effective

   !> The same sum as it is, massless equations with an empty diagonal.
   pure subroutine assemble_sum(structure, profile, d, history, factors, matrix)
      type(structure_type), intent(in) :: structure
      type(profile_type), intent(in) :: profile
      real(wp), intent(in) :: d(:)               !! (n_freedoms) where the tangent is taken
      real(wp), intent(in) :: history(:)         !! (n_history) last accepted
      real(wp), intent(in) :: factors(3)         !! c_mass, c_damping, c_stiffness
      type(skyline_type), intent(out) :: matrix
      integer :: f, g

      call new_skyline(matrix, profile)
      do f = 1, structure%map%n_freedoms
         call add_pair(structure%map, matrix, f, f, factors(1)*structure%lumped_mass(f))
      end do
      do g = 1, size(structure%groups)
         call add_group(structure, structure%groups(g), d, history, factors, matrix)
      end do
   end subroutine assemble_sum

   pure subroutine add_group(structure, group, d, history, factors, matrix)
      type(structure_type), intent(in) :: structure
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: d(:), history(:), factors(3)
      type(skyline_type), intent(inout) :: matrix
      real(wp), allocatable :: local(:, :), total(:, :), part(:, :), memory(:, :)
      integer :: e, n

      if (.not. couples_equations(group)) return
      n = size(group%lm, 1)
      allocate (local(n, size(group%lm, 2)), total(n, n), part(n, n))
      call gather(group, d, local)
      memory = group_history(group, history)
      do e = 1, size(group%lm, 2)
         total = 0.0_wp
         if (.not. group%lumped) then
            call group_mass(group, e, .false., part)
            total = factors(1)*part
         end if
         if (has_implicit_matrix(group)) then
            call group%element%stiffness(e, local(:, e), memory(:, e), part)
            total = total + factors(3)*part
            if (size(group%damping) > 0) total = total + factors(2)*group%damping(:, :, e)
         end if
         call add_element(structure%map, matrix, group%lm(:, e), total)
      end do
   end subroutine add_group

   pure subroutine add_element(map, matrix, lm, values)
      type(dof_map_type), intent(in) :: map
      type(skyline_type), intent(inout) :: matrix
      integer, intent(in) :: lm(:)
      real(wp), intent(in) :: values(:, :)
      integer :: i, j

      do j = 1, size(lm)
         do i = 1, size(lm)
            if (lm(i) == 0 .or. lm(j) == 0) cycle
            call add_pair(map, matrix, lm(i), lm(j), values(i, j))
         end do
      end do
   end subroutine add_element

   !> Adds the entry of freedoms f, g to all equations behind them; of (i, j) and (j, i) only the
   !> upper one is stored, so each is added once.
   pure subroutine add_pair(map, matrix, f, g, value)
      type(dof_map_type), intent(in) :: map
      type(skyline_type), intent(inout) :: matrix
      integer, intent(in) :: f, g
      real(wp), intent(in) :: value
      integer :: i, j

      if (.not. abs(value) > 0.0_wp) return
      do j = map%first(g), map%first(g + 1) - 1
         do i = map%first(f), map%first(f + 1) - 1
            if (map%equation(i) > map%equation(j)) cycle
            call matrix%add(map%equation(i), map%equation(j), &
                  map%coefficient(i)*map%coefficient(j)*value)
         end do
      end do
   end subroutine add_pair

end module effective_matrix
