!> The structure as a mechanical system: its freedoms, element groups and mass, and what they
!> answer: forces, matrices, energies.
module structure
   use kinds, only: wp
   use errors, only: error_type
   use text, only: to_text
   use memory_shortage, only: check_allocation
   use places, only: fail_at
   use mesh, only: scheme_implicit, scheme_explicit
   use model, only: model_type
   use element_groups, only: group_type, build_groups, group_mass
   use needed_freedoms, only: find_needed_freedoms
   use redistributed_mass, only: redistribute_mass
   use dof_map, only: dof_map_type, new_dof_map
   use element_chunks, only: new_chunks, add_forces_of_chunks
   use sparse_operator, only: sparse_operator_type, add_product
   use consistent_mass, only: build_consistent_mass
   implicit none
   private

   public :: structure_type, new_structure
   public :: elastic_force, damping_force, inertia_force, gather
   public :: group_history, freedom_name, diagonal_mass, least_mass
   public :: count_resisting, is_explicit

   !> Everything that does not change from step to step, and the numbering that may.
   type :: structure_type
      type(dof_map_type) :: map
      type(group_type), allocatable :: groups(:)
      real(wp), allocatable :: lumped_mass(:)    !! (n_freedoms) of the lumped groups
      type(sparse_operator_type) :: coupled_mass !! of the other groups, where it is kept
      logical :: has_consistent_mass = .false.
      logical :: is_linear = .true.
      integer :: n_history = 0                   !! history variables of all elements
      integer, allocatable :: node_id(:)         !! the deck's node ids, for messages
   end type structure_type

