!> What every impact method offers: take the motion over one time step.
module impact_method
   use kinds, only: wp
   use errors, only: error_type
   use impact_scene, only: scene_type, contact_motion_type
   implicit none
   private

   public :: impact_method_type

   !> A way to treat impacts; `start` prepares the first state of a run or step.
   type, abstract :: impact_method_type
   contains
      procedure(start_interface), deferred :: start
      procedure(advance_interface), deferred :: advance
   end type impact_method_type

   abstract interface
      !> Contact and acceleration at the start of a dynamic step from its d and v.
      subroutine start_interface(self, scene, motion, dt, error)
         import :: impact_method_type, scene_type, contact_motion_type, error_type, wp
         implicit none
         class(impact_method_type), intent(in) :: self
         type(scene_type), intent(inout) :: scene
         type(contact_motion_type), intent(inout) :: motion
         real(wp), intent(in) :: dt              !! step size to come
         type(error_type), allocatable, intent(out) :: error
      end subroutine start_interface

      !> Takes the motion from its time over dt.
      subroutine advance_interface(self, scene, motion, dt, error)
         import :: impact_method_type, scene_type, contact_motion_type, error_type, wp
         implicit none
         class(impact_method_type), intent(in) :: self
         type(scene_type), intent(inout) :: scene
         type(contact_motion_type), intent(inout) :: motion
         real(wp), intent(in) :: dt
         type(error_type), allocatable, intent(out) :: error
      end subroutine advance_interface
   end interface

end module impact_method
