!> Elapsed time.
module clock
   use kinds, only: wp, int64
   implicit none
   private

   public :: seconds_now

contains

   !> Seconds on a clock that never runs back; only differences mean anything.
   function seconds_now() result(seconds)
      real(wp) :: seconds
      integer(int64) :: count, rate

      call system_clock(count, rate)
      seconds = real(count, wp)/real(rate, wp)
   end function seconds_now

end module clock
