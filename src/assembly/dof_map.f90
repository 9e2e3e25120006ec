!> Freedoms and equations. A freedom is a direction of a node that some part of the scene needs; an
!> equation is a freedom that is neither prescribed nor eliminated by a linear constraint. All
!> vectors of motion and force have one entry a freedom; only solutions are made on equations.
module dof_map
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use histories, only: equation_type
   implicit none
   private

   public :: dof_map_type, new_dof_map, number_equations, reduce, expand, follow_constraints

   !> Hughes' id array and the transformation u = T q of linear constraints.
   type :: dof_map_type
      integer :: n_freedoms = 0
      integer :: n_eq = 0
      integer, allocatable :: freedom(:, :)      !! (3, n_nodes) freedom number, 0: does not exist
      integer, allocatable :: node(:), dof(:)    !! (n_freedoms) where a freedom is
      integer, allocatable :: id(:, :)           !! (3, n_nodes) equation number, 0: none
      logical, allocatable :: prescribed(:)      !! (n_freedoms)
      integer, allocatable :: first(:)           !! (n_freedoms+1) row pointers of T
      integer, allocatable :: equation(:)        !! columns of T
      real(wp), allocatable :: coefficient(:)    !! entries of T
      integer, allocatable :: dependent(:)       !! eliminated freedoms, one a constraint
      integer, allocatable :: master_first(:)    !! (n_dependent+1)
      integer, allocatable :: master(:)          !! freedoms that a dependent one follows
      real(wp), allocatable :: master_coefficient(:)
   end type dof_map_type

