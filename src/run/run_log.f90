!> The log and status files beside the result, and what the terminal shows.
module run_log
   use, intrinsic :: iso_fortran_env, only: output_unit
   use kinds, only: wp, int64
   use errors, only: error_type
   use state_archive, only: archive_type
   use text, only: to_text
   use status_lines, only: line_length, read_status_lines
   use notices, only: notice_list_type, is_warning, without_mark
   use progress, only: progress_type
   use file_calls, only: look_at, look_at_open, is_same
   use text_file, only: text_file_type, open_text, resume_text, write_line, check_text, &
         close_text
   implicit none
   private

   public :: log_type, open_log, continue_log, check_log, end_status, close_log, say, tell, note, &
         remark, warn, write_status, has_line

   !> Where lines go. Without files (a mere check), to the terminal alone.
   type :: log_type
      type(text_file_type) :: lines              !! STEM.log
      type(text_file_type) :: status             !! STEM.sta
      logical :: has_files = .false.
      logical :: terminal = .true.          !! copies of what is said
      logical :: has_held = .false.         !! an increment whose status line is not written
      integer :: held_counts(4) = 0
      real(wp) :: held_times(3) = 0.0_wp
      type(progress_type) :: progress
      type(notice_list_type) :: notices
      character(len=:), allocatable :: name      !! of the log, for messages
   contains
      procedure :: pass_state
   end type log_type

   !> So many increments of a step have a line each; of later ones one in 10 up to ten times as
   !> many, one in 100 up to a hundred times as many, and so on.
   integer, parameter :: n_lines = 10000

