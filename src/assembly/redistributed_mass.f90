!> MASS=REDISTRIBUTED of contact pairs (Khenous, Laborde & Renard 2008): contact nodes without mass,
!> in static balance with their neighbours, so that no velocity of theirs has to jump.
!>
!> The nodes of the slave surface and of a deformable master lose their mass in every direction: the
!> contact normal turns with the motion, and a node that is massless along one fixed direction would
!> not stay so along the normal. Element by element the mass goes to the other nodes of the element,
!> in proportion to their lumped mass over the square of their distance from the contact nodes; then
!> each body gets back its centre and moments of inertia (`body_moments`). An element's matrix M
!> becomes (1 + p) (D M D + diag(moved)), D zero at contact nodes. Weight and the inertia of a base
!> motion follow the mass, so that what falls freely is not strained; other body forces and
!> Rayleigh's alpha M stay where the elements have them.
module redistributed_mass
   use kinds, only: wp
   use disjoint_sets, only: join, top_of
   use errors, only: error_type
   use text, only: to_text
   use memory_shortage, only: check_allocation
   use places, only: fail_at
   use model, only: model_type
   use mesh, only: element_mass, element_truss, is_solid_kind, solid_plane, axisymmetric
   use element_groups, only: group_type
   use body_moments, only: body_type, restore_moments
   implicit none
   private

   public :: redistribute_mass, mark_contact_nodes

   !> A node is never closer to a contact node than this part of the element's size.
   real(wp), parameter :: least_distance = 1.0e-3_wp
