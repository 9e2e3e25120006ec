!> What each step of a run has counted, and the energies that the run began with. Of a run that goes
!> on from another one both count.
module step_tally
   use kinds, only: wp, int64
   use clock, only: seconds_now
   use state_archive, only: archive_type
   use energy_ledger, only: ledger_type
   use scene_setup, only: simulation_type
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: tally_type, start_tally, count_up, note_start, energies_of
   public :: n_counts, n_energies, energy_names, count_names

   integer, parameter :: n_counts = 4
   character(len=14), parameter :: count_names(n_counts) = [character(len=14) :: 'increments', &
         'iterations', 'factorizations', 'solves']
   integer, parameter :: n_energies = 7
   character(len=13), parameter :: energy_names(n_energies) = [character(len=13) :: 'kinetic', &
         'strain', 'plastic', 'damping', 'friction', 'impact_loss', 'external_work']

   !> Counts by steps.
   type :: tally_type
      integer(int64), allocatable :: counts(:, :)   !! (n_counts, n_steps) of all steps so far
      real(wp), allocatable :: seconds(:)        !! (n_steps) elapsed
      real(wp) :: at_start(n_energies) = 0.0_wp
      logical :: knows_start = .false.
      logical :: goes_on = .false.               !! from an earlier run
      integer(int64) :: last(n_counts) = 0       !! counters when it was brought up to date
      real(wp) :: since = 0.0_wp                 !! on the clock, then
   contains
      procedure :: pass_state
   end type tally_type

contains

   !> The first step to come begins now.
   subroutine start_tally(self, n_steps)
      type(tally_type), intent(out) :: self
      integer, intent(in) :: n_steps
      integer :: status

      allocate (self%counts(n_counts, n_steps), source=0_int64, stat=status)
      call check_allocation(status)
      allocate (self%seconds(n_steps), source=0.0_wp, stat=status)
      call check_allocation(status)
      self%since = seconds_now()
   end subroutine start_tally

   !> What has been counted since the last call belongs to a step.
   subroutine count_up(self, simulation, i_step)
      type(tally_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step
      integer(int64) :: counts(n_counts)
      real(wp) :: now

      if (.not. allocated(self%counts)) return
      counts = counters_of(simulation)
      now = seconds_now()
      self%counts(:, i_step) = self%counts(:, i_step) + counts - self%last
      self%seconds(i_step) = self%seconds(i_step) + now - self%since
      self%last = counts
      self%since = now
   end subroutine count_up

   pure function counters_of(simulation) result(counts)
      type(simulation_type), intent(in) :: simulation
      integer(int64) :: counts(n_counts)

      associate (scene => simulation%scene)
         counts = [scene%system%cost%increments, scene%n_iterations, &
               scene%system%matrices%n_factorizations, scene%system%matrices%n_solves]
      end associate
   end function counters_of

   !> The energies at the start of the run.
   pure subroutine note_start(self, ledger)
      type(tally_type), intent(inout) :: self
      type(ledger_type), intent(in) :: ledger

      self%at_start = energies_of(ledger)
      self%knows_start = .true.
   end subroutine note_start

   !> In the order of their names.
   pure function energies_of(ledger) result(energies)
      type(ledger_type), intent(in) :: ledger
      real(wp) :: energies(n_energies)

      energies = [ledger%kinetic, ledger%strain, ledger%plastic, ledger%damping, ledger%friction, &
            ledger%impact_loss, ledger%external_work]
   end function energies_of

   !> All of it; of an archive that has none, counting begins with the counters it holds.
   subroutine pass_state(self, archive, simulation)
      class(tally_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive
      type(simulation_type), intent(in) :: simulation   !! restored, when reading
      real(wp), allocatable :: counts(:), seconds(:)
      integer :: n

      if (archive%reading) self%goes_on = .true.
      call archive%enter('tally')
      if (archive%has('counts') .or. .not. archive%reading) then
         if (.not. archive%reading) then
            counts = real(reshape(self%counts, [size(self%counts)]), wp)
            seconds = self%seconds
         end if
         call archive%pass('counts', counts)
         call archive%pass('seconds', seconds)
         call archive%pass('knows_start', self%knows_start)
         call archive%pass_fixed('at_start', self%at_start)
      end if
      call archive%leave()
      if (.not. archive%reading) return
      self%last = counters_of(simulation)
      if (.not. (allocated(counts) .and. allocated(seconds))) return
      n = min(size(self%seconds), size(seconds), size(counts)/n_counts)
      self%counts(:, :n) = reshape(nint(counts(:n*n_counts), int64), [n_counts, n])
      self%seconds(:n) = seconds(:n)
   end subroutine pass_state

end module step_tally
