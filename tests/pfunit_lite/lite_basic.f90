!> The assertions on truth, text, shape and exceptions, and what the numeric ones are made of
module lite_basic
   use lite_exceptions, only: SourceLocation, throw_exception, catch_exception
   use lite_text, only: to_text, without_blanks
   implicit none
   private

   public :: assertTrue, assertFalse, assertFail, assertEqual, assertSameShape
   public :: assertExceptionRaised, fail_assertion, same_shape

   !> How `assertEqual` treats blanks. When `whitespace` is absent trailing blanks do not count,
   !> as in Fortran; pFUnit is more lenient there, never less.
   integer, parameter, public :: IGNORE_ALL = 1
   integer, parameter, public :: TRIM_ALL = 2
   integer, parameter, public :: KEEP_ALL = 3

   interface assertEqual
      module procedure equal_logical, equal_text
   end interface assertEqual

contains

   !> Raises an exception: the test's own `message` first, then what was found
   subroutine fail_assertion(text, message, location)
      character(len=*), intent(in) :: text
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      if (present(message)) then
         call throw_exception(trim(message) // new_line('a') // '   ' // text, location)
      else
         call throw_exception(text, location)
      end if
   end subroutine fail_assertion

   subroutine assertFail(message, location)
      character(len=*), intent(in) :: message
      type(SourceLocation), intent(in), optional :: location

      call throw_exception(message, location)
   end subroutine assertFail

   subroutine assertTrue(condition, message, location)
      logical, intent(in) :: condition
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      if (.not. condition) call fail_assertion('expected true but found false', message, location)
   end subroutine assertTrue

   subroutine assertFalse(condition, message, location)
      logical, intent(in) :: condition
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      if (condition) call fail_assertion('expected false but found true', message, location)
   end subroutine assertFalse

   subroutine equal_logical(expected, actual, message, location)
      logical, intent(in) :: expected
      logical, intent(in) :: actual
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      if (expected .eqv. actual) return
      call fail_assertion('expected ' // to_text(expected) // ' but found ' // to_text(actual), &
            message, location)
   end subroutine equal_logical

   subroutine equal_text(expected, actual, message, whitespace, location)
      character(len=*), intent(in) :: expected
      character(len=*), intent(in) :: actual
      character(len=*), intent(in), optional :: message
      integer, intent(in), optional :: whitespace
      type(SourceLocation), intent(in), optional :: location
      logical :: equal

      equal = expected == actual
      if (present(whitespace)) then
         select case (whitespace)
         case (IGNORE_ALL)
            equal = without_blanks(expected) == without_blanks(actual)
         case (TRIM_ALL)
            equal = adjustl(expected) == adjustl(actual)
         case default ! KEEP_ALL
            equal = equal .and. len(expected) == len(actual)
         end select
      end if
      if (equal) return
      call fail_assertion("expected '" // expected // "' but found '" // actual // "'", &
            message, location)
   end subroutine equal_text

   subroutine assertSameShape(expected, actual, message, location)
      integer, intent(in) :: expected(:)
      integer, intent(in) :: actual(:)
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location
      logical :: same

      same = size(expected) == size(actual)
      if (same) same = all(expected == actual)
      if (same) return
      call fail_assertion('expected the shape ' // to_text(expected) // ' but found ' // &
            to_text(actual), message, location)
   end subroutine assertSameShape

   !> Whether two shapes of the same rank agree; raises an exception if not
   logical function same_shape(expected, actual, message, location)
      integer, intent(in) :: expected(:)
      integer, intent(in) :: actual(:)
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      same_shape = all(expected == actual)
      if (.not. same_shape) call assertSameShape(expected, actual, message, location)
   end function same_shape

   !> Passes, and clears the exception, if one was raised; with `message`, one of that text
   subroutine assertExceptionRaised(message, location)
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location
      logical :: found

      call catch_exception(found, message)
      if (found) return
      if (present(message)) then
         call fail_assertion("the exception '" // message // "' was not raised", location=location)
      else
         call fail_assertion('no exception was raised', location=location)
      end if
   end subroutine assertExceptionRaised

end module lite_basic
