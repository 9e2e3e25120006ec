!> How many increments of fixed size a step has, and how long the last of them is.
module increment_count
   use kinds, only: wp
   use errors, only: error_type
   use text, only: to_text
   use places, only: fail_at
   use model, only: model_type
   use steps, only: step_type, procedure_dynamic
   use impact_scene, only: impact_settings_type
   implicit none
   private

   public :: count_increments, last_increment, check_remainder

contains

   !> Increments of a step; a remainder of more than round-off gets one of its own.
   pure function count_increments(step, origin) result(n)
      type(step_type), intent(in) :: step
      real(wp), intent(in), optional :: origin   !! step time that they are counted from
      integer :: n
      real(wp) :: length

      length = step%duration
      if (present(origin)) length = step%duration - origin
      n = max(1, ceiling(length/step%dt*(1.0_wp - 1.0e-9_wp)))
   end function count_increments

   !> Length of the last increment: the step's dt unless a remainder is left.
   pure function last_increment(step, n, origin) result(dt)
      type(step_type), intent(in) :: step
      integer, intent(in) :: n
      real(wp), intent(in), optional :: origin   !! step time that they are counted from
      real(wp) :: dt

      dt = step%duration - (n - 1)*step%dt
      if (present(origin)) dt = (step%duration - origin) - (n - 1)*step%dt
      if (abs(dt - step%dt) <= 1.0e-6_wp*step%dt) dt = step%dt
   end function last_increment

   !> The fictitious force without restitution is a penalty as stiff as the step is short: a last
   !> increment much shorter than the others throws back what overlap they have left.
   subroutine check_remainder(model, settings, step, error)
      type(model_type), intent(in) :: model
      type(impact_settings_type), intent(in) :: settings
      type(step_type), intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      real(wp), parameter :: shortest = 0.5_wp
      real(wp) :: last

      if (.not. (settings%fictitious .and. settings%pure)) return
      if (step%procedure /= procedure_dynamic .or. .not. step%direct) return
      last = last_increment(step, count_increments(step))
      if (last >= shortest*step%dt*(1.0_wp - 1.0e-9_wp)) return
      call fail_at(error, model%source, step%time_place, 'METHOD=FICTITIOUS FORCE without ' &
            //'RESTITUTION and a last increment of '//to_text(last)//': what overlap the longer ' &
            //'ones leave it throws back', &
            'write T as a multiple of dt, give a RESTITUTION, or take another METHOD')
   end subroutine check_remainder

end module increment_count
