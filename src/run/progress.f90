!> A line of progress, on a terminal only, rewritten a few times a second.
module progress
   use, intrinsic :: iso_c_binding, only: c_int
   use kinds, only: wp, int64
   use clock, only: seconds_now
   use text, only: to_text
   use steps, only: step_type, procedure_frequency
   use increment_count, only: count_increments
   use memory_shortage, only: check_allocation
   use standard_output, only: print_text, flush_standard_output
   implicit none
   private

   public :: progress_type, place_type, start_progress, show_progress, end_progress
   public :: progress_line, rate_text, time_text

   !> Where a run is, as the line tells it.
   type :: place_type
      integer :: step = 1
      integer :: rehearsal = 0                   !! of the step, 0: it is the run
      integer(int64) :: increment = 0            !! of the step
      real(wp) :: share = 0.0_wp                 !! of the step, 0 to 1
      logical :: has_contact = .false.
      integer(int64) :: n_impacts = 0
      integer :: n_touching = 0                  !! contact rows
   end type place_type

   !> The line. Speeds are means over the last seconds, older ones counting less and less.
   type :: progress_type
      logical :: shown = .false.                 !! there is a terminal
      logical :: drawn = .false.                 !! a line stands there, not ended
      integer :: n_steps = 0
      real(wp), allocatable :: ends(:)           !! (0:n_steps) share of the work behind a step
      integer :: columns = 79
      real(wp) :: last = 0.0_wp                  !! drawn, seconds
      real(wp) :: share = 0.0_wp                 !! of the run, then
      type(place_type) :: place                  !! then
      real(wp) :: seconds = 0.0_wp, shares = 0.0_wp, increments = 0.0_wp   !! weighted sums
   end type progress_type

   real(wp), parameter :: pause = 0.25_wp        !! seconds between two lines at least
   real(wp), parameter :: memory = 10.0_wp       !! seconds after which a speed counts 1/e
   character(len=*), parameter :: back = achar(13), erase = achar(27)//'[K'
   integer, parameter :: most_columns = 79, least_columns = 20

   interface
      function isatty(descriptor) bind(c, name='isatty') result(answer)
         import :: c_int
         implicit none
         integer(c_int), value :: descriptor
         integer(c_int) :: answer
      end function isatty
   end interface

