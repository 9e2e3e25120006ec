!> What a run writes to, and when others see it.
module run_output
   use kinds, only: wp, int64
   use errors, only: error_type
   use text, only: to_text
   use clock, only: pace_type, start_pace
   use cost_account, only: cost_type
   use result_file, only: result_file_type
   use run_log, only: log_type
   use progress, only: progress_type
   use publishing, only: publishing_type, is_due, publish_now, was_slow_to_start
   use stop_request, only: watch_type, look_for_stop, stop_run
   use deck_check, only: preview_type
   implicit none
   private

   public :: output_type, publish_after_start, publish_now_and_then, stop_if_asked

   !> What a run writes to, and what it listens to.
   type :: output_type
      type(result_file_type) :: results
      type(log_type) :: log
      type(progress_type) :: progress
      type(preview_type) :: preview
      type(publishing_type) :: publishing
      type(watch_type) :: watch
      type(pace_type) :: pace                    !! of the increments
      real(wp) :: end_time = 0.0_wp              !! total time at the end of the run
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

      if (.not. output%pace%fresh) return
      if (.not. is_due(output%publishing)) return
      call publish_now(output%publishing, output%results, output%log, cost, error)
      call start_pace(output%pace)
   end subroutine publish_now_and_then

   !> Stops the run between two increments if something asks for it.
   subroutine stop_if_asked(output, i_step, increment, t, error)
      type(output_type), intent(inout) :: output
      integer, intent(in) :: i_step, increment   !! the last one taken, 0 for none
      real(wp), intent(in) :: t                  !! total time
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: place

      call look_for_stop(output%watch, output%pace, output%publishing%price)
      if (.not. allocated(output%watch%reason)) return
      place = 'at the start of step '//to_text(i_step)
      if (increment > 0) place = 'after increment '//to_text(increment)//' of step ' &
            //to_text(i_step)
      call stop_run(output%watch, place//', total time '//to_text(t), error)
   end subroutine stop_if_asked

end module run_output
