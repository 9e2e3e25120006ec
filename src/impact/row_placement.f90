!> Puts contact rows on the freedoms of a structure: once where they stay as they are, in every step
!> where bodies slide on each other. A row placed at some displacements is linear about them.
module row_placement
   use kinds, only: wp
   use errors, only: error_type
   use places, only: fail_at
   use text, only: to_text
   use memory_shortage, only: check_allocation
   use model, only: model_type
   use surfaces, only: interaction_type, method_fictitious_force, method_penalty, method_lagrange
   use structure, only: structure_type
   use dof_map, only: dof_map_type
   use amplitude_value, only: amplitude_at
   use contact_pairs, only: contact_pair_list_type
   use row_terms, only: row_terms_type
   use contact_geometry, only: contact_geometry_type, find_row_terms
   use motion_state, only: state_type
   use row_matrix, only: row_matrix_type, new_row_matrix, start_row, add_entry, multiply
   use constraint_rows, only: rows_type, far_gap, law_motion, law_closed, law_penalty, law_overlap
   implicit none
   private

   public :: new_rows, place_rows, nodal_displacements, row_law

contains

   !> Makes the rows of a scene at their places in the undeformed geometry. A row whose contactor
   !> has no freedom along its normal is an error at its deck line.
   subroutine new_rows(self, geometry, list, model, structure, error)
      type(rows_type), intent(out) :: self
      type(contact_geometry_type), intent(in) :: geometry
      type(contact_pair_list_type), intent(in) :: list
      type(model_type), intent(in) :: model
      type(structure_type), intent(in) :: structure
      type(error_type), allocatable, intent(out) :: error
      integer :: i, status

      self%n = size(list%rows)
      self%moving = geometry%moving
      self%amplitudes = model%amplitudes
      self%amplitude = list%rows%amplitude
      self%motion = [(0.0_wp, i=1, self%n)]
      self%pair = list%rows%pair
      self%node_id = model%nodes%id(list%rows%node)
      self%sliding_motion = self%motion
      allocate (self%wall(3, self%n), stat=status)
      call check_allocation(status)
      self%wall = 0.0_wp
      allocate (self%offset(self%n), self%bend(self%n), self%facing(self%n), self%weight(self%n), &
            stat=status)
      call check_allocation(status)
      allocate (self%normal(3, self%n), self%tangent(3, self%n), stat=status)
      call check_allocation(status)
      call copy_behaviour(self, list, model)
      call write_rows(self, geometry%frozen, structure%map)
      self%offset = merge(geometry%frozen%gap, far_gap, self%facing)
      do i = 1, self%n
         if (self%amplitude(i) > 0) self%wall(:, i) = model%rigid_surfaces( &
               model%pairs(list%rows(i)%model_pair)%rigid_target)%motion
         call set_wall_motion(self, i)
         if (.not. self%facing(i)) cycle
         if (self%along_normal%first(i + 1) > self%along_normal%first(i)) cycle
         call fail_at(error, model%source, list%rows(i)%place, 'node ' &
               //to_text(model%nodes%id(list%rows(i)%node)) &
               //' cannot move along the contact normal: it has no freedom there', &
               'give the node a mass or an element, or leave it out of the contact')
         return
      end do
   end subroutine new_rows

   subroutine copy_behaviour(self, list, model)
      type(rows_type), intent(inout) :: self
      type(contact_pair_list_type), intent(in) :: list
      type(model_type), intent(in) :: model
      type(interaction_type) :: interaction
      integer :: i, status

      allocate (self%sustained(self%n), self%restitution(self%n), self%capture(self%n), stat=status)
      call check_allocation(status)
      allocate (self%law(self%n), self%stiffness(self%n), self%friction(self%n), stat=status)
      call check_allocation(status)
      allocate (self%massless(self%n), stat=status)
      call check_allocation(status)
      do i = 1, self%n
         interaction = model%interactions(list%rows(i)%interaction)
         self%sustained(i) = .not. interaction%has_restitution
         self%restitution(i) = merge(interaction%restitution, 0.0_wp, interaction%has_restitution)
         self%capture(i) = merge(interaction%capture, -1.0_wp, interaction%has_capture)
         self%stiffness(i) = interaction%stiffness
         self%friction(i) = interaction%friction
         self%massless(i) = .false.
         if (list%rows(i)%model_pair > 0) self%massless(i) &
               = model%pairs(list%rows(i)%model_pair)%redistributed
         self%law(i) = row_law(interaction%method, self%massless(i))
      end do
   end subroutine copy_behaviour

   !> How contact forces follow in a row; a contact node without mass has no velocity to jump.
   pure function row_law(method, massless) result(law)
      integer, intent(in) :: method              !! of the row's interaction
      logical, intent(in) :: massless
      integer :: law

      select case (method)
      case (method_fictitious_force)
         law = merge(law_closed, law_overlap, massless)
      case (method_penalty)
         law = law_penalty
      case (method_lagrange)
         law = law_closed
      case default
         law = merge(law_closed, law_motion, massless)
      end select
   end function row_law

   !> The motion of a wall along the row's normal and tangent.
   pure subroutine set_wall_motion(self, i)
      type(rows_type), intent(inout) :: self
      integer, intent(in) :: i

      self%motion(i) = -dot_product(self%normal(:, i), self%wall(:, i))
      self%sliding_motion(i) = -dot_product(self%tangent(:, i), self%wall(:, i))
   end subroutine set_wall_motion

   !> Rows of sliding bodies for a motion from one state to another, linear about the latter.
   subroutine place_rows(self, geometry, map, before, now, reach)
      type(rows_type), intent(inout) :: self
      type(contact_geometry_type), intent(inout) :: geometry
      type(dof_map_type), intent(in) :: map
      type(state_type), intent(in) :: before, now
      real(wp), intent(in) :: reach
      type(row_terms_type) :: terms
      real(wp) :: products(self%n)
      integer :: i

      if (.not. self%moving) return
      call find_row_terms(geometry, [before%t, now%t], nodal_displacements(map, before%d), &
            nodal_displacements(map, now%d), reach, terms)
      call write_rows(self, terms, map)
      products = multiply(self%along_normal, now%d)
      do i = 1, self%n
         if (.not. terms%facing(i)) then
            self%offset(i) = far_gap
         else if (terms%at_rest(i)) then
            self%offset(i) = terms%gap(i)
         else
            self%offset(i) = terms%gap(i) - products(i)
            if (self%amplitude(i) == 0) cycle
            call set_wall_motion(self, i)
            self%offset(i) = self%offset(i) - self%motion(i) &
                  *amplitude_at(self%amplitudes(self%amplitude(i)), now%t)
         end if
      end do
   end subroutine place_rows

   !> Displacements of all nodes from those of the freedoms.
   pure function nodal_displacements(map, d) result(u)
      type(dof_map_type), intent(in) :: map
      real(wp), intent(in) :: d(:)               !! (n_freedoms)
      real(wp) :: u(3, size(map%freedom, 2))
      integer :: f

      u = 0.0_wp
      do f = 1, map%n_freedoms
         u(map%dof(f), map%node(f)) = d(f)
      end do
   end function nodal_displacements

   !> Writes terms over nodes as entries over freedoms; directions without a freedom are left out.
   subroutine write_rows(self, terms, map)
      type(rows_type), intent(inout) :: self
      type(row_terms_type), intent(in) :: terms
      type(dof_map_type), intent(in) :: map
      integer :: i, k, n

      n = 3*(terms%first(self%n + 1) - 1)
      call new_row_matrix(self%along_normal, self%n, n)
      call new_row_matrix(self%along_tangent, self%n, n)
      call new_row_matrix(self%turning, self%n, n)
      do i = 1, self%n
         call start_row(self%along_normal, i)
         call start_row(self%along_tangent, i)
         call start_row(self%turning, i)
         do k = terms%first(i), terms%first(i + 1) - 1
            call write_vector(self%along_normal, i, map%freedom(:, terms%node(k)), &
                  terms%normal(:, k))
            call write_vector(self%along_tangent, i, map%freedom(:, terms%node(k)), &
                  terms%tangent(:, k))
            call write_vector(self%turning, i, map%freedom(:, terms%node(k)), terms%turning(:, k))
         end do
      end do
      self%facing = terms%facing
      self%bend = terms%bend
      self%normal = terms%direction
      self%tangent = terms%along
      self%weight = terms%weight
   end subroutine write_rows

   pure subroutine write_vector(matrix, i, freedoms, vector)
      type(row_matrix_type), intent(inout) :: matrix
      integer, intent(in) :: i, freedoms(3)
      real(wp), intent(in) :: vector(3)
      integer :: k

      do k = 1, 3
         if (freedoms(k) == 0 .or. .not. abs(vector(k)) > 0.0_wp) cycle
         call add_entry(matrix, i, freedoms(k), vector(k))
      end do
   end subroutine write_vector

end module row_placement
