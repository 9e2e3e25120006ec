!> Forces of a group of elements, chunk after chunk or one thread a chunk. Every chunk has a
!> numbering of its own nodes. What it adds to a freedom that no other chunk has goes there at once;
!> freedoms of several chunks get their parts in the order of the chunks at the end: no sum depends
!> on the number of threads.
module element_chunks
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use element_blocks, only: blocks_type
   use element_interface, only: element_type
   implicit none
   private

   public :: chunks_type, new_chunks, add_forces_of_chunks, fewest_for_threads

   !> Nodes of all elements, counted in each, from which on threads are worth their waking up.
   integer, parameter :: fewest_for_threads = 12000

   !> Nodes of chunk c are first_node(c) to first_node(c + 1) - 1 of the lists, its elements
   !> first_element(c) to first_element(c + 1) - 1 of the order in which the group works.
   type :: chunks_type
      integer :: n = 0
      integer :: most_nodes = 0                  !! of a chunk
      integer, allocatable :: first_element(:)   !! (n + 1)
      integer, allocatable :: first_node(:)      !! (n + 1)
      integer, allocatable :: ien(:, :)          !! (n_nodes, n_elements) numbered in the chunk
      integer, allocatable :: freedom(:, :)      !! (2, nodes of all chunks)
      integer, allocatable :: place(:, :)        !! (2, ..) freedom, or less a slot of a shared one
      integer, allocatable :: shared(:)          !! freedoms of several chunks
      integer, allocatable :: first_slot(:)      !! (n_shared + 1), by chunk for each of them
   end type chunks_type

contains

   !> The chunks of a group that has their order.
   pure subroutine new_chunks(self, blocks, ien, lm)
      type(chunks_type), intent(out) :: self
      type(blocks_type), intent(in) :: blocks
      integer, intent(in) :: ien(:, :)           !! (n_nodes, n_elements) nodes of the model
      integer, intent(in) :: lm(:, :)            !! (3 n_nodes, n_elements) freedoms
      integer, allocatable :: number(:), node(:)
      integer :: c, k, i, e, n, status

      self%n = blocks%n_chunks
      self%first_element = blocks%first(blocks%chunk_first)
      allocate (self%first_node(self%n + 1), self%ien(size(ien, 1), size(ien, 2)), stat=status)
      call check_allocation(status)
      allocate (number(maxval(ien)), node(size(ien)), self%freedom(2, size(ien)), stat=status)
      call check_allocation(status)
      number = 0
      n = 0
      do c = 1, self%n
         self%first_node(c) = n + 1
         do k = self%first_element(c), self%first_element(c + 1) - 1
            e = blocks%order(k)
            do i = 1, size(ien, 1)
               if (number(ien(i, e)) < self%first_node(c)) then
                  n = n + 1
                  number(ien(i, e)) = n
                  node(n) = ien(i, e)
                  self%freedom(:, n) = lm(3*i - 2:3*i - 1, e)
               end if
               self%ien(i, k) = number(ien(i, e)) - self%first_node(c) + 1
            end do
         end do
         self%most_nodes = max(self%most_nodes, n - self%first_node(c) + 1)
      end do
      self%first_node(self%n + 1) = n + 1
      self%freedom = self%freedom(:, :n)
      call share_out(self)
   end subroutine new_chunks

   !> Slots for the freedoms of several chunks.
   pure subroutine share_out(self)
      type(chunks_type), intent(inout) :: self
      integer, allocatable :: times(:), next(:)
      integer :: k, j, f, n_shared, n_slots, status

      allocate (times(maxval(self%freedom)), self%place(2, size(self%freedom, 2)), stat=status)
      call check_allocation(status)
      times = 0
      do k = 1, size(self%freedom, 2)
         times(self%freedom(:, k)) = times(self%freedom(:, k)) + 1
      end do
      allocate (self%shared(count(times > 1)), self%first_slot(count(times > 1) + 1), &
            next(size(times)), stat=status)
      call check_allocation(status)
      n_shared = 0
      n_slots = 0
      do f = 1, size(times)
         if (times(f) < 2) cycle
         n_shared = n_shared + 1
         self%shared(n_shared) = f
         self%first_slot(n_shared) = n_slots + 1
         next(f) = n_slots + 1
         n_slots = n_slots + times(f)
      end do
      self%first_slot(n_shared + 1) = n_slots + 1
      do k = 1, size(self%freedom, 2)
         do j = 1, 2
            f = self%freedom(j, k)
            self%place(j, k) = f
            if (times(f) < 2) cycle
            self%place(j, k) = -next(f)
            next(f) = next(f) + 1
         end do
      end do
   end subroutine share_out

   !> Adds the forces of all elements of a group, their strain energy and their plastic work.
   subroutine add_forces_of_chunks(self, element, d, history, force, updated, energy)
      type(chunks_type), intent(in) :: self
      class(element_type), intent(in) :: element
      real(wp), intent(in) :: d(:)               !! (n_freedoms)
      real(wp), intent(in) :: history(element%n_history, element%n_elements)   !! last accepted
      real(wp), intent(inout) :: force(:)        !! (n_freedoms)
      real(wp), intent(inout) :: updated(element%n_history, element%n_elements)   !! at d
      real(wp), intent(inout) :: energy(2)       !! strain energy, plastic work
      real(wp) :: part(2, self%n), slots(self%first_slot(size(self%first_slot)) - 1)
      integer :: c, i

      !$omp parallel if (size(self%ien) > fewest_for_threads)
      !$omp do schedule(dynamic)
      do c = 1, self%n
         call add_chunk(self, element, c, d, history, force, updated, slots, part(:, c))
      end do
      !$omp end do
      !$omp do schedule(static)
      do i = 1, size(self%shared)
         force(self%shared(i)) = force(self%shared(i)) &
               + sum(slots(self%first_slot(i):self%first_slot(i + 1) - 1))
      end do
      !$omp end do
      !$omp end parallel
      energy = energy + sum(part, 2)
   end subroutine add_forces_of_chunks

   subroutine add_chunk(self, element, c, d, history, force, updated, slots, energy)
      type(chunks_type), intent(in) :: self
      class(element_type), intent(in) :: element
      integer, intent(in) :: c
      real(wp), intent(in) :: d(:), history(element%n_history, element%n_elements)
      real(wp), intent(inout) :: force(:), updated(element%n_history, element%n_elements)
      real(wp), intent(inout) :: slots(:)
      real(wp), intent(out) :: energy(2)
      real(wp) :: u(2, self%first_node(c + 1) - self%first_node(c)), f(2, size(u, 2))
      real(wp) :: found(2)                       !! apart from where other threads write
      integer :: i, j, before

      before = self%first_node(c) - 1
      do i = 1, size(u, 2)
         u(1, i) = d(self%freedom(1, before + i))
         u(2, i) = d(self%freedom(2, before + i))
      end do
      f = 0.0_wp
      found = 0.0_wp
      call element%add_chunk_forces(c, &
            self%ien(:, self%first_element(c):self%first_element(c + 1) - 1), u, history, f, &
            updated, found)
      energy = found
      do i = 1, size(u, 2)
         do j = 1, 2
            associate (place => self%place(j, before + i))
               if (place > 0) then
                  force(place) = force(place) + f(j, i)
               else
                  slots(-place) = f(j, i)
               end if
            end associate
         end do
      end do
   end subroutine add_chunk

end module element_chunks
