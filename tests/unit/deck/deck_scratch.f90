!> Decks written for one test: lines to a file, the file to a model.
module deck_scratch
   use errors, only: error_type
   use model, only: model_type
   use deck_reader, only: read_deck, definition_type
   implicit none
   private

   public :: read_lines, write_lines, says, scratch_file

   character(len=*), parameter :: scratch_file = 'unit_deck_scratch.inp'
   character(len=*), parameter :: newline = new_line('a')

contains

   !> Reads a deck given as text, in which a | ends a line.
   subroutine read_lines(model, text, error, name, value)
      type(model_type), intent(out) :: model
      character(len=*), intent(in) :: text
      type(error_type), allocatable, intent(out) :: error
      character(len=*), intent(in), optional :: name, value   !! of a definition
      type(definition_type), allocatable :: definitions(:)

      call write_lines(scratch_file, text)
      allocate (definitions(0))
      if (present(name)) then
         deallocate (definitions)
         allocate (definitions(1))
         definitions(1)%name = name
         definitions(1)%value = value
      end if
      call read_deck(model, scratch_file, definitions, error)
      call remove(scratch_file)
   end subroutine read_lines

   !> Writes a text, in which a | ends a line, to a file.
   subroutine write_lines(path, text)
      character(len=*), intent(in) :: path, text
      integer :: unit, i

      open (newunit=unit, file=path, access='stream', form='unformatted', status='replace', &
            action='write')
      do i = 1, len(text)
         if (text(i:i) == '|') then
            write (unit) newline
         else
            write (unit) text(i:i)
         end if
      end do
      close (unit)
   end subroutine write_lines

   subroutine remove(path)
      character(len=*), intent(in) :: path
      integer :: unit

      open (newunit=unit, file=path, status='old')
      close (unit, status='delete')
   end subroutine remove

   !> True if there is an error whose message holds the words.
   function says(error, words) result(found)
      type(error_type), allocatable, intent(in) :: error
      character(len=*), intent(in) :: words
      logical :: found

      found = .false.
      if (allocated(error)) found = index(error%message, words) > 0
   end function says

end module deck_scratch
