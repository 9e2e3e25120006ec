!> Contacts of the first state of a step: what touches, what is hit at once, what is pressed.
module first_contacts
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use complementarity, only: solve_complementarity
   use constraint_rows, only: row_gaps, row_rates, row_accelerations, row_curvature, gap_size, &
         rate_size, may_hit
   use impact_scene, only: scene_type, contact_motion_type, gap_tolerance, rate_tolerance
   use row_compliance, only: compliance_type, mass_compliance
   use contact_impulses, only: restart_acceleration
   use impact_jump, only: impact_type, apply_impact
   implicit none
   private

   public :: find_first_contacts

contains

   !> The first state: rows that touch and close are hit at once; rows that touch at rest and are
   !> pressed are captured; then the acceleration of equilibrium.
   subroutine find_first_contacts(scene, motion, dt, beta, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: dt                 !! step to come
      real(wp), intent(in) :: beta               !! of the impact step, for the record
      type(error_type), allocatable, intent(out) :: error
      type(impact_type) :: impact
      real(wp) :: gap_limit
      integer :: i, status
      logical :: known

      gap_limit = gap_tolerance*gap_size(scene%rows, motion%motion, dt)
      impact%dt = dt
      impact%beta = beta
      impact%rate_limit = rate_tolerance*rate_size(scene%rows, motion%motion)
      allocate (impact%forced(scene%rows%n), impact%near(scene%rows%n), stat=status)
      call check_allocation(status)
      impact%forced = .false.
      call capture_pressed(scene, motion, gap_limit, impact%rate_limit, known, error)
      if (allocated(error)) return
      do i = 1, scene%settings%max_events
         impact%new = may_hit(scene%rows) .and. .not. motion%touching .and. &
               row_gaps(scene%rows, motion%motion) <= gap_limit .and. &
               row_rates(scene%rows, motion%motion) < -impact%rate_limit
         if (.not. any(impact%new)) exit
         if (i == 1 .and. .not. known) call restart_acceleration(scene, motion, error)
         if (allocated(error)) return
         impact%near = may_hit(scene%rows) .and. .not. (motion%touching .or. impact%new) .and. &
               .not. scene%rows%restitution > 0.0_wp .and. &
               row_gaps(scene%rows, motion%motion) <= gap_limit
         call apply_impact(scene, motion, impact, error)
         if (allocated(error)) return
      end do
      call restart_acceleration(scene, motion, error)
      motion%fresh = .true.
   end subroutine find_first_contacts

   !> Rows at rest at the wall: 0 <= lambda, W lambda + G a_free >= 0; those with a force touch.
   subroutine capture_pressed(scene, motion, gap_limit, rate_limit, known, error)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      real(wp), intent(in) :: gap_limit, rate_limit
      logical, intent(out) :: known              !! the acceleration had to be found
      type(error_type), allocatable, intent(out) :: error
      type(compliance_type) :: compliance
      real(wp) :: a_rows(scene%rows%n)
      real(wp), allocatable :: lambda(:)
      logical :: resting(scene%rows%n), solved
      integer :: status

      resting = may_hit(scene%rows) .and. row_gaps(scene%rows, motion%motion) <= gap_limit .and. &
            abs(row_rates(scene%rows, motion%motion)) <= rate_limit
      motion%touching = .false.
      known = any(resting)
      if (.not. known) return
      call restart_acceleration(scene, motion, error)
      if (allocated(error)) return
      call mass_compliance(scene, resting, compliance, error, .true.)
      if (allocated(error)) return
      allocate (lambda(size(compliance%rows)), stat=status)
      call check_allocation(status)
      a_rows = row_accelerations(scene%rows, motion%motion%a) &
            + row_curvature(scene%rows, motion%motion)
      call solve_complementarity(compliance%w, a_rows(compliance%rows), lambda, solved)
      if (solved) motion%touching(compliance%rows) = lambda > 0.0_wp
   end subroutine capture_pressed

end module first_contacts
