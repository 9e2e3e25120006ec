!> Writes free vibrations: /frequency, and the mode shapes as frames of the grid.
module mode_recorder
   use kinds, only: wp
   use errors, only: error_type
   use eigen_analysis, only: modes_type
   use contact_pairs, only: contact_pair_list_type
   use impact_scene, only: scene_type, contact_motion_type, new_contact_motion
   use gap_probe, only: not_a_number
   use snapshot, only: snapshot_type, take_snapshot
   use grid_recorder, only: record_frame
   use result_file, only: result_file_type
   implicit none
   private

   public :: record_modes

contains

   !> Writes all modes, their shapes with the frequency in the place of the time.
   subroutine record_modes(self, scene, list, motion, modes, error)
      type(result_file_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_pair_list_type), intent(in) :: list
      type(contact_motion_type), intent(in) :: motion   !! about which they were found
      type(modes_type), intent(in) :: modes
      type(error_type), allocatable, intent(out) :: error
      type(contact_motion_type) :: shape
      type(snapshot_type) :: snapshot
      integer :: i

      call write_numbers(self, modes, error)
      if (allocated(error)) return
      ! a mode's stresses are those of its shape alone, and gaps mean nothing in it
      call new_contact_motion(shape, size(motion%motion%d), scene%rows%n, &
            size(motion%motion%history))
      do i = 1, modes%n
         shape%motion%d = modes%shape(:, i)
         shape%motion%t = modes%frequency(i)
         call take_snapshot(snapshot, scene, shape, .false.)
         snapshot%gap = not_a_number()
         call record_frame(self%grid, self%file, scene, list, snapshot, error)
         if (allocated(error)) return
      end do
      self%has_records = .true.
   end subroutine record_modes

   subroutine write_numbers(self, modes, error)
      type(result_file_type), intent(inout) :: self
      type(modes_type), intent(in) :: modes
      type(error_type), allocatable, intent(out) :: error

      call self%file%create_group('/frequency', 'free vibrations, one row a mode', error)
      if (allocated(error)) return
      call self%file%write_dataset('/frequency/eigenvalue', modes%eigenvalue, &
            'square of the angular frequency', error)
      if (allocated(error)) return
      call self%file%write_dataset('/frequency/frequency', modes%frequency, &
            'cycles per unit of time; negative where the eigenvalue is', error)
      if (allocated(error)) return
      call self%file%write_dataset('/frequency/effective_mass', modes%effective_mass, &
            'mass that takes part when the supports move along x, y, z', error)
      if (allocated(error)) return
      call self%file%write_dataset('/frequency/moving_mass', modes%moving_mass, &
            'mass that is free to move along x, y, z: effective masses of all modes add up to it', &
            error)
      if (allocated(error)) return
      call self%file%write_dataset('/frequency/residual', modes%residual, &
            'residual of the eigenvalue problem, relative', error)
   end subroutine write_numbers

end module mode_recorder
