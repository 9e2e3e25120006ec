!> Putting a model together: appending in amortised constant time, and finding by name.
module model_building
   use memory_shortage, only: check_allocation
   use mesh, only: set_type
   use properties, only: material_type
   use surfaces, only: surface_type, rigid_surface_type, interaction_type
   use histories, only: amplitude_type, boundary_type, nodal_value_type
   implicit none
   private

   public :: find_named, append, fit, sort_unique

   !> Index of the item with this name, 0 if there is none.
   interface find_named
      module procedure :: find_set, find_material, find_amplitude, find_surface
      module procedure :: find_rigid_surface, find_interaction
   end interface find_named

   !> Puts an item behind the first n of a list that grows by doubling; n counts on.
   interface append
      module procedure :: append_integer, append_boundary, append_nodal_value
   end interface append

   !> Cuts a list to its first n items; afterwards it is allocated.
   interface fit
      module procedure :: fit_integers, fit_boundaries, fit_nodal_values
   end interface fit

contains

   pure function find_set(list, name) result(position)
      type(set_type), intent(in) :: list(:)
      character(len=*), intent(in) :: name
      integer :: position

      do position = 1, size(list)
         if (list(position)%name == name) return
      end do
      position = 0
   end function find_set

   pure function find_material(list, name) result(position)
      type(material_type), intent(in) :: list(:)
      character(len=*), intent(in) :: name
      integer :: position

      do position = 1, size(list)
         if (list(position)%name == name) return
      end do
      position = 0
   end function find_material

   pure function find_amplitude(list, name) result(position)
      type(amplitude_type), intent(in) :: list(:)
      character(len=*), intent(in) :: name
      integer :: position

      do position = 1, size(list)
         if (list(position)%name == name) return
      end do
      position = 0
   end function find_amplitude

   pure function find_surface(list, name) result(position)
      type(surface_type), intent(in) :: list(:)
      character(len=*), intent(in) :: name
      integer :: position

      do position = 1, size(list)
         if (list(position)%name == name) return
      end do
      position = 0
   end function find_surface

   pure function find_rigid_surface(list, name) result(position)
      type(rigid_surface_type), intent(in) :: list(:)
      character(len=*), intent(in) :: name
      integer :: position

      do position = 1, size(list)
         if (list(position)%name == name) return
      end do
      position = 0
   end function find_rigid_surface

   pure function find_interaction(list, name) result(position)
      type(interaction_type), intent(in) :: list(:)
      character(len=*), intent(in) :: name
      integer :: position

      do position = 1, size(list)
         if (list(position)%name == name) return
      end do
      position = 0
   end function find_interaction

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
         allocate (longer(2*n + 8), stat=status)
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
         allocate (longer(2*n + 8), stat=status)
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
         allocate (longer(2*n + 8), stat=status)
         call check_allocation(status)
         longer(:n) = list
         call move_alloc(longer, list)
      end if
      n = n + 1
      list(n) = item
   end subroutine append_nodal_value

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

   !> Sorts ascending and keeps each number once.
   pure subroutine sort_unique(list)
      integer, allocatable, intent(inout) :: list(:)
      integer, allocatable :: other(:)
      integer :: i, n, width, status

      n = size(list)
      if (n < 2) return
      if (any(list(2:) <= list(:n - 1))) then
         allocate (other(n), stat=status)
         call check_allocation(status)
         width = 1
         do while (width < n)
            call merge_runs(list, other, width)
            list = other
            width = 2*width
         end do
      end if
      n = 1
      do i = 2, size(list)
         if (list(i) == list(n)) cycle
         n = n + 1
         list(n) = list(i)
      end do
      call fit_integers(list, n)
   end subroutine sort_unique

   !> One pass of a merge sort: sorted runs of a width become runs of twice the width.
   pure subroutine merge_runs(list, merged, width)
      integer, intent(in) :: list(:), width
      integer, intent(out) :: merged(:)
      integer :: start, middle, finish, i, j, k
      logical :: from_left

      do start = 1, size(list), 2*width
         middle = min(start + width, size(list) + 1)
         finish = min(start + 2*width, size(list) + 1)
         i = start
         j = middle
         do k = start, finish - 1
            from_left = j >= finish
            if (.not. from_left .and. i < middle) from_left = list(i) <= list(j)
            if (from_left) then
               merged(k) = list(i)
               i = i + 1
            else
               merged(k) = list(j)
               j = j + 1
            end if
         end do
      end do
   end subroutine merge_runs

end module model_building
