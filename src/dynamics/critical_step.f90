!> Bounds on the highest frequencies from single elements: for shares M_e of the mass with
!> sum M_e <= M, omega_max^2 <= max_e lambda(K_e, M_e). All is folded onto the equations,
!> constraints followed; the mass of each equation is shared among its elements in proportion to
!> their diagonal stiffness.
module critical_step
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use small_eigen, only: largest_eigenvalue, has_larger_eigenvalue
   use element_groups, only: group_type, group_mass
   use dof_map, only: dof_map_type
   use structure, only: structure_type, least_mass
   implicit none
   private

   public :: critical_type, find_critical, find_own_limits, reached_frequency

   !> What limits the step of the groups of one scheme.
   type :: critical_type
      real(wp) :: omega = 0.0_wp            !! bound on the highest frequency, rad/time
      real(wp) :: damping_rate = 0.0_wp     !! bound on the eigenvalues of M^-1 C
      integer :: element = 0                !! model index of the element with the highest frequency
      integer :: massless_freedom = 0       !! a freedom of an explicit element without mass
      real(wp) :: step = huge(1.0_wp)       !! critical step of explicit integration
   end type critical_type

   !> An element matrix on the equations behind its freedoms: the first n of each. The room is kept
   !> from element to element.
   type :: folded_type
      integer :: n = 0
      integer, allocatable :: equation(:)
      real(wp), allocatable :: matrix(:, :)
   end type folded_type

