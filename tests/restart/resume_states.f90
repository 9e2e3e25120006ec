!> Runs a deck, keeps the state at the ends of increments, and goes on from each of these states in
!> a run built anew: the state collected there at once must be the one put in, and all states that
!> are met later the same, every entry to the bit. From the starts of steps it also goes on after
!> going back to them.
!>
!>    resume_states DECK PLACES [MOST [NAME=VALUE ...]]
!>
!> PLACES states are taken, all if the run has no more increments; the first two, the last, and
!> those at the starts and ends of steps always. MOST, if not 0, limits the increments of the run.
!> Ends with status 1 where something differs.
program resume_states
   use, intrinsic :: iso_fortran_env, only: output_unit
   use kinds, only: wp
   use errors, only: error_type
   use text, only: to_text
   use state_archive, only: archive_type
   use deck_reader, only: definition_type
   use run_state, only: collect_state, restore_state, rewind_state
   use state_runs, only: run_type, open_run, take_one, compare_archives
   implicit none

   !> The golden section spreads places that keep step with nothing.
   real(wp), parameter :: golden = 0.6180339887498949_wp
   integer, parameter :: some = 3                !! increments before going back
   integer, parameter :: most_words = 400
   integer, parameter :: most_told = 10          !! differences
   character(len=:), allocatable :: deck
   type(definition_type), allocatable :: definitions(:)
   type(archive_type), allocatable :: states(:)
   logical, allocatable :: wanted(:), starts(:)  !! by places: a state is taken, a step starts
   integer :: n_places, most, n_bad

   call read_words()
   call run_straight()
   call run_again()
   call resume_all()
   write (output_unit, '(a)') to_text(size(wanted))//' places, '//to_text(count(wanted)) &
         //' states, '//to_text(n_bad)//' differences'
   if (n_bad > 0) stop 1

contains

   subroutine read_words()
      character(len=most_words) :: word
      integer :: i, cut

      call get_command_argument(1, word)
      deck = trim(word)
      call get_command_argument(2, word)
      read (word, *) n_places
      most = 0
      call get_command_argument(3, word)
      if (len_trim(word) > 0) read (word, *) most
      allocate (definitions(max(0, command_argument_count() - 3)))
      do i = 1, size(definitions)
         call get_command_argument(i + 3, word)
         cut = index(word, '=')
         definitions(i)%name = word(:cut - 1)
         definitions(i)%value = trim(word(cut + 1:))
      end do
   end subroutine read_words

   !> The run without any state taken, but its last: which increments there are.
   subroutine run_straight()
      type(run_type) :: run
      type(error_type), allocatable :: error
      logical :: taken
      integer :: n, i

      call open_run(run, deck, definitions, error)
      call must_be_sound(error)
      allocate (wanted(0), starts(0))
      do while (most == 0 .or. size(wanted) < most)
         call take_one(run, taken, error)
         call must_be_sound(error)
         if (.not. taken) exit
         starts = [starts, run%course%increment == 0]
         wanted = [wanted, starts(size(starts)) .or. run%course%step_time &
               >= run%simulation%model%steps(run%course%step)%duration]
      end do
      n = size(wanted)
      if (n == 0) stop 'the run has no increments'
      wanted([1, min(2, n), n]) = .true.
      do i = 1, n_places
         wanted(1 + int(n*modulo(i*golden, 1.0_wp))) = .true.
      end do
      if (n_places >= n) wanted = .true.
      allocate (states(n + 1))
      call collect_state(run%simulation, run%course, states(n + 1))
   end subroutine run_straight

   !> The run once more, now with the states taken: that must not change it.
   subroutine run_again()
      type(run_type) :: run
      type(error_type), allocatable :: error
      logical :: taken
      integer :: i

      call open_run(run, deck, definitions, error)
      call must_be_sound(error)
      n_bad = 0
      do i = 1, size(wanted)
         call take_one(run, taken, error)
         call must_be_sound(error)
         if (wanted(i)) call collect_state(run%simulation, run%course, states(i))
      end do
      call compare(states(size(wanted)), states(size(wanted) + 1), 'a run that is looked at')
   end subroutine run_again

   subroutine resume_all()
      integer :: i

      do i = 1, size(wanted)
         if (wanted(i)) call resume(i)
         if (starts(i)) call go_back(i)
      end do
   end subroutine resume_all

   !> Goes on from a state and compares every one that is met.
   subroutine resume(place)
      integer, intent(in) :: place
      type(run_type) :: run
      type(archive_type) :: state
      type(error_type), allocatable :: error

      call open_run(run, deck, definitions, error)
      call must_be_sound(error)
      call restore_state(run%simulation, run%course, states(place), error)
      call must_be_sound(error)
      call collect_state(run%simulation, run%course, state)
      call compare(state, states(place), 'place '//to_text(place)//' at once')
      call follow(run, place, 'from place '//to_text(place))
   end subroutine resume

   !> Goes back to the start of a step after a few increments of it.
   subroutine go_back(place)
      integer, intent(in) :: place
      type(run_type) :: run
      type(archive_type) :: start, state
      type(error_type), allocatable :: error
      logical :: taken
      integer :: i

      call open_run(run, deck, definitions, error)
      call must_be_sound(error)
      do i = 1, size(wanted)
         call take_one(run, taken, error)
         call must_be_sound(error)
         if (i == place) call collect_state(run%simulation, run%course, start)
         if (i <= place) cycle
         if (i == place + some .or. i == size(wanted)) exit
         if (starts(i + 1)) exit
      end do
      call rewind_state(run%simulation, run%course, start, error)
      call must_be_sound(error)
      call collect_state(run%simulation, run%course, state)
      call compare(state, states(place), 'back at place '//to_text(place))
      call follow(run, place, 'back from place '//to_text(place))
   end subroutine go_back

   !> Goes to the end and compares what is met.
   subroutine follow(run, place, what)
      type(run_type), intent(inout) :: run
      integer, intent(in) :: place               !! where the run is
      character(len=*), intent(in) :: what
      type(archive_type) :: state
      type(error_type), allocatable :: error
      logical :: taken
      integer :: i

      do i = place + 1, size(wanted)
         call take_one(run, taken, error)
         call must_be_sound(error)
         if (.not. wanted(i)) cycle
         call collect_state(run%simulation, run%course, state)
         call compare(state, states(i), what//' at '//to_text(i))
      end do
   end subroutine follow

   subroutine compare(one, other, what)
      type(archive_type), intent(in) :: one, other
      character(len=*), intent(in) :: what
      character(len=:), allocatable :: names

      call compare_archives(one, other, names)
      if (len(names) == 0) return
      n_bad = n_bad + 1
      if (n_bad <= most_told) write (output_unit, '(a)') what//':'//names
   end subroutine compare

   subroutine must_be_sound(error)
      type(error_type), allocatable, intent(in) :: error

      if (.not. allocated(error)) return
      write (output_unit, '(a)') error%message
      stop 1
   end subroutine must_be_sound

end program resume_states
