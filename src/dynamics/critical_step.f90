!> Bounds on the highest frequencies from single elements: for shares M_e of the mass with
!> sum M_e <= M, omega_max^2 <= max_e lambda(K_e, M_e). The mass of each freedom is shared among its
!> elements in proportion to their diagonal stiffness.
module critical_step
   use kinds, only: wp
   use small_eigen, only: largest_eigenvalue
   use element_groups, only: group_type
   use dof_map, only: dof_map_type
   use structure, only: structure_type, row_sum_mass
   implicit none
   private

   public :: critical_type, find_critical

   !> What limits the step of the groups of one scheme.
   type :: critical_type
      real(wp) :: omega = 0.0_wp            !! bound on the highest frequency, rad/time
      real(wp) :: damping_rate = 0.0_wp     !! bound on the eigenvalues of M^-1 C
      integer :: element = 0                !! model index of the element with the highest frequency
      integer :: massless_freedom = 0       !! a freedom of an explicit element without mass
      real(wp) :: step = huge(1.0_wp)       !! critical step of explicit integration
   end type critical_type

contains

   !> Frequencies and explicit critical step h = 2 / (sqrt(omega^2 + (c/2)^2) + c/2) with the
   !> damping rate c, lagged as explicit damping is (gamma = 1/2; a larger gamma by sqrt(1/(2
   !> gamma))).
   subroutine find_critical(structure, scheme, gamma, critical)
      type(structure_type), intent(in) :: structure
      integer, intent(in) :: scheme
      real(wp), intent(in) :: gamma
      type(critical_type), intent(out) :: critical
      real(wp) :: m(structure%map%n_freedoms), k_diagonal(structure%map%n_freedoms)
      real(wp) :: c_diagonal(structure%map%n_freedoms), total
      integer :: g

      ! The consistent mass of a truss is at least a third of its row sums, in any motion
      m = (row_sum_mass(structure) + 2.0_wp*structure%lumped_mass)/3.0_wp
      call sum_diagonals(structure, scheme, k_diagonal, c_diagonal)
      do g = 1, size(structure%groups)
         if (structure%groups(g)%scheme /= scheme) cycle
         call bound_group(structure, structure%groups(g), m, k_diagonal, c_diagonal, critical)
      end do
      critical%omega = sqrt(critical%omega)
      total = sqrt(critical%omega**2 + (critical%damping_rate/2.0_wp)**2) &
            + critical%damping_rate/2.0_wp
      if (total > 0.0_wp) critical%step = sqrt(1.0_wp/(2.0_wp*gamma))*2.0_wp/total
   end subroutine find_critical

   !> Diagonals of the assembled K and C of a scheme, without constraints.
   subroutine sum_diagonals(structure, scheme, k_diagonal, c_diagonal)
      type(structure_type), intent(in) :: structure
      integer, intent(in) :: scheme
      real(wp), intent(out) :: k_diagonal(:), c_diagonal(:)
      real(wp), allocatable :: k(:, :)
      integer :: g, e, i, f

      k_diagonal = 0.0_wp
      c_diagonal = 0.0_wp
      do g = 1, size(structure%groups)
         associate (group => structure%groups(g))
            if (group%scheme /= scheme) cycle
            allocate (k(size(group%lm, 1), size(group%lm, 1)))
            do e = 1, size(group%lm, 2)
               call group%element%largest_stiffness(e, k)
               do i = 1, size(group%lm, 1)
                  f = group%lm(i, e)
                  if (f == 0) cycle
                  k_diagonal(f) = k_diagonal(f) + k(i, i)
                  if (size(group%damping) == 0) cycle
                  c_diagonal(f) = c_diagonal(f) + group%damping(i, i, e)
               end do
            end do
            deallocate (k)
         end associate
      end do
   end subroutine sum_diagonals

   !> Raises the bounds (omega squared here) by the elements of a group.
   subroutine bound_group(structure, group, m, k_diagonal, c_diagonal, critical)
      type(structure_type), intent(in) :: structure
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: m(:), k_diagonal(:), c_diagonal(:)
      type(critical_type), intent(inout) :: critical
      real(wp), allocatable :: k(:, :)
      real(wp) :: lambda
      integer :: e, f

      allocate (k(size(group%lm, 1), size(group%lm, 1)))
      do e = 1, size(group%lm, 2)
         call group%element%largest_stiffness(e, k)
         f = massless(structure%map, group%lm(:, e), k, m)
         if (f > 0) critical%massless_freedom = f
         lambda = element_bound(group%lm(:, e), k, m, k_diagonal)
         if (lambda > critical%omega) then
            critical%omega = lambda
            critical%element = group%member(e)
         end if
         if (size(group%damping) == 0) cycle
         f = massless(structure%map, group%lm(:, e), group%damping(:, :, e), m)
         if (f > 0) critical%massless_freedom = f
         critical%damping_rate = max(critical%damping_rate, &
               element_bound(group%lm(:, e), group%damping(:, :, e), m, c_diagonal))
      end do
   end subroutine bound_group

   !> A freedom that the matrix acts on, that is free and has no mass, 0 if there is none.
   pure function massless(map, lm, matrix, m) result(freedom)
      type(dof_map_type), intent(in) :: map
      integer, intent(in) :: lm(:)
      real(wp), intent(in) :: matrix(:, :), m(:)
      integer :: freedom
      integer :: i

      freedom = 0
      do i = 1, size(lm)
         if (lm(i) == 0 .or. .not. matrix(i, i) > 0.0_wp) cycle
         if (map%id(map%dof(lm(i)), map%node(lm(i))) == 0) cycle
         if (.not. m(lm(i)) > 0.0_wp) freedom = lm(i)
      end do
   end function massless

   !> Largest eigenvalue of an element matrix on its share of the mass.
   pure function element_bound(lm, matrix, m, diagonal) result(lambda)
      integer, intent(in) :: lm(:)
      real(wp), intent(in) :: matrix(:, :)
      real(wp), intent(in) :: m(:), diagonal(:)  !! (n_freedoms) mass, assembled diagonal
      real(wp) :: lambda
      integer :: rows(size(lm)), n, i
      real(wp) :: share(size(lm))

      n = 0
      do i = 1, size(lm)
         if (lm(i) == 0 .or. .not. matrix(i, i) > 0.0_wp) cycle
         if (.not. m(lm(i)) > 0.0_wp) cycle
         n = n + 1
         rows(n) = i
         share(n) = m(lm(i))*matrix(i, i)/diagonal(lm(i))
      end do
      lambda = largest_eigenvalue(matrix(rows(:n), rows(:n)), share(:n))
   end function element_bound

end module critical_step
