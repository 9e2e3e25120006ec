!> What asks a run to stop between two increments: a signal, a stop file beside the deck, the time
!> limit.
module stop_request
   use kinds, only: wp
   use text, only: to_text
   use clock, only: pace_type
   use errors, only: error_type, new_error, status_interrupted
   use file_calls, only: remove_file
   use stop_signals, only: signal_came, signal_name
   implicit none
   private

   public :: watch_type, start_watch, look_for_stop, remove_stop_files, stop_run

   !> What is looked at, and when.
   type :: watch_type
      character(len=:), allocatable :: reason    !! to stop, once there is one
      character(len=:), allocatable, private :: deck, stem   !! path, and that without its ending
      real(wp), private :: next_look = 0.0_wp    !! for a stop file, on the clock
      real(wp), private :: limit = 0.0_wp        !! seconds the run may take, 0: no limit
      real(wp), private :: deadline = huge(1.0_wp)   !! on the clock
      real(wp), private :: longest = 0.0_wp      !! of the last increments, seconds
   end type watch_type

   !> Seconds between two looks for a stop file.
   real(wp), parameter :: pause = 1.0_wp
   !> Part of the longest increment that the one before the last counts for, so that one long
   !> increment is forgotten after some dozens.
   real(wp), parameter :: memory = 0.95_wp
   !> An increment may take so many times the longest of the last ones.
   real(wp), parameter :: surprise = 1.5_wp
   !> Part of the limit, and seconds at most, that are kept for closing files and for other surprises.
   real(wp), parameter :: reserve = 0.05_wp, most_reserve = 1.0_wp

contains

   !> A watch over a run of the deck that began at a time of the clock.
   subroutine start_watch(self, deck, time_limit, began)
      type(watch_type), intent(out) :: self
      character(len=*), intent(in) :: deck       !! path
      real(wp), intent(in) :: time_limit         !! seconds, 0: none
      real(wp), intent(in) :: began
      integer :: dot

      dot = index(deck, '.', back=.true.)
      if (dot <= index(deck, '/', back=.true.) + 1) dot = len(deck) + 1
      self%deck = deck
      self%stem = deck(:dot - 1)
      self%limit = time_limit
      if (time_limit > 0.0_wp) self%deadline = began + time_limit &
            - min(reserve*time_limit, most_reserve)
      self%next_look = began
   end subroutine start_watch

   !> Looks, before an increment, whether it is to be taken: if not, there is a reason from here on.
   !> A stop file that is obeyed is removed.
   subroutine look_for_stop(self, pace, saving)
      type(watch_type), intent(inout) :: self
      type(pace_type), intent(in) :: pace        !! of the increments
      real(wp), intent(in) :: saving             !! seconds that writing the state will take

      if (allocated(self%reason)) return
      if (signal_came()) then
         self%reason = signal_name()
         return
      end if
      if (.not. pace%fresh) return
      self%longest = max(pace%interval, memory*self%longest)
      if (pace%now + surprise*self%longest + saving >= self%deadline) then
         self%reason = 'the time limit of '//to_text(self%limit)//' s'
      else if (pace%now >= self%next_look) then
         self%next_look = pace%now + pause
         call look_for_files(self)
      end if
   end subroutine look_for_stop

   subroutine look_for_files(self)
      type(watch_type), intent(inout) :: self

      call obey_file(self, self%stem//'.stop')
      if (.not. allocated(self%reason)) call obey_file(self, self%deck//'.stop')
   end subroutine look_for_files

   subroutine obey_file(self, path)
      type(watch_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      logical :: exists

      inquire (file=path, exist=exists)
      if (.not. exists) return
      self%reason = 'the file '//path
      call remove_file(path)
      inquire (file=path, exist=exists)
      if (exists) self%reason = self%reason &
            //' (it cannot be removed and would stop the next run too)'
   end subroutine obey_file

   !> A run that is over leaves no stop file to the next one.
   subroutine remove_stop_files(self)
      type(watch_type), intent(in) :: self

      call remove_file(self%stem//'.stop')
      call remove_file(self%deck//'.stop')
   end subroutine remove_stop_files

   !> The error with which an interrupted run ends.
   subroutine stop_run(self, place, error)
      type(watch_type), intent(in) :: self
      character(len=*), intent(in) :: place      !! where in the run it stops
      type(error_type), allocatable, intent(out) :: error

      call new_error(error, status_interrupted, 'interrupted by '//self%reason//' '//place)
   end subroutine stop_run

end module stop_request
