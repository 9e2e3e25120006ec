!> A bar under uniaxial stress, twice: from the law in its plane, and in one dimension on its own.
module uniaxial_bar
   use kinds, only: wp
   use elastic, only: plane_stress
   use j2_plastic, only: j2_type, n_state
   implicit none
   private

   public :: bar_type, pull_bar, pull_in_plane, table_value

   !> The bar in one dimension.
   type :: bar_type
      real(wp) :: young = 0.0_wp
      logical :: kinematic = .false.
      real(wp), allocatable :: x(:), y(:)
      real(wp) :: plastic = 0.0_wp
      real(wp) :: peeq = 0.0_wp
   end type bar_type

contains

   !> The table at x, constant beyond its ends.
   pure real(wp) function table_value(x, y, at)
      real(wp), intent(in) :: x(:), y(:), at
      integer :: i

      table_value = y(size(y))
      if (at <= x(1)) table_value = y(1)
      do i = 1, size(x) - 1
         if (at > x(i) .and. at <= x(i + 1)) table_value = y(i) &
               + (y(i + 1) - y(i))*(at - x(i))/(x(i + 1) - x(i))
      end do
   end function table_value

   !> Stress after a strain step that does not turn back, by bisection of the yield condition. The
   !> centre of a kinematic bar is given and moved.
   subroutine pull_bar(bar, strain, centre, stress)
      type(bar_type), intent(inout) :: bar
      real(wp), intent(in) :: strain
      real(wp), intent(inout) :: centre
      real(wp), intent(out) :: stress
      real(wp) :: trial, low, high, growth, side
      integer :: i

      trial = bar%young*(strain - bar%plastic) - centre
      side = sign(1.0_wp, trial)
      stress = trial + centre
      if (abs(trial) <= radius(bar, bar%peeq)) return
      low = 0.0_wp
      high = abs(trial)/bar%young
      do i = 1, 200
         growth = (low + high)/2.0_wp
         if (abs(trial) - bar%young*growth - moved(bar, growth) &
               > radius(bar, bar%peeq + growth)) then
            low = growth
         else
            high = growth
         end if
      end do
      centre = centre + side*moved(bar, growth)
      bar%plastic = bar%plastic + side*growth
      bar%peeq = bar%peeq + growth
      stress = bar%young*(strain - bar%plastic)
   end subroutine pull_bar

   real(wp) function radius(bar, peeq)
      type(bar_type), intent(in) :: bar
      real(wp), intent(in) :: peeq

      radius = bar%y(1)
      if (.not. bar%kinematic) radius = table_value(bar%x, bar%y, peeq)
   end function radius

   !> Way of the centre for a growth.
   real(wp) function moved(bar, growth)
      type(bar_type), intent(in) :: bar
      real(wp), intent(in) :: growth

      moved = 0.0_wp
      if (bar%kinematic) moved = table_value(bar%x, bar%y, bar%peeq + growth) &
            - table_value(bar%x, bar%y, bar%peeq)
   end function moved

   !> Newton's iteration for the strains 11 and 33 without stress 11 and 33 at a given strain 22.
   subroutine pull_in_plane(law, along, strain, state, stress, residual)
      type(j2_type), intent(in) :: law
      real(wp), intent(in) :: along
      real(wp), intent(inout) :: strain(4)
      real(wp), intent(inout) :: state(n_state)
      real(wp), intent(out) :: stress(4)
      real(wp), allocatable, intent(out) :: residual(:)   !! size of the stresses, per iteration
      real(wp) :: updated(n_state), c(4, 4), det
      integer :: i

      strain(2) = along
      allocate (residual(0))
      do i = 1, 30
         call law%update(strain, state, stress, updated, c)
         residual = [residual, norm2(stress([1, 3]))]
         if (residual(i) < 1.0e-12_wp*norm2(law%y)) exit
         if (law%plane == plane_stress) then
            strain(1) = strain(1) - stress(1)/c(1, 1)
         else
            det = c(1, 1)*c(3, 3) - c(1, 3)*c(3, 1)
            strain([1, 3]) = strain([1, 3]) - [c(3, 3)*stress(1) - c(1, 3)*stress(3), &
                  c(1, 1)*stress(3) - c(3, 1)*stress(1)]/det
         end if
      end do
      state = updated
   end subroutine pull_in_plane

end module uniaxial_bar
