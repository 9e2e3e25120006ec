!> The consistent mass of all groups that have one, as a sparse matrix: element by element it would
!> be integrated anew in every product.
module consistent_mass
   use kinds, only: wp, int64
   use memory_shortage, only: check_allocation
   use element_groups, only: group_type, group_mass
   use sparse_operator, only: sparse_operator_type, new_sparse_operator
   implicit none
   private

   public :: build_consistent_mass

   !> Largest number of element entries that are added up to one matrix.
   integer(int64), parameter :: most_entries = 20000000_int64

   !> Entries one by one.
   type :: entries_type
      integer :: n = 0
      integer, allocatable :: row(:), column(:)
      real(wp), allocatable :: value(:)
   end type entries_type

contains

   !> M of the groups whose mass is not lumped, over freedoms. Without such groups, and for models
   !> too large to keep it, the operator stays empty (n = 0).
   subroutine build_consistent_mass(groups, n_freedoms, mass)
      type(group_type), intent(in) :: groups(:)    !! with their lm
      integer, intent(in) :: n_freedoms
      type(sparse_operator_type), intent(out) :: mass
      type(entries_type) :: entries
      integer(int64) :: expected
      integer :: g, status

      expected = 0
      do g = 1, size(groups)
         if (groups(g)%lumped) cycle
         associate (nodes => int(size(groups(g)%ien, 1), int64))
            expected = expected + 3*nodes**2*size(groups(g)%member)
         end associate
      end do
      if (expected == 0 .or. expected > most_entries) return
      allocate (entries%row(expected), entries%column(expected), entries%value(expected), &
            stat=status)
      call check_allocation(status)
      do g = 1, size(groups)
         if (.not. groups(g)%lumped) call add_group(groups(g), entries)
      end do
      associate (n => entries%n)
         call new_sparse_operator(mass, n_freedoms, entries%row(:n), entries%column(:n), &
               entries%value(:n))
      end associate
   end subroutine build_consistent_mass

   !> Directions do not couple: an element has no more than 3 n_nodes^2 entries.
   subroutine add_group(group, entries)
      type(group_type), intent(in) :: group
      type(entries_type), intent(inout) :: entries
      real(wp) :: m(size(group%lm, 1), size(group%lm, 1))
      integer :: e, i, j

      do e = 1, size(group%member)
         call group_mass(group, e, .false., m)
         do j = 1, size(m, 2)
            do i = 1, size(m, 1)
               if (abs(m(i, j)) <= 0.0_wp .or. min(group%lm(i, e), group%lm(j, e)) == 0) cycle
               entries%n = entries%n + 1
               entries%row(entries%n) = group%lm(i, e)
               entries%column(entries%n) = group%lm(j, e)
               entries%value(entries%n) = m(i, j)
            end do
         end do
      end do
   end subroutine add_group

end module consistent_mass
