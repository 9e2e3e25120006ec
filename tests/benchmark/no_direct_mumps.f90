!> Stands in for MUMPS in a build without it; nothing of it is called there.
module direct_mumps
   use kinds, only: wp
   implicit none
   private

   public :: direct_type, direct_start, direct_analyse, direct_factorize, direct_solve, direct_end

   character(len=*), parameter :: missing = 'this program was built without MUMPS'

   !> Nothing.
   type :: direct_type
      integer :: job = 0
   end type direct_type

contains

   !> Fails.
   subroutine direct_start(self, n, row, column, values)
      type(direct_type), intent(inout) :: self
      integer, intent(in) :: n
      integer, intent(in) :: row(:), column(:)
      real(wp), intent(in) :: values(:)

      error stop missing
   end subroutine direct_start

   subroutine direct_analyse(self)
      type(direct_type), intent(inout) :: self

      error stop missing
   end subroutine direct_analyse

   subroutine direct_factorize(self)
      type(direct_type), intent(inout) :: self

      error stop missing
   end subroutine direct_factorize

   !> Fails.
   subroutine direct_solve(self, b)
      type(direct_type), intent(inout) :: self
      real(wp), intent(inout) :: b(:)

      error stop missing
   end subroutine direct_solve

   subroutine direct_end(self)
      type(direct_type), intent(inout) :: self

      error stop missing
   end subroutine direct_end

end module direct_mumps
