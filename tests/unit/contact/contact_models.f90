!> Walls, gaps and interactions for models put together by hand.
module contact_models
   use kinds, only: wp
   use mesh, only: element_gap
   use model, only: model_type
   use properties, only: section_type, section_gap
   use small_models, only: add_element_set
   use surfaces, only: interaction_type, surface_type, rigid_surface_type, contact_pair_type
   implicit none
   private

   public :: add_wall, add_gap, add_interaction

contains

   !> The next `*SURFACE INTERACTION`.
   subroutine add_interaction(model, interaction)
      type(model_type), intent(inout) :: model
      type(interaction_type), intent(in) :: interaction
      type(interaction_type), allocatable :: longer(:)
      integer :: n

      n = size(model%interactions)
      allocate (longer(n + 1))
      longer(:n) = model%interactions
      longer(n + 1) = interaction
      call move_alloc(longer, model%interactions)
   end subroutine add_interaction

   !> A pair of some nodes and a plane, at rest or moved, of the last interaction; the names are of
   !> the form S1 and W1.
   subroutine add_wall(model, nodes, point, normal, amplitude, motion)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: nodes(:)
      real(wp), intent(in) :: point(3), normal(3)   !! a unit normal
      integer, intent(in), optional :: amplitude
      real(wp), intent(in), optional :: motion(3)
      type(surface_type), allocatable :: surfaces(:)
      type(rigid_surface_type) :: plane
      type(contact_pair_type) :: pair
      integer :: n

      n = size(model%surfaces)
      allocate (surfaces(n + 1))
      surfaces(:n) = model%surfaces
      surfaces(n + 1)%name = 'S'//achar(iachar('1') + n)
      surfaces(n + 1)%nodes = nodes
      allocate (surfaces(n + 1)%edges(3, 0), surfaces(n + 1)%edge_element(0))
      call move_alloc(surfaces, model%surfaces)
      plane%name = 'W'//achar(iachar('1') + n)
      plane%point = point
      plane%normal = normal
      if (present(amplitude)) plane%amplitude = amplitude
      if (present(motion)) plane%motion = motion
      model%rigid_surfaces = [model%rigid_surfaces, plane]
      pair%contactor = n + 1
      pair%rigid_target = size(model%rigid_surfaces)
      pair%interaction = size(model%interactions)
      model%pairs = [model%pairs, pair]
   end subroutine add_wall

   !> GAPUNI between two nodes, of the last interaction, in an element set of its own name; without
   !> a normal it opens along the line of its nodes.
   subroutine add_gap(model, nodes, clearance, name, normal)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: nodes(2)
      real(wp), intent(in) :: clearance
      character(len=*), intent(in) :: name
      real(wp), intent(in), optional :: normal(3)
      type(section_type), allocatable :: sections(:)
      integer :: n

      n = model%elements%n + 1
      model%elements%n = n
      model%elements%id = [model%elements%id, 100*n]
      model%elements%kind = [model%elements%kind, element_gap]
      model%elements%nodes = [model%elements%nodes, nodes]
      model%elements%first = [model%elements%first, size(model%elements%nodes) + 1]
      deallocate (model%elements%place)
      allocate (model%elements%place(n))
      call add_element_set(model, [n])
      model%element_sets(size(model%element_sets))%name = name
      n = size(model%sections)
      allocate (sections(n + 1))
      sections(:n) = model%sections
      sections(n + 1)%kind = section_gap
      sections(n + 1)%set = size(model%element_sets)
      sections(n + 1)%clearance = clearance
      sections(n + 1)%interaction = size(model%interactions)
      if (present(normal)) sections(n + 1)%normal = normal
      call move_alloc(sections, model%sections)
      model%elements%section = [model%elements%section, n + 1]
   end subroutine add_gap

end module contact_models
