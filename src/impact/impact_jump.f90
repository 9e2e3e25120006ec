!> The velocity jump of an impact: impulses over all rows concerned, with friction by Coulomb's
!> cone, and capture of slow rebounds.
module impact_jump
   use kinds, only: wp
   use errors, only: error_type
   use constraint_rows, only: row_rates, slip_rates
   use impact_scene, only: scene_type, contact_motion_type, event_type, record_event, &
         capture_speeds, event_impact, event_capture, event_limit
   use row_compliance, only: compliance_type, mass_compliance, pushed, join_rates, split_forces
   use rough_rows, only: solve_rows
   use contact_impulses, only: hold_acceleration, restart_acceleration, project_touching
   use impulse_account, only: book_impulse, book_friction, book_reactions, dependent_impulses
   implicit none
   private

   public :: impact_type, apply_impact

   !> What happens at one instant.
   type :: impact_type
      logical, allocatable :: new(:)         !! (n_rows) rows that hit
      logical, allocatable :: near(:)        !! (n_rows) rows at the wall that take part if pushed
      logical, allocatable :: forced(:)      !! (n_rows) of these, captured: pressed at rest
      logical :: plastic = .false.           !! every new row is captured: too many events
      real(wp) :: dt = 0.0_wp                !! the whole step, for the capture speed
      real(wp) :: beta = 0.0_wp              !! for the record
      real(wp) :: rate_limit = 0.0_wp        !! smaller rates are round-off
   end type impact_type

contains

   !> 0 <= p, (G M^-1 Gt) p + G v- + e G v- >= 0 over new and touching rows together (e on the new
   !> ones); v+ = v- + M^-1 Gt p, displacements as they are. New rows that would rebound slower than
   !> the capture speed get e = 0 and touch from then on. Books energy and events.
   subroutine apply_impact(scene, motion, impact, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(impact_type), intent(in) :: impact
      type(error_type), allocatable, intent(out) :: error
      type(compliance_type) :: compliance
      real(wp), dimension(scene%rows%n) :: before, after, slip, impulse, friction
      real(wp) :: v_before(size(motion%motion%v))
      logical :: held(scene%rows%n), was(scene%rows%n)

      was = motion%touching
      v_before = motion%motion%v
      before = row_rates(scene%rows, motion%motion)
      slip = slip_rates(scene%rows, motion%motion)
      call mass_compliance(scene, was .or. impact%new .or. impact%near, compliance, error)
      if (allocated(error)) return
      call find_impulse(scene, motion, impact, compliance, impulse, friction, held, error)
      if (allocated(error)) return
      after = row_rates(scene%rows, motion%motion)
      motion%touching = held
      call book_impulse(scene, motion, impulse, before, after)
      call book_friction(scene, motion, friction, slip)
      call book_reactions(scene, motion, v_before, impulse, friction)
      call project_touching(scene, motion, 0.0_wp, 0.0_wp, error)
      if (allocated(error)) return
      call restart_acceleration(scene, motion, error)
      if (allocated(error)) return
      scene%impulse = scene%impulse + impulse
      call note_events(scene, motion, impact, was, impulse, before)
   end subroutine apply_impact

   !> Impulses and the velocity after them; repeated while a new row rebounds too slowly, or a row
   !> without rebound is thrown open by others so slowly that it would be back within the step: held
   !> then, or rows with mass in common would hit in turn at ever shorter times.
   subroutine find_impulse(scene, motion, impact, compliance, impulse, friction, held, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(impact_type), intent(in) :: impact
      type(compliance_type), intent(in) :: compliance
      real(wp), intent(out) :: impulse(:)        !! (n_rows)
      real(wp), intent(out) :: friction(:)       !! (n_rows) along the tangents
      logical, intent(out) :: held(:)            !! (n_rows) rows that touch afterwards
      type(error_type), allocatable, intent(out) :: error
      real(wp), dimension(scene%rows%n) :: e, before, slip, after, limits
      real(wp), dimension(size(motion%motion%v)) :: v_before, jump_before
      real(wp), dimension(size(compliance%w, 1)) :: q, p
      logical, dimension(scene%rows%n) :: slow, open, pressed
      logical :: solved

      pressed = .false.
      impulse = 0.0_wp
      friction = 0.0_wp
      before = row_rates(scene%rows, motion%motion)
      slip = slip_rates(scene%rows, motion%motion)
      v_before = motion%motion%v
      jump_before = motion%jump
      e = merge(scene%rows%restitution, 0.0_wp, impact%new .and. .not. impact%plastic)
      do
         q = join_rates(compliance, before + e*min(0.0_wp, before), slip)
         call solve_rows(compliance%w, q, scene%rows%friction(compliance%rows), &
               pressed(compliance%rows), p, solved)
         if (.not. solved) then
            call dependent_impulses(scene, motion%motion%t, compliance, error)
            return
         end if
         call split_forces(compliance, p, impulse, friction)
         motion%motion%v = v_before + pushed(scene, compliance, p)
         motion%jump = jump_before + (motion%motion%v - v_before)
         after = row_rates(scene%rows, motion%motion)
         held = motion%touching .or. (impact%new .and. .not. e > 0.0_wp) .or. &
               (impact%near .and. impulse > 0.0_wp)
         open = held .and. .not. impulse > 0.0_wp .and. after > impact%rate_limit
         held = impact%forced .or. pressed .or. (impact%new .and. impact%plastic) .or. &
               (held .and. .not. open)
         call hold_acceleration(scene, motion, held, error)
         if (allocated(error)) return
         limits = max(capture_speeds(scene, motion%motion%a, impact%dt), impact%rate_limit)
         slow = impact%new .and. .not. impact%forced .and. e > 0.0_wp .and. after <= limits
         open = open .and. .not. held .and. after <= limits
         pressed = pressed .or. open
         slow = slow .or. open
         if (.not. any(slow)) exit
         where (slow) e = 0.0_wp
      end do
   end subroutine find_impulse

   subroutine note_events(scene, motion, impact, was, impulse, before)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(impact_type), intent(in) :: impact
      logical, intent(in) :: was(:)
      real(wp), intent(in) :: impulse(:), before(:)
      type(event_type) :: event
      real(wp) :: after(scene%rows%n)
      integer :: i

      after = row_rates(scene%rows, motion%motion)
      do i = 1, scene%rows%n
         event = event_type(motion%motion%t, event_impact, i, before(i), after(i), impulse(i), &
               impact%beta)
         if (impact%new(i)) call record_event(scene, event)
         event%kind = event_capture
         if (impact%plastic) event%kind = event_limit
         if (motion%touching(i) .and. .not. was(i)) call record_event(scene, event)
      end do
   end subroutine note_events

end module impact_jump
