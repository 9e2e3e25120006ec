!> What the linker puts in the place of malloc and realloc in the program's own code, so that also
!> the memory that no allocate statement asks for, that of assignments, automatic arrays and
!> temporaries, is asked for in vain but once.
module checked_malloc
   use, intrinsic :: iso_c_binding, only: c_size_t, c_ptr, c_associated
   use memory_end, only: end_without_memory
   implicit none
   private

   public :: malloc_or_end, realloc_or_end

   interface
      function real_malloc(bytes) bind(c, name='__real_malloc') result(place)
         import :: c_size_t, c_ptr
         implicit none
         integer(c_size_t), value :: bytes
         type(c_ptr) :: place
      end function real_malloc

      function real_realloc(old, bytes) bind(c, name='__real_realloc') result(place)
         import :: c_size_t, c_ptr
         implicit none
         type(c_ptr), value :: old
         integer(c_size_t), value :: bytes
         type(c_ptr) :: place
      end function real_realloc
   end interface

contains

   function malloc_or_end(bytes) bind(c, name='__wrap_malloc') result(place)
      integer(c_size_t), value :: bytes
      type(c_ptr) :: place

      place = real_malloc(bytes)
      if (.not. c_associated(place) .and. bytes /= 0) call end_without_memory(bytes)
   end function malloc_or_end

   function realloc_or_end(old, bytes) bind(c, name='__wrap_realloc') result(place)
      type(c_ptr), value :: old
      integer(c_size_t), value :: bytes
      type(c_ptr) :: place

      place = real_realloc(old, bytes)
      if (.not. c_associated(place) .and. bytes /= 0) call end_without_memory(bytes)
   end function realloc_or_end

end module checked_malloc