contains

   !> Gives the groups their massless nodes and added masses; nothing without a pair that asks.
   !> Errors: a MASS at a contact node, an element of contact nodes alone, a body that cannot keep
   !> its moments with positive masses.
   subroutine redistribute_mass(groups, model, error)
      type(group_type), intent(inout) :: groups(:)
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      type(body_type), allocatable :: bodies(:)
      logical :: contact(model%nodes%n)
      integer :: b, g

      if (.not. any(model%pairs%redistributed)) return
      call mark_contact_nodes(model, contact)
      do g = 1, size(groups)
         if (groups(g)%kind == element_mass) call refuse_masses(groups(g), model, contact, error)
         if (allocated(error)) return
         if (has_mass(groups(g))) call move_inward(groups(g), model, contact, error)
         if (allocated(error)) return
      end do
      call find_bodies(groups, contact, bodies)
      do b = 1, size(bodies)
         call restore_body(groups, model, bodies(b), error)
         if (allocated(error)) return
      end do
   end subroutine redistribute_mass

   !> Whether a group's elements have mass between their nodes.
   pure function has_mass(group) result(has)
      type(group_type), intent(in) :: group
      logical :: has

      has = group%kind == element_truss .or. is_solid_kind(group%kind)
   end function has_mass

   !> Nodes without mass: both faces of every pair that asks.
   pure subroutine mark_contact_nodes(model, contact)
      type(model_type), intent(in) :: model
      logical, intent(out) :: contact(:)         !! (n_nodes)
      integer :: p

      contact = .false.
      do p = 1, size(model%pairs)
         associate (pair => model%pairs(p))
            if (.not. pair%redistributed) cycle
            contact(model%surfaces(pair%contactor)%nodes) = .true.
            if (pair%target > 0) contact(model%surfaces(pair%target)%nodes) = .true.
         end associate
      end do
   end subroutine mark_contact_nodes

   subroutine refuse_masses(group, model, contact, error)
      type(group_type), intent(in) :: group
      type(model_type), intent(in) :: model
      logical, intent(in) :: contact(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(group%member)
         if (.not. contact(group%ien(1, i))) cycle
         associate (e => group%member(i))
            call fail_at(error, model%source, model%elements%place(e), 'MASS element ' &
                  //to_text(model%elements%id(e))//' is on node ' &
                  //to_text(model%nodes%id(group%ien(1, i))) &
                  //', a contact node without mass by MASS=REDISTRIBUTED', &
                  'put it on a node inside the body, or leave out MASS=REDISTRIBUTED')
         end associate
         return
      end do
   end subroutine refuse_masses

   !> Takes the mass off the contact nodes of a group and gives it to the other nodes.
   subroutine move_inward(group, model, contact, error)
      type(group_type), intent(inout) :: group
      type(model_type), intent(in) :: model
      logical, intent(in) :: contact(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: e, status

      allocate (group%mass_share(size(group%ien, 1), size(group%member)), stat=status)
      call check_allocation(status)
      allocate (group%moved_mass, mold=group%mass_share, stat=status)
      call check_allocation(status)
      allocate (group%mass_factor(size(group%member)), stat=status)
      call check_allocation(status)
      group%mass_share = 1.0_wp
      group%moved_mass = 0.0_wp
      group%mass_factor = 1.0_wp
      do e = 1, size(group%member)
         if (.not. any(contact(group%ien(:, e)))) cycle
         call move_in_element(group, e, model%nodes%x(:, group%ien(:, e)), &
               .not. contact(group%ien(:, e)))
         if (any(group%mass_share(:, e) > 0.0_wp) .or. .not. group%mass_factor(e) > 0.0_wp) cycle
         call refuse_element(model, group%member(e), error)
         return
      end do
   end subroutine move_inward

   !> The removed mass goes to the nodes that are kept. If the rest of a consistent matrix has more
   !> than all of the mass (a corner that shape functions below zero surround), it is made smaller.
   pure subroutine move_in_element(group, e, x, kept)
      type(group_type), intent(inout) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: x(:, :)            !! (3, n_nodes)
      logical, intent(in) :: kept(:)
      real(wp), dimension(3*size(kept), 3*size(kept)) :: lumped, own
      real(wp) :: total, left, weight(size(kept))
      integer :: i

      group%mass_share(:, e) = merge(1.0_wp, 0.0_wp, kept)
      call group%element%mass(e, .true., lumped)
      call group%element%mass(e, group%lumped, own)
      weight = merge([(lumped(3*i - 2, 3*i - 2), i=1, size(kept))], 0.0_wp, kept)
      total = sum(own(1::3, 1::3))
      group%mass_factor(e) = total
      if (.not. any(weight > 0.0_wp)) return
      left = dot_product(group%mass_share(:, e), matmul(own(1::3, 1::3), group%mass_share(:, e)))
      group%mass_factor(e) = total/max(total, left)
      group%moved_mass(:, e) = max(total - left, 0.0_wp)*shares(x, kept, weight)
   end subroutine move_in_element

   !> Shares, sum one, in proportion to weight over squared distance from the nearest node not kept.
   pure function shares(x, kept, weight) result(share)
      real(wp), intent(in) :: x(:, :)            !! (3, n_nodes)
      logical, intent(in) :: kept(:)
      real(wp), intent(in) :: weight(:)
      real(wp) :: share(size(kept))
      real(wp) :: nearest, extent
      integer :: i, j

      share = 0.0_wp
      if (all(kept) .or. .not. any(weight > 0.0_wp)) return
      extent = maxval(maxval(x, 2) - minval(x, 2))
      do i = 1, size(kept)
         if (.not. kept(i)) cycle
         nearest = minval([(norm2(x(:, i) - x(:, j)), j=1, size(kept))], mask=.not. kept)
         share(i) = weight(i)/max(nearest, least_distance*extent)**2
      end do
      share = share/sum(share)
   end function shares

   subroutine refuse_element(model, e, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      type(error_type), allocatable, intent(out) :: error

      call fail_at(error, model%source, model%elements%place(e), 'element ' &
            //to_text(model%elements%id(e))//' has contact nodes only: MASS=REDISTRIBUTED leaves ' &
            //'its mass nowhere to go', &
            'refine the mesh so that every element has a node off the contact surfaces, or leave ' &
            //'out MASS=REDISTRIBUTED')
   end subroutine refuse_element

   !> Bodies that have contact nodes: elements with mass joined by common nodes.
   subroutine find_bodies(groups, contact, bodies)
      type(group_type), intent(in) :: groups(:)
      logical, intent(in) :: contact(:)          !! (n_nodes)
      type(body_type), allocatable, intent(out) :: bodies(:)
      integer :: parent(size(contact)), body_of(size(contact)), i, n, g, e, status

      parent = [(i, i=1, size(contact))]
      do g = 1, size(groups)
         if (.not. has_mass(groups(g))) cycle
         do e = 1, size(groups(g)%member)
            do i = 2, size(groups(g)%ien, 1)
               call join(parent, groups(g)%ien(i - 1, e), groups(g)%ien(i, e))
            end do
         end do
      end do
      n = 0
      body_of = 0
      do i = 1, size(contact)
         parent(i) = top_of(parent, i)
         if (.not. contact(i) .or. body_of(parent(i)) > 0) cycle
         n = n + 1
         body_of(parent(i)) = n
      end do
      body_of = body_of(parent)
      allocate (bodies(n), stat=status)
      call check_allocation(status)
      call list_elements(groups, body_of, bodies)
   end subroutine find_bodies

   !> The elements of every body.
   subroutine list_elements(groups, body_of, bodies)
      type(group_type), intent(in) :: groups(:)
      integer, intent(in) :: body_of(:)          !! (n_nodes)
      type(body_type), intent(inout) :: bodies(:)
      integer :: n(size(bodies)), pass, b, g, e, status

      do pass = 1, 2
         n = 0
         do g = 1, size(groups)
            if (.not. has_mass(groups(g))) cycle
            do e = 1, size(groups(g)%member)
               b = body_of(groups(g)%ien(1, e))
               if (b == 0) cycle
               n(b) = n(b) + 1
               if (pass == 1) cycle
               bodies(b)%group(n(b)) = g
               bodies(b)%element(n(b)) = e
               bodies(b)%axial = bodies(b)%axial .or. is_axial(groups(g)%kind)
            end do
         end do
         if (pass == 2) return
         do b = 1, size(bodies)
            allocate (bodies(b)%group(n(b)), bodies(b)%element(n(b)), stat=status)
            call check_allocation(status)
         end do
      end do
   end subroutine list_elements

   pure function is_axial(kind) result(axial)
      integer, intent(in) :: kind
      logical :: axial

      axial = .false.
      if (is_solid_kind(kind)) axial = solid_plane(kind) == axisymmetric
   end function is_axial

   subroutine restore_body(groups, model, body, error)
      type(group_type), intent(inout) :: groups(:)
      type(model_type), intent(in) :: model
      type(body_type), intent(in) :: body
      type(error_type), allocatable, intent(out) :: error
      logical :: restored

      if (size(body%group) == 0) return
      call restore_moments(groups, model%nodes%x, body, restored)
      if (restored) return
      associate (e => groups(body%group(1))%member(body%element(1)))
         call fail_at(error, model%source, model%elements%place(e), 'the body of element ' &
               //to_text(model%elements%id(e))//' is too coarse for MASS=REDISTRIBUTED: mass, ' &
               //'centre and moment of inertia cannot be kept without its contact nodes', &
               'take three elements or more between its faces, or leave out MASS=REDISTRIBUTED')
      end associate
   end subroutine restore_body

end module redistributed_mass
