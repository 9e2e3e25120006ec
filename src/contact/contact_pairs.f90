!> Contact rows: who may touch whom. A row stands for one node of a slave surface, or for one gap
!> element; against a plane, and for a gap element, its normal is fixed and the gap a linear form
!> of displacements, g = sum c_k u_k + g0 + s(t), g < 0 meaning overlap.
module contact_pairs
   use kinds, only: wp
   use errors, only: error_type
   use text, only: to_text
   use memory_shortage, only: check_allocation
   use places, only: place_type, fail_at
   use mesh, only: element_gap
   use properties, only: name_length
   use model, only: model_type
   use surfaces, only: rigid_plane
   use gap_normals, only: gap_normal
   implicit none
   private

   public :: contact_row_type, contact_pair_list_type, find_contact_rows
   public :: row_fixed, row_circle, row_surface

   !> What a row's contactor may touch.
   integer, parameter :: row_fixed = 0           !! a plane, or the other node of a gap element
   integer, parameter :: row_circle = 1          !! a rigid circle
   integer, parameter :: row_surface = 2         !! the edges of a surface

   !> One node against a rigid or deformable surface, or one gap element.
   type :: contact_row_type
      integer :: pair = 0                        !! index into the pair names
      integer :: node = 0                        !! index of the contactor node
      integer :: interaction = 0                 !! index into the model's, 0: default
      integer :: kind = row_fixed
      integer :: model_pair = 0                  !! index of the model's pair, 0: gap element
      integer :: pass = 1                        !! 2: the master surface's nodes on the slave
      integer :: other = 0                       !! the other node of a gap element
      integer :: n_terms = 0
      integer :: term_node(6) = 0, term_dof(6) = 0
      real(wp) :: coefficient(6) = 0.0_wp
      real(wp) :: normal(3) = 0.0_wp             !! direction of a positive contact force on `node`
      real(wp) :: offset = 0.0_wp                !! g0
      integer :: amplitude = 0                   !! of a moving plane, 0: at rest
      real(wp) :: motion = 0.0_wp                !! change of the gap at amplitude 1
      type(place_type) :: place
   end type contact_row_type

   !> All rows, and the names of the pairs they belong to.
   type :: contact_pair_list_type
      type(contact_row_type), allocatable :: rows(:)
      character(len=2*name_length + 1), allocatable :: names(:)
      integer :: n_names = 0                     !! while they are gathered: the list is longer then
   end type contact_pair_list_type

