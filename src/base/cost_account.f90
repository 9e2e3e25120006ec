!> What a run costs: how often it does what is dear, and where its time goes.
!>
!> One clock runs from the start to the end; the phase that is entered gets the time until the next
!> one is entered or it is left again, so that the phases add up to the time elapsed. Increments so
!> short that reading the clock would slow them down are timed one in `stride`; the time of the
!> others is shared out as that of the timed ones. What is seldom or long is always timed.
module cost_account
   use kinds, only: wp, int64
   use clock, only: seconds_now
   use state_archive, only: archive_type
   implicit none
   private

   public :: cost_type, start_clock, stop_clock, enter, leave, charge, next_increment, &
         end_increments
   public :: n_phases, phase_names, phase_meanings
   public :: phase_read, phase_build, phase_factor, phase_solve, phase_elements, phase_contact, &
         phase_output, phase_other

   integer, parameter :: n_phases = 8
   integer, parameter :: phase_read = 1, phase_build = 2, phase_factor = 3, phase_solve = 4, &
         phase_elements = 5, phase_contact = 6, phase_output = 7, phase_other = 8
   !> The time of increments that are not timed phase by phase.
   integer, parameter :: phase_untimed = 9
   integer, parameter :: n_columns = 2
   character(len=8), parameter :: phase_names(n_phases) = [character(len=8) :: 'read', 'build', &
         'factor', 'solve', 'elements', 'contact', 'output', 'other']
   character(len=72), parameter :: phase_meanings(n_phases) = [character(len=72) :: &
         'reading the deck', &
         'building the model, its equations and the start of steps', &
         'factorizing matrices', &
         'solving with factorized matrices', &
         'element forces, matrices and energies', &
         'search, rows, impacts and contact forces without their solutions', &
         'records, frames and their writing', &
         'all else: vectors, loads, status lines']

   !> Increments between two looks at how long one takes.
   integer, parameter :: n_watched = 64
   !> One increment of so many is timed where they are short; prime, so that it does not keep step
   !> with what happens every so many increments.
   integer, parameter :: long_stride = 31
   !> Mean time of an increment, seconds, below which they are short.
   real(wp), parameter :: short_increment = 1.0e-4_wp

   !> Counters, and the clock.
   type :: cost_type
      integer(int64) :: increments = 0
      integer(int64) :: element_updates = 0      !! forces or matrices of one element worked out
      integer(int64) :: energy_updates = 0       !! energies of one element worked out by themselves
      integer(int64) :: stress_updates = 0       !! stresses of one element worked out for output
      integer(int64) :: contact_searches = 0     !! placements of all rows that move
      integer(int64) :: contact_rows = 0         !! rows whose forces were solved for, summed up
      real(wp) :: elapsed = 0.0_wp               !! seconds, when the clock was stopped
      real(wp) :: processor = 0.0_wp             !! the same of processor time, all threads
      real(wp) :: seconds(n_phases) = 0.0_wp     !! by phases
      integer, private :: current = phase_other
      integer, private :: stride = 1
      integer, private :: column = 1             !! of `spent`: 2 in a timed increment of many
      real(wp), private :: started = 0.0_wp, since = 0.0_wp, watched = 0.0_wp
      real(wp), private :: started_processor = 0.0_wp
      real(wp), private :: spent(phase_untimed, n_columns) = 0.0_wp
      real(wp), private :: before(2 + n_phases) = 0.0_wp   ! elapsed, processor, phases: other runs
   contains
      procedure :: pass_state
      procedure :: pass_times
   end type cost_type

