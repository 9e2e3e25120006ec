!> Stands in for MUMPS in a build without it: it says so, and nothing else is ever called.
module mumps_solver
   use kinds, only: wp
   use errors, only: error_type, new_error, status_internal
   use sparse_matrix, only: pattern_type, sparse_report_type
   implicit none
   private

   public :: mumps_type, mumps_available, analyse, factorize, solve, discard
   public :: serve_rank_zero, dismiss_ranks

   character(len=*), parameter :: missing = 'this program was built without MUMPS'

   !> Nothing.
   type :: mumps_type
      integer :: number = 0
   end type mumps_type

contains

   !> Whether this module can do what it says.
   pure logical function mumps_available()
      mumps_available = .false.
   end function mumps_available

   !> Fails.
   subroutine analyse(self, number, pattern, report, error)
      type(mumps_type), intent(inout) :: self
      integer, intent(in) :: number
      type(pattern_type), intent(in) :: pattern
      type(sparse_report_type), intent(out) :: report
      type(error_type), allocatable, intent(out) :: error

      call new_error(error, status_internal, missing)
   end subroutine analyse

   !> Fails.
   subroutine factorize(self, pattern, values, report, error)
      type(mumps_type), intent(inout) :: self
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: values(:)
      type(sparse_report_type), intent(out) :: report
      type(error_type), allocatable, intent(out) :: error

      call new_error(error, status_internal, missing)
   end subroutine factorize

   !> Fails.
   subroutine solve(self, b, error)
      type(mumps_type), intent(inout) :: self
      real(wp), intent(inout) :: b(:, :)
      type(error_type), allocatable, intent(out) :: error

      call new_error(error, status_internal, missing)
   end subroutine solve

   !> There is nothing to discard.
   subroutine discard(self)
      type(mumps_type), intent(inout) :: self
   end subroutine discard

   !> Returns at once: there are no ranks to serve.
   subroutine serve_rank_zero(status)
      integer, intent(out) :: status

      status = 0
   end subroutine serve_rank_zero

   !> There are no ranks to dismiss.
   subroutine dismiss_ranks(status)
      integer, intent(in) :: status
   end subroutine dismiss_ranks

end module mumps_solver
