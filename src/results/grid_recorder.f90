!> Writes /VTKHDF: the mesh as points and cells, and frames of fields on it.
module grid_recorder
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use model, only: model_type
   use mesh, only: is_solid_kind, solid_topology
   use steps, only: quantity_u, quantity_v, quantity_a, quantity_rf, quantity_cf, &
         quantity_cdis, quantity_cpress, quantity_cslip, quantity_cstate, quantity_names, &
         n_quantities
   use contact_pairs, only: contact_pair_list_type
   use impact_scene, only: scene_type
   use hdf5_file, only: hdf5_file_type
   use vtkhdf_grid, only: vtkhdf_grid_type
   use output_plan, only: plan_type
   use snapshot, only: snapshot_type, on_nodes
   use gap_probe, only: not_a_number
   use element_fields, only: element_fields_type, new_element_fields, set_element_fields
   implicit none
   private

   public :: grid_type, new_grid, record_frame

   !> The grid and the numbers of its fields, 0 for those nobody asked for.
   type :: grid_type
      type(vtkhdf_grid_type) :: grid
      integer :: field(n_quantities) = 0
      type(element_fields_type) :: element_fields
      logical :: needs_reactions = .false.
   end type grid_type

   !> VTK types of points and lines by their number of nodes, of solids by topology (tri3, quad4,
   !! tri6, quad8).
   integer, parameter :: line_types(3) = [1, 3, 21]
   integer, parameter :: solid_types(4) = [5, 9, 22, 23]

   !> Quantities at nodes; those of elements are element_fields' business.
   integer, parameter :: nodal(9) = [quantity_u, quantity_v, quantity_a, quantity_rf, quantity_cf, &
         quantity_cdis, quantity_cpress, quantity_cslip, quantity_cstate]
   integer, parameter :: n_components(9) = [3, 3, 3, 3, 3, 1, 1, 1, 1]
   character(len=83), parameter :: meanings(9) = [character(len=83) :: &
         'displacement', 'velocity', 'acceleration', 'reaction force', &
         'contact force, with friction', &
         'smallest gap of contact nodes, NaN where nothing is near, 0 at other nodes', &
         'contact pressure at slave nodes; 0 at surfaces made of nodes, which have no area', &
         'path that contact nodes have slid along their partners, where there is friction', &
         '0 no contact node, 1 open, 2 touching (sticking if there is friction), 3 sliding']

