!> MUMPS as a user of its own would call it: its defaults, a symmetric matrix, no output.
module direct_mumps
   use kinds, only: wp, int64
   implicit none
   private

   public :: direct_type, direct_start, direct_analyse, direct_factorize, direct_solve, direct_end

   ! the type DMUMPS_STRUC as MUMPS declares it
   include 'dmumps_struc.h'

   interface
      subroutine dmumps(instance)
         import :: dmumps_struc
         implicit none
         type(dmumps_struc), intent(inout) :: instance
      end subroutine dmumps
   end interface

   !> A matrix in the hands of MUMPS.
   type :: direct_type
      private
      type(dmumps_struc) :: instance
   end type direct_type

contains

   !> Hands the matrix over; it stays with the caller.
   subroutine direct_start(self, n, row, column, values)
      type(direct_type), intent(inout) :: self
      integer, intent(in) :: n
      integer, intent(in), target :: row(:), column(:)   !! (entries) of one triangle
      real(wp), intent(in), target :: values(:)          !! (entries)

      self%instance%comm = 0
      self%instance%par = 1
      self%instance%sym = 2
      call work(self, -1)
      self%instance%icntl(1:3) = -1
      self%instance%icntl(4) = 0
      self%instance%n = n
      self%instance%nnz = size(row, kind=int64)
      self%instance%irn => row
      self%instance%jcn => column
      self%instance%a => values
   end subroutine direct_start

   subroutine direct_analyse(self)
      type(direct_type), intent(inout) :: self

      call work(self, 1)
   end subroutine direct_analyse

   subroutine direct_factorize(self)
      type(direct_type), intent(inout) :: self

      call work(self, 2)
   end subroutine direct_factorize

   !> One right-hand side; b is overwritten by the solution.
   subroutine direct_solve(self, b)
      type(direct_type), intent(inout) :: self
      real(wp), intent(inout), target :: b(:)

      self%instance%rhs => b
      call work(self, 3)
      nullify (self%instance%rhs)
   end subroutine direct_solve

   subroutine direct_end(self)
      type(direct_type), intent(inout) :: self

      nullify (self%instance%irn, self%instance%jcn, self%instance%a)
      call work(self, -2)
   end subroutine direct_end

   subroutine work(self, job)
      type(direct_type), intent(inout) :: self
      integer, intent(in) :: job

      self%instance%job = job
      call dmumps(self%instance)
      if (self%instance%infog(1) < 0) error stop 'MUMPS called directly has failed'
   end subroutine work

end module direct_mumps
