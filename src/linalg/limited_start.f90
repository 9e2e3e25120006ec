!> The start of the program where addresses are limited. OpenBLAS makes threads of its own as it is
!> loaded, one for each core, each with a work space of 128 MiB of addresses: those that do not get
!> it try for ever, and the program cannot even end. It has no use for them (threads: set_threads),
!> so it starts anew, with the word to the library to make none.
module limited_start
   use, intrinsic :: iso_c_binding, only: c_char, c_f_procpointer, c_funptr, c_int, c_loc, &
         c_null_char, c_null_ptr, c_associated, c_ptr
   use libc_files, only: c_execv
   use file_calls, only: set_variable, true_path
   use memory_shortage, only: check_allocation
   use memory_limit, only: has_address_limit
   use threads, only: find_symbol
   implicit none
   private

   public :: start_without_pool

   abstract interface
      function count_interface() bind(c) result(n)
         import :: c_int
         implicit none
         integer(c_int) :: n
      end function count_interface
   end interface

   !> A word of the command line as C has it.
   type :: word_type
      character(kind=c_char), allocatable :: bytes(:)
   end type word_type

   character(len=*), parameter :: variable = 'OPENBLAS_NUM_THREADS'

contains

   !> Starts the program anew, with the same words, if addresses are limited and OpenBLAS has
   !> threads of its own; to be called before anything else. Returns where there is no need, or no
   !> way.
   subroutine start_without_pool()
      character(len=2) :: before

      call get_environment_variable(variable, before)
      if (before == '1') return
      if (pool_size() < 2) return
      if (.not. has_address_limit()) return
      call set_variable(variable, '1')
      call execute_again()
   end subroutine start_without_pool

   !> Threads of OpenBLAS with the one that calls it; 1 where another library is linked.
   function pool_size() result(n)
      integer :: n
      procedure(count_interface), pointer :: counter
      type(c_funptr) :: address

      n = 1
      address = find_symbol(c_null_ptr, 'openblas_get_num_threads'//c_null_char)
      if (.not. c_associated(address)) return
      call c_f_procpointer(address, counter)
      n = int(counter())
   end function pool_size

   !> Replaces the program by itself; returns only if that fails.
   subroutine execute_again()
      character(len=*), parameter :: this_program = '/proc/self/exe'
      type(word_type), allocatable, target :: words(:)
      type(c_ptr), allocatable :: addresses(:)
      character(len=:), allocatable :: path
      integer(c_int) :: ignored
      integer :: i, n, status

      n = command_argument_count() + 1
      allocate (words(n), addresses(n + 1), stat=status)
      call check_allocation(status)
      do i = 1, n
         call get_word(i - 1, words(i)%bytes)
         addresses(i) = c_loc(words(i)%bytes)
      end do
      addresses(n + 1) = c_null_ptr
      ! by its own name, which the system shows for it
      path = true_path(this_program)
      if (len(path) == 0) path = this_program
      ignored = c_execv(path//c_null_char, addresses)
   end subroutine execute_again

   subroutine get_word(i, bytes)
      integer, intent(in) :: i                   !! 0: the program
      character(kind=c_char), allocatable, intent(out) :: bytes(:)
      character(len=:), allocatable :: text
      integer :: k, length, status

      call get_command_argument(i, length=length)
      allocate (character(len=length) :: text, stat=status)
      call check_allocation(status)
      call get_command_argument(i, text)
      allocate (bytes(length + 1), stat=status)
      call check_allocation(status)
      do k = 1, length
         bytes(k) = text(k:k)
      end do
      bytes(length + 1) = c_null_char
   end subroutine get_word

end module limited_start
