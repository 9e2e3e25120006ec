!> Writes /VTKHDF: the mesh as points, vertices and lines, and frames of fields on it.
module grid_recorder
   use kinds, only: wp
   use errors, only: error_type
   use model, only: model_type
   use steps, only: quantity_u, quantity_v, quantity_a, quantity_rf, quantity_cf, &
         quantity_cdis, n_quantities
   use contact_pairs, only: contact_pair_list_type
   use impact_scene, only: scene_type
   use hdf5_file, only: hdf5_file_type
   use vtkhdf_grid, only: vtkhdf_grid_type
   use output_plan, only: plan_type
   use snapshot, only: snapshot_type, on_nodes
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

   integer, parameter :: vertex = 1, line = 3

   !> Quantities at nodes; those of elements are element_fields' business.
   integer, parameter :: nodal(6) = [quantity_u, quantity_v, quantity_a, quantity_rf, quantity_cf, &
         quantity_cdis]
   character(len=4), parameter :: names(6) = ['U   ', 'V   ', 'A   ', 'RF  ', 'CF  ', 'CDIS']
   character(len=34), parameter :: meanings(6) = [ &
         'displacement                      ', 'velocity                          ', &
         'acceleration                      ', 'reaction force                    ', &
         'contact force                     ', 'gap of contact nodes, 0 at others ']

contains

   !> Writes the mesh and makes the fields: displacements always, others on request.
   subroutine new_grid(self, file, model, plan, has_solids, error)
      type(grid_type), intent(out) :: self
      type(hdf5_file_type), intent(in) :: file
      type(model_type), intent(in) :: model
      type(plan_type), intent(in) :: plan
      logical, intent(in) :: has_solids
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: types(:), offsets(:)
      integer :: q

      self%needs_reactions = plan%file(quantity_rf)
      offsets = model%elements%first(:model%elements%n + 1) - 1
      types = merge(vertex, line, offsets(2:) - offsets(:model%elements%n) == 1)
      call self%grid%create(file, model%nodes%x(:, :model%nodes%n), types, &
            model%elements%nodes(:offsets(size(offsets))) - 1, offsets, error)
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

   subroutine add_field(self, file, q, error)
      type(grid_type), intent(inout) :: self
      type(hdf5_file_type), intent(in) :: file
      integer, intent(in) :: q
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      i = findloc(nodal, q, dim=1)
      select case (q)
      case (quantity_cdis)
         call self%grid%add_point_field(file, trim(names(i)), 1, trim(meanings(i)), &
               self%field(q), error)
      case default
         call self%grid%add_point_field(file, trim(names(i)), 3, trim(meanings(i)), &
               self%field(q), error)
      end select
   end subroutine add_field

   !> Appends a frame.
   subroutine record_frame(self, file, scene, list, snapshot, error)
      type(grid_type), intent(inout) :: self
      type(hdf5_file_type), intent(in) :: file
      type(scene_type), intent(in) :: scene
      type(contact_pair_list_type), intent(in) :: list
      type(snapshot_type), intent(in) :: snapshot
      type(error_type), allocatable, intent(out) :: error

      call set(quantity_u, snapshot%u)
      call set(quantity_v, snapshot%v)
      call set(quantity_a, snapshot%a)
      call set(quantity_rf, snapshot%rf)
      call set(quantity_cf, snapshot%cf)
      call set_gaps(self, scene, list, snapshot)
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

   end subroutine record_frame

   subroutine set_gaps(self, scene, list, snapshot)
      type(grid_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(contact_pair_list_type), intent(in) :: list
      type(snapshot_type), intent(in) :: snapshot
      real(wp) :: gap(size(scene%system%structure%map%freedom, 2))
      integer :: i

      if (self%field(quantity_cdis) == 0) return
      gap = 0.0_wp
      do i = 1, size(list%rows)
         gap(list%rows(i)%node) = snapshot%gap(i)
      end do
      call self%grid%set_values(self%field(quantity_cdis), gap)
   end subroutine set_gaps

end module grid_recorder
