!> The smooth motion between events: over all that remains of a step, or up to where the first of
!> the touching rows lets go.
module contact_release
   use kinds, only: wp
   use errors, only: error_type
   use constraint_rows, only: row_rates, gap_size, rate_size
   use impact_scene, only: scene_type, contact_motion_type, event_type, record_event, &
         opening_rows, event_release, gap_tolerance, rate_tolerance, merge_time_tolerance
   use constrained_step, only: advance_smoothly
   use contact_impulses, only: restart_acceleration
   use impact_time, only: span_type
   use row_following, only: rows_ahead
   implicit none
   private

   public :: progress_type, smooth_span, release_rows, note_return

   !> Where a step with events stands.
   type :: progress_type
      real(wp) :: dt = 0.0_wp                !! the whole step
      real(wp) :: t_end = 0.0_wp
      real(wp) :: remaining = 0.0_wp
      real(wp) :: beta = 0.25_wp
      integer :: n_events = 0
      logical :: at_limit = .false.          !! no more events are allowed
      real(wp), allocatable :: let_go(:)     !! (n_rows) what remained when the row was released
      logical, allocatable :: stubborn(:)    !! (n_rows) held to the end of the step (note_return)
      logical, allocatable :: returned(:)    !! (n_rows) back at the instant of a release before
      logical, allocatable :: ignored(:)     !! (n_rows) not hit any more in this step
   end type progress_type

   !> A contact force below this part of its size at the start of the span has vanished.
   real(wp), parameter :: release_tolerance = 1.0e-3_wp
   integer, parameter :: max_release_trials = 8

