!> What contact rows mean for the faces they belong to: pressures at the nodes, total forces.
module contact_faces
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use model, only: model_type
   use mesh, only: axisymmetric, is_solid_kind, solid_plane
   use contact_pairs, only: contact_pair_list_type, contact_row_type
   use pressure_recovery, only: pressure_edges_type, new_pressure_edges, recover_pressures
   use row_matrix, only: row_matrix_type
   use impact_scene, only: scene_type
   implicit none
   private

   public :: contact_face_type, new_contact_faces, find_pressures, find_row_forces, share_contact

   !> Rows first to last, the nodes of one surface against its partner.
   type :: contact_face_type
      integer :: first = 0, last = -1
      integer :: first_facing = 0, last_facing = -1   !! rows of the partner's nodes against it
      logical :: weighted = .false.              !! TYPE=SURFACE TO SURFACE
      logical :: around_axis = .false.
      logical :: own_partner = .false.           !! a surface against itself
      type(pressure_edges_type) :: edges
      real(wp), allocatable :: thickness(:)      !! (nodes of edges) mean of the edges around
      integer, allocatable :: row(:)             !! (nodes of edges) its row
   end type contact_face_type

contains

   !> The faces of all contact pairs, one a pass; gap elements have none.
   subroutine new_contact_faces(faces, model, list)
      type(contact_face_type), allocatable, intent(out) :: faces(:)
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(in) :: list
      integer :: p, pass, f, n, status

      n = 0
      if (size(list%rows) > 0) n = sum(model%pairs%passes)
      allocate (faces(n), stat=status)
      call check_allocation(status)
      f = 0
      n = 0
      do p = 1, size(model%pairs)
         if (size(faces) == 0) exit
         do pass = 1, model%pairs(p)%passes
            f = f + 1
            faces(f)%first = n + 1
            do while (n < size(list%rows))
               if (list%rows(n + 1)%model_pair /= p .or. list%rows(n + 1)%pass /= pass) exit
               n = n + 1
            end do
            faces(f)%last = n
            call take_surface(faces(f), model, p, pass)
            call find_rows(faces(f), list%rows)
         end do
         call set_facing(faces(:f), model%pairs(p)%passes)
      end do
   end subroutine new_contact_faces

   subroutine take_surface(face, model, p, pass)
      type(contact_face_type), intent(inout) :: face
      type(model_type), intent(in) :: model
      integer, intent(in) :: p, pass
      integer :: surface, e, status
      real(wp), allocatable :: thickness(:)
      logical, allocatable :: around(:)

      surface = model%pairs(p)%contactor
      face%own_partner = model%pairs(p)%target == surface
      if (pass == 2) surface = model%pairs(p)%target
      face%weighted = model%pairs(p)%weighted .and. model%pairs(p)%target > 0
      associate (edges => model%surfaces(surface)%edges, owner => &
            model%surfaces(surface)%edge_element)
         allocate (thickness(size(edges, 2)), around(size(edges, 2)), stat=status)
         call check_allocation(status)
         thickness = 1.0_wp
         do e = 1, size(edges, 2)
            around(e) = is_solid_kind(model%elements%kind(owner(e))) .and. &
                  solid_plane(model%elements%kind(owner(e))) == axisymmetric
            if (model%elements%section(owner(e)) == 0) cycle
            associate (area => model%sections(model%elements%section(owner(e)))%area)
               if (area > 0.0_wp) thickness(e) = area
            end associate
         end do
         face%around_axis = any(around)
         call new_pressure_edges(face%edges, edges, model%nodes%x(:, :model%nodes%n), thickness, &
               around)
         face%thickness = mean_thickness(face%edges, model%nodes%x, edges, thickness)
      end associate
   end subroutine take_surface

   pure subroutine find_rows(face, rows)
      type(contact_face_type), intent(inout) :: face
      type(contact_row_type), intent(in) :: rows(:)
      integer :: i, status

      allocate (face%row(size(face%edges%nodes)), source=0, stat=status)
      call check_allocation(status)
      if (size(face%row) == 0) return
      do i = face%first, face%last
         face%row(face%edges%place(rows(i)%node)) = i
      end do
   end subroutine find_rows

   !> Thickness at the nodes, the mean of the edges around by their lengths.
   pure function mean_thickness(self, x, edges, thickness) result(mean)
      type(pressure_edges_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: edges(:, :)
      real(wp), intent(in) :: thickness(:)       !! (n_edges)
      real(wp) :: mean(size(self%nodes))
      real(wp) :: length(size(self%nodes)), edge_length
      integer :: e, i

      mean = 0.0_wp
      length = 0.0_wp
      do e = 1, size(edges, 2)
         edge_length = norm2(x(:, edges(2, e)) - x(:, edges(1, e)))
         do i = 1, 3
            if (self%edges(i, e) == 0) cycle
            associate (k => self%edges(i, e))
               mean(k) = mean(k) + edge_length*thickness(e)
               length(k) = length(k) + edge_length
            end associate
         end do
      end do
      mean = mean/length
   end function mean_thickness

   !> Each of the two faces of the last pair is pressed by the rows of the other one too, a surface
   !> against itself by its own.
   subroutine set_facing(faces, passes)
      type(contact_face_type), intent(inout) :: faces(:)
      integer, intent(in) :: passes
      integer :: n

      n = size(faces)
      if (passes == 2) then
         faces(n)%first_facing = faces(n - 1)%first
         faces(n)%last_facing = faces(n - 1)%last
         faces(n - 1)%first_facing = faces(n)%first
         faces(n - 1)%last_facing = faces(n)%last
      else if (faces(n)%own_partner .and. .not. faces(n)%weighted) then
         faces(n)%first_facing = faces(n)%first
         faces(n)%last_facing = faces(n)%last
      end if
   end subroutine set_facing

   !> Pressures at the contactors of all rows. Rows weighted over edges have theirs,
   !> lambda/(int N_j ds thickness); of the others, and of forces from the other side, they are
   !> recovered along the edges. Nodes without edges have none.
   subroutine find_pressures(faces, scene, list, lambda, pressures)
      type(contact_face_type), intent(in) :: faces(:)
      type(scene_type), intent(in) :: scene
      type(contact_pair_list_type), intent(in) :: list
      real(wp), intent(in) :: lambda(:)          !! (n_rows)
      real(wp), intent(out) :: pressures(:)      !! (n_rows)
      integer :: f, i

      pressures = 0.0_wp
      do f = 1, size(faces)
         associate (face => faces(f), place => faces(f)%edges%place)
            if (size(face%edges%nodes) == 0) cycle
            associate (recovered => recover_pressures(face%edges, &
                  nodal_forces(face, scene, list%rows, lambda)))
               do i = face%first, face%last
                  pressures(i) = recovered(place(list%rows(i)%node))
                  if (.not. has_own_pressure(face) .or. .not. scene%rows%weight(i) > 0.0_wp) cycle
                  pressures(i) = pressures(i) + lambda(i)/(scene%rows%weight(i) &
                        *face%thickness(place(list%rows(i)%node)))
               end do
            end associate
         end associate
      end do
   end subroutine find_pressures

   !> Whether the force of a row divided by its weight is a pressure: not where the depth changes
   !> along the edge.
   pure function has_own_pressure(face) result(has)
      type(contact_face_type), intent(in) :: face
      logical :: has

      has = face%weighted .and. .not. face%around_axis
   end function has_own_pressure

   !> Normal forces on the nodes of a face that pressures are to be recovered from.
   function nodal_forces(face, scene, rows, lambda) result(forces)
      type(contact_face_type), intent(in) :: face
      type(scene_type), intent(in) :: scene
      type(contact_row_type), intent(in) :: rows(:)
      real(wp), intent(in) :: lambda(:)
      real(wp) :: forces(size(face%edges%nodes))
      integer :: i

      forces = 0.0_wp
      if (.not. face%weighted) then
         do i = face%first, face%last
            associate (k => face%edges%place(rows(i)%node))
               forces(k) = forces(k) + lambda(i)
            end associate
         end do
      else if (face%around_axis) then
         do i = face%first, face%last
            call add_row(face, scene, i, lambda(i), 0, forces)
         end do
      end if
      do i = face%first_facing, face%last_facing
         call add_row(face, scene, i, -lambda(i), rows(i)%node, forces)
      end do
   end function nodal_forces

   !> Adds the forces of row i along its normal on the nodes of a face but one.
   subroutine add_row(face, scene, i, lambda, left_out, forces)
      type(contact_face_type), intent(in) :: face
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: i
      real(wp), intent(in) :: lambda
      integer, intent(in) :: left_out            !! a node, 0: none
      real(wp), intent(inout) :: forces(:)
      integer :: k, node, dof

      if (.not. abs(lambda) > 0.0_wp) return
      associate (g => scene%rows%along_normal, map => scene%system%structure%map)
         do k = g%first(i), g%first(i + 1) - 1
            node = map%node(g%freedom(k))
            dof = map%dof(g%freedom(k))
            if (node == left_out .or. face%edges%place(node) == 0) cycle
            associate (force => forces(face%edges%place(node)))
               force = force + lambda*g%coefficient(k)*scene%rows%normal(dof, i)
            end associate
         end do
      end associate
   end subroutine add_row

   !> Where two faces have rows on each other the force of a node may be that of its partners' rows
   !> alone: then it has their state and slip.
   subroutine share_contact(faces, scene, list, lambda, states, slips)
      type(contact_face_type), intent(in) :: faces(:)
      type(scene_type), intent(in) :: scene
      type(contact_pair_list_type), intent(in) :: list
      real(wp), intent(in) :: lambda(:)          !! (n_rows)
      integer, intent(inout) :: states(:)        !! (n_rows)
      real(wp), intent(inout) :: slips(:)        !! (n_rows)
      real(wp), parameter :: least_share = 1.0e-6_wp
      integer :: f, i, k, node

      associate (g => scene%rows%along_normal, map => scene%system%structure%map)
         do f = 1, size(faces)
            do i = faces(f)%first_facing, faces(f)%last_facing
               if (.not. lambda(i) > 0.0_wp) cycle
               do k = g%first(i), g%first(i + 1) - 1
                  node = map%node(g%freedom(k))
                  if (node == list%rows(i)%node .or. faces(f)%edges%place(node) == 0) cycle
                  if (abs(g%coefficient(k)) < least_share) cycle
                  associate (own => faces(f)%row(faces(f)%edges%place(node)))
                     states(own) = max(states(own), states(i))
                     slips(own) = max(slips(own), slips(i))
                  end associate
               end do
            end do
         end do
      end associate
   end subroutine share_contact

   !> Forces of all rows with friction on the pair's slave: rows of a second pass push the master,
   !> their sign turns.
   subroutine find_row_forces(faces, scene, list, lambda, tau, forces)
      type(contact_face_type), intent(in) :: faces(:)
      type(scene_type), intent(in) :: scene
      type(contact_pair_list_type), intent(in) :: list
      real(wp), intent(in) :: lambda(:), tau(:)  !! (n_rows)
      real(wp), intent(out) :: forces(:, :)      !! (3, n_rows)
      integer :: f, i

      do i = 1, size(list%rows)
         forces(:, i) = lambda(i)*scene%rows%normal(:, i) + tau(i)*scene%rows%tangent(:, i)
      end do
      do f = 1, size(faces)
         if (.not. faces(f)%weighted .or. faces(f)%own_partner) cycle
         ! where the surface is curved the normals of a weighted row do not add up to a unit one
         do i = faces(f)%first, faces(f)%last
            forces(:, i) = sum_of_row(faces(f), scene, scene%rows%along_normal, i, lambda(i)) &
                  + sum_of_row(faces(f), scene, scene%rows%along_tangent, i, tau(i))
         end do
      end do
      do i = 1, size(list%rows)
         if (list%rows(i)%pass == 2) forces(:, i) = -forces(:, i)
      end do
   end subroutine find_row_forces

   !> The resultant of a row on the nodes of a face.
   function sum_of_row(face, scene, matrix, i, size_of_force) result(force)
      type(contact_face_type), intent(in) :: face
      type(scene_type), intent(in) :: scene
      type(row_matrix_type), intent(in) :: matrix
      integer, intent(in) :: i
      real(wp), intent(in) :: size_of_force
      real(wp) :: force(3)
      integer :: k

      force = 0.0_wp
      associate (map => scene%system%structure%map)
         do k = matrix%first(i), matrix%first(i + 1) - 1
            if (face%edges%place(map%node(matrix%freedom(k))) == 0) cycle
            associate (component => force(map%dof(matrix%freedom(k))))
               component = component + size_of_force*matrix%coefficient(k)
            end associate
         end do
      end associate
   end function sum_of_row

end module contact_faces
