!> Which elements of a group have the same shape, so that their matrices are the same.
module congruence
   use kinds, only: wp, int64
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: find_classes

   !> Shapes are the same within this part of their size, or within the round-off of their
   !> coordinates where that is more, though never above the larger part.
   real(wp), parameter :: same_part = 1.0e-13_wp
   real(wp), parameter :: most_part = 1.0e-11_wp

contains

   !> Numbers the shapes of a group's elements in the order in which they occur. An element that is
   !> another one shifted, in the directions in which a shift changes nothing, has its number.
   pure subroutine find_classes(x, shiftable, class, first)
      real(wp), intent(in) :: x(:, :, :)                !! (2, n_nodes, n_elements)
      logical, intent(in) :: shiftable(2)               !! directions x and y
      integer, allocatable, intent(out) :: class(:)     !! (n_elements) number of the shape
      integer, allocatable, intent(out) :: first(:)     !! (n_classes) first element of each
      integer, allocatable :: table(:), next(:), members(:)
      integer :: e, n_classes, place, c, status

      allocate (class(size(x, 3)), members(size(x, 3)), next(size(x, 3)), stat=status)
      call check_allocation(status)
      allocate (table(0:2*size(x, 3)), stat=status)
      call check_allocation(status)
      table = 0
      n_classes = 0
      do e = 1, size(x, 3)
         c = 0
         if (e > 1) then
            if (are_same(x(:, :, e), x(:, :, members(class(e - 1))), shiftable)) c = class(e - 1)
         end if
         if (c == 0) then
            place = int(modulo(key_of(x(:, :, e), shiftable), int(size(table), int64)))
            c = table(place)
            do while (c > 0)
               if (are_same(x(:, :, e), x(:, :, members(c)), shiftable)) exit
               c = next(c)
            end do
         end if
         if (c == 0) then
            n_classes = n_classes + 1
            c = n_classes
            members(c) = e
            next(c) = table(place)
            table(place) = c
         end if
         class(e) = c
      end do
      first = members(:n_classes)
   end subroutine find_classes

   !> Coordinates that decide: from the first node where a shift changes nothing.
   pure function relative(x, shiftable) result(r)
      real(wp), intent(in) :: x(:, :)
      logical, intent(in) :: shiftable(2)
      real(wp) :: r(2, size(x, 2))
      integer :: i

      do i = 1, 2
         r(i, :) = x(i, :)
         if (shiftable(i)) r(i, :) = x(i, :) - x(i, 1)
      end do
   end function relative

   pure function are_same(x, y, shiftable) result(same)
      real(wp), intent(in) :: x(:, :), y(:, :)
      logical, intent(in) :: shiftable(2)
      logical :: same
      real(wp) :: extent, tolerance, gap
      integer :: i, j

      extent = 0.0_wp
      tolerance = 0.0_wp
      gap = 0.0_wp
      do j = 1, size(x, 2)
         do i = 1, 2
            extent = max(extent, abs(x(i, j) - x(i, 1)))
            tolerance = max(tolerance, abs(x(i, j)), abs(y(i, j)))
            if (shiftable(i)) then
               gap = max(gap, abs((x(i, j) - x(i, 1)) - (y(i, j) - y(i, 1))))
            else
               gap = max(gap, abs(x(i, j) - y(i, j)))
            end if
         end do
      end do
      tolerance = max(same_part*extent, 4.0_wp*epsilon(extent)*tolerance)
      same = gap <= min(tolerance, most_part*extent)
   end function are_same

   !> A number that shapes of one class share, but for those astride a step of the rounding.
   pure function key_of(x, shiftable) result(key)
      real(wp), intent(in) :: x(:, :)
      logical, intent(in) :: shiftable(2)
      integer(int64) :: key
      real(wp) :: r(2, size(x, 2)), quantum
      integer(int64), parameter :: largest = 2147483647_int64
      integer :: i, j

      ! an odd number, such that round coordinates do not fall on its steps
      quantum = 0.7310585786e-6_wp*scale(1.0_wp, exponent(maxval(abs(x(:, 2) - x(:, 1)))))
      r = relative(x, shiftable)
      key = 17
      do j = 1, size(x, 2)
         do i = 1, 2
            key = modulo(1000003_int64*key + nint(modulo(r(i, j)/quantum, 1.0e15_wp), int64), &
                  largest)
         end do
      end do
   end function key_of

end module congruence
