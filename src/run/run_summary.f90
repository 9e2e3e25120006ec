!> The end of a run in the log: steps, events, energies, memory, time, warnings; and in a few lines
!> for the terminal.
module run_summary
   use kinds, only: wp, int64
   use text, only: to_text, plural
   use memory_use, only: resident_memory
   use memory_estimate, only: memory_type, megabytes
   use cost_account, only: n_phases, phase_names
   use impact_scene, only: event_impact, event_capture, event_release, event_contact, event_limit
   use scene_setup, only: simulation_type
   use step_tally, only: tally_type, energies_of, n_counts, n_energies
   use progress, only: rate_text, time_text
   use feature_report, only: percent
   use run_report, only: procedure_name
   use run_log, only: log_type, note, tell
   implicit none
   private

   public :: report_summary, event_kinds, event_names, n_event_kinds

   integer, parameter :: n_event_kinds = 5
   integer, parameter :: event_kinds(n_event_kinds) = [event_impact, event_capture, &
         event_release, event_contact, event_limit]
   character(len=8), parameter :: event_names(n_event_kinds) = [character(len=8) :: 'impacts', &
         'captures', 'releases', 'overlaps', 'limit']

   integer, parameter :: few = 3                 !! warnings that the terminal shows

contains

   !> All of it.
   subroutine report_summary(simulation, tally, memory, log)
      type(simulation_type), intent(in) :: simulation
      type(tally_type), intent(in) :: tally
      type(memory_type), intent(in) :: memory    !! estimated
      type(log_type), intent(in) :: log

      call note(log, 'summary of the run up to time '//to_text(simulation%motion%motion%t))
      if (tally%goes_on) call note(log, '  counts and times are those of all its runs together')
      call note_steps(simulation, tally, log)
      if (simulation%scene%rows%n > 0) call note_contact(simulation, log)
      call note_energies(simulation, tally, log)
      call note_memory(memory, log)
      call note_times(simulation, log)
      call note_warnings(log)
      call tell_briefly(simulation, log)
   end subroutine report_summary

   !> A line a step, and one for all.
   subroutine note_steps(simulation, tally, log)
      type(simulation_type), intent(in) :: simulation
      type(tally_type), intent(in) :: tally
      type(log_type), intent(in) :: log
      integer :: i

      call note(log, '  step              increments  iterations factorizations       solves' &
            //'   elapsed s')
      do i = 1, size(tally%seconds)
         if (.not. any(tally%counts(:, i) > 0)) cycle
         call note_counts(to_text(i)//' '//procedure_name(simulation%model%steps(i)%procedure), &
               tally%counts(:, i), tally%seconds(i), log)
      end do
      if (size(tally%seconds) > 1) call note_counts('all', sum(tally%counts, 2), &
            sum(tally%seconds), log)
      associate (cost => simulation%scene%system%cost)
         call note(log, '  element updates '//to_text(cost%element_updates) &
               //', energy updates '//to_text(cost%energy_updates) &
               //', stress updates '//to_text(cost%stress_updates))
      end associate
   end subroutine note_steps

   subroutine note_counts(name, counts, seconds, log)
      character(len=*), intent(in) :: name
      integer(int64), intent(in) :: counts(n_counts)
      real(wp), intent(in) :: seconds
      type(log_type), intent(in) :: log
      character(len=16) :: first
      character(len=80) :: line

      first = name
      write (line, '(2x, a, i12, i12, i15, i13)') first, counts
      call note(log, trim(line)//right(to_text(seconds, 3), 12))
   end subroutine note_counts

   !> Events by kind, what contact has cost.
   subroutine note_contact(simulation, log)
      type(simulation_type), intent(in) :: simulation
      type(log_type), intent(in) :: log
      character(len=:), allocatable :: line

      associate (geometry => simulation%scene%geometry)
         call note(log, '  events            '//events_text(simulation)//', ' &
               //to_text(simulation%n_events(event_contact))//' overlaps, ' &
               //to_text(simulation%n_events(event_limit))//' at the limit')
         line = '  contact           at most '//plural(simulation%most_touching, 'row') &
               //' touching at once, '//to_text(geometry%n_searches)//' contact searches'
         call note(log, line)
         if (size(geometry%targets) > 0) call note(log, '                    ' &
               //to_text(sum(geometry%targets%n_tests))//' tests of a node and an edge, bins ' &
               //'built '//to_text(sum(geometry%targets%n_builds))//' times')
      end associate
   end subroutine note_contact

   pure function events_text(simulation) result(text)
      type(simulation_type), intent(in) :: simulation
      character(len=:), allocatable :: text

      associate (n => simulation%n_events)
         text = to_text(n(event_impact))//' impacts, '//to_text(n(event_capture))//' captures, ' &
               //to_text(n(event_release))//' releases'
      end associate
   end function events_text

   !> Each kind at the start and the end, and what the balance lacks.
   subroutine note_energies(simulation, tally, log)
      type(simulation_type), intent(in) :: simulation
      type(tally_type), intent(in) :: tally
      type(log_type), intent(in) :: log

      if (.not. tally%knows_start) return
      call note(log, '  energy          kinetic      strain     plastic     damping    friction' &
            //'     impacts    external')
      associate (ledger => simulation%scene%ledger)
         call note_values('start', tally%at_start, log)
         if (ledger%time < simulation%motion%motion%t) then
            call note_values('t = '//to_text(ledger%time, 3), energies_of(ledger), log)
         else
            call note_values('end', energies_of(ledger), log)
         end if
      end associate
      call note(log, '  balance error   '//balance_text(simulation))
   end subroutine note_energies

   subroutine note_values(name, values, log)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: values(n_energies)
      type(log_type), intent(in) :: log
      character(len=13) :: first
      character(len=:), allocatable :: line
      integer :: i

      first = '  '//name
      line = first
      do i = 1, n_energies
         line = line//right(to_text(values(i), 5), 12)
      end do
      call note(log, line)
   end subroutine note_values

   !> "1.28e-6, 2.6e-6 of the largest energy".
   pure function balance_text(simulation) result(text)
      type(simulation_type), intent(in) :: simulation
      character(len=:), allocatable :: text

      associate (ledger => simulation%scene%ledger)
         text = to_text(ledger%balance_error, 3)
         if (ledger%scale > 0.0_wp) text = text//', ' &
               //to_text(abs(ledger%balance_error)/ledger%scale, 2)//' of the largest energy, ' &
               //to_text(ledger%scale, 5)
      end associate
   end function balance_text

   subroutine note_memory(memory, log)
      type(memory_type), intent(in) :: memory
      type(log_type), intent(in) :: log

      call note(log, '  memory          '//memory_line(memory))
   end subroutine note_memory

   function memory_line(memory) result(text)
      type(memory_type), intent(in) :: memory
      character(len=:), allocatable :: text
      real(wp) :: now, most

      call resident_memory(now, most)
      text = 'at most '//megabytes(most)//' MB, estimated '//megabytes(memory%total())//' MB'
   end function memory_line

   !> Time by phases, as in /cost.
   subroutine note_times(simulation, log)
      type(simulation_type), intent(in) :: simulation
      type(log_type), intent(in) :: log
      character(len=:), allocatable :: names, seconds, shares
      integer :: i

      names = '  time  '
      seconds = '  s     '
      shares = '        '
      associate (cost => simulation%scene%system%cost)
         do i = 1, n_phases
            names = names//right(trim(phase_names(i)), 10)
            seconds = seconds//right(to_text(max(0.0_wp, cost%seconds(i)), 3), 10)
            shares = shares//right(percent(cost%seconds(i), cost%elapsed), 10)
         end do
         call note(log, names//'       all')
         call note(log, seconds//right(to_text(cost%elapsed, 3), 10))
         call note(log, shares)
         call note(log, '  elapsed         '//to_text(cost%elapsed, 3)//' s, processor time ' &
               //to_text(cost%processor, 3)//' s'//rate_of(simulation))
      end associate
   end subroutine note_times

   !> "; increments 850/s" of the time elapsed, nothing if there are none.
   pure function rate_of(simulation) result(text)
      type(simulation_type), intent(in) :: simulation
      character(len=:), allocatable :: text

      associate (cost => simulation%scene%system%cost)
         text = ''
         if (cost%increments > 0 .and. cost%elapsed > 0.0_wp) text = '; increments ' &
               //rate_text(real(cost%increments, wp)/cost%elapsed)
      end associate
   end function rate_of

   pure function right(text, width) result(column)
      character(len=*), intent(in) :: text
      integer, intent(in) :: width
      character(len=:), allocatable :: column

      column = repeat(' ', max(1, width - len(text)))//text
   end function right

   !> Those that came again and again, and how many warnings there were.
   subroutine note_warnings(log)
      type(log_type), intent(in) :: log
      integer :: i

      associate (notices => log%notices)
         do i = 1, notices%n
            if (notices%items(i)%count > 1) call note(log, notices%items(i)%line())
         end do
         if (notices%n_warnings() > 0) call note(log, '  '//plural(notices%n_warnings(), 'warning'))
      end associate
   end subroutine note_warnings

   !> "0.0232 s" or "3:05".
   pure function duration_text(seconds) result(text)
      real(wp), intent(in) :: seconds
      character(len=:), allocatable :: text

      text = time_text(seconds)
      if (seconds < 60.0_wp) text = to_text(seconds, 3)//' s'
   end function duration_text

   pure function first_line(text) result(line)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: line

      line = text(:index(text//new_line('a'), new_line('a')) - 1)
   end function first_line

   !> What a terminal shows of it.
   subroutine tell_briefly(simulation, log)
      type(simulation_type), intent(in) :: simulation
      type(log_type), intent(in) :: log
      integer :: i

      associate (cost => simulation%scene%system%cost, notices => log%notices)
         call tell(log, 'reached time '//to_text(simulation%motion%motion%t)//' in ' &
               //plural(int(cost%increments), 'increment')//', '//duration_text(cost%elapsed))
         if (simulation%scene%rows%n > 0) call tell(log, 'events: '//events_text(simulation))
         if (simulation%scene%ledger%scale > 0.0_wp) call tell(log, 'energy: balance error ' &
               //balance_text(simulation))
         if (notices%n_warnings() > few .and. allocated(log%name)) then
            call tell(log, plural(notices%n_warnings(), 'warning')//', see '//log%name)
         else
            do i = 1, notices%n
               if (notices%items(i)%warning) call tell(log, first_line(notices%items(i)%line()))
            end do
         end if
      end associate
   end subroutine tell_briefly

end module run_summary
