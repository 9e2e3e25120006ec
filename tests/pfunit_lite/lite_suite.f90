!> A test file as data: named procedures with what runs before and after each
module lite_suite
   implicit none
   private

   public :: TestMethod

   abstract interface
      subroutine test_procedure()
         implicit none
      end subroutine test_procedure
   end interface

   !> The length of the name is fixed for the same reason as in `SourceLocation`
   type :: TestMethod
      character(len=64) :: name = ''
      logical :: disabled = .false.
      procedure(test_procedure), pointer, nopass :: method => null()
      procedure(test_procedure), pointer, nopass :: setUp => null()
      procedure(test_procedure), pointer, nopass :: tearDown => null()
   end type TestMethod

   interface TestMethod
      module procedure new_test_method
   end interface TestMethod

   type, public :: TestSuite
      character(len=64) :: name = ''
      type(TestMethod), allocatable :: tests(:)
   contains
      procedure :: addTest
   end type TestSuite

   interface TestSuite
      module procedure new_test_suite
   end interface TestSuite

contains

   function new_test_method(name, method, setUp, tearDown, disabled) result(self)
      character(len=*), intent(in) :: name
      procedure(test_procedure) :: method
      procedure(test_procedure), optional :: setUp
      procedure(test_procedure), optional :: tearDown
      logical, intent(in), optional :: disabled
      type(TestMethod) :: self

      self%name = name
      self%method => method
      if (present(setUp)) self%setUp => setUp
      if (present(tearDown)) self%tearDown => tearDown
      if (present(disabled)) self%disabled = disabled
   end function new_test_method

   function new_test_suite(name) result(self)
      character(len=*), intent(in) :: name
      type(TestSuite) :: self

      self%name = name
      allocate (self%tests(0))
   end function new_test_suite

   subroutine addTest(self, test)
      class(TestSuite), intent(inout) :: self
      type(TestMethod), intent(in) :: test
      type(TestMethod), allocatable :: longer(:)

      allocate (longer(size(self%tests) + 1))
      longer(:size(self%tests)) = self%tests
      longer(size(longer)) = test
      call move_alloc(longer, self%tests)
   end subroutine addTest

end module lite_suite