contains

   !> Numbers the freedoms node by node, in the deck's order of nodes.
   pure subroutine new_dof_map(self, needed)
      type(dof_map_type), intent(out) :: self
      logical, intent(in) :: needed(:, :)        !! (3, n_nodes)
      integer :: n, i, j, status

      allocate (self%freedom(3, size(needed, 2)), self%id(3, size(needed, 2)), stat=status)
      call check_allocation(status)
      self%n_freedoms = count(needed)
      allocate (self%node(self%n_freedoms), self%dof(self%n_freedoms), stat=status)
      call check_allocation(status)
      self%freedom = 0
      self%id = 0
      n = 0
      do j = 1, size(needed, 2)
         do i = 1, 3
            if (.not. needed(i, j)) cycle
            n = n + 1
            self%freedom(i, j) = n
            self%node(n) = j
            self%dof(n) = i
         end do
      end do
   end subroutine new_dof_map

   !> Numbers the equations for the given prescribed freedoms and constraints, and builds T. The
   !> equations go through the nodes in the deck's order or in the one given.
   pure subroutine number_equations(self, prescribed, constraints, node_order)
      type(dof_map_type), intent(inout) :: self
      logical, intent(in) :: prescribed(:)       !! (n_freedoms)
      type(equation_type), intent(in) :: constraints(:)
      integer, intent(in), optional :: node_order(:)   !! (n_nodes) a permutation
      integer :: number(self%n_freedoms), f, i, j, node

      self%prescribed = prescribed
      call list_dependents(self, constraints)
      number = 0
      number(self%dependent) = -1
      where (prescribed) number = 0
      self%n_eq = 0
      do j = 1, size(self%freedom, 2)
         node = j
         if (present(node_order)) node = node_order(j)
         do i = 1, 3
            f = self%freedom(i, node)
            if (f == 0) cycle
            if (prescribed(f) .or. number(f) < 0) cycle
            self%n_eq = self%n_eq + 1
            number(f) = self%n_eq
         end do
      end do
      do f = 1, self%n_freedoms
         self%id(self%dof(f), self%node(f)) = max(0, number(f))
      end do
      call build_transformation(self, number)
   end subroutine number_equations

   !> The first freedom of each constraint follows the others.
   pure subroutine list_dependents(self, constraints)
      type(dof_map_type), intent(inout) :: self
      type(equation_type), intent(in) :: constraints(:)
      integer :: c, i, n, status

      if (allocated(self%dependent)) then
         deallocate (self%dependent, self%master_first, self%master, self%master_coefficient)
      end if
      n = 0
      do c = 1, size(constraints)
         n = n + size(constraints(c)%node) - 1
      end do
      allocate (self%dependent(size(constraints)), self%master_first(size(constraints) + 1), &
            stat=status)
      call check_allocation(status)
      allocate (self%master(n), self%master_coefficient(n), stat=status)
      call check_allocation(status)
      n = 0
      do c = 1, size(constraints)
         self%master_first(c) = n + 1
         self%dependent(c) = self%freedom(constraints(c)%dof(1), constraints(c)%node(1))
         do i = 2, size(constraints(c)%node)
            n = n + 1
            self%master(n) = self%freedom(constraints(c)%dof(i), constraints(c)%node(i))
            self%master_coefficient(n) &
                  = -constraints(c)%coefficient(i)/constraints(c)%coefficient(1)
         end do
      end do
      self%master_first(size(constraints) + 1) = n + 1
   end subroutine list_dependents

   !> T by rows: one unit entry for an equation, the masters' entries for a dependent freedom.
   pure subroutine build_transformation(self, number)
      type(dof_map_type), intent(inout) :: self
      integer, intent(in) :: number(:)   !! (n_freedoms) equation, 0 prescribed, -1 dependent
      integer :: c, f, i, n, constraint_of(self%n_freedoms)
      integer :: status

      constraint_of = 0
      do c = 1, size(self%dependent)
         constraint_of(self%dependent(c)) = c
      end do
      if (allocated(self%first)) deallocate (self%first, self%equation, self%coefficient)
      n = self%n_freedoms + size(self%master)
      allocate (self%first(self%n_freedoms + 1), self%equation(n), self%coefficient(n), stat=status)
      call check_allocation(status)
      n = 0
      do f = 1, self%n_freedoms
         self%first(f) = n + 1
         if (number(f) > 0) call append(self, n, number(f), 1.0_wp)
         if (constraint_of(f) == 0) cycle
         c = constraint_of(f)
         do i = self%master_first(c), self%master_first(c + 1) - 1
            if (number(self%master(i)) < 1) cycle
            call append(self, n, number(self%master(i)), self%master_coefficient(i))
         end do
      end do
      self%first(self%n_freedoms + 1) = n + 1
   end subroutine build_transformation

   pure subroutine append(self, n, equation, coefficient)
      type(dof_map_type), intent(inout) :: self
      integer, intent(inout) :: n
      integer, intent(in) :: equation
      real(wp), intent(in) :: coefficient

      n = n + 1
      self%equation(n) = equation
      self%coefficient(n) = coefficient
   end subroutine append

   !> Tt r: forces on freedoms to forces on equations.
   pure function reduce(self, r) result(reduced)
      type(dof_map_type), intent(in) :: self
      real(wp), intent(in) :: r(:)               !! (n_freedoms)
      real(wp) :: reduced(self%n_eq)
      integer :: f, i

      reduced = 0.0_wp
      do f = 1, self%n_freedoms
         do i = self%first(f), self%first(f + 1) - 1
            reduced(self%equation(i)) = reduced(self%equation(i)) + self%coefficient(i)*r(f)
         end do
      end do
   end function reduce

   !> T q: motion of equations to motion of freedoms, prescribed ones at rest.
   pure function expand(self, q) result(u)
      type(dof_map_type), intent(in) :: self
      real(wp), intent(in) :: q(:)               !! (n_eq)
      real(wp) :: u(self%n_freedoms)
      integer :: f, i

      u = 0.0_wp
      do f = 1, self%n_freedoms
         do i = self%first(f), self%first(f + 1) - 1
            u(f) = u(f) + self%coefficient(i)*q(self%equation(i))
         end do
      end do
   end function expand

   !> Gives the dependent freedoms the values that follow from their masters.
   pure subroutine follow_constraints(self, u)
      type(dof_map_type), intent(in) :: self
      real(wp), intent(inout) :: u(:)            !! (n_freedoms)
      integer :: c, from, to

      do c = 1, size(self%dependent)
         from = self%master_first(c)
         to = self%master_first(c + 1) - 1
         u(self%dependent(c)) = dot_product(self%master_coefficient(from:to), &
               u(self%master(from:to)))
      end do
   end subroutine follow_constraints

end module dof_map
