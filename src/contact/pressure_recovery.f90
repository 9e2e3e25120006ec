!> Contact pressures from the forces on the nodes of a surface: int N_i N_j p_j = f_i over the nodes
!> with a force, p = 0 at the others. The integrals go over the undeformed edges times the depth of
!> the body, so that the forces of a pressure linear along each edge give back that pressure.
module pressure_recovery
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use topology, only: line_functions, line_derivatives
   use quadrature, only: line_rule
   use skyline_matrix, only: profile_type, skyline_type, new_profile, couple, new_skyline
   use skyline_ldlt, only: ldlt_report_type, factorize, solve
   use target_surface, only: target_type, new_target
   implicit none
   private

   public :: pressure_edges_type, new_pressure_edges, recover_pressures

   integer, parameter :: n_points = 3
   !> A force below this part of the largest one is none.
   real(wp), parameter :: force_tolerance = 1.0e-12_wp

   !> The edges of a surface with their consistent masses. Nodes stand in the order in which one
   !> walks along the edges: neighbours are close and the matrix has a narrow profile.
   type :: pressure_edges_type
      integer, allocatable :: nodes(:)           !! (n) node indices
      integer, allocatable :: place(:)           !! (n_nodes) place of a node in `nodes`, or 0
      integer, allocatable :: edges(:, :)        !! (3, n_edges) places of its nodes, or 0
      real(wp), allocatable :: mass(:, :, :)     !! (3, 3, n_edges) int N_i N_j
      logical, allocatable :: forceless(:)       !! (n) a uniform pressure makes no force there
      type(profile_type) :: profile
   end type pressure_edges_type

