!> The order of the equations: the deck's, reverse Cuthill-McKee's or Sloan's, whichever gives the
!> effective matrix that is cheapest to factorize.
module equation_order
   use kinds, only: wp, int64
   use memory_shortage, only: check_allocation
   use histories, only: equation_type
   use skyline_matrix, only: profile_type, profile_entries, profile_cost
   use graph, only: graph_type, new_graph
   use renumbering, only: cuthill_mckee_order, sloan_order
   use dof_map, only: number_equations
   use structure, only: structure_type
   use effective_matrix, only: find_profile, mark_implicit, list_coupled
   implicit none
   private

   public :: ordering_type, order_equations, n_orders, order_names

   integer, parameter :: n_orders = 3
   character(len=21), parameter :: order_names(n_orders) = ['deck                 ', &
         'reverse Cuthill-McKee', 'Sloan                ']

   !> Models with fewer implicit equations stay in the deck's order.
   integer, parameter :: worth_it = 20
   !> Pairs of coupled nodes beyond which no order is looked for: the matrix is full anyway.
   real(wp), parameter :: too_many = 3.0e8_wp

   !> What was tried and taken.
   type :: ordering_type
      integer :: taken = 1                       !! index into order_names
      logical :: compared = .false.
      integer(int64) :: entries(n_orders) = 0    !! of the profile
      real(wp) :: cost(n_orders) = 0.0_wp        !! sum of squared column heights
   end type ordering_type

contains

   !> Numbers the equations and finds their profile.
   subroutine order_equations(structure, prescribed, constraints, profile, ordering)
      type(structure_type), intent(inout) :: structure
      logical, intent(in) :: prescribed(:)       !! (n_freedoms)
      type(equation_type), intent(in) :: constraints(:)
      type(profile_type), intent(out) :: profile
      type(ordering_type), intent(out) :: ordering
      type(graph_type) :: graph
      type(profile_type) :: trial
      integer, allocatable :: vertex_node(:), order(:, :)
      logical, allocatable :: implicit_equation(:)
      integer :: i, status

      call number_equations(structure%map, prescribed, constraints)
      call find_profile(structure, profile)
      call weigh(profile, 1, ordering)
      call mark_implicit(structure, implicit_equation)
      if (count(implicit_equation) <= worth_it) return
      call build_node_graph(structure, graph, vertex_node)
      if (graph%n == 0) return
      ordering%compared = .true.
      allocate (order(size(structure%map%freedom, 2), n_orders), stat=status)
      call check_allocation(status)
      order(:, 1) = [(i, i=1, size(order, 1))]
      order(:, 2) = all_nodes(vertex_node, cuthill_mckee_order(graph), size(order, 1))
      order(:, 3) = all_nodes(vertex_node, sloan_order(graph), size(order, 1))
      do i = 2, n_orders
         call number_equations(structure%map, prescribed, constraints, order(:, i))
         call find_profile(structure, trial)
         call weigh(trial, i, ordering)
      end do
      ordering%taken = minloc(ordering%cost, dim=1)
      call number_equations(structure%map, prescribed, constraints, order(:, ordering%taken))
      call find_profile(structure, profile)
   end subroutine order_equations

   pure subroutine weigh(profile, i, ordering)
      type(profile_type), intent(in) :: profile
      integer, intent(in) :: i
      type(ordering_type), intent(inout) :: ordering

      ordering%entries(i) = profile_entries(profile)
      ordering%cost(i) = profile_cost(profile)
   end subroutine weigh

   !> The graph of the nodes with equations that off-diagonal entries couple: those of an element,
   !> and the masters of a dependent freedom. It stays empty if it would be nearly complete.
   subroutine build_node_graph(structure, graph, vertex_node)
      type(structure_type), intent(in) :: structure
      type(graph_type), intent(out) :: graph
      integer, allocatable, intent(out) :: vertex_node(:)   !! node of each vertex
      integer, allocatable :: first(:), member(:), vertex(:)
      integer :: i, n, status

      call list_cliques(structure, first, member)
      if (sum(real(first(2:) - first(:size(first) - 1), wp)**2) > too_many) return
      allocate (vertex(size(structure%map%freedom, 2)), stat=status)
      call check_allocation(status)
      vertex = 0
      vertex(member) = 1
      vertex_node = pack([(i, i=1, size(vertex))], vertex == 1)
      n = size(vertex_node)
      vertex(vertex_node) = [(i, i=1, n)]
      call new_graph(graph, n, first, vertex(member))
   end subroutine build_node_graph

   !> The sets of nodes coupled with each other: those of the coupled equations, neighbours of one
   !> node taken once.
   subroutine list_cliques(structure, first, member)
      type(structure_type), intent(in) :: structure
      integer, allocatable, intent(out) :: first(:), member(:)
      integer :: node_of(structure%map%n_eq), f, i, k, n, from, last_node

      associate (map => structure%map)
         do f = 1, map%n_freedoms
            if (map%id(map%dof(f), map%node(f)) > 0) node_of(map%id(map%dof(f), map%node(f))) &
                  = map%node(f)
         end do
      end associate
      call list_coupled(structure, first, member)
      n = 0
      do i = 1, size(first) - 1
         from = first(i)
         first(i) = n + 1
         last_node = 0
         do k = from, first(i + 1) - 1
            if (node_of(member(k)) == last_node) cycle
            last_node = node_of(member(k))
            n = n + 1
            member(n) = last_node
         end do
      end do
      first(size(first)) = n + 1
      member = member(:n)
   end subroutine list_cliques

   !> The nodes of the graph in an order of its vertices, then all others as they are.
   pure function all_nodes(vertex_node, order, n_nodes) result(nodes)
      integer, intent(in) :: vertex_node(:), order(:), n_nodes
      integer :: nodes(n_nodes)
      logical :: listed(n_nodes)
      integer :: i

      listed = .false.
      listed(vertex_node) = .true.
      nodes(:size(order)) = vertex_node(order)
      nodes(size(order) + 1:) = pack([(i, i=1, n_nodes)], .not. listed)
   end function all_nodes

end module equation_order
