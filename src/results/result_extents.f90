!> How far the growing parts of a result file reach, so that a run can go on behind a place in it.
module result_extents
   use errors, only: error_type
   use part_file, only: part_file_type, shown_path
   use model, only: model_type
   use contact_pairs, only: contact_pair_list_type
   use impact_scene, only: scene_type
   use state_archive, only: archive_type
   use result_file, only: result_file_type, make_parts
   implicit none
   private

   public :: extents_type, measure_results, resume_results

   !> Rows and columns of the tables, frames and fields of the grid.
   type :: extents_type
      integer :: history(2) = 0, energy(2) = 0, events(2) = 0, frames(2) = 0
   contains
      procedure :: pass_state
   end type extents_type

contains

   subroutine pass_state(self, archive)
      class(extents_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%enter('results')
      call pass_pair('history', self%history)
      call pass_pair('energy', self%energy)
      call pass_pair('events', self%events)
      call pass_pair('frames', self%frames)
      call archive%leave()

   contains

      subroutine pass_pair(name, pair)
         character(len=*), intent(in) :: name
         integer, intent(inout) :: pair(2)

         call archive%pass(name//'_reached', pair(1))
         call archive%pass(name//'_beside', pair(2))
      end subroutine pass_pair

   end subroutine pass_state

   !> What results hold now, in the file or on the way there.
   subroutine measure_results(extents, results)
      type(extents_type), intent(out) :: extents
      type(result_file_type), intent(in) :: results

      extents%history = [results%history%table%count_rows(), results%history%table%count_columns()]
      extents%energy = [results%energy%count_rows(), results%energy%count_columns()]
      extents%events = [results%events%count_rows(), results%events%count_columns()]
      extents%frames = [results%grid%grid%count_frames(), results%grid%grid%count_fields()]
   end subroutine measure_results

   !> Opens the results of an earlier run, which have been copied to the part file, and cuts them
   !> back to go on behind a place in them. If they are not what the deck records now, `misfit` says
   !> so: they cannot be gone on with then.
   subroutine resume_results(self, place, model, scene, list, extents, misfit, error)
      type(result_file_type), intent(inout) :: self
      type(part_file_type), intent(in) :: place  !! taken over
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      type(contact_pair_list_type), intent(in) :: list
      type(extents_type), intent(in) :: extents
      character(len=:), allocatable, intent(out) :: misfit
      type(error_type), allocatable, intent(out) :: error   !! status_file
      type(extents_type) :: present_extents

      call self%file%modify_claimed(place, shown_path(place), error)
      if (allocated(error)) return
      ! these come last in a run
      call self%file%remove('/cost', error)
      if (.not. allocated(error)) call self%file%remove('/frequency', error)
      if (.not. allocated(error)) call make_parts(self, model, scene, list, error)
      if (.not. allocated(error)) call cut_results(self, extents, misfit, error)
      if (allocated(error) .or. allocated(misfit)) return
      call measure_results(present_extents, self)
      if (any([present_extents%history, present_extents%energy, present_extents%events, &
            present_extents%frames] /= [extents%history, extents%energy, extents%events, &
            extents%frames])) misfit = 'they have columns or fields besides'
      self%has_records = .not. allocated(misfit)
   end subroutine resume_results

   subroutine cut_results(self, extents, misfit, error)
      type(result_file_type), intent(inout) :: self
      type(extents_type), intent(in) :: extents
      character(len=:), allocatable, intent(out) :: misfit
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: short

      call self%history%table%cut_back(self%file, extents%history(1), short, error)
      if (.not. (allocated(error) .or. allocated(short))) call self%events%cut_back(self%file, &
            extents%events(1), short, error)
      if (.not. (allocated(error) .or. allocated(short))) call self%energy%cut_back(self%file, &
            extents%energy(1), short, error)
      if (.not. (allocated(error) .or. allocated(short))) call self%grid%grid%cut_back(self%file, &
            extents%frames(1), short, error)
      if (allocated(short)) misfit = short//' is missing or too short in them'
   end subroutine cut_results

end module result_extents
