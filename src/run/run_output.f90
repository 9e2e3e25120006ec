!> What a run writes to, and when others see it.
module run_output
   use kinds, only: wp, int64
   use errors, only: error_type
   use cost_account, only: cost_type
   use state_archive, only: archive_type
   use result_file, only: result_file_type
   use run_log, only: log_type
   use step_tally, only: tally_type
   use increment_notices, only: seen_type
   use shape_watch, only: shape_type
   use publishing, only: publishing_type, is_due, publish_now, was_slow_to_start
   use stop_request, only: watch_type, start_looking
   use deck_check, only: preview_type
   implicit none
   private

   public :: output_type, aside_type, publish_after_start, publish_now_and_then

   !> The state at the end of a step, where it has been put off: it is written if an error ends the
   !> run before another state is.
   type :: aside_type
      type(archive_type), allocatable :: archive
      real(wp) :: price = 0.0_wp                 !! seconds that the last one took
      real(wp) :: spent = 0.0_wp                 !! seconds for all of them
   end type aside_type

   !> What a run writes to, and what it listens to.
   type :: output_type
      type(result_file_type) :: results
      type(log_type) :: log
      type(tally_type) :: tally
      type(seen_type) :: seen                    !! counters that warnings come from
      type(shape_type) :: shape                  !! largest rotation, strain
      logical :: gain_told = .false.             !! that contact has added energy
      type(preview_type) :: preview
      type(publishing_type) :: publishing
      type(watch_type) :: watch
      logical :: state_due = .false.             !! *RESTART asks for the state of this increment
      type(aside_type) :: aside
      integer(int64) :: iterations = 0           !! at the end of the last increment
   end type output_type

contains

   !> The initial state, where getting that far has taken a while.
   subroutine publish_after_start(output, cost, error)
      type(output_type), intent(inout) :: output
      type(cost_type), intent(inout) :: cost
      type(error_type), allocatable, intent(out) :: error

      if (was_slow_to_start(output%publishing)) call publish_now(output%publishing, &
            output%results, output%log, cost, error)
   end subroutine publish_after_start

   !> Keeps what others see complete up to a few seconds ago.
   subroutine publish_now_and_then(output, cost, error)
      type(output_type), intent(inout) :: output
      type(cost_type), intent(inout) :: cost
      type(error_type), allocatable, intent(out) :: error

      if (.not. output%watch%pace%fresh) return
      if (.not. is_due(output%publishing)) return
      call publish_now(output%publishing, output%results, output%log, cost, error)
      output%watch%saving = output%publishing%price
      call start_looking(output%watch)
   end subroutine publish_now_and_then

end module run_output
