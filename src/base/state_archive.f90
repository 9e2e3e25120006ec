!> The state of a computation as named numbers, to be stored and fetched again bit for bit.
!>
!> Each type with a state has one procedure that passes its components to `pass`, in the same way
!> whether the archive is being filled or read: what is written and what is read cannot differ. An
!> array that is not allocated when the archive is filled is not allocated after reading.
!> Logicals are kept as integers 0 and 1, all integers with 64 bits.
module state_archive
   use kinds, only: wp, int64
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: archive_type, entry_type

   !> One scalar or array under its name, such as `motion/d`; one of both arrays is allocated.
   type :: entry_type
      character(len=:), allocatable :: name
      real(wp), allocatable :: reals(:)
      integer(int64), allocatable :: integers(:)
   end type entry_type

   !> The entries; `reading` says which way `pass` goes.
   type :: archive_type
      type(entry_type), allocatable :: entries(:)   !! grown by doubling
      integer :: n = 0
      logical :: reading = .false.
      character(len=:), allocatable :: problem      !! the first entry that was missing or unfit
      character(len=:), allocatable, private :: group
      integer, private :: last = 0                  ! entry read last
   contains
      procedure :: enter => enter_group
      procedure :: leave => leave_group
      procedure :: add_reals
      procedure :: add_integers
      procedure :: has
      procedure :: demand
      procedure :: pass_fixed
      generic :: pass => pass_real, pass_reals, pass_real_table, pass_integer, pass_long, &
            pass_integers, pass_logical, pass_logicals
      procedure, private :: pass_real, pass_reals, pass_real_table, pass_integer, pass_long
      procedure, private :: pass_integers, pass_logical, pass_logicals
   end type archive_type

