!> Strips of solids, straight or bent, whose faces are surfaces of contact pairs.
module strip_models
   use kinds, only: wp
   use mesh, only: plane_stress, tri3, quad4, quad8
   use model, only: model_type
   use properties, only: material_type, section_solid, section_type
   use small_models, only: add_node
   use surfaces, only: contact_pair_type, surface_type
   implicit none
   private

   public :: strip_type, add_strip, bend, add_pair, add_surface, nodes_at

   !> A strip of cells on a grid; a triangle is half a cell.
   type :: strip_type
      integer :: plane = plane_stress
      integer :: topology = quad4
      integer :: cells(2) = [6, 2]
      real(wp) :: corner(2) = 0.0_wp
      real(wp) :: size(2) = [6.0_wp, 2.0_wp]
   end type strip_type

contains

   !> Nodes and elements of a strip: E 900, nu 0.3, density 3, thickness 2.
   subroutine add_strip(model, strip)
      type(model_type), intent(inout) :: model
      type(strip_type), intent(in) :: strip
      integer, allocatable :: number(:, :)
      integer :: i, j, c(2)

      call add_section(model)
      allocate (number(0:2*strip%cells(1), 0:2*strip%cells(2)))
      number = 0
      do i = 1, strip%cells(1)
         do j = 1, strip%cells(2)
            c = 2*[i, j] - 2
            select case (strip%topology)
            case (quad4)
               call add_cell([0, 0, 2, 0, 2, 2, 0, 2])
            case (quad8)
               call add_cell([0, 0, 2, 0, 2, 2, 0, 2, 1, 0, 2, 1, 1, 2, 0, 1])
            case (tri3)
               call add_cell([0, 0, 2, 0, 2, 2])
               call add_cell([0, 0, 2, 2, 0, 2])
            case default
               call add_cell([0, 0, 2, 0, 2, 2, 1, 0, 2, 1, 1, 1])
               call add_cell([0, 0, 2, 2, 0, 2, 1, 1, 1, 2, 0, 1])
            end select
         end do
      end do

   contains

      !> One element with its nodes at the given half cells from the cell's corner.
      subroutine add_cell(place)
         integer, intent(in) :: place(:)
         integer :: nodes(size(place)/2), k, p(2)
         real(wp) :: x(2)

         do k = 1, size(nodes)
            p = c + place(2*k - 1:2*k)
            if (number(p(1), p(2)) == 0) then
               x = strip%corner + strip%size*p/(2.0_wp*strip%cells)
               call add_node(model, [x, 0.0_wp])
               number(p(1), p(2)) = model%nodes%n
            end if
            nodes(k) = number(p(1), p(2))
         end do
         call add_element(model, 100*strip%plane + 10*strip%topology, nodes)
      end subroutine add_cell

   end subroutine add_strip

   !> Turns x, y into radius and angle: radius 1 + y/4, a half circle for an x of 6.
   subroutine bend(model)
      type(model_type), intent(inout) :: model
      real(wp) :: radius, angle
      integer :: i

      do i = 1, model%nodes%n
         radius = 1.0_wp + model%nodes%x(2, i)/4.0_wp
         angle = -acos(-1.0_wp)*model%nodes%x(1, i)/6.0_wp
         model%nodes%x(1:2, i) = radius*[cos(angle), sin(angle)]
      end do
   end subroutine bend

   !> The nodes that lie on a line x(direction) = place.
   pure function nodes_at(model, direction, place) result(nodes)
      type(model_type), intent(in) :: model
      integer, intent(in) :: direction
      real(wp), intent(in) :: place
      integer, allocatable :: nodes(:)
      integer :: i

      nodes = pack([(i, i=1, model%nodes%n)], abs(model%nodes%x(direction, :) - place) < 1.0e-9_wp)
   end function nodes_at

   !> The next surface of some nodes.
   subroutine add_surface(model, nodes)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: nodes(:)
      type(surface_type), allocatable :: longer(:)
      integer :: n

      n = size(model%surfaces)
      allocate (longer(n + 1))
      longer(:n) = model%surfaces
      longer(n + 1)%nodes = nodes
      allocate (longer(n + 1)%edges(3, 0), longer(n + 1)%edge_element(0))
      call move_alloc(longer, model%surfaces)
   end subroutine add_surface

   !> A pair with redistributed mass; without a target its master is a rigid plane.
   subroutine add_pair(model, contactor, target)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: contactor
      integer, intent(in) :: target              !! 0: rigid
      type(contact_pair_type) :: pair

      if (size(model%rigid_surfaces) == 0) then
         deallocate (model%rigid_surfaces)
         allocate (model%rigid_surfaces(1))
         model%rigid_surfaces(1)%normal = [1.0_wp, 0.0_wp, 0.0_wp]
      end if
      pair%contactor = contactor
      pair%target = target
      if (target == 0) pair%rigid_target = 1
      pair%redistributed = .true.
      model%pairs = [model%pairs, pair]
   end subroutine add_pair

   subroutine add_section(model)
      type(model_type), intent(inout) :: model
      type(material_type), allocatable :: materials(:)
      type(section_type), allocatable :: sections(:)
      integer :: n

      n = size(model%materials)
      allocate (materials(n + 1))
      materials(:n) = model%materials
      materials(n + 1)%young = 900.0_wp
      materials(n + 1)%poisson = 0.3_wp
      materials(n + 1)%density = 3.0_wp
      call move_alloc(materials, model%materials)
      allocate (sections(size(model%sections) + 1))
      sections(:size(model%sections)) = model%sections
      associate (section => sections(size(sections)))
         section%kind = section_solid
         section%material = n + 1
         section%area = 2.0_wp
      end associate
      call move_alloc(sections, model%sections)
   end subroutine add_section

   !> An element of the last section; its id is a hundred times its index.
   subroutine add_element(model, kind, nodes)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: kind, nodes(:)
      integer :: n

      n = model%elements%n + 1
      model%elements%n = n
      model%elements%id = [model%elements%id, 100*n]
      model%elements%kind = [model%elements%kind, kind]
      model%elements%nodes = [model%elements%nodes, nodes]
      model%elements%first = [model%elements%first, size(model%elements%nodes) + 1]
      model%elements%section = [model%elements%section, size(model%sections)]
      deallocate (model%elements%place)
      allocate (model%elements%place(n))
   end subroutine add_element

end module strip_models
