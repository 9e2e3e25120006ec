!> Columns of the compliance of contact rows that stay as they are: on fixed rows of a linear
!> structure they depend on the matrix alone. Those on the mass and on the last few effective
!> matrices are kept.
module compliance_store
   use kinds, only: wp, int64
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: compliance_store_type, choose_shelf, missing_columns, keep_column, add_columns
   public :: begin_batch, shelves_by_age, kept_columns

   integer, parameter :: n_shelves = 4
   !> Largest number of entries kept on one shelf.
   integer(int64), parameter, public :: most_entries = 20000000_int64

   !> Columns on one matrix. Column k belongs to the normal of row k, n_rows + k to its tangent.
   type, public :: shelf_type
      integer(int64) :: generation = -1          !! of the matrices
      real(wp) :: factors(3) = -1.0_wp           !! c_m, c_c, c_k of the matrix
      integer(int64) :: last_use = -1
      integer :: n = 0                           !! columns kept
      integer, allocatable :: place(:)           !! (2 n_rows) of a column, 0: not kept
      integer :: n_batches = 0                   !! of columns that have been found together
      integer, allocatable :: batch(:)           !! (2 n_rows) of the columns kept, in their order
      real(wp), allocatable :: x(:, :)           !! (n_freedoms, n) motion by unit forces
      real(wp), allocatable :: w(:, :)           !! (2 n_rows, n) of all rows
   end type shelf_type

   !> Motions by unit forces in held rows, on the complex matrix of one step size.
   type, public :: complex_columns_type
      real(wp) :: dt = -1.0_wp
      integer(int64) :: generation = -1          !! of the matrices
      integer, allocatable :: rows(:)            !! (n)
      complex(wp), allocatable :: x(:, :)        !! (n_freedoms, n)
      complex(wp), allocatable :: w(:, :)        !! (n, n) along these rows
   end type complex_columns_type

   !> The first shelf is for the mass, which no other matrix drives out.
   type :: compliance_store_type
      type(shelf_type) :: shelves(n_shelves)
      integer(int64) :: clock = 0
   end type compliance_store_type

contains

   !> The shelf of a matrix; an empty one, or the one longest not used, if there is none yet.
   pure subroutine choose_shelf(self, generation, factors, n_rows, shelf)
      type(compliance_store_type), intent(inout) :: self
      integer(int64), intent(in) :: generation
      real(wp), intent(in) :: factors(3)
      integer, intent(in) :: n_rows
      integer, intent(out) :: shelf
      integer :: i

      self%clock = self%clock + 1
      shelf = 1
      if (any(abs(factors(2:3)) > 0.0_wp)) then
         shelf = 1 + minloc(self%shelves(2:)%last_use, dim=1)
         do i = 2, n_shelves
            if (holds(self%shelves(i), generation, factors)) shelf = i
         end do
      end if
      associate (chosen => self%shelves(shelf))
         chosen%last_use = self%clock
         if (holds(chosen, generation, factors)) return
         chosen%generation = generation
         chosen%factors = factors
         chosen%n = 0
         chosen%n_batches = 0
         chosen%place = [(0, i=1, 2*n_rows)]
         chosen%batch = chosen%place
      end associate
   end subroutine choose_shelf

   pure function holds(shelf, generation, factors) result(does)
      type(shelf_type), intent(in) :: shelf
      integer(int64), intent(in) :: generation
      real(wp), intent(in) :: factors(3)
      logical :: does

      does = shelf%generation == generation .and. .not. any(abs(shelf%factors - factors) > 0.0_wp)
   end function holds

   !> Of some columns those that the shelf has not.
   pure function missing_columns(shelf, columns) result(missing)
      type(shelf_type), intent(in) :: shelf
      integer, intent(in) :: columns(:)
      integer, allocatable :: missing(:)

      missing = pack(columns, shelf%place(columns) == 0)
   end function missing_columns

   !> Columns kept from now on are found together.
   pure subroutine begin_batch(shelf)
      type(shelf_type), intent(inout) :: shelf

      shelf%n_batches = shelf%n_batches + 1
   end subroutine begin_batch

   !> The shelves of a generation of matrices, the one used last at the end.
   pure function shelves_by_age(self, generation) result(shelves)
      type(compliance_store_type), intent(in) :: self
      integer(int64), intent(in) :: generation
      integer, allocatable :: shelves(:)
      logical :: left(n_shelves)
      integer :: i, status

      left = self%shelves%generation == generation
      allocate (shelves(count(left)), stat=status)
      call check_allocation(status)
      do i = 1, size(shelves)
         shelves(i) = minloc(self%shelves%last_use, dim=1, mask=left)
         left(shelves(i)) = .false.
      end do
   end function shelves_by_age

   !> The columns on a shelf in the order in which they have been found.
   pure function kept_columns(shelf) result(columns)
      type(shelf_type), intent(in) :: shelf
      integer :: columns(shelf%n)
      integer :: i

      do i = 1, size(shelf%place)
         if (shelf%place(i) > 0) columns(shelf%place(i)) = i
      end do
   end function kept_columns

   !> Keeps a column and what it moves in all rows.
   pure subroutine keep_column(shelf, column, x, w)
      type(shelf_type), intent(inout) :: shelf
      integer, intent(in) :: column
      real(wp), intent(in) :: x(:)               !! (n_freedoms)
      real(wp), intent(in) :: w(:)               !! (2 n_rows)

      shelf%n = shelf%n + 1
      call make_room(shelf%x, size(x), shelf%n)
      call make_room(shelf%w, size(w), shelf%n)
      shelf%place(column) = shelf%n
      shelf%batch(shelf%n) = shelf%n_batches
      shelf%x(:, shelf%n) = x
      shelf%w(:, shelf%n) = w
   end subroutine keep_column

   !> The sum of some columns with factors: four at a time, for the sum goes to memory and back.
   pure subroutine add_columns(shelf, places, factors, total)
      type(shelf_type), intent(in) :: shelf
      integer, intent(in) :: places(:)
      real(wp), intent(in) :: factors(:)
      real(wp), intent(out) :: total(:)          !! (n_freedoms)
      integer :: i, j, whole

      total = 0.0_wp
      whole = size(places) - modulo(size(places), 4)
      associate (x => shelf%x)
         do j = 1, whole, 4
            associate (a => places(j), b => places(j + 1), c => places(j + 2), d => places(j + 3))
               do i = 1, size(total)
                  total(i) = total(i) + factors(j)*x(i, a) + factors(j + 1)*x(i, b) &
                        + factors(j + 2)*x(i, c) + factors(j + 3)*x(i, d)
               end do
            end associate
         end do
         do j = whole + 1, size(places)
            do i = 1, size(total)
               total(i) = total(i) + factors(j)*x(i, places(j))
            end do
         end do
      end associate
   end subroutine add_columns

   !> Room for n columns, doubled where it is too small.
   pure subroutine make_room(a, m, n)
      real(wp), allocatable, intent(inout) :: a(:, :)
      integer, intent(in) :: m, n
      real(wp), allocatable :: larger(:, :)
      integer :: status

      if (allocated(a)) then
         if (size(a, 1) == m .and. size(a, 2) >= n) return
         if (size(a, 1) /= m) deallocate (a)
      end if
      allocate (larger(m, max(8, 2*(n - 1))), stat=status)
      call check_allocation(status)
      if (allocated(a)) larger(:, :n - 1) = a(:, :n - 1)
      call move_alloc(larger, a)
   end subroutine make_room

end module compliance_store
