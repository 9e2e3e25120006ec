!> Numeric kinds used throughout the program.
module kinds
   use, intrinsic :: iso_fortran_env, only: int32, int64, real64
   implicit none
   private

   public :: wp, int32, int64

   !> The one working precision.
   integer, parameter :: wp = real64

end module kinds
