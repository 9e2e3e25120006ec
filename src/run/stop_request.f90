!> What asks a run to stop between two increments: a signal, a stop file beside the deck, the time
!> limit.
module stop_request
   use kinds, only: wp
   use text, only: to_text
   use clock, only: pace_type, start_pace, keep_pace
   use errors, only: error_type, new_error, status_interrupted
   use file_calls, only: remove_file
   use stop_signals, only: signal_came, signal_name
   implicit none
   private

   public :: watch_type, start_watch, start_looking, keep_watch, look_for_stop, stop_run, &
         remove_stop_files

   !> What is looked at, and when. One that has not been started sees signals alone.
   type :: watch_type
      type(pace_type) :: pace                    !! of the increments
      real(wp) :: saving = 0.0_wp                !! seconds that writing the state will take
      character(len=:), allocatable, private :: reason   !! to stop, once there is one
      character(len=:), allocatable, private :: deck, stem   !! path, and that without its ending
      real(wp), private :: next_look = huge(1.0_wp)   !! for a stop file, on the clock
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
   !> Part of the limit, and seconds at most, kept for closing files and for other surprises.
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

   !> An increment begins now, or something that is none has ended.
   subroutine start_looking(self)
      type(watch_type), intent(inout) :: self

      call start_pace(self%pace)
   end subroutine start_looking

   !> An increment has ended.
   subroutine keep_watch(self)
      type(watch_type), intent(inout) :: self

      call keep_pace(self%pace)
   end subroutine keep_watch

   !> Looks, between two increments, whether something asks the run to stop. A stop file that is
   !> obeyed is removed.
   subroutine look_for_stop(self, asked)
      type(watch_type), intent(inout) :: self
      logical, intent(out) :: asked

      if (.not. allocated(self%reason)) then
         if (signal_came()) then
            self%reason = signal_name()
         else if (self%pace%fresh) then
            call look_around(self)
         end if
      end if
      asked = allocated(self%reason)
   end subroutine look_for_stop

   !> The error with which the run then ends.
   subroutine stop_run(self, place, t, error)
      type(watch_type), intent(in) :: self
      character(len=*), intent(in) :: place      !! where it stops
      real(wp), intent(in) :: t                  !! total time
      type(error_type), allocatable, intent(out) :: error   !! status_interrupted

      call new_error(error, status_interrupted, 'interrupted by '//self%reason//' '//place &
            //', total time '//to_text(t))
   end subroutine stop_run

   subroutine look_around(self)
      type(watch_type), intent(inout) :: self

      self%longest = max(self%pace%interval, memory*self%longest)
      if (self%pace%now + surprise*self%longest + self%saving >= self%deadline) then
         self%reason = 'the time limit of '//to_text(self%limit)//' s'
      else if (self%pace%now >= self%next_look) then
         self%next_look = self%pace%now + pause
         call look_for_files(self)
      end if
   end subroutine look_around

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

end module stop_request
