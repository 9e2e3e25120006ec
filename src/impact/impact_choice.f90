!> Which rows take part in an impact.
module impact_choice
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use constraint_rows, only: row_gaps, row_rates, rate_size, may_hit
   use impact_scene, only: scene_type, contact_motion_type, gap_tolerance, merge_gap_tolerance, &
         rate_tolerance, merge_time_tolerance
   use contact_release, only: progress_type
   use impact_time, only: span_type, hits_type
   use impact_jump, only: impact_type
   implicit none
   private

   public :: choose_rows

   !> Impacts this close, in parts of the step, are one where the step is of fourth order: one that
   !> is taken too early is off by twice what is left of its gap.
   real(wp), parameter :: finest_merge_time = 1.0e-10_wp

contains

   !> Which rows take part in the impact: all that close and are at the wall now, or will be within
   !> the merging time; rows at rest that are pressed against the wall are captured without impact.
   subroutine choose_rows(scene, motion, span, hits, tau, progress, impact)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(span_type), intent(in) :: span
      type(hits_type), intent(in) :: hits
      real(wp), intent(in) :: tau
      type(progress_type), intent(in) :: progress
      type(impact_type), intent(out) :: impact
      real(wp), dimension(scene%rows%n) :: gaps, rates
      real(wp) :: near, at_wall, nearest
      integer :: i, row, status

      gaps = row_gaps(scene%rows, motion%motion)
      rates = row_rates(scene%rows, motion%motion)
      at_wall = span%gap_limit*(merge_gap_tolerance/gap_tolerance)
      near = progress%dt*merge(finest_merge_time, merge_time_tolerance, scene%settings%fourth_order)
      impact%dt = progress%dt
      impact%beta = progress%beta
      impact%plastic = progress%at_limit
      impact%rate_limit = rate_tolerance*rate_size(scene%rows, motion%motion)
      impact%new = may_hit(scene%rows) .and. .not. motion%touching .and. &
            rates < -impact%rate_limit .and. &
            (gaps <= at_wall .or. gaps <= -near*rates)
      ! an impact elsewhere may push a row at the wall; without a rebound of its own it answers at
      ! once
      impact%near = may_hit(scene%rows) .and. .not. motion%touching .and. .not. impact%new .and. &
            .not. scene%rows%restitution > 0.0_wp .and. gaps <= at_wall
      allocate (impact%forced(scene%rows%n), stat=status)
      call check_allocation(status)
      impact%forced = .false.
      do i = 1, hits%n
         row = hits%row(i)
         impact%forced(row) = .not. hits%high(i) > 0.0_wp .and. .not. tau > 0.0_wp .and. &
               rates(row) >= -impact%rate_limit
      end do
      if (.not. any(impact%new) .and. .not. any(impact%forced)) then
         ! never go on with nothing: the row that is nearest then, and those that are as near
         nearest = minval(gaps(hits%row(:hits%n)))
         impact%forced(hits%row(:hits%n)) = gaps(hits%row(:hits%n)) <= nearest + at_wall
      end if
      impact%new = impact%new .or. impact%forced
      impact%near = impact%near .and. .not. impact%new
   end subroutine choose_rows

end module impact_choice
