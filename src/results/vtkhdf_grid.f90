!> The moving mesh in the group /VTKHDF of the result file, for ParaView and VTK 9.3 or later.
!>
!> VTKHDF 2.0, temporal UnstructuredGrid: the mesh is written once, the fields frame by frame, those
!> that stay as they are once too.
!> https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html#vtkhdf-file-format
!> Frames of small meshes are gathered in memory and written in blocks; `flush` writes what is
!> left, and must be called before the file is closed. The data are written first and the number
!> of frames last: whatever happens in between, a reader finds the frames before.
module vtkhdf_grid
   use errors, only: error_type, new_error, status_internal, status_numerical
   use grid_field, only: field_type, new_field, chunk_rows, set_frame, is_sound, begin_frame, &
         append_field, cut_field
   use hdf5_file, only: hdf5_file_type, series_integer, series_real
   use kinds, only: int64, wp
   use text, only: to_text
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: vtkhdf_grid_type

   character(len=*), parameter :: root = '/VTKHDF'
   integer, parameter :: most_frames = 256   ! gathered, and in a chunk of the lists of frames
   integer, parameter :: most_values = 2**16   ! points and cells of the gathered frames

   !> Lists with an entry a frame that is always the same, and the numbers in a row of them.
   character(len=21), parameter :: step_lists(5) = [character(len=21) :: 'PartOffsets', &
         'NumberOfParts', 'PointOffsets', 'CellOffsets', 'ConnectivityIdOffsets']
   integer, parameter :: step_entries(5) = [0, 1, 0, 0, 0], step_components(5) = [0, 0, 0, 1, 1]

   !> The grid: the mesh, its fields and the number of frames written.
   type :: vtkhdf_grid_type
      private
      integer :: n_points = 0
      integer :: n_cells = 0
      integer :: n_written = 0          ! frames in the file
      integer :: n_held = 0             ! frames gathered
      real(wp), allocatable :: times(:)   ! of them
      type(field_type), allocatable :: fields(:)
   contains
      procedure :: create
      procedure :: add_point_field
      procedure :: add_cell_field
      procedure :: append_frame
      procedure :: count_frames
      procedure :: count_fields
      procedure :: cut_back
      procedure :: flush => flush_frames
      generic :: set_values => set_scalars, set_vectors
      procedure, private :: set_scalars, set_vectors
   end type vtkhdf_grid_type

