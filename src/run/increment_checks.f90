!> What stops a run after an increment: a motion that is not finite, energies that do not balance.
module increment_checks
   use kinds, only: wp
   use errors, only: error_type, new_error, status_numerical
   use text, only: to_text
   use steps, only: step_type, request_type, request_energy_print
   use output_plan, only: is_due
   use motion_state, only: state_type
   use energy_ledger, only: ledger_type
   implicit none
   private

   public :: check_finite, check_energies, check_interpolation, check_balance
   public :: needs_energies

contains

   !> A motion that is not finite stops the run; what was good is in the results.
   subroutine check_finite(motion, ledger, dt, error)
      type(state_type), intent(in) :: motion
      type(ledger_type), intent(in) :: ledger
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error

      ! energies of every freedom, if just found, leave no doubt
      if (ledger%has_found) then
         if (all(abs(ledger%found) <= huge(1.0_wp))) return
      end if
      if (all(abs(motion%d) <= huge(1.0_wp)) .and. all(abs(motion%v) <= huge(1.0_wp)) .and. &
            all(abs(motion%a) <= huge(1.0_wp))) return
      call new_error(error, status_numerical, &
            'the motion is not finite (NaN or infinite) at time ' &
            //to_text(motion%t)//last_good(motion%t, dt)//new_line('a') &
            //'  cure: a smaller step, and a look at the loads and the energy before it')
   end subroutine check_finite

   !> Energies are squares: they overflow while the motion is still finite.
   subroutine check_energies(ledger, t, dt, error)
      type(ledger_type), intent(in) :: ledger    !! of the last increment closed
      real(wp), intent(in) :: t, dt              !! its end and its size
      type(error_type), allocatable, intent(out) :: error

      if (abs(ledger%total) <= huge(1.0_wp) .and. abs(ledger%balance_error) <= huge(1.0_wp)) return
      call new_error(error, status_numerical, 'the energies are not finite at time '//to_text(t) &
            //': kinetic '//to_text(ledger%kinetic)//', strain '//to_text(ledger%strain) &
            //', external work '//to_text(ledger%external_work) &
            //last_good(t, dt)//new_line('a') &
            //'  cure: other units, so that the squares of displacements and velocities do not ' &
            //'overflow; or a smaller step, if energy grew from step to step')
   end subroutine check_energies

   !> Up to where the results go, nothing at the start of a run.
   function last_good(t, dt) result(words)
      real(wp), intent(in) :: t, dt
      character(len=:), allocatable :: words

      words = ''
      if (dt > 0.0_wp) words = '; the last good increment is at '//to_text(t - dt)
   end function last_good

   !> EVENTS=ANCHOR interpolates between the ends of steps, which makes energy of nothing where a
   !> step is many periods long. Half of all there is must not come from there.
   subroutine check_interpolation(ledger, t, error)
      type(ledger_type), intent(in) :: ledger
      real(wp), intent(in) :: t
      type(error_type), allocatable, intent(out) :: error
      real(wp), parameter :: most_made = 0.5_wp

      if (ledger%balance_error <= most_made*ledger%scale) return
      call new_error(error, status_numerical, 'EVENTS=ANCHOR has made the energy ' &
            //to_text(ledger%balance_error)//' of '//to_text(ledger%scale)//' by interpolation ' &
            //'until time '//to_text(t)//': the step is too long for it'//new_line('a') &
            //'  cure: a smaller step, or EVENTS=SUBSTEP')
   end subroutine check_interpolation

   !> Whether energies are recorded or limited at the end of an increment.
   pure function needs_energies(requests, increment) result(needed)
      type(request_type), intent(in) :: requests(:)
      integer, intent(in) :: increment
      logical :: needed

      needed = is_due(requests, [request_energy_print], increment, .false.) .or. &
            any(requests%kind == request_energy_print .and. requests%balance_limit > 0.0_wp)
   end function needs_energies

   !> The deck's limit on the balance error, a part of the largest energy met.
   subroutine check_balance(ledger, step, t, error)
      type(ledger_type), intent(in) :: ledger
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: t
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(step%requests)
         if (step%requests(i)%kind /= request_energy_print) cycle
         if (.not. step%requests(i)%balance_limit > 0.0_wp) cycle
         if (abs(ledger%balance_error) <= step%requests(i)%balance_limit*ledger%scale) cycle
         call new_error(error, status_numerical, 'the energy balance error ' &
               //to_text(ledger%balance_error)//' at time '//to_text(t)//' exceeds LIMIT=' &
               //to_text(step%requests(i)%balance_limit)//' of the energy '//to_text(ledger%scale) &
               //new_line('a')//'  cure: a smaller step, or a larger LIMIT on *ENERGY PRINT')
         return
      end do
   end subroutine check_balance

end module increment_checks