contains

   !> Writes the mesh and makes the fields: displacements always, others on request.
   subroutine new_grid(self, file, model, plan, has_solids, error)
      type(grid_type), intent(out) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(model_type), intent(in) :: model
      type(plan_type), intent(in) :: plan
      logical, intent(in) :: has_solids
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: types(:), connectivity(:), offsets(:)
      integer :: q

      self%needs_reactions = plan%file(quantity_rf)
      call make_cells(model, types, connectivity, offsets)
      call self%grid%create(file, model%nodes%x(:, :model%nodes%n), types, connectivity, offsets, &
            error)
      if (allocated(error)) return
      do q = 1, n_quantities
         if (.not. plan%file(q) .and. q /= quantity_u) cycle
         if (.not. any(nodal == q)) cycle
         call add_field(self, file, q, error)
         if (allocated(error)) return
      end do
      call new_element_fields(self%element_fields, self%grid, file, plan%file, model%elements%n, &
            has_solids, error)
   end subroutine new_grid

   !> The elements as VTK cells. Of a line with three nodes VTK wants the middle one last; decks
   !! differ in that, so the one between the others is looked for.
   subroutine make_cells(model, types, connectivity, offsets)
      type(model_type), intent(in) :: model
      integer, allocatable, intent(out) :: types(:), connectivity(:), offsets(:)
      integer :: e, n, n_nodes, status

      n = model%elements%n
      offsets = model%elements%first(:n + 1) - 1
      connectivity = model%elements%nodes(:offsets(n + 1)) - 1
      allocate (types(n), stat=status)
      call check_allocation(status)
      do e = 1, n
         if (is_solid_kind(model%elements%kind(e))) then
            types(e) = solid_types(solid_topology(model%elements%kind(e)))
            cycle
         end if
         n_nodes = offsets(e + 1) - offsets(e)
         types(e) = line_types(n_nodes)
         if (n_nodes < 3) cycle
         associate (points => connectivity(offsets(e) + 1:offsets(e + 1)))
            if (is_between(model%nodes%x(:, points + 1))) points = points([1, 3, 2])
         end associate
      end do
   end subroutine make_cells

   !> Whether the second of three points, rather than the third, lies between the others.
   pure function is_between(x) result(between)
      real(wp), intent(in) :: x(3, 3)
      logical :: between

      between = norm2(x(:, 1) + x(:, 3) - 2.0_wp*x(:, 2)) &
            < norm2(x(:, 1) + x(:, 2) - 2.0_wp*x(:, 3))
   end function is_between

   subroutine add_field(self, file, q, error)
      type(grid_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: q
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      i = findloc(nodal, q, dim=1)
      call self%grid%add_point_field(file, trim(quantity_names(q)), n_components(i), &
            trim(meanings(i)), self%field(q), error, partial=q == quantity_cdis)
   end subroutine add_field

   !> Appends a frame.
   subroutine record_frame(self, file, scene, list, snapshot, error)
      type(grid_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(scene_type), intent(inout) :: scene
      type(contact_pair_list_type), intent(in) :: list
      type(snapshot_type), intent(in) :: snapshot
      type(error_type), allocatable, intent(out) :: error

      call set(quantity_u, snapshot%u)
      call set(quantity_v, snapshot%v)
      call set(quantity_a, snapshot%a)
      call set(quantity_rf, snapshot%rf)
      call set(quantity_cf, snapshot%cf)
      call set_gaps(self, scene, list, snapshot)
      call set_largest(quantity_cpress, snapshot%pressure)
      call set_largest(quantity_cslip, snapshot%slip)
      call set_largest(quantity_cstate, real(snapshot%state, wp))
      call set_element_fields(self%element_fields, self%grid, scene, snapshot)
      call self%grid%append_frame(file, snapshot%time, error)

   contains

      subroutine set(q, values)
         integer, intent(in) :: q
         real(wp), intent(in) :: values(:)

         if (self%field(q) == 0) return
         call self%grid%set_values(self%field(q), &
               on_nodes(scene%system%structure%map%freedom, values))
      end subroutine set

      !> Of a node with several rows, the largest value.
      subroutine set_largest(q, values)
         integer, intent(in) :: q
         real(wp), intent(in) :: values(:)       !! (n_rows)
         real(wp) :: largest(size(scene%system%structure%map%freedom, 2))
         integer :: i

         if (self%field(q) == 0) return
         largest = 0.0_wp
         largest(list%rows%node) = -huge(1.0_wp)
         do i = 1, size(list%rows)
            associate (node => list%rows(i)%node)
               largest(node) = max(largest(node), values(i))
            end associate
         end do
         call self%grid%set_values(self%field(q), largest)
      end subroutine set_largest

   end subroutine record_frame

   !> Of a node with several rows, the smallest gap.
   subroutine set_gaps(self, scene, list, snapshot)
      type(grid_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(contact_pair_list_type), intent(in) :: list
      type(snapshot_type), intent(in) :: snapshot
      real(wp) :: gap(size(scene%system%structure%map%freedom, 2))
      integer :: i

      if (self%field(quantity_cdis) == 0) return
      gap = 0.0_wp
      gap(list%rows%node) = not_a_number()
      do i = 1, size(list%rows)
         associate (node => list%rows(i)%node)
            if (ieee_is_nan(snapshot%gap(i))) cycle
            if (ieee_is_nan(gap(node))) gap(node) = snapshot%gap(i)
            gap(node) = min(gap(node), snapshot%gap(i))
         end associate
      end do
      call self%grid%set_values(self%field(quantity_cdis), gap)
   end subroutine set_gaps

end module grid_recorder
