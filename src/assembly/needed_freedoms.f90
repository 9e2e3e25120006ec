!> Which freedoms a scene needs: those of its elements and constraints, and at a mass those that a
!> load, condition, gap or contact names.
module needed_freedoms
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use mesh, only: element_mass, element_gap
   use model, only: model_type
   use surfaces, only: contact_pair_type, rigid_plane
   use gap_normals, only: gap_normal
   use histories, only: boundary_type, nodal_value_type, gravity_type
   use steps, only: step_type
   use element_groups, only: group_type
   implicit none
   private

   public :: find_needed_freedoms

contains

   !> Marks every freedom that exists.
   subroutine find_needed_freedoms(model, groups, needed)
      type(model_type), intent(in) :: model
      type(group_type), intent(in) :: groups(:)
      logical, allocatable, intent(out) :: needed(:, :)   !! (3, n_nodes)
      logical, allocatable :: named(:, :)
      logical :: has_mass(model%nodes%n)
      integer :: i, j, g, status

      allocate (needed(3, model%nodes%n), named(3, model%nodes%n), stat=status)
      call check_allocation(status)
      needed = .false.
      named = .false.
      has_mass = .false.
      do g = 1, size(groups)
         call mark_elements(groups(g), needed)
         if (groups(g)%kind == element_mass) has_mass(groups(g)%ien(1, :)) = .true.
      end do
      do i = 1, size(model%equations)
         do j = 1, size(model%equations(i)%node)
            needed(model%equations(i)%dof(j), model%equations(i)%node(j)) = .true.
         end do
      end do
      call name_conditions(model, named)
      call name_contact(model, named)
      do i = 1, model%nodes%n
         if (has_mass(i)) needed(:, i) = needed(:, i) .or. named(:, i)
      end do
   end subroutine find_needed_freedoms

   subroutine mark_elements(group, needed)
      type(group_type), intent(in) :: group
      logical, intent(inout) :: needed(:, :)
      logical :: used(3*size(group%ien, 1))
      integer :: e, i

      do e = 1, size(group%member)
         used = group%element%uses(e)
         do i = 1, size(group%ien, 1)
            needed(:, group%ien(i, e)) = needed(:, group%ien(i, e)) .or. used(3*i - 2:3*i)
         end do
      end do
   end subroutine mark_elements

   subroutine name_conditions(model, named)
      type(model_type), intent(in) :: model
      logical, intent(inout) :: named(:, :)
      integer :: i

      call name_boundaries(model%boundaries, named)
      call name_values(model%initial_displacements, named)
      call name_values(model%initial_velocities, named)
      do i = 1, size(model%steps)
         call name_step(model, model%steps(i), named)
      end do
   end subroutine name_conditions

   subroutine name_step(model, step, named)
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      logical, intent(inout) :: named(:, :)
      integer :: i

      call name_boundaries(step%boundaries, named)
      call name_values(step%loads, named)
      call name_values(step%initial_displacements, named)
      call name_values(step%initial_velocities, named)
      do i = 1, size(step%gravity)
         call name_gravity(model, step%gravity(i), named)
      end do
      do i = 1, size(step%base_motions)
         named(step%base_motions(i)%dof, :) = .true.
      end do
   end subroutine name_step

   subroutine name_boundaries(boundaries, named)
      type(boundary_type), intent(in) :: boundaries(:)
      logical, intent(inout) :: named(:, :)
      integer :: i

      do i = 1, size(boundaries)
         named(boundaries(i)%dof, boundaries(i)%node) = .true.
      end do
   end subroutine name_boundaries

   subroutine name_values(values, named)
      type(nodal_value_type), intent(in) :: values(:)
      logical, intent(inout) :: named(:, :)
      integer :: i

      do i = 1, size(values)
         named(values(i)%dof, values(i)%node) = .true.
      end do
   end subroutine name_values

   subroutine name_gravity(model, gravity, named)
      type(model_type), intent(in) :: model
      type(gravity_type), intent(in) :: gravity
      logical, intent(inout) :: named(:, :)
      integer :: i, e, node
      integer, allocatable :: members(:)

      if (gravity%set > 0) then
         members = model%element_sets(gravity%set)%members
      else
         members = [(i, i=1, model%elements%n)]
      end if
      do i = 1, size(members)
         e = members(i)
         if (model%elements%kind(e) /= element_mass) cycle
         node = model%elements%nodes(model%elements%first(e))
         named(:, node) = named(:, node) .or. abs(gravity%acceleration) > 0.0_wp
      end do
   end subroutine name_gravity

   subroutine name_contact(model, named)
      type(model_type), intent(in) :: model
      logical, intent(inout) :: named(:, :)
      integer :: i, j, p, node
      real(wp) :: normal(3)
      logical :: direction(3)

      do p = 1, size(model%pairs)
         direction = contact_directions(model, model%pairs(p))
         associate (nodes => model%surfaces(model%pairs(p)%contactor)%nodes)
            do i = 1, size(nodes)
               named(:, nodes(i)) = named(:, nodes(i)) .or. direction
            end do
         end associate
      end do
      do i = 1, model%elements%n
         if (model%elements%kind(i) /= element_gap) cycle
         normal = gap_normal(model, i)
         do j = model%elements%first(i), model%elements%first(i + 1) - 1
            node = model%elements%nodes(j)
            named(:, node) = named(:, node) .or. abs(normal) > 0.0_wp
         end do
      end do
   end subroutine name_contact

   !> In which directions the slave of a pair can be pushed: along the normal of a plane, with
   !> friction or against what is curved in the whole x-y plane.
   pure function contact_directions(model, pair) result(direction)
      type(model_type), intent(in) :: model
      type(contact_pair_type), intent(in) :: pair
      logical :: direction(3)

      direction = [.true., .true., .false.]
      if (pair%rigid_target == 0) return
      associate (rigid => model%rigid_surfaces(pair%rigid_target))
         if (rigid%kind == rigid_plane) direction = abs(rigid%normal) > 0.0_wp
      end associate
      if (pair%interaction == 0) return
      if (model%interactions(pair%interaction)%friction > 0.0_wp) direction(:2) = .true.
   end function contact_directions

end module needed_freedoms
