!> A progress bar, on a terminal only.
module progress
   use, intrinsic :: iso_fortran_env, only: output_unit
   use, intrinsic :: iso_c_binding, only: c_int
   use kinds, only: wp
   use clock, only: seconds_now
   use text, only: to_text
   implicit none
   private

   public :: progress_type, start_progress, show_progress, end_progress

   !> Redraws at most a few times a second.
   type :: progress_type
      logical :: shown = .false.
      real(wp) :: started = 0.0_wp
      real(wp) :: last = 0.0_wp
   end type progress_type

   integer, parameter :: width = 40

   interface
      function isatty(descriptor) bind(c, name='isatty') result(answer)
         import :: c_int
         implicit none
         integer(c_int), value :: descriptor
         integer(c_int) :: answer
      end function isatty
   end interface

contains

   !> Decides whether there is a terminal to draw on.
   subroutine start_progress(self, quiet)
      type(progress_type), intent(out) :: self
      logical, intent(in) :: quiet

      self%started = seconds_now()
      self%last = self%started
      self%shown = .false.
      if (.not. quiet) self%shown = isatty(1_c_int) /= 0_c_int
   end subroutine start_progress

   !> Draws the bar for a share of the work between 0 and 1.
   subroutine show_progress(self, share, t)
      type(progress_type), intent(inout) :: self
      real(wp), intent(in) :: share
      real(wp), intent(in) :: t                  !! total time reached
      real(wp) :: now
      integer :: filled

      if (.not. self%shown) return
      now = seconds_now()
      if (now - self%last < 0.2_wp) return
      self%last = now
      filled = nint(width*min(1.0_wp, max(0.0_wp, share)))
      write (output_unit, '(a)', advance='no') achar(13)//'['//repeat('#', filled) &
            //repeat('.', width - filled)//'] '//to_text(nint(100.0_wp*share))//' %  t = ' &
            //to_text(t)//'      '
      flush (output_unit)
   end subroutine show_progress

   !> Wipes the bar.
   subroutine end_progress(self)
      type(progress_type), intent(inout) :: self

      if (self%shown) write (output_unit, '(a)', advance='no') achar(13)//repeat(' ', width + 40) &
            //achar(13)
      self%shown = .false.
   end subroutine end_progress

end module progress
