!> The deck that a result file was computed from, as /model/deck and /restart/deck have it.
module restart_deck
   use errors, only: error_type, new_error, status_file
   use memory_shortage, only: check_allocation
   use places, only: source_type, new_source_file
   use hdf5_reader, only: hdf5_reader_type
   implicit none
   private

   public :: read_restart_deck, definition_length

   integer, parameter :: definition_length = 160

contains

   !> The text of the deck and all it includes, file by file, and NAME=VALUE of the command line.
   subroutine read_restart_deck(reader, path, source, definitions, error)
      type(hdf5_reader_type), intent(in) :: reader   !! open
      character(len=*), intent(in) :: path           !! of the file, for messages
      type(source_type), intent(out) :: source
      character(len=definition_length), allocatable, intent(out) :: definitions(:)
      type(error_type), allocatable, intent(out) :: error   !! status_file
      character(len=definition_length), allocatable :: files(:)
      integer, allocatable :: n_lines(:)
      character(len=:), allocatable :: text
      integer :: i, first, last, status
      logical :: sound

      call reader%read_texts('/restart/deck/files', definition_length, files, error)
      if (.not. allocated(error)) call reader%read_dataset('/restart/deck/lines', n_lines, error)
      if (.not. allocated(error)) call reader%read_texts('/restart/deck/definitions', &
            definition_length, definitions, error)
      if (.not. allocated(error)) call reader%read_text('/model/deck', text, error)
      sound = .not. allocated(error)
      if (sound) sound = size(files) == size(n_lines)
      if (sound) then
         allocate (source%files(size(files)), stat=status)
         call check_allocation(status)
         source%n_files = size(files)
         last = 0
         do i = 1, size(files)
            first = last + 1
            call pass_lines(text, n_lines(i), last)
            call take_file(source, i, trim(files(i)), text(first:last))
         end do
         sound = last == len(text)
      end if
      if (allocated(error)) deallocate (error)
      if (.not. sound) call new_error(error, status_file, 'the deck in '''//path//''' is damaged' &
            //new_line('a')//'  cure: go on from a copy of the file, or run the deck from its ' &
            //'start')
   end subroutine read_restart_deck

   subroutine take_file(source, i, name, text)
      type(source_type), intent(inout) :: source
      integer, intent(in) :: i
      character(len=*), intent(in) :: name, text
      character(len=:), allocatable :: content

      content = text
      call new_source_file(source%files(i), name, content)
   end subroutine take_file

   !> Moves on behind so many lines of the text, at most to its end.
   pure subroutine pass_lines(text, n_lines, last)
      character(len=*), intent(in) :: text
      integer, intent(in) :: n_lines
      integer, intent(inout) :: last
      integer :: i, length

      do i = 1, n_lines
         length = index(text(last + 1:), new_line('a'))
         if (length == 0) length = len(text) - last
         last = last + length
      end do
   end subroutine pass_lines

end module restart_deck
