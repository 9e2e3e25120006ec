!> Threads of the program, and of the linear algebra library that it calls from them.
module threads
   use, intrinsic :: iso_c_binding, only: c_int, c_ptr, c_null_ptr, c_funptr, c_char, c_null_char, &
         c_associated, c_f_procpointer
   use omp_lib, only: omp_set_num_threads
   use kinds, only: wp
   use blas_interfaces, only: dtrsm
   implicit none
   private

   public :: set_threads, claim_work_space, find_symbol

   abstract interface
      subroutine setter_interface(n) bind(c)
         import :: c_int
         implicit none
         integer(c_int), value :: n
      end subroutine setter_interface
   end interface

   interface
      !> The address of a procedure of the libraries, null if none has it.
      function find_symbol(handle, name) bind(c, name='dlsym') result(address)
         import :: c_ptr, c_funptr, c_char
         implicit none
         type(c_ptr), value :: handle
         character(kind=c_char), intent(in) :: name(*)
         type(c_funptr) :: address
      end function find_symbol
   end interface

contains

   !> Sets the threads of loops and of the direct solver (0: as OMP_NUM_THREADS says, else one, so
   !> that runs side by side do not wait for each other), and has OpenBLAS work in the thread that
   !> calls it. Another library has no such call: it is looked up at run time, so that any BLAS can
   !> be linked.
   subroutine set_threads(n)
      integer, intent(in) :: n
      procedure(setter_interface), pointer :: setter
      type(c_funptr) :: address
      integer :: length

      call get_environment_variable('OMP_NUM_THREADS', length=length)
      if (n > 0) then
         call omp_set_num_threads(n)
      else if (length == 0) then
         call omp_set_num_threads(1)
      end if
      address = find_symbol(c_null_ptr, 'openblas_set_num_threads'//c_null_char)
      if (.not. c_associated(address)) return
      call c_f_procpointer(address, setter)
      call setter(1_c_int)
   end subroutine set_threads

   !> Has OpenBLAS take its work space now: later, where the address space is limited and full,
   !> it would try without end.
   subroutine claim_work_space()
      real(wp) :: one(1, 1), x(1, 1)

      one = 1.0_wp
      x = 1.0_wp
      call dtrsm('L', 'L', 'N', 'N', 1, 1, 1.0_wp, one, 1, x, 1)
   end subroutine claim_work_space

end module threads
