!> Makes groups of plane and axisymmetric solids of a model's elements, after a look at their
!> geometry.
module solid_factory
   use kinds, only: wp
   use errors, only: error_type
   use text, only: to_text
   use memory_shortage, only: check_allocation
   use places, only: fail_at
   use congruence, only: find_classes
   use model, only: model_type
   use mesh, only: solid_plane, solid_reduced, solid_topology, quad4, plane_stress, axisymmetric
   use properties, only: section_type, material_type
   use element_interface, only: element_type
   use solid, only: solid_type, new_solid, solid_material_type
   use solid_geometry, only: solid_shape_type, find_fault, fault_none, fault_coincident, &
         fault_radius, fault_clockwise, fault_size
   implicit none
   private

   public :: make_solid

contains

   !> A group of solids of one kind and section. An element that is inside out, folded or collapsed
   !> is an error at its line.
   subroutine make_solid(element, model, member, ien, lumped, error)
      class(element_type), allocatable, intent(out) :: element
      type(model_type), intent(in) :: model
      integer, intent(in) :: member(:)           !! (n) element indices in the model
      integer, intent(in) :: ien(:, :)           !! (n_nodes, n) node indices
      logical, intent(in) :: lumped
      type(error_type), allocatable, intent(out) :: error
      type(solid_type), allocatable :: made
      type(solid_shape_type) :: shape
      type(section_type) :: section
      real(wp), allocatable :: x(:, :, :)
      integer, allocatable :: class(:), first(:)
      integer :: i, status

      section = model%sections(model%elements%section(member(1)))
      shape = shape_of(model%elements%kind(member(1)), section)
      allocate (x(2, size(ien, 1), size(ien, 2)), stat=status)
      call check_allocation(status)
      do i = 1, size(member)
         x(:, :, i) = model%nodes%x(1:2, ien(:, i))
      end do
      call find_classes(x, [shape%plane /= axisymmetric, .true.], class, first)
      do i = 1, size(first)
         call check_geometry(shape, x(:, :, first(i)), model, member(first(i)), error)
         if (allocated(error)) return
      end do
      allocate (made, stat=status)
      call check_allocation(status)
      call new_solid(made, shape, x, material_of(model%materials(section%material)), lumped)
      call move_alloc(made, element)
   end subroutine make_solid

   pure function shape_of(kind, section) result(shape)
      integer, intent(in) :: kind
      type(section_type), intent(in) :: section
      type(solid_shape_type) :: shape

      shape%topology = solid_topology(kind)
      shape%plane = solid_plane(kind)
      shape%reduced = solid_reduced(kind)
      shape%b_bar = section%b_bar .and. shape%topology == quad4 .and. .not. shape%reduced &
            .and. shape%plane /= plane_stress
      if (section%area > 0.0_wp) shape%thickness = section%area
   end function shape_of

   pure function material_of(material) result(shared)
      type(material_type), intent(in) :: material
      type(solid_material_type) :: shared
      integer :: n, status

      shared%young = material%young
      shared%poisson = material%poisson
      shared%density = material%density
      shared%damping_alpha = material%damping_alpha
      shared%damping_beta = material%damping_beta
      shared%plastic = material%has_plastic
      shared%kinematic = material%kinematic
      if (.not. material%has_plastic) return
      n = material%hardening%n
      allocate (shared%hardening(2, n), stat=status)
      call check_allocation(status)
      shared%hardening(1, :) = material%hardening%x(:n)
      shared%hardening(2, :) = material%hardening%y(:n)
   end function material_of

   !> Tells what is wrong with element e, if anything is.
   subroutine check_geometry(shape, x, model, e, error)
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :)
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: cause, cure

      select case (find_fault(shape, x))
      case (fault_none)
         return
      case (fault_coincident)
         cause = 'has an edge of no length beside its size: two of its nodes coincide'
         cure = 'give its nodes different coordinates, or use a triangle'
      case (fault_size)
         cause = 'is '//to_text(maxval(maxval(x, 2) - minval(x, 2)))//' wide: its area is no number'
         cure = 'write coordinates in units in which elements measure between 1e-150 and 1e150'
      case (fault_radius)
         cause = 'is axisymmetric and has a node at a negative radius x'
         cure = 'the axis is y and x is the radius: move the mesh to x of zero or more'
      case (fault_clockwise)
         cause = 'is numbered clockwise or has no area: its Jacobian is nowhere positive'
         cure = 'list its nodes counterclockwise, corners first, seen with x right and y up; '// &
               'in gmsh turn the surface: ReverseMesh Surface {its number};'
      case default
         cause = 'is folded: its Jacobian is zero or negative somewhere'
         cure = 'list its nodes around the edge, corners first, or mend its shape'
      end select
      call fail_at(error, model%source, model%elements%place(e), &
            'element '//to_text(model%elements%id(e))//' '//cause, cure)
   end subroutine check_geometry

end module solid_factory
