!> What the user asks on the command line.
module command_line
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use kinds, only: wp
   use text, only: upper_case, to_text
   use numbers, only: parse_integer, parse_real
   use errors, only: error_type, new_error, status_usage
   use memory_shortage, only: check_allocation
   use deck_reader, only: definition_type
   use program_version, only: version_text
   implicit none
   private

   public :: command_type, read_command, usage_text
   public :: command_run, command_check, command_version, command_help, command_reference

   integer, parameter :: command_run = 1
   integer, parameter :: command_check = 2
   integer, parameter :: command_version = 3
   integer, parameter :: command_help = 4
   integer, parameter :: command_reference = 5

   integer, parameter :: most_threads = 1024

   !> A command with its options.
   type :: command_type
      integer :: kind = command_help
      character(len=:), allocatable :: deck
      character(len=:), allocatable :: topic           !! card to print the reference of, or blank
      character(len=:), allocatable :: output          !! result file
      type(definition_type), allocatable :: definitions(:)
      integer :: threads = 0                           !! 0: OMP_NUM_THREADS, else 1
      logical :: quiet = .false.
      logical :: json = .false.                        !! for machines; quiet but for that
      logical :: explain = .false.                     !! a check: say what the deck means
      logical :: overwrite = .false.                   !! results that exist may be replaced
      character(len=:), allocatable :: restart         !! results of an earlier run to go on from
      real(wp) :: memory = 0.0_wp                      !! bytes the run may take, 0: the machine's
      real(wp) :: time_limit = 0.0_wp                  !! seconds the run may take, 0: no limit
   end type command_type

