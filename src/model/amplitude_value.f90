!> Value, slope and time integrals of an amplitude: exact, since it is piecewise linear.
module amplitude_value
   use kinds, only: wp
   use histories, only: amplitude_type, time_step
   implicit none
   private

   public :: amplitude_at, amplitude_slope, amplitude_integral, amplitude_second_integral
   public :: corner_after, amplitude_start

contains

   !> a(t): linear between the given times, constant beyond them.
   pure function amplitude_at(amplitude, t) result(value)
      type(amplitude_type), intent(in) :: amplitude
      real(wp), intent(in) :: t   !! time as the amplitude counts it
      real(wp) :: value
      integer :: i

      i = interval(amplitude%t, t)
      value = amplitude%a(max(i, 1))
      if (i < 1 .or. i >= size(amplitude%t)) return
      value = value + slope_of(amplitude, i)*(t - amplitude%t(i))
   end function amplitude_at

   !> da/dt just after t.
   pure function amplitude_slope(amplitude, t) result(slope)
      type(amplitude_type), intent(in) :: amplitude
      real(wp), intent(in) :: t
      real(wp) :: slope
      integer :: i

      slope = 0.0_wp
      i = interval(amplitude%t, t)
      if (i < 1 .or. i >= size(amplitude%t)) return
      slope = slope_of(amplitude, i)
   end function amplitude_slope

   !> Integral of a from 0 to t.
   pure function amplitude_integral(amplitude, t) result(integral)
      type(amplitude_type), intent(in) :: amplitude
      real(wp), intent(in) :: t   !! not negative
      real(wp) :: integral
      real(wp) :: unused

      call integrate(amplitude, t, integral, unused)
   end function amplitude_integral

   !> Integral from 0 to t of the integral of a.
   pure function amplitude_second_integral(amplitude, t) result(integral)
      type(amplitude_type), intent(in) :: amplitude
      real(wp), intent(in) :: t   !! not negative
      real(wp) :: integral
      real(wp) :: unused

      call integrate(amplitude, t, unused, integral)
   end function amplitude_second_integral

   !> Adds up the cubic pieces of the twice integrated amplitude.
   pure subroutine integrate(amplitude, t, first, second)
      type(amplitude_type), intent(in) :: amplitude
      real(wp), intent(in) :: t
      real(wp), intent(out) :: first, second
      real(wp) :: from, to, length, a, slope

      first = 0.0_wp
      second = 0.0_wp
      from = 0.0_wp
      do while (from < t)
         to = min(t, next_corner(amplitude%t, from))
         length = to - from
         a = amplitude_at(amplitude, from)
         slope = amplitude_slope(amplitude, from)
         second = second + first*length + a*length**2/2.0_wp + slope*length**3/6.0_wp
         first = first + a*length + slope*length**2/2.0_wp
         from = to
      end do
   end subroutine integrate

   !> The total time from which an amplitude counts its own.
   pure function amplitude_start(amplitude, t_start) result(start)
      type(amplitude_type), intent(in) :: amplitude
      real(wp), intent(in) :: t_start   !! of the step
      real(wp) :: start

      start = merge(t_start, 0.0_wp, amplitude%time == time_step)
   end function amplitude_start

   !> The first total time after t at which an amplitude has a corner, huge if there is none.
   pure function corner_after(amplitude, t_start, t) result(corner)
      type(amplitude_type), intent(in) :: amplitude
      real(wp), intent(in) :: t_start   !! of the step
      real(wp), intent(in) :: t
      real(wp) :: corner

      associate (start => amplitude_start(amplitude, t_start))
         corner = start + next_corner(amplitude%t, t - start)
      end associate
   end function corner_after

   !> The first of the times after t, huge if there is none.
   pure function next_corner(times, t) result(next)
      real(wp), intent(in) :: times(:), t
      real(wp) :: next
      integer :: i

      next = huge(next)
      i = interval(times, t) + 1
      if (i <= size(times)) next = times(i)
   end function next_corner

   !> The last i with times(i) <= t, 0 before the first.
   pure function interval(times, t) result(low)
      real(wp), intent(in) :: times(:), t
      integer :: low
      integer :: high, middle

      low = 0
      high = size(times) + 1
      do while (high - low > 1)
         middle = (low + high)/2
         if (times(middle) <= t) then
            low = middle
         else
            high = middle
         end if
      end do
   end function interval

   pure function slope_of(amplitude, i) result(slope)
      type(amplitude_type), intent(in) :: amplitude
      integer, intent(in) :: i
      real(wp) :: slope

      slope = (amplitude%a(i + 1) - amplitude%a(i))/(amplitude%t(i + 1) - amplitude%t(i))
   end function slope_of

end module amplitude_value