contains

   !> Frequencies and explicit critical step h = 2 / (sqrt(omega^2 + (c/2)^2) + c/2) with the
   !> damping
   !> rate c, lagged as explicit damping is (gamma = 1/2; a larger gamma by sqrt(1/(2 gamma))).
   subroutine find_critical(structure, scheme, gamma, critical)
      type(structure_type), intent(in) :: structure   !! equations numbered
      integer, intent(in) :: scheme
      real(wp), intent(in) :: gamma
      type(critical_type), intent(out) :: critical
      real(wp), dimension(structure%map%n_eq) :: m, k_diagonal, c_diagonal
      real(wp) :: total
      integer :: g

      m = mass_on_equations(structure)
      k_diagonal = 0.0_wp
      c_diagonal = 0.0_wp
      do g = 1, size(structure%groups)
         if (structure%groups(g)%scheme /= scheme) cycle
         call sum_diagonals(structure, structure%groups(g), k_diagonal, c_diagonal)
      end do
      do g = 1, size(structure%groups)
         if (structure%groups(g)%scheme /= scheme) cycle
         call bound_group(structure, structure%groups(g), m, k_diagonal, c_diagonal, critical)
      end do
      critical%omega = sqrt(critical%omega)
      total = sqrt(critical%omega**2 + (critical%damping_rate/2.0_wp)**2) &
            + critical%damping_rate/2.0_wp
      if (total > 0.0_wp) critical%step = sqrt(1.0_wp/(2.0_wp*gamma))*2.0_wp/total
   end subroutine find_critical

   !> A frequency that the highest one of a scheme's elements is not below, all of them linear: the
   !> largest Rayleigh quotient of the motions of one equation. (With a lumped mass it is at least
   !> 1/sqrt(2) of the bound in a chain, the bound itself on single freedoms.) Zero if an equation
   !> has no mass: it would yield.
   function reached_frequency(structure, scheme) result(omega)
      type(structure_type), intent(in) :: structure   !! equations numbered
      integer, intent(in) :: scheme
      real(wp) :: omega
      real(wp), dimension(structure%map%n_eq) :: m, k, c
      integer :: g

      m = 0.0_wp
      k = 0.0_wp
      c = 0.0_wp
      do g = 1, size(structure%groups)
         call sum_masses(structure, structure%groups(g), m)
         if (structure%groups(g)%scheme == scheme) call sum_diagonals(structure, &
               structure%groups(g), k, c)
      end do
      omega = 0.0_wp
      if (size(m) > 0 .and. all(m > 0.0_wp)) omega = sqrt(maxval(k/m))
   end function reached_frequency

   !> Adds a group to the diagonal of M.
   subroutine sum_masses(structure, group, m_diagonal)
      type(structure_type), intent(in) :: structure
      type(group_type), intent(in) :: group
      real(wp), intent(inout) :: m_diagonal(:)   !! (n_eq)
      real(wp) :: m(size(group%lm, 1), size(group%lm, 1))
      type(folded_type) :: folded
      integer :: e

      do e = 1, size(group%lm, 2)
         call group_mass(group, e, group%lumped, m)
         call fold(structure%map, group%lm(:, e), m, folded)
         call add_diagonal(folded, m_diagonal)
      end do
   end subroutine sum_masses

   !> Critical explicit step of each element by itself: on its own lumped mass, or where it has none
   !> on its share of the masses around; huge where it has no stiffness, zero where it acts on a
   !> freedom without any mass.
   subroutine find_own_limits(structure, limits)
      type(structure_type), intent(in) :: structure   !! equations numbered
      real(wp), intent(out) :: limits(:)              !! (n_elements of the model)
      real(wp), dimension(structure%map%n_eq) :: m, k_diagonal, c_diagonal
      integer :: g

      limits = huge(1.0_wp)
      m = mass_on_equations(structure)
      k_diagonal = 0.0_wp
      c_diagonal = 0.0_wp
      do g = 1, size(structure%groups)
         call sum_diagonals(structure, structure%groups(g), k_diagonal, c_diagonal)
      end do
      do g = 1, size(structure%groups)
         call limit_group(structure, structure%groups(g), m, k_diagonal, c_diagonal, limits)
      end do
   end subroutine find_own_limits

   subroutine limit_group(structure, group, m, k_diagonal, c_diagonal, limits)
      type(structure_type), intent(in) :: structure
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: m(:), k_diagonal(:), c_diagonal(:)   !! (n_eq)
      real(wp), intent(inout) :: limits(:)
      type(critical_type) :: one
      type(folded_type) :: folded
      real(wp), dimension(size(group%lm, 1), size(group%lm, 1)) :: k, mass
      real(wp) :: lambda, rate
      integer :: e, i
      logical :: used(size(group%lm, 1))

      do e = 1, size(group%lm, 2)
         call group%element%largest_stiffness(e, k)
         call group_mass(group, e, .true., mass)
         one%massless_freedom = 0
         used = [(k(i, i) > 0.0_wp, i=1, size(used))]
         rate = 0.0_wp
         if (all([(mass(i, i) > 0.0_wp, i=1, size(used))] .or. .not. used)) then
            lambda = own_eigenvalue(k, mass, used)
            if (size(group%damping) > 0) rate = own_eigenvalue(group%damping(:, :, e), mass, used)
         else
            call fold(structure%map, group%lm(:, e), k, folded)
            lambda = 0.0_wp
            call bound_element(structure%map, folded, m, k_diagonal, lambda, one%massless_freedom)
         end if
         if (all(.not. used) .and. size(group%damping) > 0) then
            call fold(structure%map, group%lm(:, e), group%damping(:, :, e), folded)
            rate = 0.0_wp
            call bound_element(structure%map, folded, m, c_diagonal, rate, one%massless_freedom)
         end if
         rate = sqrt(lambda + (rate/2.0_wp)**2) + rate/2.0_wp
         if (rate > 0.0_wp) limits(group%member(e)) = 2.0_wp/rate
         if (one%massless_freedom > 0) limits(group%member(e)) = 0.0_wp
      end do
   end subroutine limit_group

   !> Largest eigenvalue of an element matrix on the element's own lumped mass.
   pure function own_eigenvalue(matrix, mass, used) result(lambda)
      real(wp), intent(in) :: matrix(:, :), mass(:, :)
      logical, intent(in) :: used(:)
      real(wp) :: lambda
      integer :: rows(count(used)), i

      rows = pack([(i, i=1, size(used))], used)
      lambda = largest_eigenvalue(matrix(rows, rows), [(mass(rows(i), rows(i)), i=1, size(rows))])
   end function own_eigenvalue

   !> A diagonal mass on equations that is nowhere above the true one: a dependent freedom adds
   !> where it follows one master, and is left out where it couples several.
   pure function mass_on_equations(structure) result(m)
      type(structure_type), intent(in) :: structure
      real(wp) :: m(structure%map%n_eq)
      real(wp) :: on_freedoms(structure%map%n_freedoms)
      integer :: f

      on_freedoms = least_mass(structure)
      m = 0.0_wp
      associate (map => structure%map)
         do f = 1, map%n_freedoms
            if (map%first(f + 1) - map%first(f) /= 1) cycle
            associate (i => map%first(f))
               m(map%equation(i)) = m(map%equation(i)) + map%coefficient(i)**2*on_freedoms(f)
            end associate
         end do
      end associate
   end function mass_on_equations

   !> T^t matrix T of an element.
   pure subroutine fold(map, lm, matrix, folded)
      type(dof_map_type), intent(in) :: map
      integer, intent(in) :: lm(:)               !! freedoms of the element
      real(wp), intent(in) :: matrix(:, :)
      type(folded_type), intent(inout) :: folded
      integer :: rows(size(lm)), i, n_terms, status
      logical :: plain

      n_terms = 0
      do i = 1, size(lm)
         if (lm(i) > 0) n_terms = n_terms + map%first(lm(i) + 1) - map%first(lm(i))
      end do
      if (allocated(folded%equation)) then
         if (size(folded%equation) < n_terms) deallocate (folded%equation, folded%matrix)
      end if
      if (.not. allocated(folded%equation)) then
         allocate (folded%equation(n_terms), folded%matrix(n_terms, n_terms), stat=status)
         call check_allocation(status)
      end if
      folded%n = 0
      plain = .true.
      do i = 1, size(lm)
         if (lm(i) == 0) cycle
         associate (first => map%first(lm(i)), next => map%first(lm(i) + 1))
            if (next == first) cycle
            plain = next == first + 1 .and. abs(map%coefficient(first) - 1.0_wp) <= 0.0_wp &
                  .and. all(folded%equation(:folded%n) /= map%equation(first))
            if (.not. plain) exit
            folded%n = folded%n + 1
            folded%equation(folded%n) = map%equation(first)
            rows(folded%n) = i
         end associate
      end do
      if (plain) then
         associate (n => folded%n)
            folded%matrix(:n, :n) = matrix(rows(:n), rows(:n))
         end associate
      else
         call fold_terms(map, lm, matrix, folded)
      end if
   end subroutine fold

   !> The same where freedoms depend on others.
   pure subroutine fold_terms(map, lm, matrix, folded)
      type(dof_map_type), intent(in) :: map
      integer, intent(in) :: lm(:)
      real(wp), intent(in) :: matrix(:, :)
      type(folded_type), intent(inout) :: folded
      real(wp) :: t(size(lm), size(folded%equation))
      integer :: i, k, column

      folded%n = 0
      t = 0.0_wp
      do i = 1, size(lm)
         if (lm(i) == 0) cycle
         do k = map%first(lm(i)), map%first(lm(i) + 1) - 1
            column = findloc(folded%equation(:folded%n), map%equation(k), dim=1)
            if (column == 0) then
               folded%n = folded%n + 1
               column = folded%n
               folded%equation(column) = map%equation(k)
            end if
            t(i, column) = t(i, column) + map%coefficient(k)
         end do
      end do
      associate (n => folded%n)
         folded%matrix(:n, :n) = matmul(transpose(t(:, :n)), matmul(matrix, t(:, :n)))
      end associate
   end subroutine fold_terms

   !> Adds a group to the diagonals of K and C.
   subroutine sum_diagonals(structure, group, k_diagonal, c_diagonal)
      type(structure_type), intent(in) :: structure
      type(group_type), intent(in) :: group
      real(wp), intent(inout) :: k_diagonal(:), c_diagonal(:)   !! (n_eq)
      real(wp) :: k(size(group%lm, 1), size(group%lm, 1))
      type(folded_type) :: folded
      integer :: e

      do e = 1, size(group%lm, 2)
         call group%element%largest_stiffness(e, k)
         call fold(structure%map, group%lm(:, e), k, folded)
         call add_diagonal(folded, k_diagonal)
         if (size(group%damping) == 0) cycle
         call fold(structure%map, group%lm(:, e), group%damping(:, :, e), folded)
         call add_diagonal(folded, c_diagonal)
      end do
   end subroutine sum_diagonals

   pure subroutine add_diagonal(folded, diagonal)
      type(folded_type), intent(in) :: folded
      real(wp), intent(inout) :: diagonal(:)
      integer :: i

      do i = 1, folded%n
         diagonal(folded%equation(i)) = diagonal(folded%equation(i)) + folded%matrix(i, i)
      end do
   end subroutine add_diagonal

   !> Raises the bounds (omega squared here) by the elements of a group.
   subroutine bound_group(structure, group, m, k_diagonal, c_diagonal, critical)
      type(structure_type), intent(in) :: structure
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: m(:), k_diagonal(:), c_diagonal(:)   !! (n_eq)
      type(critical_type), intent(inout) :: critical
      type(folded_type) :: folded
      real(wp) :: k(size(group%lm, 1), size(group%lm, 1)), before
      integer :: e

      do e = 1, size(group%lm, 2)
         call group%element%largest_stiffness(e, k)
         call fold(structure%map, group%lm(:, e), k, folded)
         before = critical%omega
         call bound_element(structure%map, folded, m, k_diagonal, critical%omega, &
               critical%massless_freedom)
         if (critical%omega > before) critical%element = group%member(e)
         if (size(group%damping) == 0) cycle
         call fold(structure%map, group%lm(:, e), group%damping(:, :, e), folded)
         call bound_element(structure%map, folded, m, c_diagonal, critical%damping_rate, &
               critical%massless_freedom)
      end do
   end subroutine bound_group

   !> Raises lambda to the largest eigenvalue of a folded element matrix on its share of the mass; a
   !> freedom that it acts on and that has no mass is named.
   pure subroutine bound_element(map, folded, m, diagonal, lambda, massless_freedom)
      type(dof_map_type), intent(in) :: map
      type(folded_type), intent(in) :: folded
      real(wp), intent(in) :: m(:), diagonal(:)  !! (n_eq) mass, assembled diagonal
      real(wp), intent(inout) :: lambda
      integer, intent(inout) :: massless_freedom
      integer :: rows(folded%n), n, i
      real(wp) :: share(folded%n), matrix(folded%n, folded%n)

      n = 0
      do i = 1, folded%n
         associate (equation => folded%equation(i))
            if (.not. folded%matrix(i, i) > 0.0_wp) cycle
            if (.not. m(equation) > 0.0_wp) then
               massless_freedom = freedom_of(map, equation)
               cycle
            end if
            n = n + 1
            rows(n) = i
            share(n) = m(equation)*folded%matrix(i, i)/diagonal(equation)
         end associate
      end do
      matrix(:n, :n) = folded%matrix(rows(:n), rows(:n))
      if (has_larger_eigenvalue(matrix(:n, :n), share(:n), lambda)) then
         lambda = max(lambda, largest_eigenvalue(matrix(:n, :n), share(:n)))
      end if
   end subroutine bound_element

   !> The freedom that an equation stands for.
   pure function freedom_of(map, equation) result(freedom)
      type(dof_map_type), intent(in) :: map
      integer, intent(in) :: equation
      integer :: freedom

      do freedom = 1, map%n_freedoms
         if (map%id(map%dof(freedom), map%node(freedom)) == equation) return
      end do
   end function freedom_of

end module critical_step
