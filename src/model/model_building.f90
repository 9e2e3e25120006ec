!> Putting a model together: appending in amortised constant time, and sorting.
module model_building
   use memory_shortage, only: check_allocation
   use histories, only: boundary_type, nodal_value_type
   use places, only: place_type
   implicit none
   private

   public :: append, fit, sort_unique

   !> Puts an item behind the first n of a list that grows by doubling; n counts on.
   interface append
      module procedure :: append_integer, append_boundary, append_nodal_value, append_place
   end interface append

   !> Cuts a list to its first n items; afterwards it is allocated.
   interface fit
      module procedure :: fit_integers, fit_boundaries, fit_nodal_values
   end interface fit

contains

   pure subroutine append_integer(list, n, item)
      integer, allocatable, intent(inout) :: list(:)
      integer, intent(inout) :: n
      integer, intent(in) :: item
      integer, allocatable :: longer(:)
      integer :: status

      if (.not. allocated(list)) then
         allocate (list(8), stat=status)
         call check_allocation(status)
      end if
      if (n == size(list)) then
         allocate (longer(grown(n)), stat=status)
         call check_allocation(status)
         longer(:n) = list
         call move_alloc(longer, list)
      end if
      n = n + 1
      list(n) = item
   end subroutine append_integer

   pure subroutine append_boundary(list, n, item)
      type(boundary_type), allocatable, intent(inout) :: list(:)
      integer, intent(inout) :: n
      type(boundary_type), intent(in) :: item
      type(boundary_type), allocatable :: longer(:)
      integer :: status

      if (.not. allocated(list)) then
         allocate (list(8), stat=status)
         call check_allocation(status)
      end if
      if (n == size(list)) then
         allocate (longer(grown(n)), stat=status)
         call check_allocation(status)
         longer(:n) = list
         call move_alloc(longer, list)
      end if
      n = n + 1
      list(n) = item
   end subroutine append_boundary

   pure subroutine append_nodal_value(list, n, item)
      type(nodal_value_type), allocatable, intent(inout) :: list(:)
      integer, intent(inout) :: n
      type(nodal_value_type), intent(in) :: item
      type(nodal_value_type), allocatable :: longer(:)
      integer :: status

      if (.not. allocated(list)) then
         allocate (list(8), stat=status)
         call check_allocation(status)
      end if
      if (n == size(list)) then
         allocate (longer(grown(n)), stat=status)
         call check_allocation(status)
         longer(:n) = list
         call move_alloc(longer, list)
      end if
      n = n + 1
      list(n) = item
   end subroutine append_nodal_value

   pure subroutine append_place(list, n, item)
      type(place_type), allocatable, intent(inout) :: list(:)
      integer, intent(inout) :: n
      type(place_type), intent(in) :: item
      type(place_type), allocatable :: longer(:)
      integer :: status

      if (.not. allocated(list)) then
         allocate (list(8), stat=status)
         call check_allocation(status)
      end if
      if (n == size(list)) then
         allocate (longer(grown(n)), stat=status)
         call check_allocation(status)
         longer(:n) = list
         call move_alloc(longer, list)
      end if
      n = n + 1
      list(n) = item
   end subroutine append_place

   !> Twice as long as a list is and a little more; without memory where that cannot be counted.
   pure integer function grown(n)
      integer, intent(in) :: n

      if (n > huge(n) - n - 8) call check_allocation(n)
      grown = 2*n + 8
   end function grown

   pure subroutine fit_integers(list, n)
      integer, allocatable, intent(inout) :: list(:)
      integer, intent(in) :: n
      integer :: status

      if (.not. allocated(list)) then
         allocate (list(0), stat=status)
         call check_allocation(status)
      end if
      if (size(list) > n) list = list(:n)
   end subroutine fit_integers

   pure subroutine fit_boundaries(list, n)
      type(boundary_type), allocatable, intent(inout) :: list(:)
      integer, intent(in) :: n
      integer :: status

      if (.not. allocated(list)) then
         allocate (list(0), stat=status)
         call check_allocation(status)
      end if
      if (size(list) > n) list = list(:n)
   end subroutine fit_boundaries

   pure subroutine fit_nodal_values(list, n)
      type(nodal_value_type), allocatable, intent(inout) :: list(:)
      integer, intent(in) :: n
      integer :: status

      if (.not. allocated(list)) then
         allocate (list(0), stat=status)
         call check_allocation(status)
      end if
      if (size(list) > n) list = list(:n)
   end subroutine fit_nodal_values

   !> Sorts ascending and keeps each number once: runs that ascend already are merged two by two.
   pure subroutine sort_unique(list)
      integer, allocatable, intent(inout) :: list(:)
      integer, allocatable :: other(:), starts(:)
      integer :: i, n, status

      if (size(list) < 2) return
      call find_runs(list, starts)
      do while (size(starts) > 2)
         allocate (other(size(list)), stat=status)
         call check_allocation(status)
         call merge_runs(list, starts, other)
         call move_alloc(other, list)
      end do
      n = 1
      do i = 2, size(list)
         if (list(i) == list(n)) cycle
         n = n + 1
         list(n) = list(i)
      end do
      call fit_integers(list, n)
   end subroutine sort_unique

   !> Where the stretches begin that do not descend; behind them the end of the list.
   pure subroutine find_runs(list, starts)
      integer, intent(in) :: list(:)
      integer, allocatable, intent(out) :: starts(:)
      integer :: i, n

      n = 0
      call append_integer(starts, n, 1)
      do i = 2, size(list)
         if (list(i) < list(i - 1)) call append_integer(starts, n, i)
      end do
      call append_integer(starts, n, size(list) + 1)
      call fit_integers(starts, n)
   end subroutine find_runs

   !> Merges the first run with the second, the third with the fourth, and so on.
   pure subroutine merge_runs(list, starts, merged)
      integer, intent(in) :: list(:)
      integer, allocatable, intent(inout) :: starts(:)   !! of the runs; out: of the merged
      integer, intent(out) :: merged(:)
      integer :: run, n_runs, finish, i, j, k
      logical :: from_left

      n_runs = size(starts) - 1
      do run = 1, n_runs, 2
         i = starts(run)
         j = starts(run + 1)
         finish = starts(min(run + 2, n_runs + 1))
         do k = starts(run), finish - 1
            from_left = j >= finish
            if (.not. from_left .and. i < starts(run + 1)) from_left = list(i) <= list(j)
            if (from_left) then
               merged(k) = list(i)
               i = i + 1
            else
               merged(k) = list(j)
               j = j + 1
            end if
         end do
      end do
      starts = [starts(1:n_runs:2), starts(n_runs + 1)]
   end subroutine merge_runs

end module model_building
