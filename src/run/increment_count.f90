!> How many increments of fixed size a step has, and how long the last of them is.
module increment_count
   use kinds, only: wp
   use steps, only: step_type
   implicit none
   private

   public :: count_increments, last_increment

contains

   !> Increments of a step; a remainder of more than round-off gets one of its own.
   pure function count_increments(step) result(n)
      type(step_type), intent(in) :: step
      integer :: n

      n = max(1, ceiling(step%duration/step%dt*(1.0_wp - 1.0e-9_wp)))
   end function count_increments

   !> Length of the last increment: the step's dt unless a remainder is left.
   pure function last_increment(step, n) result(dt)
      type(step_type), intent(in) :: step
      integer, intent(in) :: n
      real(wp) :: dt

      dt = step%duration - (n - 1)*step%dt
      if (abs(dt - step%dt) <= 1.0e-6_wp*step%dt) dt = step%dt
   end function last_increment

end module increment_count
