!> Sets while they are read: they may name each other in any order, and are put together at the end.
module set_drafts
   use memory_shortage, only: check_allocation
   use errors, only: error_type
   use places, only: place_type, source_type, fail_at
   use mesh, only: set_type
   use name_map, only: name_map_type
   use model_building, only: sort_unique
   use text, only: to_text
   implicit none
   private

   public :: draft_type, drafts_type, resolve_sets

   integer, parameter :: set_new = 0, set_open = 1, set_done = 2
   integer, parameter :: most_members = 100000000   !! of all sets of a sort

   !> A set while it is read: members so far, and the sets it takes in.
   type :: draft_type
      integer, allocatable :: members(:)
      integer :: n_members = 0
      integer, allocatable :: parts(:)           !! indices of the sets it names
      integer :: n_parts = 0
      type(place_type), allocatable :: part_places(:)
      integer :: state = set_new                 !! one of the three above
   end type draft_type

   !> All sets of one sort (nodes or elements) while they are read.
   type :: drafts_type
      character(len=8) :: what = ''              !! "node" or "element", for messages
      type(set_type), allocatable :: sets(:)
      type(draft_type), allocatable :: drafts(:)
      integer :: n = 0
      integer :: n_members = 0                   !! of all sets that are done
      type(name_map_type) :: set_of              !! name to index
   end type drafts_type

contains

   !> Takes into every set those that it names, and sorts its members. Sets may name each other to
   !> any depth: the way from set to set is kept here, not on the stack of calls.
   subroutine resolve_sets(family, source, error)
      type(drafts_type), intent(inout) :: family
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: way(:), next(:)
      integer :: i, depth, set, part, status

      allocate (way(family%n), next(family%n), source=0, stat=status)
      call check_allocation(status)
      do i = 1, family%n
         if (family%drafts(i)%state == set_done) cycle
         depth = 1
         way(1) = i
         family%drafts(i)%state = set_open
         do while (depth > 0)
            set = way(depth)
            next(set) = next(set) + 1
            if (next(set) > family%drafts(set)%n_parts) then
               call unite(family, set, source, error)
               if (allocated(error)) return
               depth = depth - 1
               cycle
            end if
            part = family%drafts(set)%parts(next(set))
            if (family%drafts(part)%state == set_done) cycle
            call check_loop(family, set, next(set), source, error)
            if (allocated(error)) return
            depth = depth + 1
            way(depth) = part
            family%drafts(part)%state = set_open
         end do
      end do
   end subroutine resolve_sets

   subroutine check_loop(family, set, k, source, error)
      type(drafts_type), intent(in) :: family
      integer, intent(in) :: set
      integer, intent(in) :: k                   !! which of its parts
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      associate (part => family%drafts(set)%parts(k))
         if (family%drafts(part)%state == set_open) call fail_at(error, source, &
               family%drafts(set)%part_places(k), &
               'set loop: '//trim(family%sets(part)%name)//' contains itself', &
               cure='a set must not contain itself, directly or through others')
      end associate
   end subroutine check_loop

   !> The members of a set and of those that it names, which are done.
   subroutine unite(family, set, source, error)
      type(drafts_type), intent(inout) :: family
      integer, intent(in) :: set
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: parts(:), members(:)
      integer :: k, n, status

      associate (draft => family%drafts(set))
         parts = draft%parts(:draft%n_parts)
         call sort_unique(parts)
         n = draft%n_members
         do k = 1, size(parts)
            n = n + size(family%sets(parts(k))%members)
         end do
         allocate (members(n), stat=status)
         call check_allocation(status)
         n = draft%n_members
         members(:n) = draft%members(:n)
         deallocate (draft%members)
         draft%state = set_done
      end associate
      do k = 1, size(parts)
         associate (more => family%sets(parts(k))%members)
            members(n + 1:n + size(more)) = more
            n = n + size(more)
         end associate
      end do
      call sort_unique(members)
      family%n_members = family%n_members + size(members)
      call move_alloc(members, family%sets(set)%members)
      if (family%n_members > most_members) call fail_at(error, source, family%sets(set)%place, &
            'the '//trim(family%what)//' sets up to this one have more than '// &
            to_text(most_members)//' members together', &
            cure='leave out sets that are not used')
   end subroutine unite

end module set_drafts
