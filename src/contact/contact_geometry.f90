!> Where contact rows stand in the current configuration: which node faces which edge, at which
!> gap, with which normal. Rows against planes, of gap elements and of pairs with SMALL SLIDING stay
!> as they are in the undeformed configuration.
module contact_geometry
   use kinds, only: wp, int64
   use text, only: to_text
   use state_archive, only: archive_type
   use memory_shortage, only: check_allocation
   use model, only: model_type
   use surfaces, only: rigid_surface_type
   use histories, only: amplitude_type
   use amplitude_value, only: amplitude_at
   use contact_pairs, only: contact_row_type, contact_pair_list_type, row_fixed, row_circle, &
         row_surface
   use contactor_normals, only: find_normals
   use row_terms, only: row_terms_type, start_terms, start_row_terms, add_term
   use target_surface, only: target_type, new_target, update_target
   use contact_partner, only: partner_type
   use contact_search, only: find_partner
   use weighted_rows, only: weighted_rows_type, find_weighted_rows
   implicit none
   private

   public :: contact_geometry_type, new_contact_geometry, allow_gaps, find_row_terms

   !> No reach is longer than this multiple of the extent of the nodes.
   real(wp), parameter :: widest_reach = 10.0_wp
   !> A node closer to a circle than this share of its radius is on it.
   real(wp), parameter :: touch_share = 1.0e-9_wp

   !> Rows first to last of the list, which are the nodes of one surface, against a target.
   type :: pass_type
      integer :: first = 0, last = -1
      integer :: target = 0                      !! index into the targets, 0: rigid or gaps
      type(rigid_surface_type) :: circle         !! a rigid circle
      logical :: frozen = .true.
      logical :: weighted = .false.              !! rows weighted over the contactor's edges
      integer, allocatable :: edges(:, :)        !! (3, n) of the contactor surface
      type(target_type) :: contactor             !! the same, of weighted rows
   end type pass_type

   !> All surfaces, with what the search needs.
   type :: contact_geometry_type
      logical :: moving = .false.                !! some rows are not frozen
      integer(int64) :: n_searches = 0           !! how often they have been placed
      real(wp) :: size = 0.0_wp                  !! largest extent of the nodes
      type(contact_row_type), allocatable :: rows(:)
      type(pass_type), allocatable :: passes(:)
      type(target_type), allocatable :: targets(:)
      type(amplitude_type), allocatable :: amplitudes(:)
      real(wp), allocatable :: x(:, :)           !! (3, n_nodes) undeformed
      type(row_terms_type) :: frozen             !! the rows that stay as they are
      real(wp), allocatable :: allowance(:)      !! (n_rows) gap that counts as none, if allocated
   contains
      procedure :: pass_state
   end type contact_geometry_type

   !> Positions of all nodes before and after a motion, and how far a node looks for a partner.
   type :: positions_type
      real(wp) :: t(2) = 0.0_wp                  !! before and after it
      real(wp) :: reach = 0.0_wp
      real(wp), allocatable :: before(:, :), now(:, :)   !! (3, n_nodes)
   end type positions_type

