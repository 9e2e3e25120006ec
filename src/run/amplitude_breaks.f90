!> Times at which the tables of loads, prescribed motions and moving walls have their points.
module amplitude_breaks
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use histories, only: amplitude_type
   use amplitude_value, only: amplitude_start
   use scene_setup, only: simulation_type
   implicit none
   private

   public :: find_breaks, reach_limit

   !> Points closer than this part of the step are one.
   real(wp), parameter :: same_time = 1.0e-9_wp

contains

   !> Times inside a span, in order, each once.
   subroutine find_breaks(simulation, span, breaks)
      type(simulation_type), intent(in) :: simulation
      real(wp), intent(in) :: span(2)            !! total times
      real(wp), allocatable, intent(out) :: breaks(:)
      integer :: i, status

      allocate (breaks(0), stat=status)
      call check_allocation(status)
      associate (loads => simulation%scene%system%loads%loads, &
            motions => simulation%scene%system%motions%motions, rows => simulation%scene%rows)
         do i = 1, size(loads)
            if (loads(i)%has_amplitude) call add_points(loads(i)%amplitude, loads(i)%t_start, &
                  span, breaks)
         end do
         do i = 1, size(motions)
            if (motions(i)%has_amplitude) call add_points(motions(i)%amplitude, &
                  motions(i)%t_start, span, breaks)
         end do
         if (.not. allocated(rows%amplitudes)) return
         do i = 1, size(rows%amplitudes)
            if (any(rows%amplitude == i)) call add_points(rows%amplitudes(i), 0.0_wp, span, breaks)
         end do
      end associate
   end subroutine find_breaks

   !> Merges the points of one table into those found.
   pure subroutine add_points(amplitude, t_start, span, breaks)
      type(amplitude_type), intent(in) :: amplitude
      real(wp), intent(in) :: t_start            !! of step time
      real(wp), intent(in) :: span(2)
      real(wp), allocatable, intent(inout) :: breaks(:)
      real(wp) :: merged(size(breaks) + size(amplitude%t)), t, apart
      integer :: i, k, n

      apart = same_time*(span(2) - span(1))
      n = 0
      k = 1
      do i = 1, size(amplitude%t)
         t = amplitude_start(amplitude, t_start) + amplitude%t(i)
         if (t <= span(1) + apart .or. t >= span(2) - apart) cycle
         do while (k <= size(breaks))
            if (breaks(k) > t) exit
            call append(merged, n, breaks(k), apart)
            k = k + 1
         end do
         call append(merged, n, t, apart)
      end do
      do k = k, size(breaks)
         call append(merged, n, breaks(k), apart)
      end do
      breaks = merged(:n)
   end subroutine add_points

   !> A time at the end of a list, unless it is there already.
   pure subroutine append(list, n, t, apart)
      real(wp), intent(inout) :: list(:)
      integer, intent(inout) :: n                !! times in it
      real(wp), intent(in) :: t, apart

      if (n > 0) then
         if (t - list(n) <= apart) return
      end if
      n = n + 1
      list(n) = t
   end subroutine append

   !> How far an increment from t may reach: it passes one point at most, lest a pulse between two
   !> be missed.
   pure subroutine reach_limit(breaks, t, next, limit)
      real(wp), intent(in) :: breaks(:), t
      integer, intent(inout) :: next             !! first point after t; moves on with t
      real(wp), intent(out) :: limit             !! a total time

      do while (next <= size(breaks))
         if (breaks(next) > t) exit
         next = next + 1
      end do
      limit = huge(limit)
      if (next < size(breaks)) limit = breaks(next + 1)
   end subroutine reach_limit

end module amplitude_breaks
