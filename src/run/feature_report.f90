!> The features of a scene as a table for `check` and the log: what is switched on, how large it is,
!> and its shares of memory and time.
module feature_report
   use kinds, only: wp
   use text, only: to_text
   use scene_features, only: feature_list_type
   use scene_advice, only: advice_list_type
   use run_log, only: log_type, say
   implicit none
   private

   public :: report_features, report_advice, percent

   integer, parameter :: name_width = 28, size_width = 58
   !> A model with fewer freedoms, if it takes fewer increments, has its features on a line or two.
   integer, parameter :: small_model = 100
   integer, parameter :: line_width = 100

contains

   !> A table, or for a small model in a log a few words.
   subroutine report_features(list, n_freedoms, whole, log)
      type(feature_list_type), intent(in) :: list
      integer, intent(in) :: n_freedoms
      logical, intent(in) :: whole               !! the table, however small the model
      type(log_type), intent(in) :: log

      if (whole .or. n_freedoms >= small_model) then
         call write_table(list, log)
      else
         call write_words(list, log)
      end if
   end subroutine report_features

   subroutine write_table(list, log)
      type(feature_list_type), intent(in) :: list
      type(log_type), intent(in) :: log
      character(len=name_width + size_width + 20) :: line
      real(wp) :: seconds, bytes
      integer :: i

      seconds = sum(list%items(:list%n)%seconds)
      bytes = sum(list%items(:list%n)%bytes)
      line = 'features of step '//to_text(list%step)//', estimated'
      line(name_width + size_width - 1:) = ' memory     time'
      if (.not. list%increments > 0.0_wp) line(name_width + size_width + 8:) = ''
      call say(log, trim(line))
      do i = 1, list%n
         associate (item => list%items(i))
            line = '  '//item%name
            line(max(name_width, len(item%name) + 5):) = item%size
            line(name_width + size_width:) = column(item%bytes, bytes)
            if (list%increments > 0.0_wp) line(name_width + size_width + 9:) = column( &
                  item%seconds, seconds)
            call say(log, trim(line))
         end associate
      end do
      if (list%increments > 0.0_wp) call say(log, '  about '//to_text(seconds, 2) &
            //' s an increment while nothing touches')
   end subroutine write_table

   !> A share as it stands in the table; nothing where there is none.
   pure function column(part, whole) result(text)
      real(wp), intent(in) :: part, whole
      character(len=6) :: text

      text = ''
      if (part > 0.0_wp) text = percent(part, whole)
      text = adjustr(text)
   end function column

   !> "features: 1 implicit SPRING1; contact BODY, 1 row, ...", in lines.
   subroutine write_words(list, log)
      type(feature_list_type), intent(in) :: list
      type(log_type), intent(in) :: log
      character(len=:), allocatable :: line, word
      integer :: i

      line = 'features:'
      do i = 1, list%n - 1
         word = ' '//list%items(i)%name
         if (len(list%items(i)%size) > 0) word = word//' ('//list%items(i)%size//')'
         if (i < list%n - 1) word = word//';'
         if (len(line) + len(word) > line_width) then
            call say(log, line)
            line = ' '
         end if
         line = line//word
      end do
      call say(log, line)
   end subroutine write_words

   !> The lines of advice.
   subroutine report_advice(advice, log)
      type(advice_list_type), intent(in) :: advice
      type(log_type), intent(in) :: log
      integer :: i

      do i = 1, advice%n
         call say(log, 'advice: '//trim(advice%lines(i)))
      end do
   end subroutine report_advice

   !> "12 %", "< 1 %".
   pure function percent(part, whole) result(text)
      real(wp), intent(in) :: part, whole
      character(len=:), allocatable :: text
      real(wp) :: share

      share = 0.0_wp
      if (whole > 0.0_wp) share = 100.0_wp*part/whole
      text = to_text(nint(share))//' %'
      if (share > 0.0_wp .and. share < 0.5_wp) text = '< 1 %'
   end function percent

end module feature_report