contains

   !> Names passed from here on are below `name`.
   subroutine enter_group(self, name)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name

      if (.not. allocated(self%group)) self%group = ''
      self%group = self%group//name//'/'
   end subroutine enter_group

   !> Back to the group around the present one.
   subroutine leave_group(self)
      class(archive_type), intent(inout) :: self
      integer :: slash

      slash = index(self%group(:len(self%group) - 1), '/', back=.true.)
      self%group = self%group(:slash)
   end subroutine leave_group

   !> Adds an entry of reals by its full name.
   subroutine add_reals(self, name, values)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: values(:)

      call make_room(self)
      self%entries(self%n)%name = name
      self%entries(self%n)%reals = values
   end subroutine add_reals

   !> Adds an entry of integers by its full name.
   subroutine add_integers(self, name, values)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(int64), intent(in) :: values(:)

      call make_room(self)
      self%entries(self%n)%name = name
      self%entries(self%n)%integers = values
   end subroutine add_integers

   !> Whether an entry of this name, below the present group, is there.
   logical function has(self, name)
      class(archive_type), intent(in) :: self
      character(len=*), intent(in) :: name

      has = place_of(self, full_name(self, name)) > 0
   end function has

   !> What does not hold is the archive's problem with the entry.
   subroutine demand(self, name, holds)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      logical, intent(in) :: holds

      if (.not. holds) call complain(self, name)
   end subroutine demand

   subroutine pass_real(self, name, value)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(wp), intent(inout) :: value
      real(wp) :: values(1)

      values = value
      call self%pass_fixed(name, values)
      value = values(1)
   end subroutine pass_real

   !> An array whose size is fixed, not allocatable.
   subroutine pass_fixed(self, name, values)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(wp), intent(inout) :: values(:)
      integer :: i

      if (.not. self%reading) then
         call self%add_reals(full_name(self, name), values)
         return
      end if
      call find(self, name, i)
      if (i == 0) then
         call complain(self, name)
      else if (.not. allocated(self%entries(i)%reals)) then
         call complain(self, name)
      else if (size(self%entries(i)%reals) /= size(values)) then
         call complain(self, name)
      else
         values = self%entries(i)%reals
      end if
   end subroutine pass_fixed

   subroutine pass_reals(self, name, values)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(wp), allocatable, intent(inout) :: values(:)
      integer :: i

      if (.not. self%reading) then
         if (allocated(values)) call self%add_reals(full_name(self, name), values)
         return
      end if
      if (allocated(values)) deallocate (values)
      call find(self, name, i)
      if (i == 0) return
      if (allocated(self%entries(i)%reals)) then
         values = self%entries(i)%reals
      else
         call complain(self, name)
      end if
   end subroutine pass_reals

   subroutine pass_real_table(self, name, values)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(wp), allocatable, intent(inout) :: values(:, :)
      real(wp), allocatable :: list(:)
      integer, allocatable :: extent(:)

      if (allocated(values)) then
         extent = shape(values)
         if (.not. self%reading) list = pack(values, .true.)
      end if
      call self%pass_integers(name//'_shape', extent)
      call self%pass_reals(name, list)
      if (.not. self%reading) return
      if (allocated(values)) deallocate (values)
      if (.not. (allocated(list) .and. allocated(extent))) return
      if (size(extent) /= 2) then
         call complain(self, name)
      else if (product(extent) /= size(list)) then
         call complain(self, name)
      else
         values = reshape(list, [extent(1), extent(2)])
      end if
   end subroutine pass_real_table

   subroutine pass_long(self, name, value)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(int64), intent(inout) :: value
      integer :: i

      if (.not. self%reading) then
         call self%add_integers(full_name(self, name), [value])
         return
      end if
      call find(self, name, i)
      if (i == 0) then
         call complain(self, name)
      else if (.not. allocated(self%entries(i)%integers)) then
         call complain(self, name)
      else if (size(self%entries(i)%integers) /= 1) then
         call complain(self, name)
      else
         value = self%entries(i)%integers(1)
      end if
   end subroutine pass_long

   subroutine pass_integer(self, name, value)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer, intent(inout) :: value
      integer(int64) :: long

      long = value
      call self%pass_long(name, long)
      value = int(long)
   end subroutine pass_integer

   subroutine pass_logical(self, name, value)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      logical, intent(inout) :: value
      integer(int64) :: long

      long = merge(1, 0, value)
      call self%pass_long(name, long)
      value = long /= 0
   end subroutine pass_logical

   subroutine pass_integers(self, name, values)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer, allocatable, intent(inout) :: values(:)
      integer :: i

      if (.not. self%reading) then
         if (allocated(values)) call self%add_integers(full_name(self, name), int(values, int64))
         return
      end if
      if (allocated(values)) deallocate (values)
      call find(self, name, i)
      if (i == 0) return
      if (allocated(self%entries(i)%integers)) then
         values = int(self%entries(i)%integers)
      else
         call complain(self, name)
      end if
   end subroutine pass_integers

   subroutine pass_logicals(self, name, values)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      logical, allocatable, intent(inout) :: values(:)
      integer, allocatable :: marks(:)

      if (allocated(values)) marks = merge(1, 0, values)
      call self%pass_integers(name, marks)
      if (.not. self%reading) return
      if (allocated(values)) deallocate (values)
      if (allocated(marks)) values = marks /= 0
   end subroutine pass_logicals

   !> Remembers the first entry that did not fit.
   subroutine complain(self, name)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name

      if (.not. allocated(self%problem)) self%problem = full_name(self, name)
   end subroutine complain

   !> Where an entry is, 0 for nowhere. Entries are mostly read in the order they were written.
   subroutine find(self, name, i)
      class(archive_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer, intent(out) :: i

      i = place_of(self, full_name(self, name))
      if (i > 0) self%last = i
   end subroutine find

   pure integer function place_of(self, name)
      class(archive_type), intent(in) :: self
      character(len=*), intent(in) :: name
      integer :: i

      do i = 1, self%n
         place_of = 1 + modulo(self%last + i - 1, self%n)
         if (self%entries(place_of)%name == name) return
      end do
      place_of = 0
   end function place_of

   pure function full_name(self, name) result(full)
      class(archive_type), intent(in) :: self
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: full

      full = name
      if (allocated(self%group)) full = self%group//name
   end function full_name

   !> One more entry.
   subroutine make_room(self)
      class(archive_type), intent(inout) :: self
      type(entry_type), allocatable :: longer(:)
      integer :: i, status

      if (.not. allocated(self%entries)) then
         allocate (self%entries(64), stat=status)
         call check_allocation(status)
      end if
      if (self%n == size(self%entries)) then
         allocate (longer(2*self%n), stat=status)
         call check_allocation(status)
         do i = 1, self%n
            call move_alloc(self%entries(i)%name, longer(i)%name)
            call move_alloc(self%entries(i)%reals, longer(i)%reals)
            call move_alloc(self%entries(i)%integers, longer(i)%integers)
         end do
         call move_alloc(longer, self%entries)
      end if
      self%n = self%n + 1
   end subroutine make_room

end module state_archive
