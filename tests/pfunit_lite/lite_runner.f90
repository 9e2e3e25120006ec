!> Runs suites and prints what the ctest property of the tests looks for
module lite_runner
   use, intrinsic :: iso_fortran_env, only: int64, output_unit
   use lite_exceptions, only: anyExceptions, clear_exceptions, exception_count, exception_text
   use lite_suite, only: TestMethod, TestSuite
   implicit none
   private

   type, public :: runner_type
      private
      logical :: verbose = .false.
      character(len=:), allocatable :: filter
      integer :: n_run = 0
      integer :: n_failed = 0
      integer :: n_disabled = 0
   contains
      procedure :: read_options
      procedure :: run_suite
      procedure :: report
   end type runner_type

contains

   !> Reads the command line: --verbose, --filter NAME. `ok` is false, and the usage is printed,
   !> if there is anything else
   subroutine read_options(self, ok)
      class(runner_type), intent(inout) :: self
      logical, intent(out) :: ok
      integer :: i

      ok = .true.
      self%filter = ''
      i = 1
      do while (i <= command_argument_count())
         select case (argument(i))
         case ('-v', '--verbose')
            self%verbose = .true.
         case ('-f', '--filter')
            i = i + 1
            self%filter = argument(i)
            ok = len(self%filter) > 0
         case default
            ok = .false.
         end select
         if (.not. ok) then
            write (output_unit, '(a)') 'usage: [-v|--verbose] [-f|--filter NAME]'
            return
         end if
         i = i + 1
      end do
   end subroutine read_options

   !> The argument `i` of the command line, empty if there is none
   function argument(i) result(text)
      integer, intent(in) :: i
      character(len=:), allocatable :: text
      integer :: length

      length = 0
      if (i <= command_argument_count()) call get_command_argument(i, length=length)
      allocate (character(len=length) :: text)
      if (length > 0) call get_command_argument(i, text)
   end function argument

   subroutine run_suite(self, suite)
      class(runner_type), intent(inout) :: self
      type(TestSuite), intent(in) :: suite
      character(len=:), allocatable :: name
      integer :: i

      do i = 1, size(suite%tests)
         name = trim(suite%name) // '.' // trim(suite%tests(i)%name)
         if (index(name, self%filter) == 0) cycle
         if (suite%tests(i)%disabled) then
            self%n_disabled = self%n_disabled + 1
            write (output_unit, '(a)') 'disabled ' // name
         else
            call run_test(self, suite%tests(i), name)
         end if
      end do
   end subroutine run_suite

   subroutine run_test(self, test, name)
      type(runner_type), intent(inout) :: self
      type(TestMethod), intent(in) :: test
      character(len=*), intent(in) :: name
      integer(int64) :: start, finish, rate
      integer :: i

      if (self%verbose) write (output_unit, '(a)') 'start    ' // name
      flush (output_unit)
      call clear_exceptions()
      call system_clock(start, rate)
      call call_in_order(test)
      call system_clock(finish)

      self%n_run = self%n_run + 1
      if (anyExceptions()) then
         self%n_failed = self%n_failed + 1
         write (output_unit, '(a)') 'FAILED   ' // name
         do i = 1, exception_count()
            write (output_unit, '(a)') '   ' // exception_text(i)
         end do
      else if (self%verbose) then
         write (output_unit, '(a, f6.3, a)') 'passed   ' // name // ' (', &
               real(finish - start) / real(rate), ' s)'
      end if
      flush (output_unit)
      call clear_exceptions()
   end subroutine run_test

   !> A test whose set-up failed does not run
   subroutine call_in_order(test)
      type(TestMethod), intent(in) :: test

      if (associated(test%setUp)) call test%setUp()
      if (.not. anyExceptions()) call test%method()
      if (associated(test%tearDown)) call test%tearDown()
   end subroutine call_in_order

   !> Prints the verdict; `failed` asks the program for `stop 2`
   subroutine report(self, failed)
      class(runner_type), intent(in) :: self
      logical, intent(out) :: failed

      failed = self%n_failed > 0
      if (self%n_disabled > 0) write (output_unit, '(/, a, i0)') ' Disabled: ', self%n_disabled
      if (failed) then
         write (output_unit, '(/, a)') 'FAILURES!!!'
         write (output_unit, '(a, i0, a, i0)') 'Tests run: ', self%n_run, &
               ', failures: ', self%n_failed
         write (output_unit, '(a)') &
               '*** Encountered 1 or more failures/errors during testing ***'
      else
         write (output_unit, '(/, a)') ' OK'
         write (output_unit, '(a, i0, a)') ' (', self%n_run, &
               trim(merge(' test) ', ' tests)', self%n_run == 1))
      end if
      flush (output_unit)
   end subroutine report

end module lite_runner
