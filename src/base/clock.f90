!> Elapsed time, and a look at it that costs nothing where what is timed is short.
module clock
   use kinds, only: wp, int64
   implicit none
   private

   public :: seconds_now, pace_type, start_pace, keep_pace

   !> The time of things that follow each other, as increments: of short ones one in many is looked
   !> at.
   type :: pace_type
      real(wp) :: now = 0.0_wp                   !! on the clock, at the last look
      real(wp) :: interval = 0.0_wp              !! mean of those since the look before, seconds
      logical :: fresh = .false.                 !! the last call has looked
      integer, private :: stride = 1             !! of which one is looked at
      integer, private :: left = 1               !! to the next look
   end type pace_type

   integer, parameter :: longest_stride = 64
   !> Times between two looks, in seconds, below which and above which they are too many or too few.
   real(wp), parameter :: short_time = 1.0e-3_wp, long_time = 5.0e-3_wp

contains

   !> Seconds on a clock that never runs back; only differences mean anything.
   function seconds_now() result(seconds)
      real(wp) :: seconds
      integer(int64) :: count, rate

      call system_clock(count, rate)
      seconds = real(count, wp)/real(rate, wp)
   end function seconds_now

   !> The next one begins now.
   subroutine start_pace(self)
      type(pace_type), intent(inout) :: self

      self%now = seconds_now()
      self%interval = 0.0_wp
      self%fresh = .true.
      self%left = self%stride
   end subroutine start_pace

   !> One more is done.
   subroutine keep_pace(self)
      type(pace_type), intent(inout) :: self
      real(wp) :: before

      self%left = self%left - 1
      self%fresh = self%left <= 0
      if (.not. self%fresh) return
      before = self%now
      self%now = seconds_now()
      self%interval = (self%now - before)/real(self%stride, wp)
      if (self%now - before > long_time) then
         self%stride = 1
      else if (self%now - before < short_time) then
         self%stride = min(2*self%stride, longest_stride)
      end if
      self%left = self%stride
   end subroutine keep_pace

end module clock
