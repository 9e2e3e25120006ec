!> What a run writes to, and when that is brought to the disk.
module run_output
   use kinds, only: wp, int64
   use errors, only: error_type
   use text, only: to_text
   use clock, only: seconds_now, pace_type, start_pace
   use cost_account, only: cost_type, enter, leave, phase_output
   use result_file, only: result_file_type, flush_results
   use run_log, only: log_type
   use progress, only: progress_type
   use stop_request, only: watch_type, look_for_stop, stop_run
   use deck_check, only: preview_type
   implicit none
   private

   public :: output_type, flush_after_start, flush_now_and_then, stop_if_asked

   !> Results are brought to the disk at least this often, seconds.
   real(wp), parameter :: flush_interval = 5.0_wp
   !> Before the first increment of a run whose start-up took longer they are there too, seconds.
   real(wp), parameter :: quick_start = 0.5_wp

   !> What a run writes to, and what it listens to.
   type :: output_type
      type(result_file_type) :: results
      type(log_type) :: log
      type(progress_type) :: progress
      type(preview_type) :: preview
      type(watch_type) :: watch
      type(pace_type) :: pace                    !! of the increments
      real(wp) :: last_flush = 0.0_wp
      real(wp) :: saving = 0.0_wp                !! seconds that the last flush took
      real(wp) :: end_time = 0.0_wp              !! total time at the end of the run
      integer(int64) :: iterations = 0           !! at the end of the last increment
   end type output_type

contains

   !> The initial state, where getting that far has taken a while.
   subroutine flush_after_start(output, cost, error)
      type(output_type), intent(inout) :: output
      type(cost_type), intent(inout) :: cost
      type(error_type), allocatable, intent(out) :: error

      if (seconds_now() - output%last_flush > quick_start) call flush_now(output, cost, error)
   end subroutine flush_after_start

   !> Keeps the file complete up to a few seconds ago.
   subroutine flush_now_and_then(output, cost, error)
      type(output_type), intent(inout) :: output
      type(cost_type), intent(inout) :: cost
      type(error_type), allocatable, intent(out) :: error

      if (.not. output%pace%fresh) return
      if (output%pace%now - output%last_flush >= flush_interval) call flush_now(output, cost, error)
   end subroutine flush_now_and_then

   subroutine flush_now(output, cost, error)
      type(output_type), intent(inout) :: output
      type(cost_type), intent(inout) :: cost
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: began
      integer :: outer

      began = seconds_now()
      call enter(cost, phase_output, outer, .true.)
      call flush_results(output%results, error)
      call leave(cost, outer)
      call start_pace(output%pace)
      output%last_flush = output%pace%now
      output%saving = output%pace%now - began
   end subroutine flush_now

   !> Stops the run between two increments if something asks for it.
   subroutine stop_if_asked(output, i_step, increment, t, error)
      type(output_type), intent(inout) :: output
      integer, intent(in) :: i_step, increment   !! the last one taken, 0 for none
      real(wp), intent(in) :: t                  !! total time
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: place

      call look_for_stop(output%watch, output%pace, output%saving)
      if (.not. allocated(output%watch%reason)) return
      place = 'at the start of step '//to_text(i_step)
      if (increment > 0) place = 'after increment '//to_text(increment)//' of step ' &
            //to_text(i_step)
      call stop_run(output%watch, place//', total time '//to_text(t), error)
   end subroutine stop_if_asked

end module run_output
