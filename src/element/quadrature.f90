!> Gauss rules of plane elements and of their edges. Points of quadrilaterals stand with the first
!> natural coordinate fastest.
module quadrature
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use topology, only: tri3, quad4, tri6, count_corners
   implicit none
   private

   public :: rule_type, stiffness_rule, mass_rule, triangle_rule, quadrilateral_rule, line_rule

   !> sum of weight(i) f(point(:, i)).
   type :: rule_type
      integer :: n = 0
      real(wp), allocatable :: point(:, :)      !! (2, n)
      real(wp), allocatable :: weight(:)        !! (n)
   end type rule_type

contains

   !> The rule of stresses and stiffness, as CalculiX and Abaqus have it: 1 point for the three-node
   !> triangle, 3 for the six-node one, 2x2 and 3x3 for quadrilaterals, 1 and 2x2 reduced.
   pure function stiffness_rule(topology, reduced) result(rule)
      integer, intent(in) :: topology
      logical, intent(in) :: reduced            !! triangles have no reduced rule
      type(rule_type) :: rule

      select case (topology)
      case (tri3)
         call triangle_rule(1, rule)
      case (tri6)
         call triangle_rule(3, rule)
      case (quad4)
         call quadrilateral_rule(merge(1, 2, reduced), rule)
      case default
         call quadrilateral_rule(merge(2, 3, reduced), rule)
      end select
   end function stiffness_rule

   !> The rule of mass and loads, never reduced: degree 5, so that N N r is exact on triangles with
   !> straight edges.
   pure function mass_rule(topology) result(rule)
      integer, intent(in) :: topology
      type(rule_type) :: rule

      if (count_corners(topology) == 3) then
         call triangle_rule(7, rule)
      else
         call quadrilateral_rule(3, rule)
      end if
   end function mass_rule

   !> Symmetric rules of the triangle of area 1/2 (Cowper 1973): 1 point of degree 1, 3 of degree 2,
   !> 6 of degree 4, 7 of degree 5.
   pure subroutine triangle_rule(n, rule)
      integer, intent(in) :: n                  !! 1, 3, 6 or 7
      type(rule_type), intent(out) :: rule
      real(wp) :: root
      integer :: status

      rule%n = 0
      allocate (rule%point(2, n), rule%weight(n), stat=status)
      call check_allocation(status)
      select case (n)
      case (1)
         call add_centre(rule, 1.0_wp)
      case (3)
         call add_orbit(rule, 1.0_wp/6.0_wp, 1.0_wp/3.0_wp)
      case (6)
         call add_orbit(rule, 0.445948490915964886318329253883_wp, &
               0.223381589678011465722302189360_wp)
         call add_orbit(rule, 0.091576213509770743459571463402_wp, &
               0.109951743655321867610998143973_wp)
      case default
         root = sqrt(15.0_wp)
         call add_centre(rule, 9.0_wp/40.0_wp)
         call add_orbit(rule, (6.0_wp + root)/21.0_wp, (155.0_wp + root)/1200.0_wp)
         call add_orbit(rule, (6.0_wp - root)/21.0_wp, (155.0_wp - root)/1200.0_wp)
      end select
      rule%weight = rule%weight/2.0_wp
   end subroutine triangle_rule

   pure subroutine add_centre(rule, weight)
      type(rule_type), intent(inout) :: rule
      real(wp), intent(in) :: weight

      rule%n = rule%n + 1
      rule%point(:, rule%n) = 1.0_wp/3.0_wp
      rule%weight(rule%n) = weight
   end subroutine add_centre

   !> The three points with two area coordinates equal to a.
   pure subroutine add_orbit(rule, a, weight)
      type(rule_type), intent(inout) :: rule
      real(wp), intent(in) :: a, weight
      integer :: first

      first = rule%n + 1
      rule%n = rule%n + 3
      rule%point(:, first) = [a, a]
      rule%point(:, first + 1) = [1.0_wp - 2.0_wp*a, a]
      rule%point(:, first + 2) = [a, 1.0_wp - 2.0_wp*a]
      rule%weight(first:rule%n) = weight
   end subroutine add_orbit

   !> Product of two Gauss rules of n points: degree 2 n - 1 in each direction.
   pure subroutine quadrilateral_rule(n, rule)
      integer, intent(in) :: n                  !! points in each direction: 1, 2 or 3
      type(rule_type), intent(out) :: rule
      real(wp) :: s(n), weight(n)
      integer :: i, j, status

      call line_rule(s, weight)
      rule%n = n*n
      allocate (rule%point(2, n*n), rule%weight(n*n), stat=status)
      call check_allocation(status)
      do j = 1, n
         do i = 1, n
            rule%point(:, (j - 1)*n + i) = [s(i), s(j)]
            rule%weight((j - 1)*n + i) = weight(i)*weight(j)
         end do
      end do
   end subroutine quadrilateral_rule

   !> Gauss rule from -1 to 1 with as many points as there is room for: 1, 2 or 3.
   pure subroutine line_rule(s, weight)
      real(wp), intent(out) :: s(:)
      real(wp), intent(out) :: weight(:)
      real(wp) :: a

      select case (size(s))
      case (1)
         s = 0.0_wp
         weight = 2.0_wp
      case (2)
         a = 1.0_wp/sqrt(3.0_wp)
         s = [-a, a]
         weight = 1.0_wp
      case default
         a = sqrt(0.6_wp)
         s = [-a, 0.0_wp, a]
         weight = [5.0_wp, 8.0_wp, 5.0_wp]/9.0_wp
      end select
   end subroutine line_rule

end module quadrature
