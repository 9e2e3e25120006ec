!> Gaps for the records. The rows of a run see only as far as its steps need; for the records they
!> are placed anew with a wide reach, on copies: the run goes on undisturbed.
module gap_probe
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use kinds, only: wp
   use state_archive, only: archive_type
   use contact_geometry, only: contact_geometry_type
   use constraint_rows, only: rows_type, row_gaps
   use row_placement, only: place_rows
   use impact_scene, only: scene_type, contact_motion_type
   implicit none
   private

   public :: gap_probe_type, new_gap_probe, probe_gaps, not_a_number

   !> The reach is this multiple of the model's size, ...
   real(wp), parameter :: widest_reach = 2.0_wp
   !> ... and with more rows than this the less, so that the search grows with their number only.
   real(wp), parameter :: many_rows = 2000.0_wp

   !> Copies of the rows and of what places them.
   type :: gap_probe_type
      type(rows_type) :: rows
      type(contact_geometry_type) :: geometry
      real(wp) :: reach = 0.0_wp
   contains
      procedure :: pass_state
   end type gap_probe_type

contains

   !> Copies the rows of a scene; needed only where they move.
   subroutine new_gap_probe(self, scene)
      type(gap_probe_type), intent(out) :: self
      type(scene_type), intent(in) :: scene

      self%rows = scene%rows
      if (.not. scene%rows%moving) return
      self%geometry = scene%geometry
      self%reach = widest_reach*scene%geometry%size &
            *min(1.0_wp, many_rows/max(1.0_wp, real(scene%rows%n, wp)))
   end subroutine new_gap_probe

   !> What searches leave behind.
   subroutine pass_state(self, archive)
      class(gap_probe_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%enter('probe')
      call self%geometry%pass_state(archive)
      call archive%leave()
   end subroutine pass_state

   !> Gaps of all rows, NaN where there is no partner within the reach.
   subroutine probe_gaps(self, scene, motion, gaps)
      type(gap_probe_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      real(wp), intent(out) :: gaps(:)           !! (n_rows)

      if (scene%rows%moving) call place_rows(self%rows, self%geometry, &
            scene%system%structure%map, motion%motion, motion%motion, self%reach)
      gaps = row_gaps(self%rows, motion%motion)
      where (.not. self%rows%facing) gaps = not_a_number()
   end subroutine probe_gaps

   !> A quiet NaN.
   pure function not_a_number() result(value)
      real(wp) :: value

      value = ieee_value(1.0_wp, ieee_quiet_nan)
   end function not_a_number

end module gap_probe