contains

   !> Help for the user.
   pure function usage_text() result(text)
      character(len=:), allocatable :: text
      character(len=1), parameter :: nl = new_line('a')

      text = 'carom '//version_text()//': structural dynamics with impact'//nl//nl// &
            'usage: carom run DECK [-o OUT.h5] [--define NAME=VALUE]... [--threads N] [--quiet]' &
            //nl// &
            '                      [--overwrite] [--restart OLD.h5] [--memory SIZE]'//nl// &
            '                      [--time-limit TIME] [--json]'//nl// &
            '       carom check DECK [--explain] [--define NAME=VALUE]... [--memory SIZE]' &
            //nl// &
            '                      [--json]'//nl// &
            '       carom help [CARD]'//nl// &
            '       carom --version | --help'//nl//nl// &
            '  run      computes the deck; writes OUT.h5, OUT.log and OUT.sta'//nl// &
            '           (default: beside the deck, with its name)'//nl// &
            '  check    reads the deck, builds the model and prints what a run would do'//nl// &
            '  --explain  prints what the deck means: periods, waves, contact, a step' &
            //nl// &
            '  help     prints the deck reference of a card; without one the list of cards'//nl// &
            '  --define overrides a *PARAMETER of the deck'//nl// &
            '  --threads threads to work with (default: OMP_NUM_THREADS, else 1)'//nl// &
            '  --quiet  no progress on the terminal'//nl// &
            '  --json   run and check print one JSON object, nothing else'//nl// &
            '  --overwrite  replaces results that exist'//nl// &
            '  --restart  goes on from the state saved in OLD.h5, there or in OUT.h5'//nl// &
            '  --memory  what the run may take, as 500M or 12G (default: the machine''s)'//nl// &
            '  --time-limit  stops then with the state saved; seconds or HH:MM:SS'//nl//nl// &
            'exit status: 0 done, 1 usage, 2 deck, 3 file, 4 numerical, 5 interrupted, 6 internal'
   end function usage_text

   !> Reads the arguments of the program.
   subroutine read_command(command, error)
      type(command_type), intent(out) :: command
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: word
      integer :: i, status

      allocate (command%definitions(0), stat=status)
      call check_allocation(status)
      if (command_argument_count() == 0) return
      do i = 2, command_argument_count()
         if (argument(i) == '--json') command%json = .true.
      end do
      command%quiet = command%json
      select case (argument(1))
      case ('run')
         command%kind = command_run
      case ('check')
         command%kind = command_check
      case ('help')
         command%kind = command_reference
         call read_topic(command)
         return
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

   !> All words behind `help`: a card's name may have two.
   subroutine read_topic(command)
      type(command_type), intent(inout) :: command
      integer :: i

      command%topic = ''
      do i = 2, command_argument_count()
         command%topic = command%topic//' '//argument(i)
      end do
      command%topic = trim(adjustl(command%topic))
   end subroutine read_topic

   subroutine read_word(command, word, i, error)
      type(command_type), intent(inout) :: command
      character(len=*), intent(in) :: word
      integer, intent(inout) :: i                !! moves on when an option takes the next argument
      type(error_type), allocatable, intent(out) :: error

      select case (word)
      case ('-o', '--define', '--threads', '--restart', '--memory', '--time-limit')
         i = i + 1
         if (i > command_argument_count()) then
            call usage_error(error, word//' needs a value behind it')
            return
         end if
         call read_option(command, word, argument(i), error)
      case ('--quiet')
         command%quiet = .true.
      case ('--json')
         command%json = .true.
      case ('--overwrite')
         command%overwrite = .true.
      case ('--explain')
         command%explain = .true.
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
      character(len=:), allocatable :: cause
      integer :: split

      select case (option)
      case ('-o')
         command%output = value
      case ('--restart')
         command%restart = value
      case ('--memory')
         call read_memory(value, command%memory, error)
      case ('--time-limit')
         call read_time(value, command%time_limit, error)
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
         call parse_integer(value, command%threads, cause)
         if (.not. allocated(cause) .and. command%threads > 0 .and. &
               command%threads <= most_threads) return
         call usage_error(error, '--threads '''//value//''' is not an integer from 1 to '// &
               to_text(most_threads))
      end select
   end subroutine read_option

   !> A size in bytes, or with K, M, G or T behind it (powers of 1000, as in MB of messages).
   subroutine read_memory(value, bytes, error)
      character(len=*), intent(in) :: value
      real(wp), intent(out) :: bytes
      type(error_type), allocatable, intent(out) :: error
      integer :: length, power

      length = len(value)
      power = index('KMGT', upper_case(value(max(1, length):)))
      if (length == 0) power = 0
      if (power > 0) length = length - 1
      bytes = plain_number(value(:length))*1000.0_wp**power
      if (.not. bytes > 0.0_wp) call usage_error(error, '--memory '''//value &
            //''' is not a size such as 500M or 12G')
   end subroutine read_memory

   !> Seconds, or MM:SS, or HH:MM:SS.
   subroutine read_time(value, seconds, error)
      character(len=*), intent(in) :: value
      real(wp), intent(out) :: seconds
      type(error_type), allocatable, intent(out) :: error
      integer :: first, colon, parts

      seconds = 0.0_wp
      first = 1
      do parts = 1, 3
         colon = index(value(first:), ':')
         if (colon == 0) colon = len(value) - first + 2
         seconds = 60.0_wp*seconds + plain_number(value(first:first + colon - 2))
         first = first + colon
         if (first > len(value) + 1) exit
      end do
      if (.not. seconds > 0.0_wp .or. first <= len(value)) call usage_error(error, &
            '--time-limit '''//value//''' is neither seconds nor HH:MM:SS')
   end subroutine read_time

   !> A decimal number without a sign and exponent; not a number (NaN) where it is none.
   function plain_number(word) result(number)
      character(len=*), intent(in) :: word
      real(wp) :: number
      character(len=:), allocatable :: cause

      call parse_real(word, number, cause)
      if (allocated(cause) .or. verify(word, '0123456789.') > 0) then
         number = ieee_value(number, ieee_quiet_nan)
      end if
   end function plain_number

   !> Checks what belongs together and fills in the name of the result file.
   subroutine complete(command, error)
      type(command_type), intent(inout) :: command
      type(error_type), allocatable, intent(out) :: error
      integer :: dot

      if (command%kind /= command_run .and. command%kind /= command_check) then
         if (allocated(command%deck) .or. command%json) call usage_error(error, &
               'nothing may follow here')
         return
      end if
      if (.not. allocated(command%deck)) then
         call usage_error(error, 'no deck given')
         return
      end if
      if (command%kind == command_check .and. allocated(command%restart)) then
         call usage_error(error, '--restart goes with run: a check starts nothing')
      else if (command%kind == command_run .and. command%explain) then
         call usage_error(error, '--explain goes with check')
      else if (allocated(command%output)) then
         call check_ending(command%output, error)
         return
      else if (allocated(command%restart)) then
         command%output = command%restart
         return
      end if
      dot = index(command%deck, '.', back=.true.)
      if (dot <= index(command%deck, '/', back=.true.) + 1) dot = len(command%deck) + 1
      command%output = command%deck(:dot - 1)//'.h5'
   end subroutine complete

   !> Results have a name of their own kind: no slip of the pen makes them replace a deck or a log.
   subroutine check_ending(path, error)
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error
      character(len=*), parameter :: endings(*) = ['.h5    ', '.hdf5  ', '.hdf   ', '.vtkhdf']
      character(len=:), allocatable :: name
      integer :: i

      name = path(index(path, '/', back=.true.) + 1:)
      do i = 1, size(endings)
         if (len(name) <= len_trim(endings(i))) cycle
         if (name(len(name) - len_trim(endings(i)) + 1:) == endings(i)) return
      end do
      call usage_error(error, '-o '''//path//''': a file of results ends in .h5, .hdf5, .hdf or ' &
            //'.vtkhdf')
   end subroutine check_ending

   subroutine usage_error(error, cause)
      type(error_type), allocatable, intent(out) :: error
      character(len=*), intent(in) :: cause

      call new_error(error, status_usage, cause//new_line('a')//usage_text())
   end subroutine usage_error

   function argument(i) result(word)
      integer, intent(in) :: i
      character(len=:), allocatable :: word
      integer :: length, status

      call get_command_argument(i, length=length)
      allocate (character(len=length) :: word, stat=status)
      call check_allocation(status)
      call get_command_argument(i, word)
   end function argument

end module command_line
