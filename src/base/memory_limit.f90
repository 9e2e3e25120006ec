!> How much memory the program may have: what the user allows, or the least of what the machine has
!> to give, what the control groups of the process leave, and the room in its address space.
module memory_limit
   use omp_lib, only: omp_get_max_threads
   use kinds, only: wp
   use text, only: to_text
   use memory_use, only: resident_memory, number_in_file
   implicit none
   private

   public :: memory_limit_type, find_limit, group_limit, has_address_limit

   !> Addresses that a thread takes without ever using the memory: work space of BLAS (OpenBLAS
   !> waits for ever where it does not get its 128 MiB), and of threads but the first a stack and a
   !> part of the heap.
   real(wp), parameter :: work_space = 1.4e8_wp, stack_and_heap = 8.0e7_wp
   !> A control group with more than this has no limit, bytes.
   real(wp), parameter :: no_limit = 1.0e17_wp

   !> Where the system tells what is limited, and the limits that addresses count against.
   character(len=*), parameter :: all_limits = '/proc/self/limits'
   character(len=*), parameter :: space = 'Max address space', data_size = 'Max data size'

   !> A limit of the resident memory.
   type :: memory_limit_type
      real(wp) :: bytes = huge(1.0_wp)
      logical :: by_user = .false.               !! asked for, not found
      logical :: of_addresses = .false.          !! these are limited, whatever the memory
      character(len=:), allocatable :: source    !! where it comes from
      character(len=:), allocatable :: cure      !! how it is raised
   end type memory_limit_type

contains

   !> The limit in force now. What the process has already counts as its own.
   subroutine find_limit(self, allowed)
      type(memory_limit_type), intent(out) :: self
      real(wp), intent(in) :: allowed            !! bytes by --memory, 0: not given
      real(wp) :: now, most, bytes

      self%source = 'no limit is known'
      self%cure = 'a higher limit with --memory SIZE'
      self%by_user = allowed > 0.0_wp
      call resident_memory(now, most)
      if (self%by_user) then
         call lower(self, allowed, '--memory')
      else
         bytes = number_in_file('/proc/meminfo', 'MemAvailable:')
         if (bytes >= 0.0_wp) call lower(self, 1024.0_wp*bytes + now, &
               'what this machine has available')
         bytes = group_limit('/proc/self/cgroup', '/sys/fs/cgroup') + now
         if (bytes < self%bytes) self%cure = 'more memory for the control group (job, container)'
         call lower(self, bytes, 'what the control group of the process leaves')
      end if
      call lower_by_addresses(self, now, [character(len=20) :: space, 'VmSize:'], 'ulimit -v')
      call lower_by_addresses(self, now, [character(len=20) :: data_size, 'VmData:'], 'ulimit -d')
   end subroutine find_limit

   !> Whether the addresses of the process are limited.
   function has_address_limit() result(has)
      logical :: has

      has = number_in_file(all_limits, space) >= 0.0_wp
      if (.not. has) has = number_in_file(all_limits, data_size) >= 0.0_wp
   end function has_address_limit

   !> What is left where addresses are limited. A user who sets a limit knows better than this, but
   !> not where the libraries find no room.
   subroutine lower_by_addresses(self, now, words, command)
      type(memory_limit_type), intent(inout) :: self
      real(wp), intent(in) :: now                !! bytes resident
      character(len=*), intent(in) :: words(2)   !! of the limit and the use in files of the system
      character(len=*), intent(in) :: command    !! of the shell that sets it
      real(wp) :: bytes, idle
      integer :: n_threads

      bytes = number_in_file(all_limits, trim(words(1)))
      if (bytes < 0.0_wp) return
      self%of_addresses = .true.
      n_threads = omp_get_max_threads()
      idle = n_threads*work_space + (n_threads - 1)*stack_and_heap
      bytes = bytes - 1024.0_wp*number_in_file('/proc/self/status', trim(words(2))) - idle + now
      if (self%by_user .and. bytes > now) return
      if (bytes < self%bytes) self%cure = 'a higher limit with '//command
      call lower(self, bytes, command//' less '//to_text(nint(1.0e-6_wp*idle)) &
            //' MB of addresses for libraries')
   end subroutine lower_by_addresses

   subroutine lower(self, bytes, source)
      type(memory_limit_type), intent(inout) :: self
      real(wp), intent(in) :: bytes
      character(len=*), intent(in) :: source

      if (bytes >= self%bytes) return
      self%bytes = max(0.0_wp, bytes)
      self%source = source
   end subroutine lower

   !> Bytes that the control groups of a process leave, of version 2 or 1, from the innermost to the
   !> root; huge where there is no limit.
   function group_limit(list, root) result(bytes)
      character(len=*), intent(in) :: list       !! file that names the groups of the process
      character(len=*), intent(in) :: root       !! folder of all groups
      real(wp) :: bytes
      character(len=1000) :: line
      integer :: unit, status

      bytes = huge(1.0_wp)
      open (newunit=unit, file=list, action='read', status='old', iostat=status)
      if (status /= 0) return
      do
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         if (index(line, '0::') == 1) then
            call climb(root, trim(line(4:)), ['memory.max    ', 'memory.current'], bytes)
         else if (index(line, ':memory:') > 0) then
            call climb(root//'/memory', trim(line(index(line, ':memory:') + 8:)), &
                  ['memory.limit_in_bytes', 'memory.usage_in_bytes'], bytes)
         end if
      end do
      close (unit)
   end function group_limit

   !> The least that a group and those it is in leave. Pages of files do not count.
   subroutine climb(root, group, names, bytes)
      character(len=*), intent(in) :: root, group
      character(len=*), intent(in) :: names(2)   !! files with the limit and the use
      real(wp), intent(inout) :: bytes
      character(len=:), allocatable :: folder
      real(wp) :: limit, use, of_files
      integer :: length

      length = len(group)
      do
         folder = root//group(:length)//'/'
         limit = number_in_file(folder//trim(names(1)), '')
         if (limit >= 0.0_wp .and. limit < no_limit) then
            use = max(0.0_wp, number_in_file(folder//trim(names(2)), ''))
            of_files = max(0.0_wp, number_in_file(folder//'memory.stat', 'inactive_file ')) &
                  + max(0.0_wp, number_in_file(folder//'memory.stat', 'active_file '))
            bytes = min(bytes, limit - max(0.0_wp, use - of_files))
         end if
         if (length == 0) exit
         length = max(0, index(group(:length), '/', back=.true.) - 1)
      end do
   end subroutine climb

end module memory_limit
