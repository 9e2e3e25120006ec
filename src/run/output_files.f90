!> The files that a run writes: their names, and that none of them is one it reads.
module output_files
   use errors, only: error_type, new_error, status_file
   use file_calls, only: file_facts_type, look_at, is_device, is_regular, is_same
   use part_file, only: part_file_type, claim
   use places, only: source_type
   use command_line, only: command_type
   implicit none
   private

   public :: claim_output, log_stem

contains

   !> Takes the result file for this run alone. Nothing is made before all is found in order.
   subroutine claim_output(place, command, source, error)
      type(part_file_type), intent(out) :: place
      type(command_type), intent(in) :: command
      type(source_type), intent(in) :: source    !! the deck, with all it includes
      type(error_type), allocatable, intent(out) :: error   !! status_file
      character(len=*), parameter :: endings(*) = ['     ', '.part', '.next', '.log ', '.sta ']
      character(len=:), allocatable :: name
      integer :: i, j

      do i = 1, size(endings)
         name = command%output//trim(endings(i))
         if (i > 3) name = log_stem(command%output)//trim(endings(i))
         do j = 1, source%n_files
            if (is_same(look_at(name), look_at(source%files(j)%name))) then
               call new_error(error, status_file, 'cannot write '''//name//''': the deck is read ' &
                     //'from it'//new_line('a')//'  cure: give the results another name with -o')
               return
            end if
         end do
      end do
      call check_text(log_stem(command%output)//'.log', 'carom ', command%overwrite, error)
      if (allocated(error)) return
      call check_text(log_stem(command%output)//'.sta', '# step', command%overwrite, error)
      if (allocated(error)) return
      call claim(place, command%output, command%overwrite, error)
   end subroutine claim_output

   !> The log belongs to the results and goes with them: where there are none any more it is
   !> replaced. A file that no run has written is not.
   subroutine check_text(path, beginning, overwrite, error)
      character(len=*), intent(in) :: path
      character(len=*), intent(in) :: beginning  !! of what a run has written
      logical, intent(in) :: overwrite
      type(error_type), allocatable, intent(out) :: error
      character(len=len(beginning)) :: found
      type(file_facts_type) :: facts
      integer :: unit, status

      facts = look_at(path)
      if (.not. facts%exists) return
      if (.not. (is_regular(facts) .or. is_device(facts))) then
         call new_error(error, status_file, 'cannot write '''//path//''': it is a directory, ' &
               //'pipe or socket'//new_line('a')//'  cure: give the results another name with -o')
      end if
      if (allocated(error) .or. overwrite .or. facts%size == 0) return
      open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
            action='read', iostat=status)
      if (status == 0) then
         read (unit, iostat=status) found
         close (unit)
      end if
      if (status /= 0) found = ''
      if (found == beginning) return
      call new_error(error, status_file, 'cannot write '''//path//''': it exists, and no run has ' &
            //'written it'//new_line('a')//'  cure: --overwrite replaces it; or give the results ' &
            //'another name with -o')
   end subroutine check_text

   !> The log of OUT.h5 is OUT.log; with any other ending the whole name stays: no two results share
   !> a log.
   pure function log_stem(path) result(stem)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: stem
      character(len=*), parameter :: ending = '.h5'

      integer :: last

      stem = path
      last = len(path) - len(ending)
      if (last < 1) return
      if (path(last + 1:) == ending) stem = path(:last)
   end function log_stem

end module output_files
