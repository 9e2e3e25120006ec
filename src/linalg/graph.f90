!> Undirected graphs as lists of neighbours, and breadth-first levels in them.
module graph
   use kinds, only: wp, int64
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: graph_type, new_graph, vertex_cliques, degree, walk_levels, sort_by_degree, order_cost

   !> The neighbours of vertex v stand at neighbour(first(v):first(v + 1) - 1).
   type :: graph_type
      integer :: n = 0
      integer, allocatable :: first(:)           !! (n+1)
      integer, allocatable :: neighbour(:)
   end type graph_type

contains

   !> The graph in which all members of each clique are neighbours of each other.
   pure subroutine new_graph(self, n, first, member)
      type(graph_type), intent(out) :: self
      integer, intent(in) :: n
      integer, intent(in) :: first(:)            !! (n_cliques+1) where a clique starts
      integer, intent(in) :: member(:)           !! vertices, a repeated one counts once
      integer, allocatable :: clique_first(:), clique(:), seen(:)
      integer :: v, i, j, k, pass, status

      call vertex_cliques(n, first, member, clique_first, clique)
      self%n = n
      allocate (self%first(n + 1), seen(n), stat=status)
      call check_allocation(status)
      do pass = 1, 2
         seen = 0
         k = 0
         do v = 1, n
            self%first(v) = k + 1
            seen(v) = v
            do i = clique_first(v), clique_first(v + 1) - 1
               do j = first(clique(i)), first(clique(i) + 1) - 1
                  if (seen(member(j)) == v) cycle
                  seen(member(j)) = v
                  k = k + 1
                  if (pass == 2) self%neighbour(k) = member(j)
               end do
            end do
         end do
         self%first(n + 1) = k + 1
         if (pass == 1) then
            allocate (self%neighbour(k), stat=status)
            call check_allocation(status)
         end if
      end do
   end subroutine new_graph

   !> The cliques of every vertex.
   pure subroutine vertex_cliques(n, first, member, clique_first, clique)
      integer, intent(in) :: n, first(:), member(:)
      integer, allocatable, intent(out) :: clique_first(:), clique(:)
      integer, allocatable :: next(:)
      integer :: c, i, status

      allocate (clique_first(n + 1), clique(size(member)), stat=status)
      call check_allocation(status)
      clique_first = 0
      do i = 1, size(member)
         clique_first(member(i) + 1) = clique_first(member(i) + 1) + 1
      end do
      clique_first(1) = 1
      do i = 1, n
         clique_first(i + 1) = clique_first(i + 1) + clique_first(i)
      end do
      next = clique_first
      do c = 1, size(first) - 1
         do i = first(c), first(c + 1) - 1
            clique(next(member(i))) = c
            next(member(i)) = next(member(i)) + 1
         end do
      end do
   end subroutine vertex_cliques

   !> Number of neighbours.
   elemental integer function degree(self, v)
      type(graph_type), intent(in) :: self
      integer, intent(in) :: v

      degree = self%first(v + 1) - self%first(v)
   end function degree

   !> Breadth-first search: the vertices reached from a root in the order of reaching them, and
   !> where each level starts in that list.
   pure subroutine walk_levels(self, root, distance, reached, n_reached, level_first)
      type(graph_type), intent(in) :: self
      integer, intent(in) :: root
      integer, intent(inout) :: distance(:)      !! -1 if not reached; comes and leaves all -1
      integer, intent(inout) :: reached(:)       !! (n) the first n_reached are set
      integer, intent(out) :: n_reached
      integer, allocatable, intent(out) :: level_first(:)   !! (n_levels+1)
      integer :: i, j, v, status

      reached(1) = root
      distance(root) = 0
      n_reached = 1
      i = 0
      do while (i < n_reached)
         i = i + 1
         do j = self%first(reached(i)), self%first(reached(i) + 1) - 1
            v = self%neighbour(j)
            if (distance(v) >= 0) cycle
            distance(v) = distance(reached(i)) + 1
            n_reached = n_reached + 1
            reached(n_reached) = v
         end do
      end do
      allocate (level_first(distance(reached(n_reached)) + 2), stat=status)
      call check_allocation(status)
      level_first = n_reached + 1
      do i = n_reached, 1, -1
         level_first(distance(reached(i)) + 1) = i
         distance(reached(i)) = -1
      end do
   end subroutine walk_levels

   !> Orders the neighbours of every vertex by ascending degree, all at once (Chan and George):
   !> vertices taken by degree enter the lists of their neighbours one after the other.
   pure subroutine sort_by_degree(self)
      type(graph_type), intent(inout) :: self
      integer, allocatable :: by_degree(:), next(:), sorted(:)
      integer :: i, j, v, w, status

      by_degree = vertices_by_degree(self)
      next = self%first
      allocate (sorted(size(self%neighbour)), stat=status)
      call check_allocation(status)
      do i = 1, self%n
         v = by_degree(i)
         do j = self%first(v), self%first(v + 1) - 1
            w = self%neighbour(j)
            sorted(next(w)) = v
            next(w) = next(w) + 1
         end do
      end do
      call move_alloc(sorted, self%neighbour)
   end subroutine sort_by_degree

   !> Counting sort; vertices of equal degree stay in their order.
   pure function vertices_by_degree(self) result(by_degree)
      type(graph_type), intent(in) :: self
      integer :: by_degree(self%n)
      integer :: start(0:self%n), v, k

      start = 0
      do v = 1, self%n
         k = degree(self, v) + 1
         start(k) = start(k) + 1
      end do
      do k = 1, self%n
         start(k) = start(k) + start(k - 1)
      end do
      do v = 1, self%n
         k = degree(self, v)
         start(k) = start(k) + 1
         by_degree(start(k)) = v
      end do
   end function vertices_by_degree

   !> Size of the profile of a matrix with this graph, diagonal included, and the cost of its
   !> factorization, the sum of squared column heights.
   pure subroutine order_cost(self, order, entries, cost)
      type(graph_type), intent(in) :: self
      integer, intent(in) :: order(:)            !! (n) the vertex at each place
      integer(int64), intent(out) :: entries
      real(wp), intent(out) :: cost
      integer, allocatable :: place(:)
      integer :: i, j, top, status

      allocate (place(self%n), stat=status)
      call check_allocation(status)
      do i = 1, self%n
         place(order(i)) = i
      end do
      entries = 0
      cost = 0.0_wp
      do i = 1, self%n
         top = i
         do j = self%first(order(i)), self%first(order(i) + 1) - 1
            top = min(top, place(self%neighbour(j)))
         end do
         entries = entries + i - top + 1
         cost = cost + real(i - top + 1, wp)**2
      end do
   end subroutine order_cost

end module graph
