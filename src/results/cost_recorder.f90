!> Writes /cost: how often a run has done what is dear, and where its time went.
module cost_recorder
   use kinds, only: wp, int64
   use errors, only: error_type
   use cost_account, only: n_phases, phase_names, phase_meanings
   use impact_scene, only: scene_type
   use hdf5_file, only: hdf5_file_type, series_integer
   implicit none
   private

   public :: write_cost

   character(len=*), parameter :: group = '/cost/'

contains

   !> Writes the group. The clock of the scene has been stopped.
   subroutine write_cost(file, scene, error)
      type(hdf5_file_type), intent(inout) :: file
      type(scene_type), intent(in) :: scene
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      call file%create_group('/cost', 'what the run has cost', error)
      if (allocated(error)) return
      call write_counts(file, scene, error)
      if (allocated(error)) return
      associate (cost => scene%system%cost)
         call file%write_dataset(group//'cpu_seconds', [cost%processor], &
               'processor time of all threads', error)
         if (allocated(error)) return
         call file%write_dataset(group//'elapsed_seconds', [cost%elapsed], &
               'time elapsed, which the phases add up to', error)
         do i = 1, n_phases
            if (allocated(error)) return
            call file%write_dataset(group//'seconds_'//trim(phase_names(i)), [cost%seconds(i)], &
                  'time elapsed in: '//trim(phase_meanings(i)), error)
         end do
      end associate
   end subroutine write_cost

   subroutine write_counts(file, scene, error)
      type(hdf5_file_type), intent(inout) :: file
      type(scene_type), intent(in) :: scene
      type(error_type), allocatable, intent(out) :: error

      associate (cost => scene%system%cost, matrices => scene%system%matrices)
         call write_count('increments', cost%increments, 'increments accepted')
         call write_count('iterations', scene%n_iterations, &
               'iterations of Newton''s method and of the fictitious force')
         call write_count('solves', matrices%n_solves, &
               'back-substitutions, one for each right-hand side')
         call write_count('factorizations', matrices%n_factorizations, &
               'factorizations of matrices that couple equations')
         call write_count('element_updates', cost%element_updates, &
               'forces or a matrix of one element worked out')
         call write_count('energy_updates', cost%energy_updates, &
               'energies of one element worked out by themselves')
         call write_count('stress_updates', cost%stress_updates, &
               'stresses of one element worked out for records and frames')
         call write_count('contact_searches', scene%geometry%n_searches, &
               'placements of all contact rows of bodies that slide')
         call write_count('contact_rows', cost%contact_rows, &
               'contact rows for whose forces or impulses a solution was sought, summed up')
      end associate

   contains

      subroutine write_count(name, value, description)
         character(len=*), intent(in) :: name, description
         integer(int64), intent(in) :: value

         if (allocated(error)) return
         call file%create_series(group//name, series_integer, 0, 1, description, error)
         if (.not. allocated(error)) call file%append(group//name, [value], error)
      end subroutine write_count

   end subroutine write_counts

end module cost_recorder
