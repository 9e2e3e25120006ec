!> The fictitious-force method (Ayari and Saouma): overlaps are pulled back in the iteration of the
!> step by back-substitutions only. A row with a restitution coefficient ends its contact as soon as
!> it would leave faster than e times its approach speed, or opens, and then jumps to that speed.
module fictitious_force
   use kinds, only: wp
   use errors, only: error_type
   use constraint_rows, only: row_gaps, row_rates, row_accelerations, rate_size, &
         acceleration_size
   use impact_scene, only: scene_type, contact_motion_type, event_type, record_event, accept_span, &
         capture_speeds, event_impact, event_capture, event_release, event_contact, &
         let_go, rate_tolerance, acceleration_tolerance
   use impact_method, only: impact_method_type
   use contact_impulses, only: restart_acceleration, set_rates
   use row_following, only: rows_ahead, rows_here
   use constrained_step, only: advance_smoothly
   implicit none
   private

   public :: fictitious_force_type

   !> Contact by pull-back forces.
   type, extends(impact_method_type) :: fictitious_force_type
   contains
      procedure :: start
      procedure :: advance
   end type fictitious_force_type

contains

   !> Nothing is in contact before the first overlap.
   subroutine start(self, scene, motion, dt, error)
      class(fictitious_force_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error

      motion%touching = .false.
      motion%leaving = .false.
      motion%entry_speed = 0.0_wp
      motion%sticking = .false.
      call rows_here(scene, motion, dt)
      call restart_acceleration(scene, motion, error)
   end subroutine start

   !> One step with pull-back forces, then the ends of contacts with restitution.
   subroutine advance(self, scene, motion, dt, error)
      class(fictitious_force_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      type(contact_motion_type) :: next
      logical :: ending(scene%rows%n)

      call rows_ahead(scene, motion, dt, error)
      if (allocated(error)) return
      call advance_smoothly(scene, motion, dt, scene%system%newmark%beta, next, error)
      if (allocated(error)) return
      call accept_span(scene, motion, next)
      call note_contacts(scene, motion, next)
      ending = next%entry_speed > 0.0_wp .and. &
            (row_rates(scene%rows, next%motion) >= scene%rows%restitution*next%entry_speed .or. &
            row_gaps(scene%rows, next%motion) >= 0.0_wp)
      if (any(ending)) call end_contacts(scene, next, dt, ending, error)
      if (allocated(error)) return
      call release_open(scene, next)
      ! a row on its way out is free again once it is out, or when it turns back; one that has just
      ! ended its contact with e = 0 has no speed yet
      next%leaving = next%leaving .and. row_gaps(scene%rows, next%motion) < 0.0_wp &
            .and. (ending .or. row_rates(scene%rows, next%motion) > 0.0_wp)
      motion = next
   end subroutine advance

   !> Begins and ends of overlap. With restitution, the approach speed is kept.
   subroutine note_contacts(scene, from, to)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      type(contact_motion_type), intent(inout) :: to
      real(wp) :: approach(scene%rows%n), rates(scene%rows%n)
      logical :: pushed, was_pushed
      integer :: i

      approach = row_rates(scene%rows, from%motion)
      rates = row_rates(scene%rows, to%motion)
      do i = 1, scene%rows%n
         if (to%touching(i)) cycle
         pushed = to%lambda(i) > 0.0_wp
         was_pushed = from%lambda(i) > 0.0_wp .and. .not. from%touching(i)
         if (pushed .and. .not. was_pushed) then
            call record_event(scene, event_type(to%motion%t, event_contact, i, approach(i), &
                  rates(i), 0.0_wp, scene%system%newmark%beta))
            if (.not. scene%rows%sustained(i) .and. .not. to%entry_speed(i) > 0.0_wp) then
               to%entry_speed(i) = max(-approach(i), tiny(1.0_wp))
            end if
         else if (was_pushed .and. .not. pushed .and. scene%rows%sustained(i)) then
            call record_event(scene, event_type(to%motion%t, event_release, i, approach(i), &
                  rates(i), 0.0_wp, scene%system%newmark%beta))
         end if
      end do
   end subroutine note_contacts

   !> The jump to e times the approach speed; a rebound below the capture speed stays in contact,
   !> held
   !> where it is (moving it to gap zero would add energy).
   subroutine end_contacts(scene, motion, dt, ending, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt
      logical, intent(in) :: ending(:)
      type(error_type), allocatable, intent(out) :: error
      real(wp), dimension(scene%rows%n) :: before, target_rate, impulse, closing, limits
      logical :: captured(scene%rows%n)
      real(wp) :: rate_limit
      integer :: i

      before = row_rates(scene%rows, motion%motion)
      target_rate = merge(scene%rows%restitution*motion%entry_speed, 0.0_wp, ending)
      rate_limit = rate_tolerance*rate_size(scene%rows, motion%motion)
      call set_rates(scene, motion, ending .or. motion%touching, target_rate, impulse, error)
      if (allocated(error)) return
      call restart_acceleration(scene, motion, error)
      if (allocated(error)) return
      closing = max(0.0_wp, -row_accelerations(scene%rows, motion%motion%a))
      limits = max(capture_speeds(scene, motion%motion%a, dt), rate_limit)
      ! a rebound that is back within one step would be repeated for ever
      where (scene%rows%capture < 0.0_wp) limits = max(limits, dt/2.0_wp*closing)
      captured = ending .and. closing > 0.0_wp .and. target_rate <= limits
      do i = 1, scene%rows%n
         if (.not. ending(i)) cycle
         call record_event(scene, event_type(motion%motion%t, event_impact, i, &
               -motion%entry_speed(i), target_rate(i), impulse(i), scene%system%newmark%beta))
         if (captured(i)) call record_event(scene, event_type(motion%motion%t, event_capture, i, &
               before(i), target_rate(i), impulse(i), scene%system%newmark%beta))
      end do
      motion%touching = motion%touching .or. captured
      motion%leaving = motion%leaving .or. (ending .and. .not. captured)
      where (ending) motion%entry_speed = 0.0_wp
      if (any(captured)) call settle(scene, motion, error)
   end subroutine end_contacts

   !> Captured rows come to rest and are held.
   subroutine settle(scene, motion, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: at_rest(scene%rows%n), impulse(scene%rows%n)

      at_rest = 0.0_wp
      call set_rates(scene, motion, motion%touching, at_rest, impulse, error)
      if (allocated(error)) return
      call restart_acceleration(scene, motion, error)
   end subroutine settle

   !> Lets captured rows go that are pulled apart.
   subroutine release_open(scene, motion)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      logical :: open(scene%rows%n)

      if (.not. any(motion%touching)) return
      open = motion%touching .and. .not. motion%lambda > 0.0_wp .and. &
            row_accelerations(scene%rows, motion%motion%a) > acceleration_tolerance &
            *acceleration_size(scene%rows, motion%motion%a)
      call let_go(scene, motion, open)
   end subroutine release_open

end module fictitious_force
