!> Warnings and notes of what happens within increments, from the counters that the computing keeps.
module increment_notices
   use kinds, only: wp, int64
   use impact_scene, only: event_limit
   use scene_setup, only: simulation_type
   use course, only: course_type
   use run_log, only: log_type, warn
   implicit none
   private

   public :: seen_type, look_at_counters, notice_trouble

   !> Counters when they were looked at last.
   type :: seen_type
      integer(int64) :: limits = 0               !! rows captured by MAX EVENTS
      integer(int64) :: cycles = 0               !! of the fictitious force
      integer :: cuts = 0                        !! static increments tried in vain, of the step
   end type seen_type

contains

   !> The counters now, nothing being said of them.
   pure subroutine look_at_counters(self, simulation, course)
      type(seen_type), intent(out) :: self
      type(simulation_type), intent(in) :: simulation
      type(course_type), intent(in) :: course

      self%limits = simulation%n_events(event_limit)
      self%cycles = simulation%scene%n_cycles
      self%cuts = course%control%n_cut
   end subroutine look_at_counters

   !> At the end of an increment.
   subroutine notice_trouble(self, simulation, course, log)
      type(seen_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(course_type), intent(in) :: course
      type(log_type), intent(inout) :: log
      real(wp) :: t

      t = simulation%motion%motion%t
      if (simulation%n_events(event_limit) > self%limits) call warn(log, 'MAX EVENTS was ' &
            //'reached: further hits were held to the end of the increment'//new_line('a') &
            //'  cure: a smaller step, a larger MAX EVENTS, or CAPTURE', .true., t, &
            simulation%n_events(event_limit) - self%limits)
      if (simulation%scene%n_cycles > self%cycles) call warn(log, 'the iteration of the ' &
            //'fictitious force found no set of overlapping rows to stay with; the ' &
            //'complementarity problem was solved instead', .false., t, &
            simulation%scene%n_cycles - self%cycles)
      if (course%control%n_cut > self%cuts) call warn(log, 'an increment did not converge and ' &
            //'was cut back', .false., t, int(course%control%n_cut - self%cuts, int64))
      call look_at_counters(self, simulation, course)
   end subroutine notice_trouble

end module increment_notices
