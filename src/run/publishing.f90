!> When the results of a run are brought to where others see them.
!>
!> The library rewrites its file in place, so the run writes aside (part_file) and publishes copies.
!> Publications are so far apart that they take a twentieth of the time.
module publishing
   use kinds, only: wp
   use errors, only: error_type
   use clock, only: seconds_now
   use cost_account, only: cost_type, enter, leave, phase_output
   use result_file, only: result_file_type, publish_results
   use run_log, only: log_type, check_log
   implicit none
   private

   public :: publishing_type, start_publishing, was_slow_to_start, is_due, publish_now

   !> When the last publication was, and what it took.
   type :: publishing_type
      real(wp) :: last = 0.0_wp
      real(wp) :: price = 0.0_wp                 !! seconds
   end type publishing_type

   !> Seconds between two publications at least.
   real(wp), parameter :: shortest = 5.0_wp
   !> Seconds of start-up after which the initial state is published.
   real(wp), parameter :: slow_start = 1.0_wp
   !> A publication takes at most one part of so many of the time.
   real(wp), parameter :: share = 20.0_wp

contains

   !> The run begins.
   subroutine start_publishing(self)
      type(publishing_type), intent(out) :: self

      self%last = seconds_now()
   end subroutine start_publishing

   !> Whether so much time has passed before the first increment that its state is worth a copy.
   function was_slow_to_start(self) result(slow)
      type(publishing_type), intent(in) :: self
      logical :: slow

      slow = seconds_now() - self%last > slow_start
   end function was_slow_to_start

   !> Whether it is time for a publication; for small files a state to restart from may be
   !> published earlier: `interval` then is 0.
   function is_due(self, interval) result(due)
      type(publishing_type), intent(in) :: self
      real(wp), intent(in), optional :: interval   !! seconds, instead of the usual ones
      logical :: due
      real(wp) :: wait

      wait = shortest
      if (present(interval)) wait = interval
      due = seconds_now() - self%last >= max(wait, share*self%price)
   end function is_due

   !> Brings the log to its file and publishes all results. The log goes first: whatever ends the
   !> run, status lines up to the state that others see are there.
   subroutine publish_now(self, results, log, cost, error, began)
      type(publishing_type), intent(inout) :: self
      type(result_file_type), intent(inout) :: results
      type(log_type), intent(inout) :: log
      type(cost_type), intent(inout) :: cost
      type(error_type), allocatable, intent(out) :: error   !! status_file
      real(wp), intent(in), optional :: began    !! when what is published was begun to be made
      type(error_type), allocatable :: log_error
      real(wp) :: start
      integer :: outer

      call enter(cost, phase_output, outer, .true.)
      start = seconds_now()
      if (present(began)) start = began
      call check_log(log, log_error)
      call publish_results(results, error)
      self%last = seconds_now()
      self%price = self%last - start
      call leave(cost, outer)
      if (.not. allocated(error) .and. allocated(log_error)) call move_alloc(log_error, error)
   end subroutine publish_now

end module publishing
