!> What a test file sees: the part of pFUnit's module `funit` that tests of this project may use
module funit
   use lite_basic, only: assertEqual, assertExceptionRaised, assertFail, assertFalse, &
         assertSameShape, assertTrue, IGNORE_ALL, KEEP_ALL, TRIM_ALL
   use lite_exceptions, only: anyExceptions, SourceLocation
   use lite_int32, only: assertEqual, assertGreaterThan, assertGreaterThanOrEqual, &
         assertLessThan, assertLessThanOrEqual, assertNotEqual
   use lite_int64, only: assertEqual, assertGreaterThan, assertGreaterThanOrEqual, &
         assertLessThan, assertLessThanOrEqual, assertNotEqual
   use lite_real32, only: assertEqual, assertGreaterThan, assertGreaterThanOrEqual, &
         assertIsFinite, assertIsNaN, assertLessThan, assertLessThanOrEqual, assertNotEqual, &
         assertRelativelyEqual
   use lite_real64, only: assertEqual, assertGreaterThan, assertGreaterThanOrEqual, &
         assertIsFinite, assertIsNaN, assertLessThan, assertLessThanOrEqual, assertNotEqual, &
         assertRelativelyEqual
   use lite_suite, only: TestMethod, TestSuite
   implicit none
   private

   public :: anyExceptions, SourceLocation, TestMethod, TestSuite
   public :: assertEqual, assertExceptionRaised, assertFail, assertFalse
   public :: assertGreaterThan, assertGreaterThanOrEqual, assertIsFinite, assertIsNaN
   public :: assertLessThan, assertLessThanOrEqual, assertNotEqual
   public :: assertRelativelyEqual, assertSameShape, assertTrue
   public :: IGNORE_ALL, KEEP_ALL, TRIM_ALL

end module funit
