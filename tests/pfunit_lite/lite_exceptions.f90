!> The list of failed assertions of the running test. An assertion has no argument to carry it,
!> so it is the one variable a module of this project keeps.
module lite_exceptions
   use lite_text, only: to_text
   implicit none
   private

   public :: anyExceptions, throw_exception, catch_exception, clear_exceptions
   public :: exception_count, exception_text

   !> Where an assertion stands; the length is fixed because gfortran 12 leaks structure
   !> constructors with allocatable components.
   type, public :: SourceLocation
      character(len=128) :: fileName = '<unknown file>'
      integer :: lineNumber = 0
   end type SourceLocation

   type :: exception_type
      character(len=:), allocatable :: message
      type(SourceLocation) :: location
   end type exception_type

   type(exception_type), allocatable :: raised(:)

contains

   logical function anyExceptions()
      anyExceptions = exception_count() > 0
   end function anyExceptions

   integer function exception_count()
      exception_count = 0
      if (allocated(raised)) exception_count = size(raised)
   end function exception_count

   !> The exception `i` as `file:line: message`
   function exception_text(i) result(text)
      integer, intent(in) :: i
      character(len=:), allocatable :: text

      text = trim(raised(i)%location%fileName) // ':' // &
            to_text(raised(i)%location%lineNumber) // ': ' // raised(i)%message
   end function exception_text

   subroutine throw_exception(message, location)
      character(len=*), intent(in) :: message
      type(SourceLocation), intent(in), optional :: location
      type(exception_type), allocatable :: longer(:)
      integer :: n, i

      n = exception_count()
      allocate (longer(n + 1))
      do i = 1, n
         longer(i) = raised(i)
      end do
      longer(n + 1)%message = message
      if (present(location)) longer(n + 1)%location = location
      call move_alloc(longer, raised)
   end subroutine throw_exception

   !> Removes the first exception, or the first that carries exactly `message`
   subroutine catch_exception(found, message)
      logical, intent(out) :: found
      character(len=*), intent(in), optional :: message
      type(exception_type), allocatable :: rest(:)
      integer :: i, j

      found = .false.
      do i = 1, exception_count()
         found = .true.
         if (present(message)) found = raised(i)%message == message
         if (found) exit
      end do
      if (.not. found) return

      allocate (rest(size(raised) - 1))
      do j = 1, size(rest)
         rest(j) = raised(merge(j, j + 1, j < i))
      end do
      call move_alloc(rest, raised)
   end subroutine catch_exception

   subroutine clear_exceptions()
      if (allocated(raised)) deallocate (raised)
   end subroutine clear_exceptions

end module lite_exceptions
