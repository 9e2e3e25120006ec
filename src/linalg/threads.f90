!> Threads of the program, and of the linear algebra library that it calls from them.
module threads
   use, intrinsic :: iso_c_binding, only: c_int, c_ptr, c_null_ptr, c_funptr, c_char, c_null_char, &
         c_associated, c_f_procpointer
   use omp_lib, only: omp_set_num_threads
   implicit none
   private

   public :: set_threads

   abstract interface
      subroutine setter_interface(n) bind(c)
         import :: c_int
         implicit none
         integer(c_int), value :: n
      end subroutine setter_interface
   end interface

   interface
      function find_symbol(handle, name) bind(c, name='dlsym') result(address)
         import :: c_ptr, c_funptr, c_char
         implicit none
         type(c_ptr), value :: handle
         character(kind=c_char), intent(in) :: name(*)
         type(c_funptr) :: address
      end function find_symbol
   end interface

contains

   !> Sets the threads of loops and of the direct solver (0: as the environment says), and has
   !> OpenBLAS work in the thread that calls it. Another library has no such call: it is looked up
   !> at run time, so that any BLAS can be linked.
   subroutine set_threads(n)
      integer, intent(in) :: n
      procedure(setter_interface), pointer :: setter
      type(c_funptr) :: address

      if (n > 0) call omp_set_num_threads(n)
      address = find_symbol(c_null_ptr, 'openblas_set_num_threads'//c_null_char)
      if (.not. c_associated(address)) return
      call c_f_procpointer(address, setter)
      call setter(1_c_int)
   end subroutine set_threads

end module threads
