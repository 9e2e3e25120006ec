!> The assertions on integer(int64)
module lite_int64
   use, intrinsic :: iso_fortran_env, only: int64
   use lite_basic, only: fail_assertion, same_shape
   use lite_exceptions, only: SourceLocation
   use lite_text, only: position_text, to_text
   implicit none
   private

   public :: assertEqual, assertNotEqual
   public :: assertLessThan, assertLessThanOrEqual
   public :: assertGreaterThan, assertGreaterThanOrEqual

   integer, parameter :: k = int64

   interface assertEqual
      module procedure equal_0_0, equal_0_1, equal_1_1, equal_0_2, equal_2_2
   end interface assertEqual

   interface assertNotEqual
      module procedure not_equal
   end interface assertNotEqual

   interface assertLessThan
      module procedure less_0_0, less_0_1, less_1_1, less_0_2, less_2_2
   end interface assertLessThan

   interface assertLessThanOrEqual
      module procedure less_equal_0_0, less_equal_0_1, less_equal_1_1
      module procedure less_equal_0_2, less_equal_2_2
   end interface assertLessThanOrEqual

   interface assertGreaterThan
      module procedure greater_0_0, greater_0_1, greater_1_1, greater_0_2, greater_2_2
   end interface assertGreaterThan

   interface assertGreaterThanOrEqual
      module procedure greater_equal_0_0, greater_equal_0_1, greater_equal_1_1
      module procedure greater_equal_0_2, greater_equal_2_2
   end interface assertGreaterThanOrEqual

contains

   include 'equal_integer.inc'
   include 'order_integer.inc'

end module lite_int64
