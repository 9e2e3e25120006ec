!> Orders of the vertices of a graph that keep the profile of its matrix small: the reverse of
!> Cuthill and McKee's, and Sloan's (Int. J. Numer. Meth. Engng 23 (1986) 239-251, 28 (1989)
!> 2651-2679). Both start at the ends of long, narrow level structures.
module renumbering
   use kinds, only: wp, int64
   use memory_shortage, only: check_allocation
   use graph, only: graph_type, degree, walk_levels, sort_by_degree, order_cost
   use priority_queue, only: queue_type, new_queue
   implicit none
   private

   public :: cuthill_mckee_order, sloan_order, find_ends

   !> Vertices of the last level tried as the other end, and restarts of the search for ends.
   integer, parameter :: max_candidates = 5, max_restarts = 40

   !> Weights of the distance to the end and of the growth of the front: Sloan's, and those of Reid
   !> and Scott for graphs where the distance tells more.
   integer, parameter :: weights(2, 2) = reshape([1, 2, 16, 1], [2, 2])

   integer, parameter :: inactive = 0, preactive = 1, active = 2, numbered = 3

contains

   !> Reverse Cuthill-McKee: order(i) is the vertex at place i. Isolated vertices and parts that
   !> hang together by nothing come one after the other.
   pure function cuthill_mckee_order(graph) result(order)
      type(graph_type), intent(in) :: graph
      integer :: order(graph%n)
      type(graph_type) :: sorted
      integer, allocatable :: distance(:), level_first(:)
      integer :: v, n, n_part, ends(2), status
      logical, allocatable :: done(:)

      sorted = graph
      call sort_by_degree(sorted)
      allocate (distance(graph%n), done(graph%n), stat=status)
      call check_allocation(status)
      distance = -1
      done = .false.
      n = 0
      do v = 1, graph%n
         if (done(v)) cycle
         call find_ends(graph, v, distance, order(n + 1:), ends)
         call walk_levels(sorted, ends(1), distance, order(n + 1:), n_part, level_first)
         order(n + 1:n + n_part) = order(n + n_part:n + 1:-1)
         done(order(n + 1:n + n_part)) = .true.
         n = n + n_part
      end do
   end function cuthill_mckee_order

   !> Sloan's order, by the weights that give the cheaper factorization.
   pure function sloan_order(graph) result(order)
      type(graph_type), intent(in) :: graph
      integer :: order(graph%n)
      integer :: trial(graph%n), w
      integer(int64) :: entries
      real(wp) :: cost, best

      best = huge(best)
      do w = 1, size(weights, 2)
         trial = order_by_weights(graph, weights(:, w))
         call order_cost(graph, trial, entries, cost)
         if (cost >= best) cycle
         best = cost
         order = trial
      end do
   end function sloan_order

   pure function order_by_weights(graph, weight) result(order)
      type(graph_type), intent(in) :: graph
      integer, intent(in) :: weight(2)
      integer :: order(graph%n)
      type(queue_type) :: queue
      integer, allocatable :: distance(:), state(:), reached(:), level_first(:)
      integer :: v, n, n_part, level, i, ends(2), status

      allocate (distance(graph%n), state(graph%n), reached(graph%n), stat=status)
      call check_allocation(status)
      distance = -1
      state = inactive
      call new_queue(queue, [(-weight(2)*(degree(graph, v) + 1), v=1, graph%n)])
      n = 0
      do v = 1, graph%n
         if (state(v) /= inactive) cycle
         call find_ends(graph, v, distance, reached, ends)
         call walk_levels(graph, ends(2), distance, reached, n_part, level_first)
         do level = 2, size(level_first) - 1
            do i = level_first(level), level_first(level + 1) - 1
               queue%priority(reached(i)) = queue%priority(reached(i)) + weight(1)*(level - 1)
            end do
         end do
         call number_part(graph, ends(1), weight(2), queue, state, order, n)
      end do
   end function order_by_weights

   !> Numbers all that hangs together with the start: always the vertex that adds least to the front
   !> of active vertices and lies farthest from the end.
   pure subroutine number_part(graph, start, weight, queue, state, order, n)
      type(graph_type), intent(in) :: graph
      integer, intent(in) :: start, weight
      type(queue_type), intent(inout) :: queue
      integer, intent(inout) :: state(:), order(:), n
      integer :: v, i, w

      call wake(queue, state, start)
      do while (queue%n_queued > 0)
         call queue%take(v)
         if (state(v) == preactive) call favour_neighbours(graph, v, weight, queue, state)
         n = n + 1
         order(n) = v
         state(v) = numbered
         do i = graph%first(v), graph%first(v + 1) - 1
            w = graph%neighbour(i)
            if (state(w) /= preactive) cycle
            state(w) = active
            call queue%raise(w, weight)
            call favour_neighbours(graph, w, weight, queue, state)
         end do
      end do
   end subroutine number_part

   !> v has come to the front: one vertex less to come for each of its neighbours.
   pure subroutine favour_neighbours(graph, v, weight, queue, state)
      type(graph_type), intent(in) :: graph
      integer, intent(in) :: v, weight
      type(queue_type), intent(inout) :: queue
      integer, intent(inout) :: state(:)
      integer :: i, w

      do i = graph%first(v), graph%first(v + 1) - 1
         w = graph%neighbour(i)
         if (state(w) == numbered) cycle
         call queue%raise(w, weight)
         if (state(w) == inactive) call wake(queue, state, w)
      end do
   end subroutine favour_neighbours

   pure subroutine wake(queue, state, v)
      type(queue_type), intent(inout) :: queue
      integer, intent(inout) :: state(:)
      integer, intent(in) :: v

      state(v) = preactive
      call queue%insert(v)
   end subroutine wake

   !> Two vertices far apart in the part of a given vertex: the level structure from the first is
   !> as long as could be found, that from the second the narrowest of that length.
   pure subroutine find_ends(graph, seed, distance, reached, ends)
      type(graph_type), intent(in) :: graph
      integer, intent(in) :: seed
      integer, intent(inout) :: distance(:)      !! all -1, work space
      integer, intent(inout) :: reached(:)       !! room for all vertices of the part
      integer, intent(out) :: ends(2)
      integer, allocatable :: level_first(:), candidates(:), levels(:)
      integer :: n_part, n_levels, width, restart, c

      call walk_levels(graph, seed, distance, reached, n_part, level_first)
      ends(1) = reached(minloc(degree(graph, reached(:n_part)), dim=1))
      do restart = 1, max_restarts
         call walk_levels(graph, ends(1), distance, reached, n_part, level_first)
         n_levels = size(level_first)
         candidates = pick_candidates(graph, reached(level_first(n_levels - 1):n_part))
         width = huge(width)
         do c = 1, size(candidates)
            call walk_levels(graph, candidates(c), distance, reached, n_part, levels)
            if (size(levels) > n_levels) exit
            if (maxval(levels(2:) - levels(:size(levels) - 1)) >= width) cycle
            width = maxval(levels(2:) - levels(:size(levels) - 1))
            ends(2) = candidates(c)
         end do
         if (c > size(candidates)) return
         if (restart < max_restarts) ends(1) = candidates(c)
      end do
      ends(2) = candidates(c)
   end subroutine find_ends

   !> A few vertices of ascending degree, one of each degree (Duff, Reid and Scott).
   pure function pick_candidates(graph, level) result(candidates)
      type(graph_type), intent(in) :: graph
      integer, intent(in) :: level(:)
      integer, allocatable :: candidates(:)
      integer :: degrees(size(level)), i, lowest, status

      degrees = degree(graph, level)
      allocate (candidates(0), stat=status)
      call check_allocation(status)
      do i = 1, max_candidates
         if (.not. any(degrees < huge(1))) return
         lowest = minval(degrees)
         candidates = [candidates, level(findloc(degrees, lowest, dim=1))]
         where (degrees == lowest) degrees = huge(1)
      end do
   end function pick_candidates

end module renumbering
