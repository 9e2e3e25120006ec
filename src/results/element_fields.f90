!> Stress, strain, plastic strain, energy and Mises stress as fields of the grid: in the cells (mean
!> over the volume of an element) and, for solids, at the points of the grid (extrapolated to the
!> nodes of each element and averaged over the elements that meet there).
module element_fields
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use element_interface, only: n_recovered, recovered_stress, recovered_strain, recovered_peeq, &
         recovered_energy
   use steps, only: n_quantities, quantity_s, quantity_e, quantity_ener, quantity_peeq
   use impact_scene, only: scene_type
   use hdf5_file, only: hdf5_file_type
   use vtkhdf_grid, only: vtkhdf_grid_type
   use snapshot, only: snapshot_type, point_values
   implicit none
   private

   public :: element_fields_type, new_element_fields, set_element_fields, mises_stress

   integer, parameter :: n_fields = 5
   integer, parameter :: field_s = 1, field_e = 2, field_peeq = 3, field_energy = 4, field_mises = 5
   integer, parameter :: field_size(n_fields) = [6, 6, 1, 1, 1]
   character(len=5), parameter :: field_name(n_fields) = &
         ['S    ', 'E    ', 'PEEQ ', 'ENER ', 'MISES']
   character(len=42), parameter :: meaning(n_fields) = [ &
         'stress 11 22 33 12 23 13 (truss: 11 axial)', &
         'strain 11 22 33 12 23 13 (truss: 11 axial)', &
         'equivalent plastic strain                 ', &
         'strain energy density                     ', &
         'Mises stress                              ']
   !> Rows of `recover` in the order of a VTK tensor: XX YY ZZ XY YZ XZ.
   integer, parameter :: tensor_order(6) = [1, 2, 3, 4, 6, 5]

   !> Numbers of the fields in the grid, 0 for those nobody asked for.
   type :: element_fields_type
      integer :: cell(n_fields) = 0, point(n_fields) = 0
      integer :: n_elements = 0
   end type element_fields_type

contains

   !> Makes the fields that are wanted; those at points only where there are solids.
   subroutine new_element_fields(self, grid, file, wanted, n_elements, with_points, error)
      type(element_fields_type), intent(out) :: self
      type(vtkhdf_grid_type), intent(inout) :: grid
      type(hdf5_file_type), intent(inout) :: file
      logical, intent(in) :: wanted(n_quantities)
      integer, intent(in) :: n_elements
      logical, intent(in) :: with_points
      type(error_type), allocatable, intent(out) :: error
      logical :: chosen(n_fields)
      integer :: i

      self%n_elements = n_elements
      chosen = [wanted(quantity_s), wanted(quantity_e), wanted(quantity_peeq), &
            wanted(quantity_ener), wanted(quantity_s)]
      do i = 1, n_fields
         if (.not. chosen(i)) cycle
         call grid%add_cell_field(file, trim(field_name(i)), field_size(i), trim(meaning(i)), &
               self%cell(i), error)
         if (allocated(error)) return
         if (.not. with_points) cycle
         call grid%add_point_field(file, trim(field_name(i)), field_size(i), &
               trim(meaning(i))//', averaged at nodes', self%point(i), error)
         if (allocated(error)) return
      end do
   end subroutine new_element_fields

   !> Hands the values of a snapshot to the grid.
   subroutine set_element_fields(self, grid, scene, snapshot)
      type(element_fields_type), intent(in) :: self
      type(vtkhdf_grid_type), intent(inout) :: grid
      type(scene_type), intent(inout) :: scene
      type(snapshot_type), intent(in) :: snapshot
      real(wp), allocatable :: cells(:, :), points(:, :)
      integer, allocatable :: n_meeting(:)
      integer :: g, i, status

      if (all(self%cell == 0)) return
      associate (n_nodes => size(scene%system%structure%map%freedom, 2))
         allocate (cells(n_recovered, self%n_elements), points(n_recovered, n_nodes), stat=status)
         call check_allocation(status)
         allocate (n_meeting(n_nodes), stat=status)
         call check_allocation(status)
      end associate
      cells = 0.0_wp
      points = 0.0_wp
      n_meeting = 0
      do g = 1, size(scene%system%structure%groups)
         if (scene%system%structure%groups(g)%element%n_points == 0) cycle
         call add_group(scene, g, snapshot, cells, points, n_meeting)
      end do
      do i = 1, size(n_meeting)
         points(:, i) = points(:, i)/max(1, n_meeting(i))
      end do
      do i = 1, n_fields
         if (self%cell(i) > 0) call set_field(grid, self%cell(i), i, cells)
         if (self%point(i) > 0) call set_field(grid, self%point(i), i, points)
      end do
   end subroutine set_element_fields

   subroutine add_group(scene, g, snapshot, cells, points, n_meeting)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: g
      type(snapshot_type), intent(in) :: snapshot
      real(wp), intent(inout) :: cells(:, :)     !! (n_recovered, n_elements)
      real(wp), intent(inout) :: points(:, :)    !! (n_recovered, n_nodes) sums
      integer, intent(inout) :: n_meeting(:)     !! (n_nodes)
      real(wp) :: values(n_recovered, scene%system%structure%groups(g)%element%n_points)
      real(wp), allocatable :: matrix(:, :)
      integer :: e, i

      associate (group => scene%system%structure%groups(g))
         matrix = group%element%extrapolation()
         do e = 1, size(group%member)
            values = point_values(scene, g, e, snapshot)
            cells(:, group%member(e)) = matmul(values, group%element%point_shares(e))
            do i = 1, size(group%ien, 1)
               points(:, group%ien(i, e)) = points(:, group%ien(i, e)) &
                     + matmul(values, matrix(i, :))
               n_meeting(group%ien(i, e)) = n_meeting(group%ien(i, e)) + 1
            end do
         end do
      end associate
   end subroutine add_group

   subroutine set_field(grid, number, field, values)
      type(vtkhdf_grid_type), intent(inout) :: grid
      integer, intent(in) :: number, field
      real(wp), intent(in) :: values(:, :)       !! (n_recovered, n)
      integer :: i

      select case (field)
      case (field_s)
         call grid%set_values(number, values(recovered_stress - 1 + tensor_order, :))
      case (field_e)
         call grid%set_values(number, values(recovered_strain - 1 + tensor_order, :))
      case (field_peeq)
         call grid%set_values(number, values(recovered_peeq, :))
      case (field_energy)
         call grid%set_values(number, values(recovered_energy, :))
      case default
         call grid%set_values(number, [(mises_stress(values(recovered_stress:recovered_stress + 5, &
               i)), i=1, size(values, 2))])
      end select
   end subroutine set_field

   !> Equivalent stress of von Mises.
   pure function mises_stress(s) result(mises)
      real(wp), intent(in) :: s(6)               !! 11 22 33 12 13 23
      real(wp) :: mises

      mises = sqrt(((s(1) - s(2))**2 + (s(2) - s(3))**2 + (s(3) - s(1))**2)/2.0_wp &
            + 3.0_wp*sum(s(4:6)**2))
   end function mises_stress

end module element_fields