contains

   !> Decides whether there is a terminal to draw on. The work of a step is taken as its increments,
   !> where it has automatic ones as those of the size it begins with.
   subroutine start_progress(self, quiet, steps)
      type(progress_type), intent(out) :: self
      logical, intent(in) :: quiet
      type(step_type), intent(in) :: steps(:)
      character(len=20) :: value
      integer :: i, status

      if (quiet) return
      self%shown = isatty(1_c_int) /= 0_c_int
      call get_environment_variable('TERM', value, status=status)
      if (status > 0 .or. value == 'dumb') self%shown = .false.
      if (.not. self%shown) return
      call get_environment_variable('COLUMNS', value, status=status)
      if (status == 0) read (value, *, iostat=status) self%columns
      if (status /= 0) self%columns = most_columns
      self%columns = max(least_columns, min(most_columns, self%columns - 1))
      self%n_steps = size(steps)
      allocate (self%ends(0:self%n_steps), source=0.0_wp, stat=status)
      call check_allocation(status)
      do i = 1, self%n_steps
         self%ends(i) = self%ends(i - 1) + merge(1.0_wp, real(count_increments(steps(i)), wp), &
               steps(i)%procedure == procedure_frequency)
      end do
      self%ends = self%ends/max(1.0_wp, self%ends(self%n_steps))
      self%last = seconds_now()
      self%share = -1.0_wp
   end subroutine start_progress

   !> Draws the line if it is time for it.
   subroutine show_progress(self, now, place)
      type(progress_type), intent(inout) :: self
      real(wp), intent(in) :: now                !! on the clock
      type(place_type), intent(in) :: place
      real(wp) :: share, faded

      if (.not. self%shown) return
      share = share_of(self, place)
      if (self%share < 0.0_wp .or. place%step /= self%place%step &
            .or. place%rehearsal /= self%place%rehearsal) then
         ! the first look at something: speeds come with the next
         self%share = share
         if (.not. self%drawn .or. place%rehearsal /= self%place%rehearsal) then
            self%last = now
            self%seconds = 0.0_wp
            self%shares = 0.0_wp
            self%increments = 0.0_wp
         end if
         self%place = place
      end if
      if (now - self%last < pause) return
      faded = exp((self%last - now)/memory)
      self%seconds = faded*self%seconds + now - self%last
      self%increments = faded*self%increments + real(place%increment - self%place%increment, wp)
      self%shares = faded*self%shares + share - self%share
      self%last = now
      self%share = share
      self%place = place
      self%drawn = .true.
      call draw(progress_line(self))
   end subroutine show_progress

   !> Share of the run's work.
   pure function share_of(self, place) result(share)
      type(progress_type), intent(in) :: self
      type(place_type), intent(in) :: place
      real(wp) :: share

      associate (ends => self%ends(place%step - 1:place%step))
         share = ends(1)
         if (place%rehearsal == 0) share = ends(1) + place%share*(ends(2) - ends(1))
      end associate
   end function share_of

   !> The line as it stands; what the terminal has no room for is left out at its end.
   pure function progress_line(self) result(line)
      type(progress_type), intent(in) :: self
      character(len=:), allocatable :: line
      integer :: cut

      associate (place => self%place)
         line = to_text(int(100.0_wp*min(1.0_wp, self%share)))//' %'
         line = repeat(' ', max(0, 5 - len(line)))//line//'  step '//to_text(place%step)
         if (self%n_steps > 1) line = line//'/'//to_text(self%n_steps)
         if (place%rehearsal > 0) line = line//'  rehearsing ('//to_text(place%rehearsal)//'), ' &
               //to_text(int(100.0_wp*place%share))//' %'
         line = line//'  increment '//to_text(place%increment)
         if (self%increments > 0.0_wp) line = line//'  '//rate_text(self%increments/self%seconds)
         if (self%shares > 0.0_wp .and. place%rehearsal == 0) line = line//'  left ' &
               //time_text((1.0_wp - self%share)*self%seconds/self%shares)
         if (place%has_contact) line = line//'  impacts '//to_text(place%n_impacts) &
               //'  touching '//to_text(place%n_touching)
      end associate
      if (len(line) <= self%columns) return
      cut = index(line(:self%columns + 1), '  ', back=.true.)
      line = line(:min(self%columns, cut - 1))
   end function progress_line

   subroutine draw(line)
      character(len=*), intent(in) :: line

      call write_out(back//line//erase)
   end subroutine draw

   !> A terminal that is gone is no reason to stop.
   subroutine write_out(text)
      character(len=*), intent(in) :: text

      call print_text(text)
      call flush_standard_output()
   end subroutine write_out

   !> Ends the line: at 100 %, or where the run has stopped.
   subroutine end_progress(self, completed, place)
      type(progress_type), intent(inout) :: self
      logical, intent(in) :: completed
      type(place_type), intent(in) :: place      !! where the run has ended

      if (self%drawn) then
         self%place = place
         self%share = merge(1.0_wp, share_of(self, place), completed)
         self%shares = 0.0_wp
         call draw(progress_line(self))
         call write_out(new_line('a'))
      end if
      self%drawn = .false.
      self%shown = .false.
   end subroutine end_progress

   !> Increments a second, or seconds an increment.
   pure function rate_text(rate) result(text)
      real(wp), intent(in) :: rate
      character(len=:), allocatable :: text

      if (rate >= 100.0_wp .and. rate < 1.0e9_wp) then
         text = to_text(nint(rate))//'/s'
      else if (rate >= 1.0_wp) then
         text = to_text(rate, 2)//'/s'
      else
         text = to_text(1.0_wp/max(rate, tiny(1.0_wp)), 2)//' s each'
      end if
   end function rate_text

   !> Seconds as "42 s", "3:05" or "1:03:05".
   pure function time_text(seconds) result(text)
      real(wp), intent(in) :: seconds
      character(len=:), allocatable :: text
      character(len=8) :: rest
      integer(int64) :: whole

      whole = ceiling(min(max(0.0_wp, seconds), 1.0e12_wp), int64)
      if (whole < 60) then
         text = to_text(whole)//' s'
      else if (whole < 3600) then
         write (rest, '(i2.2)') modulo(whole, 60_int64)
         text = to_text(whole/60)//':'//trim(rest)
      else
         write (rest, '(i2.2,a,i2.2)') modulo(whole, 3600_int64)/60, ':', modulo(whole, 60_int64)
         text = to_text(whole/3600)//':'//trim(rest)
      end if
   end function time_text

end module progress