contains

   !> Takes the edges of a surface in the undeformed body.
   subroutine new_pressure_edges(self, edges, x, thickness, around_axis)
      type(pressure_edges_type), intent(out) :: self
      integer, intent(in) :: edges(:, :)         !! (3, n_edges) nodes: ends, then the middle or 0
      real(wp), intent(in) :: x(:, :)            !! (2 or 3, n_nodes)
      real(wp), intent(in) :: thickness(:)       !! (n_edges) of plane bodies
      logical, intent(in) :: around_axis(:)      !! (n_edges) the depth is 2 pi r instead
      integer :: e, n, status

      call order_nodes(self, edges, size(x, 2))
      allocate (self%edges(3, size(edges, 2)), source=0, stat=status)
      call check_allocation(status)
      allocate (self%mass(3, 3, size(edges, 2)), source=0.0_wp, stat=status)
      call check_allocation(status)
      call new_profile(self%profile, size(self%nodes))
      do e = 1, size(edges, 2)
         n = merge(3, 2, edges(3, e) > 0)
         self%edges(:n, e) = self%place(edges(:n, e))
         call couple(self%profile, self%edges(:n, e))
         self%mass(:n, :n, e) = edge_mass(x(:2, edges(:n, e)), thickness(e), around_axis(e))
      end do
      call find_forceless(self)
   end subroutine new_pressure_edges

   !> Nodes with int N_i = 0: on the axis, the ends of quadratic edges.
   subroutine find_forceless(self)
      type(pressure_edges_type), intent(inout) :: self
      real(wp), dimension(size(self%nodes)) :: area, largest
      integer :: e, i

      area = 0.0_wp
      largest = 0.0_wp
      do e = 1, size(self%edges, 2)
         do i = 1, count(self%edges(:, e) > 0)
            associate (k => self%edges(i, e))
               area(k) = area(k) + sum(self%mass(:, i, e))
               largest(k) = max(largest(k), maxval(abs(self%mass(:, i, e))))
            end associate
         end do
      end do
      self%forceless = abs(area) <= force_tolerance*largest
   end subroutine find_forceless

   !> Numbers the nodes along the chains of edges, the open ones from their beginning.
   subroutine order_nodes(self, edges, n_nodes)
      type(pressure_edges_type), intent(inout) :: self
      integer, intent(in) :: edges(:, :)
      integer, intent(in) :: n_nodes
      type(target_type) :: chain
      logical :: seen(size(edges, 2))
      integer :: e, n, status

      call new_target(chain, edges, n_nodes)
      allocate (self%nodes(size(chain%nodes)), self%place(n_nodes), source=0, stat=status)
      call check_allocation(status)
      seen = .false.
      n = 0
      do e = 1, size(edges, 2)
         if (chain%previous(e) == 0) call walk(e)
      end do
      do e = 1, size(edges, 2)
         call walk(e)
      end do

   contains

      subroutine walk(start)
         integer, intent(in) :: start
         integer :: e

         e = start
         do while (e > 0)
            if (seen(e)) return
            seen(e) = .true.
            call number_node(edges(1, e))
            call number_node(edges(3, e))
            call number_node(edges(2, e))
            e = chain%next(e)
         end do
      end subroutine walk

      subroutine number_node(node)
         integer, intent(in) :: node

         if (node == 0) return
         if (self%place(node) > 0) return
         n = n + 1
         self%place(node) = n
         self%nodes(n) = node
      end subroutine number_node

   end subroutine order_nodes

   !> int N_i N_j over one edge.
   pure function edge_mass(x, thickness, around_axis) result(mass)
      real(wp), intent(in) :: x(:, :)            !! (2, n) n = 2 or 3
      real(wp), intent(in) :: thickness
      logical, intent(in) :: around_axis
      real(wp) :: mass(size(x, 2), size(x, 2))
      real(wp), parameter :: two_pi = 2.0_wp*acos(-1.0_wp)
      real(wp) :: s(n_points), weight(n_points), shape(size(x, 2)), area
      integer :: i, n

      n = size(x, 2)
      call line_rule(s, weight)
      mass = 0.0_wp
      do i = 1, n_points
         shape = line_functions(n, s(i))
         area = weight(i)*thickness
         if (around_axis) area = weight(i)*two_pi*dot_product(x(1, :), shape)
         area = area*norm2(matmul(x, line_derivatives(n, s(i))))
         mass = mass + area*spread(shape, 2, n)*spread(shape, 1, n)
      end do
   end function edge_mass

   !> Pressures at the nodes from the normal forces on them, both in the order of self%nodes; zero
   !> everywhere where an edge has no length.
   function recover_pressures(self, forces) result(pressures)
      type(pressure_edges_type), intent(in) :: self
      real(wp), intent(in) :: forces(:)          !! (n) positive where the surface is pressed
      real(wp) :: pressures(size(forces))
      type(skyline_type) :: matrix
      type(ldlt_report_type) :: report
      logical :: active(size(forces))
      integer :: i

      pressures = 0.0_wp
      active = abs(forces) > force_tolerance*maxval(abs(forces))
      if (.not. any(active)) return
      call join_forceless(self, active)
      call new_skyline(matrix, self%profile)
      do i = 1, size(forces)
         if (.not. active(i)) call matrix%add(i, i, 1.0_wp)
      end do
      do i = 1, size(self%edges, 2)
         call add_edge(matrix, self%edges(:, i), self%mass(:, :, i), active)
      end do
      call factorize(matrix, report)
      if (report%zero_pivot > 0) return
      pressures = merge(forces, 0.0_wp, active)
      call solve(matrix, pressures)
   end function recover_pressures

   !> A node that no pressure shows on has one where another node of its edge has.
   pure subroutine join_forceless(self, active)
      type(pressure_edges_type), intent(in) :: self
      logical, intent(inout) :: active(:)
      integer :: e, n

      if (.not. any(self%forceless)) return
      do e = 1, size(self%edges, 2)
         n = count(self%edges(:, e) > 0)
         associate (nodes => self%edges(:n, e))
            if (any(active(nodes))) active(nodes) = active(nodes) .or. self%forceless(nodes)
         end associate
      end do
   end subroutine join_forceless

   pure subroutine add_edge(matrix, nodes, mass, active)
      type(skyline_type), intent(inout) :: matrix
      integer, intent(in) :: nodes(3)
      real(wp), intent(in) :: mass(3, 3)
      logical, intent(in) :: active(:)
      integer :: i, j

      do j = 1, count(nodes > 0)
         if (.not. active(nodes(j))) cycle
         do i = 1, j
            if (active(nodes(i))) call matrix%add(nodes(i), nodes(j), mass(i, j))
         end do
      end do
   end subroutine add_edge

end module pressure_recovery
