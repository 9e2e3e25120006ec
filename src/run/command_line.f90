!> What the user asks on the command line.
module command_line
   use errors, only: error_type, new_error, status_usage
   use deck_reader, only: definition_type
   implicit none
   private

   public :: command_type, read_command, usage_text, version_text
   public :: command_run, command_check, command_version, command_help

   integer, parameter :: command_run = 1
   integer, parameter :: command_check = 2
   integer, parameter :: command_version = 3
   integer, parameter :: command_help = 4

   character(len=*), parameter :: version_text = '0.1.0'

   !> A command with its options.
   type :: command_type
      integer :: kind = command_help
      character(len=:), allocatable :: deck
      character(len=:), allocatable :: output          !! result file
      type(definition_type), allocatable :: definitions(:)
      integer :: threads = 0                           !! 0: as the environment says
      logical :: quiet = .false.
   end type command_type

contains

   !> Help for the user.
   pure function usage_text() result(text)
      character(len=:), allocatable :: text
      character(len=1), parameter :: nl = new_line('a')

      text = 'carom '//version_text//': structural dynamics with impact'//nl//nl// &
            'usage: carom run DECK [-o OUT.h5] [--define NAME=VALUE]... [--threads N] [--quiet]' &
            //nl// &
            '       carom check DECK [--define NAME=VALUE]...'//nl// &
            '       carom --version | --help'//nl//nl// &
            '  run      computes the deck; writes OUT.h5, OUT.log and OUT.sta'//nl// &
            '           (default: beside the deck, with its name)'//nl// &
            '  check    reads the deck, builds the model and prints what a run would do'//nl// &
            '  --define overrides a *PARAMETER of the deck'//nl// &
            '  --threads threads to work with'//nl// &
            '  --quiet  no progress on the terminal'//nl//nl// &
            'exit status: 0 done, 1 usage, 2 deck, 3 file, 4 numerical, 5 interrupted, 6 internal'
   end function usage_text

   !> Reads the arguments of the program.
   subroutine read_command(command, error)
      type(command_type), intent(out) :: command
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: word
      integer :: i

      allocate (command%definitions(0))
      if (command_argument_count() == 0) return
      select case (argument(1))
      case ('run')
         command%kind = command_run
      case ('check')
         command%kind = command_check
      case ('--version')
         command%kind = command_version
      case ('--help', '-h')
         command%kind = command_help
      case default
         call usage_error(error, 'unknown command '''//argument(1)//'''')
         return
      end select
      i = 2
      do while (i <= command_argument_count())
         word = argument(i)
         call read_word(command, word, i, error)
         if (allocated(error)) return
         i = i + 1
      end do
      call complete(command, error)
   end subroutine read_command

   subroutine read_word(command, word, i, error)
      type(command_type), intent(inout) :: command
      character(len=*), intent(in) :: word
      integer, intent(inout) :: i                !! moves on when an option takes the next argument
      type(error_type), allocatable, intent(out) :: error

      select case (word)
      case ('-o', '--define', '--threads')
         i = i + 1
         if (i > command_argument_count()) then
            call usage_error(error, word//' needs a value behind it')
            return
         end if
         call read_option(command, word, argument(i), error)
      case ('--quiet')
         command%quiet = .true.
      case ('--restart')
         call usage_error(error, '--restart is known but does not work yet')
      case default
         if (word(1:min(1, len(word))) == '-' .or. len(word) == 0) then
            call usage_error(error, 'unknown option '''//word//'''')
         else if (allocated(command%deck)) then
            call usage_error(error, 'more than one deck: '''//command%deck//''' and '''//word//'''')
         else
            command%deck = word
         end if
      end select
   end subroutine read_word

   subroutine read_option(command, option, value, error)
      type(command_type), intent(inout) :: command
      character(len=*), intent(in) :: option, value
      type(error_type), allocatable, intent(out) :: error
      type(definition_type) :: definition
      integer :: split, status

      select case (option)
      case ('-o')
         command%output = value
      case ('--define')
         split = index(value, '=')
         if (split < 2 .or. split == len(value)) then
            call usage_error(error, '--define '''//value//''' is not NAME=VALUE')
            return
         end if
         definition%name = value(:split - 1)
         definition%value = value(split + 1:)
         command%definitions = [command%definitions, definition]
      case default
         if (verify(value, '0123456789') == 0) then
            read (value, *, iostat=status) command%threads
            if (status == 0 .and. command%threads > 0) return
         end if
         call usage_error(error, '--threads '''//value//''' is not a positive integer')
      end select
   end subroutine read_option

   !> Checks what belongs together and fills in the name of the result file.
   subroutine complete(command, error)
      type(command_type), intent(inout) :: command
      type(error_type), allocatable, intent(out) :: error
      integer :: dot

      if (command%kind /= command_run .and. command%kind /= command_check) then
         if (allocated(command%deck)) call usage_error(error, 'nothing may follow here')
         return
      end if
      if (.not. allocated(command%deck)) then
         call usage_error(error, 'no deck given')
         return
      end if
      if (allocated(command%output)) return
      dot = index(command%deck, '.', back=.true.)
      if (dot <= index(command%deck, '/', back=.true.) + 1) dot = len(command%deck) + 1
      command%output = command%deck(:dot - 1)//'.h5'
   end subroutine complete

   subroutine usage_error(error, cause)
      type(error_type), allocatable, intent(out) :: error
      character(len=*), intent(in) :: cause

      call new_error(error, status_usage, cause//new_line('a')//usage_text())
   end subroutine usage_error

   function argument(i) result(word)
      integer, intent(in) :: i
      character(len=:), allocatable :: word
      integer :: length

      call get_command_argument(i, length=length)
      allocate (character(len=length) :: word)
      call get_command_argument(i, word)
   end function argument

end module command_line
