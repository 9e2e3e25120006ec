!> The motion inside a step from its ends: the cubic of Hermite through displacements and
!> velocities, and the gaps on it.
module step_interpolant
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use equation_of_motion, only: impose
   use constraint_rows, only: row_gaps, row_rates, may_hit
   use impact_scene, only: scene_type, contact_motion_type
   use gap_path, only: path_type, new_hermite_path, path_value, find_dip, find_rise, find_root
   use impact_time, only: span_type, hits_type
   implicit none
   private

   public :: interpolate_motion, find_hits_between

contains

   !> The motion at a time in the step: accelerations and contact forces go linearly over it.
   subroutine interpolate_motion(scene, from, to, t, at)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: from, to
      real(wp), intent(in) :: t
      type(contact_motion_type), intent(out) :: at
      real(wp) :: s, x

      s = to%motion%t - from%motion%t
      x = (t - from%motion%t)/s
      at = from
      at%motion%t = t
      ! h00 = 1 - h01
      associate (h01 => x**2*(3.0_wp - 2.0_wp*x), h10 => s*x*(1.0_wp - x)**2, &
            h11 => s*x**2*(x - 1.0_wp), dh01 => 6.0_wp*x*(1.0_wp - x)/s, &
            dh10 => (1.0_wp - x)*(1.0_wp - 3.0_wp*x), dh11 => x*(3.0_wp*x - 2.0_wp))
         at%motion%d = from%motion%d + h01*(to%motion%d - from%motion%d) + h10*from%motion%v &
               + h11*to%motion%v
         at%motion%v = dh01*(to%motion%d - from%motion%d) + dh10*from%motion%v + dh11*to%motion%v
      end associate
      at%motion%a = from%motion%a + x*(to%motion%a - from%motion%a)
      at%lambda = from%lambda + x*(to%lambda - from%lambda)
      at%tau = from%tau + x*(to%tau - from%tau)
      at%force = from%force + x*(to%force - from%force)
      at%left_out = from%left_out + x*(to%left_out - from%left_out)
      at%jump = 0.0_wp
      at%sticking = to%sticking
      at%fresh = .false.
      call impose(scene%system, at%motion)
   end subroutine interpolate_motion

   !> Free rows that overlap at the end of the step or dip under the wall inside it, with the times
   !> of it (both ends of their brackets); both zero for a row that is hit at once.
   subroutine find_hits_between(scene, from, to, span, hits)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: from, to
      type(span_type), intent(in) :: span
      type(hits_type), intent(out) :: hits
      real(wp), dimension(scene%rows%n, 2) :: gaps, rates
      logical :: free(scene%rows%n)
      real(wp) :: x
      integer :: i, status

      allocate (hits%row(scene%rows%n), hits%low(scene%rows%n), hits%high(scene%rows%n), &
            stat=status)
      call check_allocation(status)
      gaps(:, 1) = row_gaps(scene%rows, from%motion)
      gaps(:, 2) = row_gaps(scene%rows, to%motion)
      rates(:, 1) = row_rates(scene%rows, from%motion)
      rates(:, 2) = row_rates(scene%rows, to%motion)
      free = may_hit(scene%rows) .and. .not. from%touching
      do i = 1, scene%rows%n
         if (.not. free(i)) cycle
         x = hit_time(new_hermite_path(span%dt, gaps(i, :), rates(i, :)), span)
         if (x < 0.0_wp) cycle
         hits%n = hits%n + 1
         hits%row(hits%n) = i
         hits%low(hits%n) = x
         hits%high(hits%n) = x
      end do
   end subroutine find_hits_between

   !> When a path meets the wall, negative if it does not. One that starts slightly overlapped and
   !> opens does not.
   pure function hit_time(path, span) result(x)
      type(path_type), intent(in) :: path
      type(span_type), intent(in) :: span
      real(wp) :: x
      real(wp) :: threshold, low, high, dip

      x = -1.0_wp
      threshold = min(path%g0, 0.0_wp) - span%gap_limit
      high = path%s
      dip = find_dip(path)
      if (dip > 0.0_wp) then
         if (path_value(path, dip) < threshold) high = dip
      end if
      if (path_value(path, high) >= threshold) return
      low = 0.0_wp
      if (path%g0 <= span%gap_limit) then
         x = 0.0_wp
         if (path%r0 <= span%rate_limit) return
         ! it leaves the wall first, and comes back
         low = find_rise(path)
         if (low < 0.0_wp .or. low >= high) return
         if (path_value(path, low) <= span%gap_limit) return
      end if
      x = find_root(path, low, high)
   end function hit_time

end module step_interpolant