contains

   !> The counters; a clock begins anew with its process.
   subroutine pass_state(self, archive)
      class(cost_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%pass('increments', self%increments)
      call archive%pass('element_updates', self%element_updates)
      call archive%pass('energy_updates', self%energy_updates)
      call archive%pass('stress_updates', self%stress_updates)
      call archive%pass('contact_searches', self%contact_searches)
      call archive%pass('contact_rows', self%contact_rows)
   end subroutine pass_state

   !> What runs have taken so far, this one included; read, it is what those before have taken.
   subroutine pass_times(self, archive)
      class(cost_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive
      type(cost_type) :: now
      real(wp) :: seconds(size(self%before))

      if (.not. archive%reading) then
         now = self
         call stop_clock(now)
         seconds = [now%elapsed, now%processor, now%seconds]
      end if
      call archive%enter('cost')
      call archive%pass_fixed('seconds', seconds)
      call archive%leave()
      if (archive%reading) self%before = seconds
   end subroutine pass_times

   !> Starts the clock.
   subroutine start_clock(self)
      type(cost_type), intent(inout) :: self

      call cpu_time(self%started_processor)
      self%started = seconds_now()
      self%since = self%started
      self%watched = self%started
   end subroutine start_clock

   !> Enters a phase.
   subroutine enter(self, phase, outer, always)
      type(cost_type), intent(inout) :: self
      integer, intent(in) :: phase               !! one of the phase_ parameters
      integer, intent(out) :: outer              !! where `leave` goes back to
      logical, intent(in), optional :: always    !! timed in every increment

      outer = n_columns*self%current + self%column
      if (present(always)) then
         call go_to(self, phase, 1)
      else if (self%current /= phase_untimed) then
         call go_to(self, phase, self%column)
      end if
   end subroutine enter

   !> Goes back to the phase before.
   subroutine leave(self, outer)
      type(cost_type), intent(inout) :: self
      integer, intent(in) :: outer               !! from `enter`
      integer :: column

      column = 1 + modulo(outer - 1, n_columns)
      call go_to(self, (outer - column)/n_columns, column)
   end subroutine leave

   !> The time until now is that of the phase at hand, what follows that of another.
   subroutine go_to(self, phase, column)
      type(cost_type), intent(inout) :: self
      integer, intent(in) :: phase, column
      real(wp) :: now

      if (phase == self%current .and. column == self%column) return
      now = seconds_now()
      self%spent(self%current, self%column) = self%spent(self%current, self%column) &
            + now - self%since
      self%since = now
      self%current = phase
      self%column = column
   end subroutine go_to

   !> Seconds of the phase at hand that another phase has spent.
   pure subroutine charge(self, phase, seconds)
      type(cost_type), intent(inout) :: self
      integer, intent(in) :: phase
      real(wp), intent(in) :: seconds

      self%spent(phase, 1) = self%spent(phase, 1) + seconds
      self%spent(self%current, self%column) = self%spent(self%current, self%column) - seconds
   end subroutine charge

   !> An increment is done; whether the next one is timed.
   subroutine next_increment(self)
      type(cost_type), intent(inout) :: self
      real(wp) :: now

      self%increments = self%increments + 1
      if (modulo(self%increments, int(n_watched, int64)) == 0) then
         now = seconds_now()
         self%stride = merge(long_stride, 1, now - self%watched < n_watched*short_increment)
         self%watched = now
      end if
      if (self%stride == 1) then
         call go_to(self, phase_other, 1)
      else if (modulo(self%increments, int(self%stride, int64)) == 0) then
         call go_to(self, phase_other, 2)
      else
         call go_to(self, phase_untimed, 1)
      end if
   end subroutine next_increment

   !> No increment is under way.
   subroutine end_increments(self)
      type(cost_type), intent(inout) :: self

      call go_to(self, phase_other, 1)
   end subroutine end_increments

   !> Stops the clock and shares out what was not timed.
   subroutine stop_clock(self)
      type(cost_type), intent(inout) :: self
      real(wp) :: sample

      call end_increments(self)
      self%elapsed = seconds_now() - self%started
      call cpu_time(self%processor)
      self%processor = self%processor - self%started_processor
      self%seconds = self%spent(:n_phases, 1) + self%spent(:n_phases, 2)
      sample = sum(self%spent(:n_phases, 2))
      if (sample > 0.0_wp) self%seconds = self%seconds &
            + self%spent(:n_phases, 2)*self%spent(phase_untimed, 1)/sample
      ! the rest: since the last change, and untimed increments without a timed one among them
      self%seconds(phase_other) = 0.0_wp
      self%seconds(phase_other) = self%elapsed - sum(self%seconds)
      self%elapsed = self%elapsed + self%before(1)
      self%processor = self%processor + self%before(2)
      self%seconds = self%seconds + self%before(3:)
   end subroutine stop_clock

end module cost_account