contains

   !> Writes the mesh. Cell types: 1 vertex, 3 line, 5, 9 and 22, 23 linear and quadratic
   !> triangle and quadrilateral.
   subroutine create(self, file, points, types, connectivity, offsets, error)
      class(vtkhdf_grid_type), intent(out) :: self
      type(hdf5_file_type), intent(inout) :: file
      real(wp), contiguous, intent(in) :: points(:, :)       !! (3, n_points)
      integer, contiguous, intent(in) :: types(:)            !! (n_cells)
      integer, contiguous, intent(in) :: connectivity(:)     !! points of the cells, counted from 0
      integer, contiguous, intent(in) :: offsets(:)          !! (n_cells + 1), the first is 0
      type(error_type), allocatable, intent(out) :: error   !! status_file
      character(len=15), parameter :: counted(3) = [character(len=15) :: 'Points', 'Cells', &
            'ConnectivityIds']
      integer :: counts(3), i, status

      self%n_points = size(points, 2)
      self%n_cells = size(types)
      allocate (self%fields(0), self%times(max(1, min(most_frames, &
            most_values/max(1, self%n_points, self%n_cells)))), stat=status)
      call check_allocation(status)
      if (size(points, 1) /= 3 .or. size(offsets) /= self%n_cells + 1 &
            .or. offsets(size(offsets)) /= size(connectivity)) then
         call new_error(error, status_internal, 'the arrays of the grid do not fit together')
         return
      end if
      call file%create_group(root, 'the mesh and its frames, in the VTKHDF format', error)
      if (.not. allocated(error)) call file%set_attribute(root, 'Version', [2, 0], error)
      if (.not. allocated(error)) call file%set_attribute(root, 'Type', 'UnstructuredGrid', error)
      counts = [self%n_points, self%n_cells, size(connectivity)]
      do i = 1, size(counts)
         if (.not. allocated(error)) call file%write_dataset(root//'/NumberOf'//trim(counted(i)), &
               counts(i:i), 'the number in the name', error)
      end do
      if (.not. allocated(error)) call file%write_dataset(root//'/Points', points, &
            'undeformed places of the points', error)
      if (.not. allocated(error)) call file%write_dataset(root//'/Connectivity', connectivity, &
            'points of the cells, counted from 0', error)
      if (.not. allocated(error)) call file%write_dataset(root//'/Offsets', offsets, &
            'where the points of each cell begin in the connectivity', error)
      if (.not. allocated(error)) call file%write_bytes(root//'/Types', types, &
            'VTK types of the cells', error)
      if (.not. allocated(error)) call create_steps(file, error)
   end subroutine create

   !> Makes the group with one entry a frame.
   subroutine create_steps(file, error)
      type(hdf5_file_type), intent(inout) :: file
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      call file%create_group(root//'/Steps', 'the frames', error)
      if (.not. allocated(error)) call file%set_attribute(root//'/Steps', 'NSteps', 0, error)
      if (.not. allocated(error)) call file%create_series(root//'/Steps/Values', series_real, 0, &
            most_frames, 'time', error)
      do i = 1, size(step_lists)
         if (allocated(error)) return
         call file%create_series(root//'/Steps/'//trim(step_lists(i)), series_integer, &
               step_components(i), most_frames, &
               'the same in each frame: the mesh does not change', error)
      end do
   end subroutine create_steps

   !> Adds a quantity at the points; only before the first frame.
   subroutine add_point_field(self, file, name, n_components, description, field, error, partial)
      class(vtkhdf_grid_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: name, description
      integer, intent(in) :: n_components   !! 1 scalar, 3 vector, 6 symmetric tensor
      integer, intent(out) :: field         !! its number, for `set_values`
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical, intent(in), optional :: partial   !! NaN stands where there is no value

      call add_field(self, 'Point', name, n_components, self%n_points, field)
      if (present(partial)) self%fields(field)%partial = partial
      call create_field(self, file, self%fields(field), description, error)
      if (.not. allocated(error)) call mark_active(self, file, 'Point', field, error)
   end subroutine add_point_field

   !> Adds a quantity of the cells; only before the first frame.
   subroutine add_cell_field(self, file, name, n_components, description, field, error)
      class(vtkhdf_grid_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: name, description
      integer, intent(in) :: n_components   !! 1 scalar, 3 vector, 6 symmetric tensor
      integer, intent(out) :: field         !! its number, for `set_values`
      type(error_type), allocatable, intent(out) :: error   !! status_file

      call add_field(self, 'Cell', name, n_components, self%n_cells, field)
      call create_field(self, file, self%fields(field), description, error)
      if (.not. allocated(error)) call mark_active(self, file, 'Cell', field, error)
   end subroutine add_cell_field

   !> Marks the first vector and the first tensor of a place as its active ones, which filters that
   !> want a vector take unless they are told another: U, that comes first, moves the mesh.
   subroutine mark_active(self, file, place, field, error)
      type(vtkhdf_grid_type), intent(in) :: self
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: place   !! 'Point' or 'Cell'
      integer, intent(in) :: field            !! the one that was added last
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: group
      integer :: i, n_components

      group = root//'/'//place//'Data'
      n_components = size(self%fields(field)%held, 1)
      if (n_components < 3) return
      do i = 1, field - 1
         if (size(self%fields(i)%held, 1) == n_components &
               .and. index(self%fields(i)%data_path, group//'/') == 1) return
      end do
      associate (name => self%fields(field)%data_path(len(group) + 2:))
         if (n_components == 3) call file%set_attribute(group, 'Vectors', name, error)
         if (n_components == 6) call file%set_attribute(group, 'Tensors', name, error)
      end associate
   end subroutine mark_active

   !> Appends a field, all zero, to the list.
   subroutine add_field(self, place, name, n_components, n_values, field)
      type(vtkhdf_grid_type), intent(inout) :: self
      character(len=*), intent(in) :: place   !! 'Point' or 'Cell'
      character(len=*), intent(in) :: name
      integer, intent(in) :: n_components, n_values
      integer, intent(out) :: field
      type(field_type), allocatable :: longer(:)
      integer :: i, status

      field = size(self%fields) + 1
      allocate (longer(field), stat=status)
      call check_allocation(status)
      do i = 1, field - 1
         longer(i) = self%fields(i)
      end do
      call new_field(longer(field), n_components, n_values, size(self%times))
      longer(field)%data_path = root//'/'//place//'Data/'//name
      longer(field)%offset_path = root//'/Steps/'//place//'DataOffsets/'//name
      call move_alloc(longer, self%fields)
   end subroutine add_field

   !> Makes the datasets of a field in the file.
   subroutine create_field(self, file, field, description, error)
      type(vtkhdf_grid_type), intent(in) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(field_type), intent(in) :: field
      character(len=*), intent(in) :: description
      type(error_type), allocatable, intent(out) :: error
      integer :: components

      if (self%count_frames() > 0) then
         call new_error(error, status_internal, field%data_path//' comes after the first frame')
         return
      end if
      components = size(field%held, 1)
      if (components == 1) components = 0
      call file%create_series(field%data_path, series_real, components, chunk_rows(field), &
            description, error)
      if (allocated(error)) return
      call file%create_series(field%offset_path, series_integer, 0, most_frames, &
            'where each frame begins in '//field%data_path, error)
   end subroutine create_field

   !> Bytes by which the file grows at most when the gathered frames are written: their data, chunks
   !> begun, and the tables of chunks.
   pure function bytes_needed(self) result(bytes)
      type(vtkhdf_grid_type), intent(in) :: self
      integer(int64) :: bytes, data
      integer(int64), parameter :: tables = 8192
      integer :: i

      bytes = tables*(6 + 2*size(self%fields))
      do i = 1, size(self%fields)
         associate (field => self%fields(i))
            data = 8_int64*size(field%held, 1)*field%n*self%n_held
            bytes = bytes + data + data/16 + 16_int64*size(field%held, 1)*chunk_rows(field)
         end associate
      end do
   end function bytes_needed

   !> No result is infinite, nor NaN but where there is no value.
   subroutine check_finite(self, time, error)
      type(vtkhdf_grid_type), intent(in) :: self
      real(wp), intent(in) :: time
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(self%fields)
         associate (field => self%fields(i))
            if (is_sound(field, self%n_held)) cycle
            call new_error(error, status_numerical, field%data_path//' is not finite (NaN or ' &
                  //'infinite) at time '//to_text(time)//new_line('a') &
                  //'  cure: a smaller step; or other units, so that no number overflows')
            return
         end associate
      end do
   end subroutine check_finite

   !> Hands over a scalar field for the next frame; it stays until it is set again.
   pure subroutine set_scalars(self, field, values)
      class(vtkhdf_grid_type), intent(inout) :: self
      integer, intent(in) :: field
      real(wp), intent(in) :: values(:)   !! (point or cell)

      call set_frame(self%fields(field), self%n_held, values)
   end subroutine set_scalars

   !> Hands over a vector or tensor field for the next frame; it stays until it is set again.
   pure subroutine set_vectors(self, field, values)
      class(vtkhdf_grid_type), intent(inout) :: self
      integer, intent(in) :: field
      real(wp), intent(in) :: values(:, :)   !! (component, point or cell)

      call set_frame(self%fields(field), self%n_held, values)
   end subroutine set_vectors

   !> Makes a frame of the fields as they were handed over.
   subroutine append_frame(self, file, time, error)
      class(vtkhdf_grid_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      real(wp), intent(in) :: time   !! or whatever orders the frames, e.g. a frequency
      !> status_file; status_numerical: a value that is not finite
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      call check_finite(self, time, error)
      if (allocated(error)) return
      self%n_held = self%n_held + 1
      self%times(self%n_held) = time
      if (self%n_held == size(self%times)) then
         call self%flush(file, error)
         return
      end if
      do i = 1, size(self%fields)
         call begin_frame(self%fields(i), self%n_held)
      end do
   end subroutine append_frame

   !> Writes the gathered frames: data, entries in the lists, at last their number.
   subroutine flush_frames(self, file, error)
      class(vtkhdf_grid_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer :: i

      if (self%n_held == 0) return
      call file%reserve(bytes_needed(self), error)
      if (allocated(error)) return
      do i = 1, size(self%fields)
         call append_field(self%fields(i), file, self%n_held, error)
         if (allocated(error)) return
      end do
      call append_steps(self, file, error)
      if (allocated(error)) return
      call file%set_attribute(root//'/Steps', 'NSteps', self%count_frames(), error)
      if (allocated(error)) return
      self%n_written = self%count_frames()
      self%n_held = 0
   end subroutine flush_frames

   subroutine append_steps(self, file, error)
      type(vtkhdf_grid_type), intent(in) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(error_type), allocatable, intent(out) :: error
      integer :: entries(self%n_held), i

      do i = 1, size(step_lists)
         entries = step_entries(i)
         call file%append(root//'/Steps/'//trim(step_lists(i)), entries, error)
         if (allocated(error)) return
      end do
      call file%append(root//'/Steps/Values', self%times(:self%n_held), error)
   end subroutine append_steps

   !> Frames appended so far, written or not.
   pure integer function count_frames(self)
      class(vtkhdf_grid_type), intent(in) :: self

      count_frames = self%n_written + self%n_held
   end function count_frames

   pure integer function count_fields(self)
      class(vtkhdf_grid_type), intent(in) :: self

      count_fields = size(self%fields)
   end function count_fields

   !> Leaves the first frames of a reopened file, to go on behind them.
   subroutine cut_back(self, file, n_frames, short, error)
      class(vtkhdf_grid_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: n_frames
      character(len=:), allocatable, intent(out) :: short   !! what has not so many, if something
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer :: i

      do i = 1, size(self%fields)
         call cut_field(self%fields(i), file, n_frames, short, error)
         if (allocated(error) .or. allocated(short)) return
      end do
      do i = 1, size(step_lists)
         call file%cut(root//'/Steps/'//trim(step_lists(i)), int(n_frames, int64), short, error)
         if (allocated(error) .or. allocated(short)) return
      end do
      call file%cut(root//'/Steps/Values', int(n_frames, int64), short, error)
      if (allocated(error) .or. allocated(short)) return
      call file%set_attribute(root//'/Steps', 'NSteps', n_frames, error)
      self%n_written = n_frames
   end subroutine cut_back

end module vtkhdf_grid