contains

   !> Creates STEM.log and STEM.sta.
   subroutine open_log(self, stem, quiet, error)
      type(log_type), intent(out) :: self
      character(len=*), intent(in) :: stem
      logical, intent(in) :: quiet
      type(error_type), allocatable, intent(out) :: error

      self%terminal = .not. quiet
      ! 'carom run deck.inp > deck.log': the log says all that
      if (is_same(look_at_open(1), look_at(stem//'.log'))) self%terminal = .false.
      call open_text(self%lines, stem//'.log', .false., error)
      if (allocated(error)) return
      call open_text(self%status, stem//'.sta', .false., error)
      if (allocated(error)) return
      self%has_files = .true.
      self%name = stem//'.log'
      call write_head(self)
   end subroutine open_log

   subroutine write_head(self)
      type(log_type), intent(in) :: self

      call write_line(self%status, '# step  increment    step time      total time     '// &
            'increment      iterations  events')
      call write_line(self%status, '# a line an increment; beyond 10000 of a step one '// &
            'in 10, beyond 100000 one in 100, ..., with all iterations and events since the last')
   end subroutine write_head

   !> Goes on with the files of an earlier run: behind the last line of the log if it is the same,
   !> and behind the status line of the increment that is gone on from.
   subroutine continue_log(self, stem, earlier, quiet, archive, error)
      type(log_type), intent(out) :: self
      character(len=*), intent(in) :: stem, earlier   !! of the log to be written, of that before
      logical, intent(in) :: quiet
      type(archive_type), intent(inout) :: archive    !! read: the state
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: lines
      integer :: place(2)

      self%terminal = .not. quiet
      if (is_same(look_at_open(1), look_at(stem//'.log'))) self%terminal = .false.
      call self%pass_state(archive)
      call archive%pass('course/step', place(1))
      call archive%pass('course/increment', place(2))
      call read_status_lines(earlier//'.sta', place(1), place(2), .not. self%has_held, lines)
      call open_text(self%lines, stem//'.log', &
            is_same(look_at(stem//'.log'), look_at(earlier//'.log')), error)
      if (allocated(error)) return
      call resume_text(self%status, stem//'.sta', lines, error)
      if (allocated(error)) return
      self%has_files = .true.
      self%name = stem//'.log'
      if (len(lines) == 0) call write_head(self)
   end subroutine continue_log

   !> What of the status lines is not written yet, and the warnings so far.
   subroutine pass_state(self, archive)
      class(log_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive
      integer, allocatable :: counts(:)

      counts = self%held_counts
      call archive%enter('log')
      call archive%pass('has_held', self%has_held)
      call archive%pass('held_counts', counts)
      call archive%pass_fixed('held_times', self%held_times)
      call self%notices%pass_state(archive)
      call archive%leave()
      if (.not. allocated(counts)) return
      if (size(counts) == size(self%held_counts)) self%held_counts = counts
   end subroutine pass_state

   !> Brings all lines to the files; an error if one of them cannot be written.
   subroutine check_log(self, error)
      type(log_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error   !! status_file

      call check_text(self%lines, error)
      if (.not. allocated(error)) call check_text(self%status, error)
   end subroutine check_log

   !> One line (or several, parted by new lines) for the log and the terminal.
   subroutine say(self, line)
      type(log_type), intent(in) :: self
      character(len=*), intent(in) :: line

      call write_line(self%lines, line)
      call tell(self, line)
   end subroutine say

   !> One line for the terminal alone, in the place of that of the progress.
   subroutine tell(self, line)
      type(log_type), intent(in) :: self
      character(len=*), intent(in) :: line
      integer :: status

      if (.not. self%terminal) return
      if (self%progress%drawn) then
         write (output_unit, '(a)', iostat=status) achar(13)//achar(27)//'[K'//line
      else
         write (output_unit, '(a)', iostat=status) line
      end if
      ! a terminal that is gone is no reason to stop
      if (status /= 0) return
      flush (output_unit, iostat=status)
      if (status /= 0) return
   end subroutine tell

   !> A note on the deck, or a warning if it says so, before the first increment.
   subroutine remark(self, text)
      type(log_type), intent(inout) :: self
      character(len=*), intent(in) :: text
      logical :: is_new

      call self%notices%add(without_mark(text), is_warning(text), is_new)
      call say(self, trim(merge('warning', 'note   ', is_warning(text)))//': '//without_mark(text))
   end subroutine remark

   !> A warning or note of what happens in the run: said when it comes first, then counted.
   subroutine warn(self, text, warning, t, times)
      type(log_type), intent(inout) :: self
      character(len=*), intent(in) :: text
      logical, intent(in) :: warning             !! else a note
      real(wp), intent(in) :: t                  !! total time
      integer(int64), intent(in) :: times        !! that it came since it was counted last
      logical :: is_new

      call self%notices%add(text, warning, is_new, t, times)
      if (is_new) call say(self, trim(merge('warning', 'note   ', warning))//' (at t = ' &
            //to_text(t)//'): '//text)
   end subroutine warn

   !> One line for the log alone.
   subroutine note(self, line)
      type(log_type), intent(in) :: self
      character(len=*), intent(in) :: line

      call write_line(self%lines, line)
   end subroutine note

   !> Whether an increment of a step has a line in the status file.
   pure function has_line(increment)
      integer, intent(in) :: increment           !! of the step
      logical :: has_line
      integer :: last, stride

      last = n_lines
      stride = 1
      do while (increment > last .and. last < 100000000)
         last = 10*last
         stride = 10*stride
      end do
      has_line = modulo(increment, stride) == 0
   end function has_line

   !> One line of the status file an increment, or a few where there are very many. The last
   !> increment of a step and of the run always has one.
   subroutine write_status(self, counts, times)
      type(log_type), intent(inout) :: self
      integer, intent(in) :: counts(4)           !! step, increment, iterations, events
      real(wp), intent(in) :: times(3)           !! step time, total time, increment

      if (.not. self%has_files) return
      if (self%has_held .and. counts(1) > self%held_counts(1)) call write_held(self)
      self%held_counts(1:2) = counts(1:2)
      self%held_counts(3:4) = self%held_counts(3:4) + counts(3:4)
      self%held_times = times
      self%has_held = .true.
      if (has_line(counts(2))) call write_held(self)
   end subroutine write_status

   subroutine write_held(self)
      type(log_type), intent(inout) :: self
      character(len=line_length) :: line

      write (line, '(i6,i11,3es15.6,i12,i8)') self%held_counts(1:2), self%held_times, &
            self%held_counts(3:4)
      call write_line(self%status, line)
      self%held_counts(3:4) = 0
      self%has_held = .false.
   end subroutine write_held

   !> After the last increment: its status line is written, all lines are brought to the files.
   subroutine end_status(self, error)
      type(log_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error   !! status_file

      if (self%has_held) call write_held(self)
      call check_log(self, error)
   end subroutine end_status

   !> Closes the files; an error if one of them could not be written to the end.
   subroutine close_log(self, error)
      type(log_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error   !! status_file

      call end_status(self, error)
      call close_text(self%lines)
      call close_text(self%status)
      self%has_files = .false.
   end subroutine close_log

end module run_log
