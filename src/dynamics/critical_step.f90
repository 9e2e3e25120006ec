!> Bounds on the highest frequencies from single elements: for shares M_e of the mass with
!> sum M_e <= M, omega_max^2 <= max_e lambda(K_e, M_e). All is folded onto the equations,
!> constraints
!> followed; the mass of each equation is shared among its elements in proportion to their diagonal
!> stiffness.
module critical_step
   use kinds, only: wp
   use small_eigen, only: largest_eigenvalue, eigenvalue_bound
   use element_groups, only: group_type, group_mass
   use dof_map, only: dof_map_type
   use structure, only: structure_type, least_mass
   implicit none
   private

   public :: critical_type, find_critical, find_own_limits

   !> What limits the step of the groups of one scheme.
   type :: critical_type
      real(wp) :: omega = 0.0_wp            !! bound on the highest frequency, rad/time
      real(wp) :: damping_rate = 0.0_wp     !! bound on the eigenvalues of M^-1 C
      integer :: element = 0                !! model index of the element with the highest frequency
      integer :: massless_freedom = 0       !! a freedom of an explicit element without mass
      real(wp) :: step = huge(1.0_wp)       !! critical step of explicit integration
   end type critical_type

   !> An element matrix on the equations behind its freedoms.
   type :: folded_type
      integer :: n = 0
      integer, allocatable :: equation(:)
      real(wp), allocatable :: matrix(:, :)
   end type folded_type

   !> Freedoms of an element that is remembered at most.
   integer, parameter :: most_remembered = 16

   !> The elements last looked into, in turn.
   type :: bounded_type
      integer :: next = 0
      integer :: n(4) = -1
      real(wp) :: share(most_remembered, 4) = 0.0_wp
      real(wp) :: matrix(most_remembered, most_remembered, 4) = 0.0_wp
   end type bounded_type

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
            call bound_element(structure%map, folded, m, k_diagonal, lambda, one%massless_freedom)
         end if
         if (all(.not. used) .and. size(group%damping) > 0) then
            call fold(structure%map, group%lm(:, e), group%damping(:, :, e), folded)
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
      type(folded_type), intent(out) :: folded
      integer :: i, k, column, n_terms
      real(wp), allocatable :: t(:, :)

      if (size(map%dependent) == 0) then
         call select_equations(map, lm, matrix, folded)
         return
      end if
      n_terms = 0
      do i = 1, size(lm)
         if (lm(i) > 0) n_terms = n_terms + map%first(lm(i) + 1) - map%first(lm(i))
      end do
      allocate (folded%equation(n_terms), t(size(lm), n_terms))
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
      folded%matrix = matmul(transpose(t(:, :folded%n)), matmul(matrix, t(:, :folded%n)))
   end subroutine fold

   !> The same without constraints: what is not prescribed.
   pure subroutine select_equations(map, lm, matrix, folded)
      type(dof_map_type), intent(in) :: map
      integer, intent(in) :: lm(:)
      real(wp), intent(in) :: matrix(:, :)
      type(folded_type), intent(out) :: folded
      integer :: rows(size(lm)), i

      do i = 1, size(lm)
         if (lm(i) == 0) cycle
         if (map%first(lm(i) + 1) == map%first(lm(i))) cycle
         folded%n = folded%n + 1
         rows(folded%n) = i
      end do
      allocate (folded%equation(folded%n), folded%matrix(folded%n, folded%n))
      do i = 1, folded%n
         folded%equation(i) = map%equation(map%first(lm(rows(i))))
         folded%matrix(:, i) = matrix(rows(:folded%n), rows(i))
      end do
   end subroutine select_equations

   !> Adds a group to the diagonals of K and C.
   subroutine sum_diagonals(structure, group, k_diagonal, c_diagonal)
      type(structure_type), intent(in) :: structure
      type(group_type), intent(in) :: group
      real(wp), intent(inout) :: k_diagonal(:), c_diagonal(:)   !! (n_eq)
      real(wp) :: k(size(group%lm, 1), size(group%lm, 1))
      integer :: e

      do e = 1, size(group%lm, 2)
         call group%element%largest_stiffness(e, k)
         call add_diagonal(structure%map, group%lm(:, e), k, k_diagonal)
         if (size(group%damping) == 0) cycle
         call add_diagonal(structure%map, group%lm(:, e), group%damping(:, :, e), c_diagonal)
      end do
   end subroutine sum_diagonals

   pure subroutine add_diagonal(map, lm, matrix, diagonal)
      type(dof_map_type), intent(in) :: map
      integer, intent(in) :: lm(:)
      real(wp), intent(in) :: matrix(:, :)
      real(wp), intent(inout) :: diagonal(:)
      type(folded_type) :: folded
      integer :: i

      call fold(map, lm, matrix, folded)
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
      type(bounded_type) :: last
      real(wp) :: k(size(group%lm, 1), size(group%lm, 1)), lambda
      integer :: e

      do e = 1, size(group%lm, 2)
         call group%element%largest_stiffness(e, k)
         call fold(structure%map, group%lm(:, e), k, folded)
         call bound_element(structure%map, folded, m, k_diagonal, lambda, &
               critical%massless_freedom, last, critical%omega)
         if (lambda > critical%omega) then
            critical%omega = lambda
            critical%element = group%member(e)
         end if
         if (size(group%damping) == 0) cycle
         call fold(structure%map, group%lm(:, e), group%damping(:, :, e), folded)
         call bound_element(structure%map, folded, m, c_diagonal, lambda, critical%massless_freedom)
         critical%damping_rate = max(critical%damping_rate, lambda)
      end do
   end subroutine bound_group

   !> Largest eigenvalue of a folded element matrix on its share of the mass; a freedom that it
   !> acts on and that has no mass is named. Given the last element looked into and the largest
   !> value so far, an element that is the same or that cannot be above it is not looked into: it
   !> gets zero.
   pure subroutine bound_element(map, folded, m, diagonal, lambda, massless_freedom, last, largest)
      type(dof_map_type), intent(in) :: map
      type(folded_type), intent(in) :: folded
      real(wp), intent(in) :: m(:), diagonal(:)  !! (n_eq) mass, assembled diagonal
      real(wp), intent(out) :: lambda
      integer, intent(inout) :: massless_freedom
      type(bounded_type), intent(inout), optional :: last
      real(wp), intent(in), optional :: largest
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
      do i = 1, n
         matrix(:n, i) = folded%matrix(rows(:n), rows(i))
      end do
      lambda = 0.0_wp
      if (present(last)) then
         if (is_known(last, matrix(:n, :n), share(:n))) return
         if (eigenvalue_bound(matrix(:n, :n), share(:n)) <= largest) return
         call remember(last, matrix(:n, :n), share(:n))
      end if
      lambda = largest_eigenvalue(matrix(:n, :n), share(:n))
   end subroutine bound_element

   !> Whether one of the elements remembered has this matrix and no more mass.
   pure function is_known(last, matrix, share) result(known)
      type(bounded_type), intent(in) :: last
      real(wp), intent(in) :: matrix(:, :), share(:)
      logical :: known
      real(wp), parameter :: round_off = 1.0e-12_wp
      real(wp) :: largest
      integer :: i, j, n

      known = .false.
      n = size(share)
      do i = 1, size(last%n)
         if (last%n(i) /= n) cycle
         if (any(share < (1.0_wp - round_off)*last%share(:n, i))) cycle
         largest = 0.0_wp
         do j = 1, n
            largest = max(largest, matrix(j, j))
         end do
         if (any(abs(matrix - last%matrix(:n, :n, i)) > round_off*largest)) cycle
         known = .true.
         return
      end do
   end function is_known

   !> Keeps an element in place of the one kept longest.
   pure subroutine remember(last, matrix, share)
      type(bounded_type), intent(inout) :: last
      real(wp), intent(in) :: matrix(:, :), share(:)
      integer :: n

      n = size(share)
      if (n > most_remembered) return
      last%next = modulo(last%next, size(last%n)) + 1
      last%n(last%next) = n
      last%share(:n, last%next) = share
      last%matrix(:n, :n, last%next) = matrix
   end subroutine remember

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
