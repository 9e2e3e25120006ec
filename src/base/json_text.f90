!> Text in JSON (RFC 8259), put together value by value. Objects and lists are opened and closed in
!> order; commas and escapes are the writer's. Numbers that are not finite become null.
module json_text
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp, int64
   use text, only: to_text
   use display, only: next_character, hexadecimal
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: json_type, json_string, json_number

   integer, parameter :: most_levels = 16
   integer, parameter :: first_room = 4096
   integer, parameter :: most_digits = 17        !! that tell any two numbers apart
   real(wp), parameter :: longest = 1.0e300_wp

   !> What has been written; closed levels are complete. Inside lists values have no names: ''.
   type :: json_type
      private
      character(len=:), allocatable :: room      !! grown by doubling
      integer :: length = 0                      !! used of it
      integer :: level = 0
      logical :: is_empty(0:most_levels) = .true.   !! nothing stands in the level yet
      character(len=1) :: closing(most_levels) = ' '
   contains
      procedure :: open_object
      procedure :: open_list
      procedure :: close => close_level
      procedure :: text => text_so_far
      generic :: put => put_string, put_integer, put_long, put_real, put_logical
      procedure :: put_null
      procedure, private :: put_string, put_integer, put_long, put_real, put_logical
   end type json_type

contains

   !> An object begins.
   subroutine open_object(self, name)
      class(json_type), intent(inout) :: self
      character(len=*), intent(in) :: name

      call open_level(self, name, '{', '}')
   end subroutine open_object

   !> A list begins.
   subroutine open_list(self, name)
      class(json_type), intent(inout) :: self
      character(len=*), intent(in) :: name

      call open_level(self, name, '[', ']')
   end subroutine open_list

   subroutine open_level(self, name, opening, closing)
      class(json_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      character(len=1), intent(in) :: opening, closing

      call add_value(self, name, opening)
      self%level = self%level + 1
      self%is_empty(self%level) = .true.
      self%closing(self%level) = closing
   end subroutine open_level

   !> The innermost object or list ends.
   subroutine close_level(self)
      class(json_type), intent(inout) :: self
      logical :: was_empty

      was_empty = self%is_empty(self%level)
      self%level = self%level - 1
      if (.not. was_empty) call add(self, new_line('a')//repeat('  ', self%level))
      call add(self, self%closing(self%level + 1))
   end subroutine close_level

   !> All there is.
   pure function text_so_far(self) result(text)
      class(json_type), intent(in) :: self
      character(len=:), allocatable :: text

      text = ''
      if (allocated(self%room)) text = self%room(:self%length)
   end function text_so_far

   subroutine put_string(self, name, value)
      class(json_type), intent(inout) :: self
      character(len=*), intent(in) :: name, value

      call add_value(self, name, json_string(value))
   end subroutine put_string

   subroutine put_integer(self, name, value)
      class(json_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer, intent(in) :: value

      call add_value(self, name, to_text(value))
   end subroutine put_integer

   subroutine put_long(self, name, value)
      class(json_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(int64), intent(in) :: value

      call add_value(self, name, to_text(value))
   end subroutine put_long

   subroutine put_real(self, name, value)
      class(json_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: value

      call add_value(self, name, json_number(value))
   end subroutine put_real

   subroutine put_logical(self, name, value)
      class(json_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      logical, intent(in) :: value

      call add_value(self, name, trim(merge('true ', 'false', value)))
   end subroutine put_logical

   !> A value that there is not.
   subroutine put_null(self, name)
      class(json_type), intent(inout) :: self
      character(len=*), intent(in) :: name

      call add_value(self, name, 'null')
   end subroutine put_null

   !> A value on a line of its own, with its name in an object.
   subroutine add_value(self, name, value)
      class(json_type), intent(inout) :: self
      character(len=*), intent(in) :: name, value

      if (.not. self%is_empty(self%level)) call add(self, ',')
      self%is_empty(self%level) = .false.
      if (self%level > 0) call add(self, new_line('a')//repeat('  ', self%level))
      if (len(name) > 0) call add(self, json_string(name)//': ')
      call add(self, value)
   end subroutine add_value

   subroutine add(self, piece)
      class(json_type), intent(inout) :: self
      character(len=*), intent(in) :: piece
      character(len=:), allocatable :: longer
      integer :: status

      if (.not. allocated(self%room)) then
         allocate (character(len=first_room) :: self%room, stat=status)
         call check_allocation(status)
      end if
      if (self%length + len(piece) > len(self%room)) then
         allocate (character(len=2*len(self%room) + len(piece)) :: longer, stat=status)
         call check_allocation(status)
         longer(:self%length) = self%room(:self%length)
         call move_alloc(longer, self%room)
      end if
      self%room(self%length + 1:self%length + len(piece)) = piece
      self%length = self%length + len(piece)
   end subroutine add

   !> A text in quotation marks; bytes that are no UTF-8 become U+FFFD.
   pure function json_string(value) result(string)
      character(len=*), intent(in) :: value
      character(len=:), allocatable :: string
      integer :: i, code, length

      string = '"'
      i = 1
      do while (i <= len(value))
         call next_character(value, i, code, length)
         select case (code)
         case (:-1)
            string = string//'\ufffd'
         case (0:127)
            string = string//escaped(value(i:i))
         case default
            string = string//value(i:i + length - 1)
         end select
         i = i + length
      end do
      string = string//'"'
   end function json_string

   !> A character of ASCII as it stands in a text.
   pure function escaped(letter) result(string)
      character(len=1), intent(in) :: letter
      character(len=:), allocatable :: string

      select case (iachar(letter))
      case (9)
         string = '\t'
      case (10)
         string = '\n'
      case (13)
         string = '\r'
      case (34, 92)
         string = '\'//letter
      case (0:8, 11:12, 14:31, 127)
         string = '\u'//hexadecimal(iachar(letter), 4)
      case default
         string = letter
      end select
   end function escaped

   !> The shortest decimal that is read as the same number.
   pure function json_number(value) result(number)
      real(wp), intent(in) :: value
      character(len=:), allocatable :: number
      real(wp) :: again
      integer :: n_digits, status

      number = 'null'
      if (.not. ieee_is_finite(value)) return
      number = to_text(value, most_digits)
      ! fewer digits of the largest numbers may be read as beyond them
      if (abs(value) > longest .or. abs(value) < 1.0_wp/longest) then
         if (.not. abs(value) > 0.0_wp) number = '0'
         return
      end if
      do n_digits = 6, most_digits
         if (n_digits > 6 .and. n_digits < 15) cycle
         number = to_text(value, n_digits)
         read (number, *, iostat=status) again
         if (status == 0 .and. .not. abs(again - value) > 0.0_wp) return
      end do
   end function json_number

end module json_text
