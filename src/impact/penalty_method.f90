!> The penalty method: a row that overlaps is pushed by a spring, k times its overlap, and with
!> friction held by another of the same k along the tangent, whose force follows from its own of the
!> step before by return mapping,
!>
!>     lambda1 = k max(0, -g1),   tau1 = tau0 - k s, brought back to |tau1| <= mu lambda1,
!>
!> s the slip of the step, all at its end: implicit with Newmark's beta, explicit at beta = 0. The
!> overlap left is lambda/k; the energy of the springs counts as strain energy. That a spring comes
!> and goes within a step is not resolved: the step in which contact begins takes k o1 g0/2 from the
!> bodies (g0 the gap before, o1 the overlap after), the one in which it ends gives k o0 g1/2, and
!> a stiff spring in a large step gives more than it has taken. The ledger calls both impact loss.
module penalty_method
   use kinds, only: wp
   use errors, only: error_type, new_error, status_numerical
   use text, only: to_text
   use equation_of_motion, only: prepare_mass, solve_mass
   use constraint_rows, only: row_rates, row_vector
   use impact_scene, only: scene_type, contact_motion_type, event_type, record_event, accept_span, &
         event_contact, event_release
   use impact_method, only: impact_method_type
   use contact_impulses, only: restart_acceleration
   use row_following, only: rows_ahead, rows_here
   use constrained_step, only: advance_smoothly
   implicit none
   private

   public :: penalty_method_type

   !> Contact by springs.
   type, extends(impact_method_type) :: penalty_method_type
   contains
      procedure :: start
      procedure :: advance
   end type penalty_method_type

contains

   !> Springs push where rows overlap, as after a static step.
   subroutine start(self, scene, motion, dt, error)
      class(penalty_method_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error

      motion%touching = .false.
      call rows_here(scene, motion, dt)
      call restart_acceleration(scene, motion, error)
   end subroutine start

   !> One step with springs. Errors: those of the step, and a spring too stiff for it.
   subroutine advance(self, scene, motion, dt, error)
      class(penalty_method_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      type(contact_motion_type) :: next
      logical :: pushed(scene%rows%n), was_pushed(scene%rows%n)

      call rows_ahead(scene, motion, dt, error)
      if (allocated(error)) return
      call advance_smoothly(scene, motion, dt, scene%system%newmark%beta, next, error)
      if (allocated(error)) return
      call accept_span(scene, motion, next)
      pushed = next%lambda > 0.0_wp
      was_pushed = motion%lambda > 0.0_wp
      call note_events(scene, motion, next, pushed .and. .not. was_pushed, event_contact)
      call note_events(scene, motion, next, was_pushed .and. .not. pushed, event_release)
      call check_springs(scene, next, pushed .and. .not. was_pushed, dt, error)
      motion = next
   end subroutine advance

   subroutine note_events(scene, from, to, marked, kind)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from, to
      logical, intent(in) :: marked(:)           !! (n_rows)
      integer, intent(in) :: kind
      real(wp), dimension(scene%rows%n) :: before, after
      integer :: i

      if (.not. any(marked)) return
      before = row_rates(scene%rows, from%motion)
      after = row_rates(scene%rows, to%motion)
      do i = 1, scene%rows%n
         if (marked(i)) call record_event(scene, event_type(to%motion%t, kind, i, before(i), &
               after(i), 0.0_wp, scene%system%newmark%beta))
      end do
   end subroutine note_events

   !> Where the step is stable for small frequencies only, beta < gamma/2, springs must be slow too:
   !> (gamma/2 - beta) h^2 k G M^-1 Gt <= 1 for each row on its own, which is necessary.
   subroutine check_springs(scene, motion, marked, dt, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      logical, intent(in) :: marked(:)           !! (n_rows)
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: force(size(motion%motion%d)), room, stiffness, limit
      integer :: i

      room = scene%system%newmark%gamma/2.0_wp - scene%system%newmark%beta
      if (.not. any(marked) .or. .not. room > 0.0_wp) return
      call prepare_mass(scene%system, error)
      if (allocated(error)) return
      do i = 1, scene%rows%n
         if (.not. marked(i)) cycle
         force = row_vector(scene%rows, i, size(force))
         stiffness = room*scene%rows%stiffness(i) &
               *dot_product(force, solve_mass(scene%system, force))
         if (.not. stiffness*dt**2 > 1.0_wp) cycle
         limit = 1.0_wp/sqrt(stiffness)
         call new_error(error, status_numerical, 'the contact spring of node ' &
               //to_text(scene%rows%node_id(i))//' is too stiff for the step '//to_text(dt) &
               //' at time '//to_text(motion%motion%t)//new_line('a') &
               //'  cure: a step below '//to_text(limit, 4)//', or a STIFFNESS below ' &
               //to_text(scene%rows%stiffness(i)*(limit/dt)**2, 4))
         return
      end do
   end subroutine check_springs

end module penalty_method
