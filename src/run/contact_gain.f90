!> Contact that gives energy to what it touches: a step too long for its springs, or a return
!> parameter too large.
module contact_gain
   use kinds, only: wp, int64
   use text, only: to_text
   use surfaces, only: method_penalty, method_fictitious_force
   use impact_scene, only: scene_type
   use run_log, only: log_type, warn
   implicit none
   private

   public :: warn_of_gain

   !> Part of the largest energy met that contact may add.
   real(wp), parameter :: much = 0.01_wp

contains

   !> At the end of a step, its energies known.
   subroutine warn_of_gain(scene, t, told, log)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: t                  !! total time
      logical, intent(inout) :: told             !! it has been said
      type(log_type), intent(inout) :: log

      associate (ledger => scene%ledger)
         if (told .or. .not. -ledger%impact_loss > much*ledger%scale) return
         told = .true.
         call warn(log, 'contact has added the energy '//to_text(-ledger%impact_loss, 3)//', ' &
               //to_text(-100.0_wp*ledger%impact_loss/ledger%scale, 2)//' % of the largest in ' &
               //'this run ('//to_text(ledger%scale, 3)//'), where it can only take some' &
               //new_line('a')//'  cure: '//cure_of(scene%settings%method), .true., t, 1_int64)
      end associate
   end subroutine warn_of_gain

   pure function cure_of(method) result(cure)
      integer, intent(in) :: method
      character(len=:), allocatable :: cure

      select case (method)
      case (method_penalty)
         cure = 'a smaller step or a smaller STIFFNESS, so that some 20 increments fall in a ' &
               //'period of the mass of a node on its contact spring; or METHOD=TRANSFORMATION'
      case (method_fictitious_force)
         cure = 'a smaller step, or METHOD=TRANSFORMATION'
      case default
         cure = 'a smaller step'
      end select
   end function cure_of

end module contact_gain
