!> The effective stiffness as a skyline matrix: its profile and its values. The profile follows the
!> implicit elements alone; a freedom of explicit elements only has a column of height one.
module effective_matrix
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use skyline_matrix, only: profile_type, new_profile, couple, skyline_type, new_skyline
   use element_groups, only: group_type
   use dof_map, only: dof_map_type
   use element_sum, only: effective_element, has_implicit_matrix, contributes
   use element_colours, only: colours_type, colour_elements
   use structure, only: structure_type, gather, group_history
   implicit none
   private

   public :: find_profile, assemble_effective, assemble_sum, mark_implicit
   public :: couples_equations, count_coupled, count_parts, equations_of, list_coupled

   !> Elements from which threads share a group.
   integer, parameter :: worth_threads = 500

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
      integer :: g, e, status

      allocate (implicit_equation(structure%map%n_eq), stat=status)
      call check_allocation(status)
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

   !> Whether a group fills entries of the effective matrix beside the diagonal.
   pure function couples_equations(group) result(couples)
      type(group_type), intent(in) :: group
      logical :: couples

      couples = has_implicit_matrix(group) .or. .not. group%lumped
   end function couples_equations

   !> Elements whose matrices c_mass M + c_damping C + c_stiffness K takes.
   pure function count_coupled(structure, factors) result(n)
      type(structure_type), intent(in) :: structure
      real(wp), intent(in) :: factors(3)
      integer :: n
      integer :: g

      n = 0
      do g = 1, size(structure%groups)
         if (contributes(structure%groups(g), factors)) n = n + size(structure%groups(g)%member)
      end do
   end function count_coupled

   !> The same of M, C and K one by one.
   pure integer function count_parts(structure)
      type(structure_type), intent(in) :: structure
      real(wp), parameter :: one = 1.0_wp, none = 0.0_wp

      count_parts = count_coupled(structure, [one, none, none]) &
            + count_coupled(structure, [none, one, none]) &
            + count_coupled(structure, [none, none, one])
   end function count_parts

   !> The equations behind some freedoms, constraints followed.
   pure function equations_of(map, freedoms) result(equations)
      type(dof_map_type), intent(in) :: map
      integer, intent(in) :: freedoms(:)
      integer, allocatable :: equations(:)
      integer :: i, n, n_behind, status

      n = 0
      do i = 1, size(freedoms)
         if (freedoms(i) > 0) n = n + map%first(freedoms(i) + 1) - map%first(freedoms(i))
      end do
      allocate (equations(n), stat=status)
      call check_allocation(status)
      n = 0
      do i = 1, size(freedoms)
         if (freedoms(i) == 0) cycle
         n_behind = map%first(freedoms(i) + 1) - map%first(freedoms(i))
         equations(n + 1:n + n_behind) = map%equation(map%first(freedoms(i)):map%first(freedoms(i) &
               + 1) - 1)
         n = n + n_behind
      end do
   end function equations_of

   !> The sets of equations that constraints and elements couple: set i is
   !> member(first(i):first(i + 1) - 1). Counted first, then listed.
   subroutine list_coupled(structure, first, member)
      type(structure_type), intent(in) :: structure
      integer, allocatable, intent(out) :: first(:), member(:)
      integer :: f, g, e, n, m, pass, status

      associate (map => structure%map)
         do pass = 1, 2
            n = 0
            m = 0
            do f = 1, size(map%dependent)
               call append(equations_of(map, map%dependent(f:f)))
            end do
            do g = 1, size(structure%groups)
               if (.not. couples_equations(structure%groups(g))) cycle
               do e = 1, size(structure%groups(g)%lm, 2)
                  call append(equations_of(map, structure%groups(g)%lm(:, e)))
               end do
            end do
            if (pass == 1) then
               allocate (first(n + 1), member(m), stat=status)
               call check_allocation(status)
            end if
         end do
      end associate
      first(n + 1) = m + 1

   contains

      subroutine append(equations)
         integer, intent(in) :: equations(:)

         n = n + 1
         if (pass == 2) first(n) = m + 1
         if (pass == 2) member(m + 1:m + size(equations)) = equations
         m = m + size(equations)
      end subroutine append

   end subroutine list_coupled

   !> c_mass M + c_damping C + c_stiffness K, damping and tangent stiffness of implicit groups only.
   !> Without stiffness and damping, massless equations get a unit diagonal.
   subroutine assemble_effective(structure, profile, d, history, factors, matrix)
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
   subroutine assemble_sum(structure, profile, d, history, factors, matrix)
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

   !> Adds the elements of a group, those of one colour after those of another; a few are added as
   !> they come.
   subroutine add_group(structure, group, d, history, factors, matrix)
      type(structure_type), intent(in) :: structure
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: d(:), history(:), factors(3)
      type(skyline_type), intent(inout) :: matrix
      real(wp), allocatable :: local(:, :), memory(:, :), total(:, :)
      type(colours_type) :: colours
      integer :: k, i, n, status

      if (.not. contributes(group, factors)) return
      n = size(group%lm, 1)
      allocate (local(n, size(group%lm, 2)), stat=status)
      call check_allocation(status)
      call gather(group, d, local)
      allocate (memory, source=group_history(group, history), stat=status)
      call check_allocation(status)
      if (size(group%lm, 2) < worth_threads) then
         colours%first = [1, size(group%lm, 2) + 1]
         colours%element = [(i, i=1, size(group%lm, 2))]
      else
         call colour_elements(structure%map, group%lm, colours)
      end if
      !$omp parallel if (size(group%lm, 2) >= worth_threads) private(total, k, status)
      allocate (total(n, n), stat=status)
      call check_allocation(status)
      do k = 1, size(colours%first) - 1
         !$omp do schedule(static)
         do i = colours%first(k), colours%first(k + 1) - 1
            associate (e => colours%element(i))
               call effective_element(group, e, local(:, e), memory(:, e), factors, total)
               call add_element(structure%map, matrix, group%lm(:, e), total)
            end associate
         end do
         !$omp end do
      end do
      !$omp end parallel
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
