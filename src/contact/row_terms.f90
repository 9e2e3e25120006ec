!> Contact rows as linear forms of nodal motion: what a row asks of which node.
module row_terms
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: row_terms_type, start_terms, start_row_terms, add_term

   !> Rows over nodes: gap rate = sum normal . v, slip rate = sum tangent . v. The force of a row on
   !> a node is its normal vector times the contact force.
   type :: row_terms_type
      integer :: n = 0                           !! rows
      integer, allocatable :: first(:)           !! (n+1) row i has the terms first(i):first(i+1)-1
      integer, allocatable :: node(:)            !! (n_terms) node index
      real(wp), allocatable :: normal(:, :)      !! (3, n_terms)
      real(wp), allocatable :: tangent(:, :)     !! (3, n_terms)
      real(wp), allocatable :: turning(:, :)     !! (3, n_terms) how the partner's normal turns
      real(wp), allocatable :: gap(:)            !! (n) at the positions the rows were made for
      logical, allocatable :: facing(:)          !! (n) has a partner
      logical, allocatable :: at_rest(:)         !! (n) the gap is that of zero displacements
      real(wp), allocatable :: bend(:)           !! (n) n . x'' of the partner, by arc length
      real(wp), allocatable :: direction(:, :)   !! (3, n) unit normal at the contactor
      real(wp), allocatable :: along(:, :)       !! (3, n) unit tangent
      real(wp), allocatable :: weight(:)         !! (n) length that the row stands for, 0: unknown
   end type row_terms_type

contains

   !> Empty rows without partners.
   pure subroutine start_terms(self, n)
      type(row_terms_type), intent(inout) :: self
      integer, intent(in) :: n                   !! rows
      integer :: status

      if (.not. allocated(self%first)) then
         allocate (self%first(n + 1), self%gap(n), self%facing(n), self%bend(n), stat=status)
         call check_allocation(status)
         allocate (self%weight(n), self%at_rest(n), stat=status)
         call check_allocation(status)
         allocate (self%direction(3, n), self%along(3, n), stat=status)
         call check_allocation(status)
         allocate (self%node(4*n), self%normal(3, 4*n), stat=status)
         call check_allocation(status)
         allocate (self%tangent(3, 4*n), self%turning(3, 4*n), stat=status)
         call check_allocation(status)
      end if
      self%n = n
      self%first = 1
      self%gap = 0.0_wp
      self%facing = .false.
      self%at_rest = .false.
      self%bend = 0.0_wp
      self%weight = 0.0_wp
      self%direction = 0.0_wp
      self%along = 0.0_wp
   end subroutine start_terms

   !> Row i begins where row i - 1 has ended.
   pure subroutine start_row_terms(self, i)
      type(row_terms_type), intent(inout) :: self
      integer, intent(in) :: i

      self%first(i + 1) = self%first(i)
   end subroutine start_row_terms

   !> Appends a node to row i, the last one started.
   pure subroutine add_term(self, i, node, normal, tangent, turning)
      type(row_terms_type), intent(inout) :: self
      integer, intent(in) :: i, node
      real(wp), intent(in) :: normal(3), tangent(3), turning(3)
      integer :: k

      k = self%first(i + 1)
      if (k > size(self%node)) call grow(self)
      self%node(k) = node
      self%normal(:, k) = normal
      self%tangent(:, k) = tangent
      self%turning(:, k) = turning
      self%first(i + 1) = k + 1
   end subroutine add_term

   pure subroutine grow(self)
      type(row_terms_type), intent(inout) :: self
      integer :: n

      n = size(self%node)
      self%node = [self%node, self%node, 0]
      call double(self%normal)
      call double(self%tangent)
      call double(self%turning)

   contains

      pure subroutine double(vectors)
         real(wp), allocatable, intent(inout) :: vectors(:, :)
         real(wp), allocatable :: longer(:, :)
         integer :: status

         allocate (longer(3, 2*n + 1), stat=status)
         call check_allocation(status)
         longer(:, :n) = vectors
         call move_alloc(longer, vectors)
      end subroutine double

   end subroutine grow

end module row_terms
