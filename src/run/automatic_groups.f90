!> SCHEME=AUTO: each element becomes explicit if it is stable by itself at the step asked for, with
!> a margin, and implicit otherwise.
module automatic_groups
   use kinds, only: wp, int64
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use places, only: fail_at
   use model, only: model_type
   use mesh, only: scheme_implicit, scheme_explicit, scheme_automatic
   use steps, only: procedure_dynamic
   use dof_map, only: number_equations
   use structure, only: structure_type, new_structure
   use skyline_matrix, only: profile_type, profile_entries, profile_cost
   use effective_matrix, only: find_profile
   use critical_step, only: find_own_limits
   implicit none
   private

   public :: partition_type, resolve_automatic

   !> What AUTO chose.
   type :: partition_type
      integer :: n_elements = 0                  !! elements that the deck leaves to AUTO
      integer :: n_explicit = 0
      real(wp) :: dt = 0.0_wp                    !! step it was chosen for
      integer(int64) :: entries(2) = 0           !! of the profile: as chosen, all implicit
      real(wp) :: cost(2) = 0.0_wp               !! of the factorization likewise
   end type partition_type

   !> An element is explicit up to this part of its own critical step.
   real(wp), parameter :: margin = 0.95_wp

contains

   !> Builds the structure anew with every AUTO element in its place. AUTO needs a dynamic step with
   !> fixed increments: an error at the group's place without one.
   subroutine resolve_automatic(model, structure, partition, error)
      type(model_type), intent(in) :: model
      type(structure_type), intent(inout) :: structure
      type(partition_type), intent(out) :: partition
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: limits(:)
      integer, allocatable :: scheme(:)
      logical :: automatic(model%elements%n)
      integer :: g, status

      automatic = .false.
      do g = 1, size(model%groups)
         if (model%groups(g)%scheme /= scheme_automatic) cycle
         automatic(model%element_sets(model%groups(g)%set)%members) = .true.
      end do
      if (.not. any(automatic)) return
      partition%dt = largest_step(model)
      if (.not. partition%dt > 0.0_wp) then
         g = findloc(model%groups%scheme, scheme_automatic, dim=1)
         call fail_at(error, model%source, model%groups(g)%place, &
               'SCHEME=AUTO chooses by the step, and no *DYNAMIC, DIRECT step gives one', &
               'add a *DYNAMIC, DIRECT step, or say IMPLICIT or EXPLICIT')
         return
      end if
      allocate (limits(model%elements%n), scheme(model%elements%n), stat=status)
      call check_allocation(status)
      call number_freely(model, structure)
      call find_own_limits(structure, limits)
      scheme = merge(scheme_explicit, scheme_implicit, partition%dt <= margin*limits)
      partition%n_elements = count(automatic)
      partition%n_explicit = count(automatic .and. scheme == scheme_explicit)
      call measure(model, partition, scheme, 1, structure, error)
      if (allocated(error)) return
      call measure(model, partition, 0*scheme + scheme_implicit, 2, structure, error)
      if (allocated(error)) return
      call new_structure(structure, model, error, scheme)
   end subroutine resolve_automatic

   !> The largest fixed step of the dynamic steps, 0 if there is none.
   pure function largest_step(model) result(dt)
      type(model_type), intent(in) :: model
      real(wp) :: dt
      integer :: i

      dt = 0.0_wp
      do i = 1, size(model%steps)
         if (model%steps(i)%procedure /= procedure_dynamic) cycle
         if (model%steps(i)%direct) dt = max(dt, model%steps(i)%dt)
      end do
   end function largest_step

   !> Profile and cost with the given schemes, in the deck's order of nodes.
   subroutine measure(model, partition, scheme, place, structure, error)
      type(model_type), intent(in) :: model
      type(partition_type), intent(inout) :: partition
      integer, intent(in) :: scheme(:)           !! (n_elements)
      integer, intent(in) :: place               !! in the partition's figures
      type(structure_type), intent(inout) :: structure
      type(error_type), allocatable, intent(out) :: error
      type(profile_type) :: profile

      call new_structure(structure, model, error, scheme)
      if (allocated(error)) return
      call number_freely(model, structure)
      call find_profile(structure, profile)
      partition%entries(place) = profile_entries(profile)
      partition%cost(place) = profile_cost(profile)
   end subroutine measure

   !> Equations for all freedoms but those of constraints: boundary conditions only lower
   !> frequencies.
   subroutine number_freely(model, structure)
      type(model_type), intent(in) :: model
      type(structure_type), intent(inout) :: structure
      logical :: none(structure%map%n_freedoms)

      none = .false.
      call number_equations(structure%map, none, model%equations)
   end subroutine number_freely

end module automatic_groups