contains

   !> The smooth motion ahead: over all that remains, or up to the first release of a touching row.
   !> A row that opens at once is let go here (`span%dt` zero: begin again). At the limit of events
   !> all rows that touch are held to the end of the step, so that each can be captured but once:
   !> let go, one might be back under the wall before the next event is found.
   subroutine smooth_span(scene, motion, progress, span, next, release, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      type(progress_type), intent(inout) :: progress
      type(span_type), intent(out) :: span
      type(contact_motion_type), intent(inout) :: next   !! gets the end; its arrays are used again
      logical, intent(out) :: release(:)         !! (n_rows) rows to let go at the end of the span
      type(error_type), allocatable, intent(out) :: error
      logical :: opening(size(release))

      span%dt = progress%remaining
      span%beta = progress%beta
      span%held = motion%touching
      span%gap_limit = gap_tolerance*gap_size(scene%rows, motion%motion, progress%dt)
      ! rows of bodies that slide on each other are put on their edges anyway
      span%found_limit = span%gap_limit
      if (scene%rows%moving) span%found_limit = 10.0_wp*span%gap_limit
      span%rate_limit = rate_tolerance*rate_size(scene%rows, motion%motion)
      release = .false.
      if (any(progress%stubborn) .or. progress%at_limit) then
         call advance_smoothly(scene, motion, span%dt, span%beta, next, error, motion%touching)
      else
         call advance_smoothly(scene, motion, span%dt, span%beta, next, error)
      end if
      if (allocated(error) .or. progress%at_limit .or. .not. any(motion%touching)) return
      opening = opening_rows(scene, motion, next) .and. .not. progress%stubborn
      span%held = motion%touching .and. .not. opening
      if (any(opening)) then
         call cut_at_release(scene, motion, opening, progress, span, next, release, error)
      end if
   end subroutine smooth_span

   !> Ends the span where the first of the opening rows lets go.
   subroutine cut_at_release(scene, motion, opening, progress, span, next, release, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      logical, intent(in) :: opening(:)          !! (n_rows)
      type(progress_type), intent(inout) :: progress
      type(span_type), intent(inout) :: span
      type(contact_motion_type), intent(inout) :: next
      logical, intent(inout) :: release(:)       !! (n_rows)
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: theta(size(release)), first

      call release_times(scene, motion, span, opening, theta, error)
      if (allocated(error)) return
      first = minval(theta, mask=opening)
      release = opening .and. theta <= first + merge_time_tolerance
      if (first <= merge_time_tolerance) then
         call release_rows(scene, motion, release, progress)
         ! with no time gone since the restart, the force in the acceleration is not a past one
         if (motion%fresh) call restart_acceleration(scene, motion, error)
         motion%fresh = .false.
         span%dt = 0.0_wp
      else if (first < 1.0_wp - merge_time_tolerance) then
         span%held = motion%touching
         call locate_release(scene, motion, release, first, span, next, error)
      end if
   end subroutine cut_at_release

   !> Cuts the span where the first of the releasing rows has lost its contact force: the linear
   !> guess, improved by regula falsi where the force is not linear (steps large for the structure).
   subroutine locate_release(scene, motion, release, first, span, next, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      logical, intent(in) :: release(:)          !! (n_rows)
      real(wp), intent(in) :: first              !! linear guess, in parts of the span
      type(span_type), intent(inout) :: span
      type(contact_motion_type), intent(inout) :: next
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: low, high, force_low, force_high, force, whole
      integer :: row, i

      row = findloc(release, .true., dim=1)
      whole = span%dt
      low = 0.0_wp
      high = whole
      force_low = motion%lambda(row)
      force_high = force_low*(1.0_wp - 1.0_wp/first)
      span%dt = first*whole
      do i = 1, max_release_trials
         call hold_for_a_while(scene, motion, span, next, error)
         if (allocated(error)) return
         force = next%lambda(row)
         if (abs(force) <= release_tolerance*motion%lambda(row)) return
         if (force > 0.0_wp) then
            low = span%dt
            force_low = force
            force_high = force_high/2.0_wp
         else
            high = span%dt
            force_high = force
            force_low = force_low/2.0_wp
         end if
         span%dt = low + (high - low)*force_low/(force_low - force_high)
      end do
      call hold_for_a_while(scene, motion, span, next, error)
   end subroutine locate_release

   !> A part of the step with touching rows held, sliding rows placed at its end.
   subroutine hold_for_a_while(scene, motion, span, next, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(span_type), intent(in) :: span
      type(contact_motion_type), intent(out) :: next
      type(error_type), allocatable, intent(out) :: error

      call rows_ahead(scene, motion, span%dt, error)
      if (allocated(error)) return
      call advance_smoothly(scene, motion, span%dt, span%beta, next, error, span%held)
   end subroutine hold_for_a_while

   !> When the opening rows let go, in parts of the span: contact forces go linearly over it.
   subroutine release_times(scene, motion, span, opening, theta, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(span_type), intent(in) :: span
      logical, intent(in) :: opening(:)
      real(wp), intent(out) :: theta(:)          !! (n_rows)
      type(error_type), allocatable, intent(out) :: error
      type(contact_motion_type) :: held

      theta = 1.0_wp
      where (opening .and. .not. motion%lambda > 0.0_wp) theta = 0.0_wp
      if (.not. scene%settings%locate_release) return
      call advance_smoothly(scene, motion, span%dt, span%beta, held, error, motion%touching)
      if (allocated(error)) return
      where (opening .and. motion%lambda > 0.0_wp .and. held%lambda < 0.0_wp)
         theta = motion%lambda/(motion%lambda - held%lambda)
      end where
   end subroutine release_times

   !> Lets rows go. The acceleration stays as it is, contact force included: restarted without it,
   !> the
   !> row would be thrown back.
   subroutine release_rows(scene, motion, release, progress)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      logical, intent(in) :: release(:)
      type(progress_type), intent(inout) :: progress
      type(event_type) :: event
      real(wp) :: rates(size(release))
      logical :: new(size(release))
      integer :: i

      new = release .and. abs(progress%let_go - progress%remaining) > 0.0_wp
      motion%touching = motion%touching .and. .not. release
      if (.not. any(new)) return
      rates = row_rates(scene%rows, motion%motion)
      progress%n_events = progress%n_events + 1
      do i = 1, size(release)
         if (.not. new(i)) cycle
         progress%let_go(i) = progress%remaining
         event = event_type(motion%motion%t, event_release, i, rates(i), rates(i), 0.0_wp, &
               progress%beta)
         call record_event(scene, event)
      end do
   end subroutine release_rows

   !> A row that comes back at the instant of its release, on a curved edge or, once more, without
   !> speed, has a contact force that just vanishes: within the error of the step it stays. It is
   !> held to the end of the step.
   pure subroutine note_return(motion, slow, progress)
      type(contact_motion_type), intent(in) :: motion
      logical, intent(in) :: slow(:)             !! (n_rows) that may have come back so
      type(progress_type), intent(inout) :: progress
      logical :: back(size(slow))

      back = slow .and. motion%touching .and. &
            abs(progress%let_go - progress%remaining) <= merge_time_tolerance*progress%dt
      progress%stubborn = progress%stubborn .or. (back .and. progress%returned)
      progress%returned = progress%returned .or. back
   end subroutine note_return

end module contact_release
