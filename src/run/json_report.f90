!> The JSON object of a run or check: what is common to both, and how the program ended.
module json_report
   use kinds, only: wp
   use errors, only: error_type, status_done, status_usage, status_interrupted
   use numbers, only: parse_integer
   use json_text, only: json_type
   use model, only: model_type
   use notices, only: notice_list_type
   use scene_advice, only: advice_list_type
   use command_line, only: command_type, command_check
   use program_version, only: version_text
   implicit none
   private

   public :: open_report, close_report, put_model, put_notices, put_advice, put_optional

   character(len=1), parameter :: nl = new_line('a')

contains

   !> The object begins: program, version, command, deck, output.
   subroutine open_report(report, command)
      type(json_type), intent(inout) :: report
      type(command_type), intent(in) :: command
      integer :: i

      call report%open_object('')
      call report%put('program', 'carom')
      call report%put('version', version_text())
      call report%put('command', trim(merge('check', 'run  ', command%kind == command_check)))
      call put_optional(report, 'deck', command%deck)
      call report%open_object('definitions')
      if (allocated(command%definitions)) then
         do i = 1, size(command%definitions)
            call report%put(command%definitions(i)%name, command%definitions(i)%value)
         end do
      end if
      call report%close()
      if (command%kind == command_check) return
      call put_optional(report, 'output', command%output)
      call put_optional(report, 'restart', command%restart)
   end subroutine open_report

   !> A text, or null where there is none.
   subroutine put_optional(report, name, text)
      type(json_type), intent(inout) :: report
      character(len=*), intent(in) :: name
      character(len=:), allocatable, intent(in) :: text

      if (allocated(text)) then
         call report%put(name, text)
      else
         call report%put_null(name)
      end if
   end subroutine put_optional

   !> The object ends: exit status, ending, error.
   subroutine close_report(report, error)
      type(json_type), intent(inout) :: report
      type(error_type), allocatable, intent(in) :: error

      if (.not. allocated(error)) then
         call report%put('status', status_done)
         call report%put('ending', 'completed')
         call report%put_null('error')
      else
         call report%put('status', error%status)
         call report%put('ending', trim(merge('interrupted', 'failed     ', &
               error%status == status_interrupted)))
         if (error%status == status_usage) then
            ! without the help that follows it
            call put_error(report, error%message(:index(error%message//nl, nl) - 1))
         else
            call put_error(report, error%message)
         end if
      end if
      call report%close()
   end subroutine close_report

   !> The parts of a message: "file:line: cause", and behind "cure:" what helps.
   subroutine put_error(report, message)
      type(json_type), intent(inout) :: report
      character(len=*), intent(in) :: message
      character(len=*), parameter :: mark = nl//'  cure: '
      character(len=:), allocatable :: first, cause
      integer :: cut, colon, place, line

      call report%open_object('error')
      call report%put('message', message)
      first = message(:index(message//nl, nl) - 1)
      call find_place(first, colon, cut, line)
      if (colon > 0) then
         call report%put('file', first(:colon - 1))
         call report%put('line', line)
      else
         call report%put_null('file')
         call report%put_null('line')
      end if
      cause = first(cut + 1:)
      call report%put('cause', cause)
      place = index(message, mark)
      if (place > 0) then
         first = message(place + len(mark):)
         call report%put('cure', first(:index(first//nl, nl) - 1))
      else
         call report%put_null('cure')
      end if
      call report%close()
   end subroutine put_error

   !> The first ":number: " of a line.
   subroutine find_place(text, colon, last, line)
      character(len=*), intent(in) :: text
      integer, intent(out) :: colon              !! before the number, 0: there is none
      integer, intent(out) :: last               !! place of the blank behind it, 0
      integer, intent(out) :: line
      character(len=:), allocatable :: cause
      integer :: length

      last = 0
      line = 0
      colon = 0
      do
         length = scan(text(colon + 1:), ':')
         if (length == 0) exit
         colon = colon + length
         length = verify(text(colon + 1:)//'.', '0123456789')
         if (length < 2 .or. length > 10) cycle
         if (index(text(colon + length:), ': ') /= 1) cycle
         call parse_integer(text(colon + 1:colon + length - 1), line, cause)
         if (allocated(cause)) cycle
         last = colon + length + 1
         return
      end do
      colon = 0
   end subroutine find_place

   !> Heading and sizes of a model.
   subroutine put_model(report, model, n_freedoms, n_groups, n_rows)
      type(json_type), intent(inout) :: report
      type(model_type), intent(in) :: model
      integer, intent(in) :: n_freedoms, n_groups, n_rows

      call report%put('heading', trim(model%heading))
      call report%open_object('model')
      call report%put('nodes', model%nodes%n)
      call report%put('elements', model%elements%n)
      call report%put('groups', n_groups)
      call report%put('freedoms', n_freedoms)
      call report%put('contact_rows', n_rows)
      call report%close()
   end subroutine put_model

   !> Warnings and notes, each with its count.
   subroutine put_notices(report, notices)
      type(json_type), intent(inout) :: report
      type(notice_list_type), intent(in) :: notices

      call put_kind('warnings', .true.)
      call put_kind('notes', .false.)

   contains

      subroutine put_kind(name, warning)
         character(len=*), intent(in) :: name
         logical, intent(in) :: warning
         integer :: i

         call report%open_list(name)
         do i = 1, notices%n
            associate (notice => notices%items(i))
               if (notice%warning .neqv. warning) cycle
               call report%open_object('')
               call report%put('text', notice%text)
               call report%put('count', notice%count)
               if (notice%timed) then
                  call report%put('first_time', notice%t)
               else
                  call report%put_null('first_time')
               end if
               call report%close()
            end associate
         end do
         call report%close()
      end subroutine put_kind

   end subroutine put_notices

   !> What could be cheaper.
   subroutine put_advice(report, lists)
      type(json_type), intent(inout) :: report
      type(advice_list_type), intent(in) :: lists(:)
      integer :: i, j

      call report%open_list('advice')
      do j = 1, size(lists)
         do i = 1, lists(j)%n
            call report%put('', trim(lists(j)%lines(i)))
         end do
      end do
      call report%close()
   end subroutine put_advice

end module json_report
