!> Bodies of solids and trusses: what is connected by their nodes; how large they are, and how long
!> a wave takes through them.
module continuum_bodies
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use disjoint_sets, only: join, top_of
   use model, only: model_type
   use wave_speeds, only: is_continuum, longitudinal_speed, element_length, material_of
   implicit none
   private

   public :: body_list_type, find_bodies, forget_bodies

   !> The bodies of a model, by the first of their nodes.
   type :: body_list_type
      integer :: n = 0
      integer, allocatable :: of_node(:)         !! (n_nodes) body of a node, 0: none
      integer, allocatable :: of_element(:)      !! (n_elements)
      real(wp), allocatable :: low(:, :), high(:, :)   !! (3, n) corners of their boxes
      real(wp), allocatable :: speed(:)          !! (n) of the fastest wave, 0: no density
      real(wp), allocatable :: impedance(:)      !! (n) density times speed, of the same material
      real(wp), allocatable :: shortest_time(:)  !! (n) of a wave through an element, the least
      integer, allocatable :: shortest(:)        !! (n) that element's index
   contains
      procedure :: extent
      procedure :: transit_time
   end type body_list_type

contains

   !> Finds the bodies.
   subroutine find_bodies(self, model)
      type(body_list_type), intent(out) :: self
      type(model_type), intent(in) :: model
      integer :: root(model%nodes%n), e, i, status

      root = [(i, i=1, size(root))]
      allocate (self%of_node(model%nodes%n), self%of_element(model%elements%n), stat=status)
      call check_allocation(status)
      self%of_node = 0
      self%of_element = 0
      do e = 1, model%elements%n
         if (.not. is_continuum(model%elements%kind(e))) cycle
         do i = model%elements%first(e) + 1, model%elements%first(e + 1) - 1
            call join(root, model%elements%nodes(i - 1), model%elements%nodes(i))
         end do
      end do
      do e = 1, model%elements%n
         if (.not. is_continuum(model%elements%kind(e))) cycle
         associate (nodes => model%elements%nodes(model%elements%first(e): &
               model%elements%first(e + 1) - 1))
            i = top_of(root, nodes(1))
            if (self%of_node(i) == 0) then
               self%n = self%n + 1
               self%of_node(i) = self%n
            end if
            self%of_element(e) = self%of_node(i)
            self%of_node(nodes) = self%of_node(i)
         end associate
      end do
      call measure(self, model)
   end subroutine find_bodies

   !> Gives the memory back.
   pure subroutine forget_bodies(self)
      type(body_list_type), intent(out) :: self

      self%n = 0
   end subroutine forget_bodies

   !> Boxes, speeds and smallest elements.
   subroutine measure(self, model)
      type(body_list_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp) :: c, time
      integer :: e, i, b, status

      allocate (self%low(3, self%n), self%high(3, self%n), self%speed(self%n), &
            self%impedance(self%n), self%shortest_time(self%n), self%shortest(self%n), stat=status)
      call check_allocation(status)
      self%low = huge(1.0_wp)
      self%high = -huge(1.0_wp)
      self%speed = 0.0_wp
      self%impedance = 0.0_wp
      self%shortest_time = huge(1.0_wp)
      self%shortest = 0
      do i = 1, model%nodes%n
         b = self%of_node(i)
         if (b == 0) cycle
         self%low(:, b) = min(self%low(:, b), model%nodes%x(:, i))
         self%high(:, b) = max(self%high(:, b), model%nodes%x(:, i))
      end do
      do e = 1, model%elements%n
         b = self%of_element(e)
         if (b == 0 .or. material_of(model, e) == 0) cycle
         c = longitudinal_speed(model%materials(material_of(model, e)), model%elements%kind(e))
         if (.not. c > 0.0_wp) cycle
         if (c > self%speed(b)) then
            self%speed(b) = c
            self%impedance(b) = c*model%materials(material_of(model, e))%density
         end if
         time = element_length(model, e)/c
         if (time >= self%shortest_time(b)) cycle
         self%shortest_time(b) = time
         self%shortest(b) = e
      end do
   end subroutine measure

   !> Length of a body's box along a direction.
   pure real(wp) function extent(self, b, direction)
      class(body_list_type), intent(in) :: self
      integer, intent(in) :: b
      real(wp), intent(in) :: direction(3)       !! of unit length

      extent = dot_product(abs(direction), self%high(:, b) - self%low(:, b))
   end function extent

   !> Time of a wave through a body along a direction; 0 where that is not known.
   pure real(wp) function transit_time(self, b, direction)
      class(body_list_type), intent(in) :: self
      integer, intent(in) :: b
      real(wp), intent(in) :: direction(3)

      transit_time = 0.0_wp
      if (self%speed(b) > 0.0_wp) transit_time = self%extent(b, direction)/self%speed(b)
   end function transit_time

end module continuum_bodies