contains

   !> Targets and passes of the model's pairs, and the rows that stay.
   subroutine new_contact_geometry(self, model, list)
      type(contact_geometry_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(in) :: list
      type(positions_type) :: positions
      integer :: i, n_passes, n_targets, status

      self%rows = list%rows
      self%amplitudes = model%amplitudes
      self%x = model%nodes%x(:, :model%nodes%n)
      self%size = maxval(maxval(self%x, dim=2) - minval(self%x, dim=2))
      n_passes = 0
      n_targets = 0
      do i = 1, size(list%rows)
         if (.not. begins_pass(list%rows, i)) cycle
         n_passes = n_passes + 1
         if (list%rows(i)%kind == row_surface) n_targets = n_targets + 1
      end do
      allocate (self%passes(n_passes), self%targets(n_targets), stat=status)
      call check_allocation(status)
      n_passes = 0
      n_targets = 0
      do i = 1, size(list%rows)
         if (begins_pass(list%rows, i)) then
            n_passes = n_passes + 1
            call begin_pass(self, model, i, self%passes(n_passes), n_targets)
         end if
         self%passes(n_passes)%last = i
      end do
      self%moving = any(.not. self%passes%frozen)
      call start_terms(self%frozen, size(self%rows))
      positions%reach = widest_reach*self%size
      positions%before = self%x
      positions%now = self%x
      do i = 1, n_passes
         call place_pass(self, self%passes(i), positions, self%frozen)
      end do
   end subroutine new_contact_geometry

   !> What searches leave behind, where rows move.
   subroutine pass_state(self, archive)
      class(contact_geometry_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive
      integer :: i

      if (.not. self%moving) return
      do i = 1, size(self%targets)
         call archive%enter('target_'//to_text(i))
         call self%targets(i)%pass_state(archive)
         call archive%leave()
      end do
      call archive%pass('n_searches', self%n_searches)
   end subroutine pass_state

   !> From now on the gaps of all rows are counted from these.
   subroutine allow_gaps(self, allowance)
      type(contact_geometry_type), intent(inout) :: self
      real(wp), intent(in) :: allowance(:)       !! (n_rows)

      if (allocated(self%allowance)) self%frozen%gap = self%frozen%gap + self%allowance
      self%allowance = allowance
      self%frozen%gap = self%frozen%gap - allowance
   end subroutine allow_gaps

   !> Whether row i is the first of its pass.
   pure function begins_pass(rows, i) result(begins)
      type(contact_row_type), intent(in) :: rows(:)
      integer, intent(in) :: i
      logical :: begins

      begins = i == 1
      if (begins) return
      begins = rows(i)%model_pair /= rows(i - 1)%model_pair .or. rows(i)%pass /= rows(i - 1)%pass
   end function begins_pass

   subroutine begin_pass(self, model, i, pass, n_targets)
      type(contact_geometry_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                   !! its first row
      type(pass_type), intent(inout) :: pass
      integer, intent(inout) :: n_targets        !! so far
      integer :: contactor, master

      pass%first = i
      if (self%rows(i)%model_pair == 0) return
      associate (pair => model%pairs(self%rows(i)%model_pair))
         contactor = pair%contactor
         master = pair%target
         if (self%rows(i)%pass == 2) contactor = pair%target
         if (self%rows(i)%pass == 2) master = pair%contactor
         pass%frozen = pair%small_sliding .or. self%rows(i)%kind == row_fixed
         pass%edges = model%surfaces(contactor)%edges
         if (self%rows(i)%kind == row_circle) pass%circle = model%rigid_surfaces(pair%rigid_target)
         if (self%rows(i)%kind /= row_surface) return
         n_targets = n_targets + 1
         pass%target = n_targets
         call new_target(self%targets(n_targets), model%surfaces(master)%edges, model%nodes%n, &
               model%surfaces(master)%edge_element)
         pass%weighted = pair%weighted
         if (pass%weighted) call new_target(pass%contactor, pass%edges, model%nodes%n)
      end associate
   end subroutine begin_pass

   !> All rows at the displacements `now`, reached from those `before`.
   subroutine find_row_terms(self, t, before, now, reach, terms)
      type(contact_geometry_type), intent(inout) :: self
      real(wp), intent(in) :: t(2)               !! total time before and after
      real(wp), intent(in) :: before(:, :), now(:, :)   !! (3, n_nodes) displacements
      real(wp), intent(in) :: reach              !! nodes farther from all edges have no partner
      type(row_terms_type), intent(inout) :: terms
      type(positions_type) :: positions
      integer :: i, k

      self%n_searches = self%n_searches + 1
      positions%t = t
      positions%reach = reach
      ! a row whose gap counts as none may be as far away as that
      if (allocated(self%allowance)) positions%reach = reach + maxval(abs(self%allowance))
      positions%reach = min(positions%reach, widest_reach*self%size)
      positions%before = self%x + before
      positions%now = self%x + now
      call start_terms(terms, size(self%rows))
      do i = 1, size(self%passes)
         if (self%passes(i)%frozen) then
            do k = self%passes(i)%first, self%passes(i)%last
               call copy_row(self%frozen, k, terms)
            end do
         else
            call place_pass(self, self%passes(i), positions, terms)
         end if
      end do
   end subroutine find_row_terms

   !> The rows of a pass where they are now.
   subroutine place_pass(self, pass, positions, terms)
      type(contact_geometry_type), intent(inout) :: self
      type(pass_type), intent(in) :: pass
      type(positions_type), intent(in) :: positions
      type(row_terms_type), intent(inout) :: terms
      real(wp), allocatable :: normals(:, :)
      type(weighted_rows_type) :: weighted
      integer :: nodes(pass%last - pass%first + 1), i, next

      if (pass%target > 0) call update_target(self%targets(pass%target), positions%before, &
            positions%now, positions%reach)
      if (pass%weighted) then
         call find_weighted_rows(pass%contactor, self%targets(pass%target), positions%now, &
               positions%reach, weighted)
      else if (pass%target > 0) then
         nodes = self%rows(pass%first:pass%last)%node
         call find_normals(pass%edges, nodes, positions%now, normals)
      end if
      next = 1
      do i = pass%first, pass%last
         call start_row_terms(terms, i)
         terms%at_rest(i) = pass%frozen
         if (pass%weighted) then
            call place_weighted(weighted, next, self%rows(i)%node, i, terms)
         else if (self%rows(i)%kind == row_fixed) then
            call place_fixed(self%rows(i), i, terms)
         else if (self%rows(i)%kind == row_circle) then
            call place_on_circle(self, pass, i, positions, terms)
         else
            call place_on_edge(self, pass, i, positions, normals(:, i - pass%first + 1), terms)
         end if
         if (allocated(self%allowance)) terms%gap(i) = terms%gap(i) - self%allowance(i)
      end do
   end subroutine place_pass

   !> A node against a plane or the other node of a gap element.
   pure subroutine place_fixed(row, i, terms)
      type(contact_row_type), intent(in) :: row
      integer, intent(in) :: i
      type(row_terms_type), intent(inout) :: terms
      real(wp) :: along(3)
      real(wp), parameter :: none(3) = 0.0_wp

      along = [-row%normal(2), row%normal(1), 0.0_wp]
      terms%facing(i) = .true.
      terms%gap(i) = row%offset
      terms%direction(:, i) = row%normal
      terms%along(:, i) = along
      if (row%other > 0) call add_term(terms, i, row%other, -row%normal, -along, none)
      call add_term(terms, i, row%node, row%normal, along, none)
   end subroutine place_fixed

   !> A node outside a circle, or inside one of negative radius.
   subroutine place_on_circle(self, pass, i, positions, terms)
      type(contact_geometry_type), intent(in) :: self
      type(pass_type), intent(in) :: pass
      integer, intent(in) :: i
      type(positions_type), intent(in) :: positions
      type(row_terms_type), intent(inout) :: terms
      real(wp) :: start(2), arm(2), distance, normal(3), along(3)
      real(wp), parameter :: none(3) = 0.0_wp

      arm = positions%now(:2, self%rows(i)%node) - centre_of(self, pass, positions%t(2))
      start = positions%before(:2, self%rows(i)%node) - centre_of(self, pass, positions%t(1))
      distance = norm2(arm)
      normal = 0.0_wp
      normal(:2) = entry_to_circle(start, arm, pass%circle%radius)
      if (norm2(normal) > 0.0_wp) then
         distance = dot_product(normal(:2), arm)
      else
         if (.not. distance > 0.0_wp) arm = [0.0_wp, 1.0_wp]
         normal(:2) = sign(1.0_wp, pass%circle%radius)*arm/norm2(arm)
      end if
      along = [-normal(2), normal(1), 0.0_wp]
      terms%facing(i) = .true.
      terms%gap(i) = sign(1.0_wp, pass%circle%radius)*(distance - abs(pass%circle%radius))
      terms%bend(i) = -1.0_wp/pass%circle%radius
      terms%direction(:, i) = normal
      terms%along(:, i) = along
      call add_term(terms, i, self%rows(i)%node, normal, along, none)
   end subroutine place_on_circle

   pure function centre_of(self, pass, t) result(centre)
      type(contact_geometry_type), intent(in) :: self
      type(pass_type), intent(in) :: pass
      real(wp), intent(in) :: t
      real(wp) :: centre(2)

      centre = pass%circle%point(:2)
      if (pass%circle%amplitude == 0 .or. pass%frozen) return
      centre = centre + pass%circle%motion(:2) &
            *amplitude_at(self%amplitudes(pass%circle%amplitude), t)
   end function centre_of

   !> The normal where a straight path enters a circle, if it leaves it again: a node must not fly
   !> through in one step. Zero if it does not. Places are relative to the centre.
   pure function entry_to_circle(start, finish, radius) result(normal)
      real(wp), intent(in) :: start(2), finish(2)
      real(wp), intent(in) :: radius
      real(wp) :: normal(2)
      real(wp) :: path(2), a, b, c

      normal = 0.0_wp
      if (radius < 0.0_wp .or. norm2(finish) < radius) return
      if (norm2(start) < radius*(1.0_wp + touch_share)) return
      path = finish - start
      a = dot_product(path, path)
      b = dot_product(path, start)
      c = dot_product(start, start) - radius**2
      if (b >= 0.0_wp .or. b + a <= 0.0_wp .or. b**2 <= a*c) return
      ! the smaller root of a s^2 + 2 b s + c without cancellation
      normal = start + path*c/(sqrt(b**2 - a*c) - b)
      normal = normal/norm2(normal)
   end function entry_to_circle

   !> A node against the edge it faces, if any.
   subroutine place_on_edge(self, pass, i, positions, outward, terms)
      type(contact_geometry_type), intent(inout) :: self
      type(pass_type), intent(in) :: pass
      integer, intent(in) :: i
      type(positions_type), intent(in) :: positions
      real(wp), intent(in) :: outward(2)         !! normal of the contactor, or zero
      type(row_terms_type), intent(inout) :: terms
      type(partner_type) :: partner
      real(wp) :: normal(3), along(3)
      real(wp), parameter :: none(3) = 0.0_wp
      integer :: k

      call find_partner(self%targets(pass%target), positions%before, positions%now, &
            self%rows(i)%node, positions%reach, outward, partner)
      if (partner%edge == 0) return
      normal = [partner%normal, 0.0_wp]
      along = [partner%tangent, 0.0_wp]
      terms%facing(i) = .true.
      terms%gap(i) = partner%gap
      terms%bend(i) = partner%bend
      terms%direction(:, i) = normal
      terms%along(:, i) = along
      call add_term(terms, i, self%rows(i)%node, normal, along, none)
      do k = 1, partner%n_nodes
         call add_term(terms, i, partner%nodes(k), -partner%shape(k)*normal, &
               -partner%shape(k)*along, partner%slope(k)*normal)
      end do
   end subroutine place_on_edge

   !> The weighted row of a node, if it has one; both lists ascend.
   subroutine place_weighted(weighted, next, node, i, terms)
      type(weighted_rows_type), intent(in) :: weighted
      integer, intent(inout) :: next             !! row that comes next
      integer, intent(in) :: node, i
      type(row_terms_type), intent(inout) :: terms
      real(wp), parameter :: none(3) = 0.0_wp
      integer :: k

      if (next > weighted%n) return
      if (weighted%slave_node(next) /= node) return
      terms%facing(i) = .true.
      terms%gap(i) = weighted%gap(next)
      terms%weight(i) = weighted%weight(next)
      terms%direction(:2, i) = weighted%normal(:, next)
      terms%along(:2, i) = [-weighted%normal(2, next), weighted%normal(1, next)]
      do k = weighted%first(next), weighted%first(next + 1) - 1
         call add_term(terms, i, weighted%node(k), [weighted%normal_coefficient(:, k), 0.0_wp], &
               [weighted%tangent_coefficient(:, k), 0.0_wp], none)
      end do
      next = next + 1
   end subroutine place_weighted

   !> Appends row i of one set of terms to another.
   pure subroutine copy_row(from, i, to)
      type(row_terms_type), intent(in) :: from
      integer, intent(in) :: i
      type(row_terms_type), intent(inout) :: to
      integer :: k

      call start_row_terms(to, i)
      do k = from%first(i), from%first(i + 1) - 1
         call add_term(to, i, from%node(k), from%normal(:, k), from%tangent(:, k), &
               from%turning(:, k))
      end do
      to%gap(i) = from%gap(i)
      to%facing(i) = from%facing(i)
      to%at_rest(i) = from%at_rest(i)
      to%bend(i) = from%bend(i)
      to%weight(i) = from%weight(i)
      to%direction(:, i) = from%direction(:, i)
      to%along(:, i) = from%along(:, i)
   end subroutine copy_row

end module contact_geometry
