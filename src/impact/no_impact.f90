!> The plain step: no contact rows, no events.
module no_impact
   use kinds, only: wp
   use errors, only: error_type
   use impact_scene, only: scene_type, contact_motion_type, accept_span, exchange_motions
   use impact_method, only: impact_method_type
   use contact_impulses, only: restart_acceleration
   use constrained_step, only: advance_smoothly
   use explicit_motion, only: new_explicit_motion, advance_explicitly
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

      if (.not. scene%explicit%ready) call look_ahead(scene, motion)
      if (scene%explicit%usable .and. scene%explicit%ready) then
         call advance_explicitly(scene%explicit, scene%system, scene%ledger, motion%motion, dt)
         return
      end if
      call exchange_motions(scene%spare, next)
      call advance_smoothly(scene, motion, dt, scene%system%newmark%beta, next, error)
      if (allocated(error)) return
      call accept_span(scene, motion, next)
      call exchange_motions(motion, next)
      call exchange_motions(scene%spare, next)
   end subroutine advance

   !> Whether the step to come is wholly explicit. A jump of the velocity that dampers are to resist
   !> in parts needs the general way first.
   subroutine look_ahead(scene, motion)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion

      call new_explicit_motion(scene%explicit, scene%system, motion%motion)
      if (scene%rows%n > 0) scene%explicit%usable = .false.
      if (.not. scene%explicit%usable) return
      scene%explicit%ready = all(abs(motion%left_out) <= 0.0_wp)
      if (scene%explicit%ready) motion%jump = 0.0_wp
   end subroutine look_ahead

end module no_impact
