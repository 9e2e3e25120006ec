!> Values and positions as the text of failure messages
module lite_text
   use, intrinsic :: iso_fortran_env, only: int32, int64, real32, real64
   implicit none
   private

   public :: to_text, position_text, without_blanks

   interface to_text
      module procedure int32_text, int64_text, real32_text, real64_text
      module procedure logical_text, extents_text
   end interface to_text

   integer, parameter :: max_length = 40

contains

   pure function int32_text(value) result(text)
      integer(int32), intent(in) :: value
      character(len=:), allocatable :: text

      text = int64_text(int(value, int64))
   end function int32_text

   pure function int64_text(value) result(text)
      integer(int64), intent(in) :: value
      character(len=:), allocatable :: text
      character(len=max_length) :: buffer

      write (buffer, '(i0)') value
      text = trim(buffer)
   end function int64_text

   pure function real32_text(value) result(text)
      real(real32), intent(in) :: value
      character(len=:), allocatable :: text
      character(len=max_length) :: buffer

      write (buffer, '(es20.8e2)') value
      text = trim(adjustl(buffer))
   end function real32_text

   pure function real64_text(value) result(text)
      real(real64), intent(in) :: value
      character(len=:), allocatable :: text
      character(len=max_length) :: buffer

      write (buffer, '(es30.16e3)') value
      text = trim(adjustl(buffer))
   end function real64_text

   pure function logical_text(value) result(text)
      logical, intent(in) :: value
      character(len=:), allocatable :: text

      text = trim(merge('true ', 'false', value))
   end function logical_text

   !> A shape or a position, as (2,3)
   pure function extents_text(extents) result(text)
      integer, intent(in) :: extents(:)
      character(len=:), allocatable :: text
      integer :: i

      text = '('
      do i = 1, size(extents)
         if (i > 1) text = text // ','
         text = text // to_text(extents(i))
      end do
      text = text // ')'
   end function extents_text

   !> ' in element (2,3)' for the element `i`, in memory order, of an array of shape `extents`;
   !> empty for a scalar
   pure function position_text(i, extents) result(text)
      integer, intent(in) :: i
      integer, intent(in) :: extents(:)
      character(len=:), allocatable :: text
      integer :: position(size(extents))
      integer :: k, rest

      text = ''
      if (size(extents) == 0) return
      rest = i - 1
      do k = 1, size(extents)
         position(k) = mod(rest, extents(k)) + 1
         rest = rest / extents(k)
      end do
      text = ' in element ' // to_text(position)
   end function position_text

   !> The text with every blank and tab taken out
   pure function without_blanks(text) result(dense)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: dense
      integer :: i

      dense = ''
      do i = 1, len(text)
         if (text(i:i) == ' ' .or. text(i:i) == achar(9)) cycle
         dense = dense // text(i:i)
      end do
   end function without_blanks

end module lite_text
