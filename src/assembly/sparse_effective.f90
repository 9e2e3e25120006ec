!> The effective stiffness as a sparse matrix: its pattern and its values, from the same elements as
!> in `effective_matrix`.
module sparse_effective
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use sparse_matrix, only: pattern_type, new_pattern, add_entry, pattern_entries, diagonal_places
   use element_groups, only: group_type
   use dof_map, only: dof_map_type
   use structure, only: structure_type, gather, group_history
   use effective_matrix, only: list_coupled
   use element_sum, only: effective_element, contributes
   implicit none
   private

   public :: find_pattern, assemble_sparse, fill_empty_diagonal

contains

   !> The places of K*.
   subroutine find_pattern(structure, pattern)
      type(structure_type), intent(in) :: structure
      type(pattern_type), intent(out) :: pattern
      integer, allocatable :: first(:), member(:)

      call list_coupled(structure, first, member)
      call new_pattern(pattern, structure%map%n_eq, first, member)
   end subroutine find_pattern

   !> c_mass M + c_damping C + c_stiffness K, damping and tangent stiffness of implicit groups only.
   pure subroutine assemble_sparse(structure, pattern, d, history, factors, values)
      type(structure_type), intent(in) :: structure
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: d(:)               !! (n_freedoms) where the tangent is taken
      real(wp), intent(in) :: history(:)         !! (n_history) last accepted
      real(wp), intent(in) :: factors(3)         !! c_mass, c_damping, c_stiffness
      real(wp), allocatable, intent(inout) :: values(:)   !! (entries)
      integer :: f, g, status

      if (allocated(values)) then
         if (size(values, kind=kind(pattern%first)) /= pattern_entries(pattern)) deallocate (values)
      end if
      if (.not. allocated(values)) then
         allocate (values(pattern_entries(pattern)), stat=status)
         call check_allocation(status)
      end if
      values = 0.0_wp
      do f = 1, structure%map%n_freedoms
         call add_pair(structure%map, pattern, values, [f, f], factors(1)*structure%lumped_mass(f))
      end do
      do g = 1, size(structure%groups)
         call add_group(structure, structure%groups(g), pattern, d, history, factors, values)
      end do
   end subroutine assemble_sparse

   pure subroutine add_group(structure, group, pattern, d, history, factors, values)
      type(structure_type), intent(in) :: structure
      type(group_type), intent(in) :: group
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: d(:), history(:), factors(3)
      real(wp), intent(inout) :: values(:)
      real(wp), allocatable :: local(:, :), total(:, :), memory(:, :)
      integer :: e, n, status

      if (.not. contributes(group, factors)) return
      n = size(group%lm, 1)
      allocate (local(n, size(group%lm, 2)), total(n, n), stat=status)
      call check_allocation(status)
      call gather(group, d, local)
      allocate (memory, source=group_history(group, history), stat=status)
      call check_allocation(status)
      do e = 1, size(group%lm, 2)
         call effective_element(group, e, local(:, e), memory(:, e), factors, total)
         call add_element(structure%map, pattern, values, group%lm(:, e), total)
      end do
   end subroutine add_group

   pure subroutine add_element(map, pattern, values, lm, total)
      type(dof_map_type), intent(in) :: map
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(inout) :: values(:)
      integer, intent(in) :: lm(:)
      real(wp), intent(in) :: total(:, :)
      integer :: i, j

      do j = 1, size(lm)
         do i = 1, size(lm)
            if (lm(i) == 0 .or. lm(j) == 0) cycle
            call add_pair(map, pattern, values, [lm(i), lm(j)], total(i, j))
         end do
      end do
   end subroutine add_element

   !> Adds the entry of a pair of freedoms to all equations behind them; of (i, j) and (j, i) only
   !> the upper one is stored, so each is added once.
   pure subroutine add_pair(map, pattern, values, freedoms, value)
      type(dof_map_type), intent(in) :: map
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(inout) :: values(:)
      integer, intent(in) :: freedoms(2)
      real(wp), intent(in) :: value
      integer :: i, j

      if (.not. abs(value) > 0.0_wp) return
      do j = map%first(freedoms(2)), map%first(freedoms(2) + 1) - 1
         do i = map%first(freedoms(1)), map%first(freedoms(1) + 1) - 1
            if (map%equation(i) > map%equation(j)) cycle
            call add_entry(pattern, values, map%equation(i), map%equation(j), &
                  map%coefficient(i)*map%coefficient(j)*value)
         end do
      end do
   end subroutine add_pair

   !> Gives equations without mass a unit diagonal in a mass matrix.
   pure subroutine fill_empty_diagonal(pattern, values)
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(inout) :: values(:)       !! (entries)
      integer :: j

      associate (places => diagonal_places(pattern))
         do j = 1, pattern%n
            if (.not. values(places(j)) > 0.0_wp) values(places(j)) = 1.0_wp
         end do
      end associate
   end subroutine fill_empty_diagonal

end module sparse_effective