contains

   !> Builds groups, freedoms and mass. Errors: zero-length elements, empty freedoms, mass that
   !> cannot be redistributed.
   subroutine new_structure(self, model, error, automatic)
      type(structure_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer, intent(in), optional :: automatic(:)   !! (n_elements) scheme in place of AUTO
      logical, allocatable :: needed(:, :)
      logical :: lumped_default
      integer :: i, g, status

      lumped_default = .false.
      do i = 1, size(model%steps)
         lumped_default = lumped_default .or. model%steps(i)%explicit
      end do
      if (present(automatic)) then
         call build_groups(self%groups, model, lumped_default, error, automatic)
      else
         call build_groups(self%groups, model, lumped_default, error)
      end if
      if (allocated(error)) return
      call redistribute_mass(self%groups, model, error)
      if (allocated(error)) return
      call find_needed_freedoms(model, self%groups, needed)
      call new_dof_map(self%map, needed)
      self%node_id = model%nodes%id(:model%nodes%n)
      do g = 1, size(self%groups)
         call locate(self%groups(g), self%map)
         associate (group => self%groups(g))
            group%resists = any(group%element%uses(1))
            if (group%element%blocks%n_chunks > 0) call new_chunks(group%chunks, &
                  group%element%blocks, group%ien, group%lm)
         end associate
         self%has_consistent_mass = self%has_consistent_mass .or. .not. self%groups(g)%lumped
         self%is_linear = self%is_linear .and. self%groups(g)%element%linear
         self%groups(g)%history_start = self%n_history
         self%n_history = self%n_history &
               + self%groups(g)%element%n_history*self%groups(g)%element%n_elements
      end do
      call build_consistent_mass(self%groups, self%map%n_freedoms, self%coupled_mass)
      allocate (self%lumped_mass(self%map%n_freedoms), stat=status)
      call check_allocation(status)
      self%lumped_mass = 0.0_wp
      do g = 1, size(self%groups)
         if (self%groups(g)%lumped) call add_lumped(self%groups(g), 1.0_wp, self%lumped_mass)
      end do
      call check_freedoms(self, model, error)
   end subroutine new_structure

   !> Elements with forces in the groups of a scheme.
   pure function count_resisting(self, scheme) result(n)
      type(structure_type), intent(in) :: self
      integer, intent(in) :: scheme              !! scheme_implicit or scheme_explicit
      integer :: n
      integer :: g

      n = 0
      do g = 1, size(self%groups)
         if (self%groups(g)%scheme /= scheme .or. .not. self%groups(g)%resists) cycle
         n = n + size(self%groups(g)%member)
      end do
   end function count_resisting

   !> Whether nothing that resists is implicit.
   pure logical function is_explicit(self)
      type(structure_type), intent(in) :: self

      is_explicit = any(self%groups%scheme == scheme_explicit) .and. &
            count_resisting(self, scheme_implicit) == 0
   end function is_explicit

   !> The lm array: freedoms of every element of a group.
   subroutine locate(group, map)
      type(group_type), intent(inout) :: group
      type(dof_map_type), intent(in) :: map
      integer :: e, i, status

      allocate (group%lm(3*size(group%ien, 1), size(group%member)), stat=status)
      call check_allocation(status)
      do e = 1, size(group%member)
         do i = 1, size(group%ien, 1)
            group%lm(3*i - 2:3*i, e) = map%freedom(:, group%ien(i, e))
         end do
      end do
   end subroutine locate

   !> A freedom must have stiffness, damping or mass, unless a condition or constraint holds it.
   subroutine check_freedoms(self, model, error)
      type(structure_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      logical :: carried(self%map%n_freedoms)
      integer :: f, i

      call find_carried(self, carried)
      do i = 1, size(model%boundaries)
         call mark(model%boundaries(i)%dof, model%boundaries(i)%node)
      end do
      do i = 1, size(model%equations)
         call mark(model%equations(i)%dof(1), model%equations(i)%node(1))
      end do
      do f = 1, size(carried)
         if (carried(f)) cycle
         call fail_at(error, model%source, model%nodes%place(self%map%node(f)), &
               freedom_name(self, f)//' has neither stiffness nor mass', &
               'give it a mass, a spring or an element with stiffness, or fix it with *BOUNDARY')
         return
      end do

   contains

      subroutine mark(dof, node)
         integer, intent(in) :: dof, node

         if (self%map%freedom(dof, node) > 0) carried(self%map%freedom(dof, node)) = .true.
      end subroutine mark

   end subroutine check_freedoms

   !> Freedoms with an entry on the diagonal of M, C or K, or on a nonlinear element.
   subroutine find_carried(self, carried)
      type(structure_type), intent(in) :: self
      logical, intent(out) :: carried(:)
      integer :: g, e, i, status
      real(wp), allocatable :: k(:, :), m(:, :), c(:, :)
      logical :: entry

      carried = self%lumped_mass > 0.0_wp
      do g = 1, size(self%groups)
         associate (group => self%groups(g))
            i = size(group%lm, 1)
            allocate (k(i, i), m(i, i), c(i, i), stat=status)
            call check_allocation(status)
            do e = 1, size(group%member)
               if (all(carried(pack(group%lm(:, e), group%lm(:, e) > 0)))) cycle
               call group%element%largest_stiffness(e, k)
               call group%element%damping(e, c)
               call group_mass(group, e, group%lumped, m)
               do i = 1, size(group%lm, 1)
                  entry = abs(k(i, i)) + abs(c(i, i)) + m(i, i) > 0.0_wp
                  entry = entry .or. .not. group%element%linear
                  if (group%lm(i, e) > 0 .and. entry) carried(group%lm(i, e)) = .true.
               end do
            end do
            deallocate (k, m, c)
         end associate
      end do
   end subroutine find_carried

   !> Values on freedoms gathered to the elements of a group.
   pure subroutine gather(group, u, local)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: u(:)               !! (n_freedoms)
      real(wp), intent(out) :: local(:, :)       !! (3 n_nodes, n_elements)
      integer :: e, i

      do e = 1, size(group%lm, 2)
         do i = 1, size(group%lm, 1)
            local(i, e) = 0.0_wp
            if (group%lm(i, e) > 0) local(i, e) = u(group%lm(i, e))
         end do
      end do
   end subroutine gather

   !> Adds element forces into forces on freedoms.
   pure subroutine scatter(group, local, force)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: local(:, :)
      real(wp), intent(inout) :: force(:)
      integer :: e, i

      do e = 1, size(group%lm, 2)
         do i = 1, size(group%lm, 1)
            if (group%lm(i, e) == 0) cycle
            force(group%lm(i, e)) = force(group%lm(i, e)) + local(i, e)
         end do
      end do
   end subroutine scatter

   !> The history of a group's elements in the history of all.
   pure function group_history(group, history) result(part)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: history(:)         !! of all elements
      real(wp) :: part(group%element%n_history, group%element%n_elements)

      part = reshape(history(group%history_start + 1:group%history_start + size(part)), shape(part))
   end function group_history

   !> Adds S(d) of the groups of a scheme and updates their history from the last accepted one; and,
   !> if asked for, their strain energy and plastic work at d.
   subroutine elastic_force(self, scheme, d, history, force, updated, energy)
      type(structure_type), intent(in) :: self
      integer, intent(in) :: scheme              !! scheme_implicit or scheme_explicit
      real(wp), intent(in) :: d(:)               !! (n_freedoms)
      real(wp), intent(in), contiguous :: history(:)        !! (n_history) last accepted
      real(wp), intent(inout), contiguous :: force(:)       !! (n_freedoms)
      real(wp), intent(inout), contiguous :: updated(:)     !! (n_history) at d, in this scheme
      real(wp), intent(inout), optional :: energy(2)        !! strain energy, plastic work
      real(wp) :: part(2)
      integer :: g, from, to

      do g = 1, size(self%groups)
         associate (group => self%groups(g))
            if (group%scheme /= scheme .or. .not. group%resists) cycle
            if (group%chunks%n == 0) then
               call add_one_by_one(group, d, history, force, updated, energy)
               cycle
            end if
            from = group%history_start + 1
            to = group%history_start + group%element%n_history*group%element%n_elements
            part = 0.0_wp
            call add_forces_of_chunks(group%chunks, group%element, d, history(from:to), force, &
                  updated(from:to), part)
            if (present(energy)) energy = energy + part
         end associate
      end do
   end subroutine elastic_force

   !> The same of one group whose elements have no chunks.
   pure subroutine add_one_by_one(group, d, history, force, updated, energy)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: d(:), history(:)
      real(wp), intent(inout) :: force(:), updated(:)
      real(wp), intent(inout), optional :: energy(2)
      real(wp), dimension(size(group%lm, 1), size(group%lm, 2)) :: local, local_force
      real(wp), dimension(group%element%n_history, group%element%n_elements) :: memory
      integer :: n

      call gather(group, d, local)
      call group%element%internal_force(local, group_history(group, history), local_force, memory)
      call scatter(group, local_force, force)
      n = size(memory)
      updated(group%history_start + 1:group%history_start + n) = reshape(memory, [n])
      if (present(energy)) energy = energy + [group%element%strain_energy(local, memory), &
            group%element%plastic_work(memory)]
   end subroutine add_one_by_one

   !> Adds C v of the groups of a scheme.
   pure subroutine damping_force(self, scheme, v, force)
      type(structure_type), intent(in) :: self
      integer, intent(in) :: scheme
      real(wp), intent(in) :: v(:)               !! (n_freedoms)
      real(wp), intent(inout) :: force(:)        !! (n_freedoms)
      real(wp), allocatable :: local(:, :)
      integer :: g, e, status

      do g = 1, size(self%groups)
         if (self%groups(g)%scheme /= scheme .or. size(self%groups(g)%damping) == 0) cycle
         allocate (local(size(self%groups(g)%lm, 1), size(self%groups(g)%lm, 2)), stat=status)
         call check_allocation(status)
         call gather(self%groups(g), v, local)
         do e = 1, size(local, 2)
            local(:, e) = matmul(self%groups(g)%damping(:, :, e), local(:, e))
         end do
         call scatter(self%groups(g), local, force)
         deallocate (local)
      end do
   end subroutine damping_force

   !> M a of all groups.
   pure function inertia_force(self, a) result(force)
      type(structure_type), intent(in) :: self
      real(wp), intent(in) :: a(:)               !! (n_freedoms)
      real(wp) :: force(size(a))
      real(wp), allocatable :: local(:, :), m(:, :)
      integer :: g, e, status

      force = self%lumped_mass*a
      if (self%coupled_mass%n > 0) then
         call add_product(self%coupled_mass, a, force)
         return
      end if
      do g = 1, size(self%groups)
         if (self%groups(g)%lumped) cycle
         allocate (local(size(self%groups(g)%lm, 1), size(self%groups(g)%lm, 2)), stat=status)
         call check_allocation(status)
         allocate (m(size(local, 1), size(local, 1)), stat=status)
         call check_allocation(status)
         call gather(self%groups(g), a, local)
         do e = 1, size(local, 2)
            call group_mass(self%groups(g), e, .false., m)
            local(:, e) = matmul(m, local(:, e))
         end do
         call scatter(self%groups(g), local, force)
         deallocate (local, m)
      end do
   end function inertia_force

   !> Mass of each freedom with every group lumped.
   pure function diagonal_mass(self) result(m)
      type(structure_type), intent(in) :: self
      real(wp) :: m(self%map%n_freedoms)
      integer :: g

      m = self%lumped_mass
      do g = 1, size(self%groups)
         if (.not. self%groups(g)%lumped) call add_lumped(self%groups(g), 1.0_wp, m)
      end do
   end function diagonal_mass

   !> A diagonal mass nowhere above the true one: of a consistent matrix at least a share of the
   !> lumped one is left in any motion.
   pure function least_mass(self) result(m)
      type(structure_type), intent(in) :: self
      real(wp) :: m(self%map%n_freedoms)
      integer :: g

      m = self%lumped_mass
      do g = 1, size(self%groups)
         if (.not. self%groups(g)%lumped) call add_lumped(self%groups(g), &
               self%groups(g)%element%least_mass_share, m)
      end do
   end function least_mass

   !> Adds a part of the lumped mass of a group, and all of the mass that redistribution added.
   pure subroutine add_lumped(group, part, mass)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: part
      real(wp), intent(inout) :: mass(:)         !! (n_freedoms)
      real(wp) :: m(size(group%lm, 1), size(group%lm, 1))
      integer :: e, i

      do e = 1, size(group%member)
         call group_mass(group, e, .true., m, part)
         do i = 1, size(m, 1)
            if (group%lm(i, e) == 0) cycle
            mass(group%lm(i, e)) = mass(group%lm(i, e)) + m(i, i)
         end do
      end do
   end subroutine add_lumped

   !> "node 7, freedom 2", for messages.
   pure function freedom_name(self, f) result(name)
      type(structure_type), intent(in) :: self
      integer, intent(in) :: f
      character(len=:), allocatable :: name

      name = 'node '//to_text(self%node_id(self%map%node(f)))//', freedom ' &
            //to_text(self%map%dof(f))
   end function freedom_name

end module structure
