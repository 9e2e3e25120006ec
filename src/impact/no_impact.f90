!> The plain step: no contact rows, no events.
module no_impact
   use kinds, only: wp
   use errors, only: error_type
   use impact_scene, only: scene_type, contact_motion_type, accept_span
   use impact_method, only: impact_method_type
   use contact_impulses, only: restart_acceleration
   use constrained_step, only: advance_smoothly
   implicit none
   private

   public :: no_impact_type

   !> Newmark's method as it is.
   type, extends(impact_method_type) :: no_impact_type
   contains
      procedure :: start
      procedure :: advance
   end type no_impact_type

contains

   !> M a0 = f0 - C v0 - S(d0).
   subroutine start(self, scene, motion, dt, error)
      class(no_impact_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error

      call restart_acceleration(scene, motion, error)
   end subroutine start

   !> One step of smooth motion.
   subroutine advance(self, scene, motion, dt, error)
      class(no_impact_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      type(contact_motion_type) :: next

      call advance_smoothly(scene, motion, dt, scene%system%newmark%beta, next, error)
      if (allocated(error)) return
      call accept_span(scene, motion, next)
      motion = next
   end subroutine advance

end module no_impact
