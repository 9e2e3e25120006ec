!> Colours of elements: those of one colour have no equation in common, so that threads can add
!> their matrices at the same time, and every entry is summed in an order that depends on the
!> colours alone.
module element_colours
   use kinds, only: int64
   use memory_shortage, only: check_allocation
   use dof_map, only: dof_map_type
   implicit none
   private

   public :: colours_type, colour_elements

   !> Colours that fit into the bits of a word; elements beyond them get a colour each.
   integer, parameter :: most_shared = 62

   !> Colour k has the elements element(first(k):first(k + 1) - 1), in ascending order.
   type :: colours_type
      integer, allocatable :: first(:)
      integer, allocatable :: element(:)
   end type colours_type

contains

   !> Gives each element the first colour that none of its equations has yet.
   pure subroutine colour_elements(map, lm, self)
      type(dof_map_type), intent(in) :: map
      integer, intent(in) :: lm(:, :)            !! (n, n_elements) freedoms, 0 where there is none
      type(colours_type), intent(out) :: self
      integer(int64), allocatable :: taken(:)
      integer :: colour(size(lm, 2)), e, i, n_colours, status
      integer(int64) :: of_element

      allocate (taken(map%n_eq), stat=status)
      call check_allocation(status)
      taken = 0
      n_colours = most_shared
      do e = 1, size(lm, 2)
         of_element = 0
         do i = 1, size(lm, 1)
            if (lm(i, e) > 0) of_element = ior(of_element, &
                  all_bits(taken, map%equation(map%first(lm(i, e)):map%first(lm(i, e) + 1) - 1)))
         end do
         colour(e) = trailz(not(of_element)) + 1
         if (colour(e) > most_shared) then
            n_colours = n_colours + 1
            colour(e) = n_colours
            cycle
         end if
         do i = 1, size(lm, 1)
            if (lm(i, e) > 0) call mark(taken, map%equation(map%first(lm(i, e)) &
                  :map%first(lm(i, e) + 1) - 1), colour(e) - 1)
         end do
      end do
      call sort(colour, n_colours, self)
   end subroutine colour_elements

   pure integer(int64) function all_bits(taken, equations)
      integer(int64), intent(in) :: taken(:)
      integer, intent(in) :: equations(:)
      integer :: i

      all_bits = 0
      do i = 1, size(equations)
         if (equations(i) > 0) all_bits = ior(all_bits, taken(equations(i)))
      end do
   end function all_bits

   pure subroutine mark(taken, equations, bit)
      integer(int64), intent(inout) :: taken(:)
      integer, intent(in) :: equations(:), bit
      integer :: i

      do i = 1, size(equations)
         if (equations(i) > 0) taken(equations(i)) = ibset(taken(equations(i)), bit)
      end do
   end subroutine mark

   !> Lists the elements by colour.
   pure subroutine sort(colour, n_colours, self)
      integer, intent(in) :: colour(:), n_colours
      type(colours_type), intent(inout) :: self
      integer :: next(n_colours + 1), e, k
      integer :: status

      next = 0
      do e = 1, size(colour)
         next(colour(e) + 1) = next(colour(e) + 1) + 1
      end do
      next(1) = 1
      do k = 2, n_colours + 1
         next(k) = next(k) + next(k - 1)
      end do
      ! colours that no element has are left out
      self%first = [pack(next(:n_colours), next(2:) > next(:n_colours)), next(n_colours + 1)]
      allocate (self%element(size(colour)), stat=status)
      call check_allocation(status)
      do e = 1, size(colour)
         self%element(next(colour(e))) = e
         next(colour(e)) = next(colour(e)) + 1
      end do
   end subroutine sort

end module element_colours