contains

   !> Rows of all contact pairs, node by node, those of a second pass after the first; then of all
   !> gap elements.
   subroutine find_contact_rows(model, list, error)
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(out) :: list
      type(error_type), allocatable, intent(out) :: error
      integer :: p, pass, n, n_gaps, pair, e, status

      n_gaps = count(model%elements%kind(:model%elements%n) == element_gap)
      n = n_gaps
      do p = 1, size(model%pairs)
         do pass = 1, model%pairs(p)%passes
            n = n + size(model%surfaces(contactor_surface(model, p, pass))%nodes)
         end do
      end do
      allocate (list%rows(n), list%names(size(model%pairs) + n_gaps), stat=status)
      call check_allocation(status)
      n = 0
      do p = 1, size(model%pairs)
         call name_rows(list, pair_name(model, p), pair)
         if (pair < p) then
            call fail_at(error, model%source, model%pairs(p)%place, 'in the results this pair is ' &
                  //'named '//pair_name(model, p)//', and so is another', &
                  'rename a surface')
            return
         end if
         do pass = 1, model%pairs(p)%passes
            call add_pair(model, p, pass, pair, list, n)
         end do
      end do
      do e = 1, model%elements%n
         if (model%elements%kind(e) /= element_gap) cycle
         n = n + 1
         call make_gap_row(model, e, list%rows(n), error)
         if (allocated(error)) return
         call name_rows(list, trim(model%element_sets(model%sections(model%elements%section(e)) &
               %set)%name), list%rows(n)%pair)
         if (list%rows(n)%pair <= size(model%pairs)) then
            call fail_at(error, model%source, model%sections(model%elements%section(e))%place, &
                  'in the results these gaps are named '//trim(list%names(list%rows(n)%pair)) &
                  //', and so is a contact pair', 'rename the element set, or a surface')
            return
         end if
      end do
      list%names = list%names(:list%n_names)
   end subroutine find_contact_rows

   !> The surface whose nodes have rows: the slave, in the second pass the master.
   pure function contactor_surface(model, pair, pass) result(surface)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair, pass
      integer :: surface

      surface = model%pairs(pair)%contactor
      if (pass == 2) surface = model%pairs(pair)%target
   end function contactor_surface

   pure function pair_name(model, pair) result(name)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      character(len=:), allocatable :: name

      name = trim(model%surfaces(model%pairs(pair)%contactor)%name)//'-'
      if (model%pairs(pair)%target > 0) then
         name = name//trim(model%surfaces(model%pairs(pair)%target)%name)
      else
         name = name//trim(model%rigid_surfaces(model%pairs(pair)%rigid_target)%name)
      end if
   end function pair_name

   !> The rows of one pass of a pair.
   pure subroutine add_pair(model, pair, pass, named, list, n)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair, pass
      integer, intent(in) :: named               !! its index into the names
      type(contact_pair_list_type), intent(inout) :: list
      integer, intent(inout) :: n                !! rows so far
      integer :: i

      associate (nodes => model%surfaces(contactor_surface(model, pair, pass))%nodes)
         do i = 1, size(nodes)
            n = n + 1
            associate (row => list%rows(n))
               row%pair = named
               row%model_pair = pair
               row%pass = pass
               row%interaction = model%pairs(pair)%interaction
               row%place = model%pairs(pair)%place
               row%node = nodes(i)
               row%kind = row_surface
               if (model%pairs(pair)%target > 0) cycle
               call face_rigid(model, pair, row)
            end associate
         end do
      end associate
   end subroutine add_pair

   !> The index of a name, which is appended unless it is there; most often it is the last one.
   pure subroutine name_rows(list, name, named)
      type(contact_pair_list_type), intent(inout) :: list
      character(len=*), intent(in) :: name
      integer, intent(out) :: named

      do named = list%n_names, 1, -1
         if (list%names(named) == name) return
      end do
      list%n_names = list%n_names + 1
      named = list%n_names
      list%names(named) = name
   end subroutine name_rows

   !> A plane: g = n . (x + u - x_plane - s(t)). The normal of a circle is not known yet.
   pure subroutine face_rigid(model, pair, row)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(contact_row_type), intent(inout) :: row

      associate (rigid => model%rigid_surfaces(model%pairs(pair)%rigid_target))
         row%kind = row_circle
         row%amplitude = rigid%amplitude
         if (rigid%kind /= rigid_plane) return
         row%kind = row_fixed
         row%normal = rigid%normal
         row%offset = dot_product(rigid%normal, model%nodes%x(:, row%node) - rigid%point)
         row%motion = -dot_product(rigid%normal, rigid%motion)
      end associate
      call add_terms(row, row%node, row%normal)
   end subroutine face_rigid

   !> g = clearance + n . (u2 - u1), n from node 1 to node 2.
   subroutine make_gap_row(model, e, row, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      type(contact_row_type), intent(out) :: row
      type(error_type), allocatable, intent(out) :: error
      integer :: first
      real(wp) :: normal(3)

      first = model%elements%first(e)
      normal = gap_normal(model, e)
      row%place = model%elements%place(e)
      if (.not. norm2(normal) > 0.0_wp) then
         call fail_at(error, model%source, row%place, 'the nodes of gap element ' &
               //to_text(model%elements%id(e))//' coincide and *GAP gives no normal', &
               'give the normal on the data line of *GAP: clearance, nx, ny, nz')
         return
      end if
      row%node = model%elements%nodes(first + 1)
      row%other = model%elements%nodes(first)
      row%interaction = model%sections(model%elements%section(e))%interaction
      row%normal = normal
      row%offset = model%sections(model%elements%section(e))%clearance
      call add_terms(row, model%elements%nodes(first), -normal)
      call add_terms(row, model%elements%nodes(first + 1), normal)
   end subroutine make_gap_row

   pure subroutine add_terms(row, node, direction)
      type(contact_row_type), intent(inout) :: row
      integer, intent(in) :: node
      real(wp), intent(in) :: direction(3)
      integer :: i

      do i = 1, 3
         if (.not. abs(direction(i)) > 0.0_wp) cycle
         row%n_terms = row%n_terms + 1
         row%term_node(row%n_terms) = node
         row%term_dof(row%n_terms) = i
         row%coefficient(row%n_terms) = direction(i)
      end do
   end subroutine add_terms

end module contact_pairs
