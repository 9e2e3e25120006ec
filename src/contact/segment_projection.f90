!> Points and edges in the plane: where a path cuts an edge, the point of an edge closest to another
!> one, the frame of an edge. An edge has two nodes, or three with the middle one last, at s = -1, 1
!> and 0; its body lies on the left of the way from s = -1 to s = 1.
module segment_projection
   use kinds, only: wp
   use topology, only: line_derivatives, line_functions
   implicit none
   private

   public :: cut_edge, closest_on_edge, edge_frame, edge_functions

   real(wp), parameter :: round_off = 8.0_wp*epsilon(1.0_wp)
   real(wp), parameter :: place_of_node(3) = [-1.0_wp, 1.0_wp, 0.0_wp]

contains

   !> Where the straight path from start to finish first cuts an edge: the root s of
   !> u_y x(s) - u_x y(s) - (u_y x_I - u_x y_I) = 0, u = finish - start, at which the path has
   !> gone a fraction between 0 and 1 of its way. A path along a straight edge cuts it nowhere, nor
   !> does one of no length: the closest point serves then.
   pure subroutine cut_edge(x, start, finish, s, fraction, found)
      real(wp), intent(in) :: x(:, :)            !! (2, 2 or 3) nodes of the edge
      real(wp), intent(in) :: start(2), finish(2)
      real(wp), intent(out) :: s                 !! in [-1, 1]
      real(wp), intent(out) :: fraction          !! in [0, 1] of the path
      logical, intent(out) :: found
      integer :: i, n_roots
      real(wp) :: u(2), r(2, 3), c(0:2), roots(2), s_cut, t, slope, blur, room

      s = 0.0_wp
      fraction = 0.0_wp
      found = .false.
      u = finish - start
      if (.not. maxval(abs(u)) > 0.0_wp) return
      call edge_polynomial(x, start, r)
      c = u(1)*r(2, :) - u(2)*r(1, :)
      blur = round_off*norm2(u)*maxval(abs(r))
      where (abs(c) <= blur) c = 0.0_wp
      call quadratic_roots(c, roots, n_roots)
      do i = 1, n_roots
         slope = max(abs(c(1) + 2.0_wp*c(2)*roots(i)), blur, tiny(1.0_wp))
         room = 1.0e-12_wp + min(blur/slope, 1.0e-6_wp)
         if (abs(roots(i)) > 1.0_wp + room) cycle
         s_cut = min(max(roots(i), -1.0_wp), 1.0_wp)
         t = dot_product(u, r(:, 1) + s_cut*(r(:, 2) + s_cut*r(:, 3)))/dot_product(u, u)
         room = 1.0e-12_wp + round_off*maxval(abs(r))/norm2(u)
         if (t < -room .or. t > 1.0_wp + room) cycle
         t = min(max(t, 0.0_wp), 1.0_wp)
         if (found .and. t >= fraction) cycle
         found = .true.
         s = s_cut
         fraction = t
      end do
   end subroutine cut_edge

   !> The point of an edge closest to a point, exactly the node where both coincide.
   pure subroutine closest_on_edge(x, point, s, s_free)
      real(wp), intent(in) :: x(:, :)            !! (2, 2 or 3) nodes of the edge
      real(wp), intent(in) :: point(2)
      real(wp), intent(out) :: s                 !! in [-1, 1]
      real(wp), intent(out) :: s_free            !! s, beyond the end on the tangent there
      integer :: i
      real(wp) :: a(2), aa

      do i = 1, size(x, 2)
         if (any(abs(x(:, i) - point) > 0.0_wp)) cycle
         s = place_of_node(i)
         s_free = s
         return
      end do
      if (size(x, 2) == 3) then
         call closest_on_curve(x, point, s, s_free)
         return
      end if
      a = (x(:, 2) - x(:, 1))/2.0_wp
      aa = max(dot_product(a, a), tiny(1.0_wp))
      s_free = -1.0_wp - dot_product(a, x(:, 1) - point)/aa
      if (s_free > 0.0_wp) s_free = 1.0_wp - dot_product(a, x(:, 2) - point)/aa
      s = min(max(s_free, -1.0_wp), 1.0_wp)
   end subroutine closest_on_edge

   !> Point X(s), unit tangent X'/J, outward unit normal (t_y, -t_x), J = |X'| and the curvature
   !> n . X''/J^2, negative where the body is convex.
   pure subroutine edge_frame(x, s, point, tangent, normal, stretch, bend)
      real(wp), intent(in) :: x(:, :)            !! (2, 2 or 3) nodes of the edge
      real(wp), intent(in) :: s
      real(wp), intent(out) :: point(2), tangent(2), normal(2), stretch, bend
      real(wp) :: shape(3), rise(3)

      call edge_functions(size(x, 2), s, shape, rise)
      point = shape(1)*x(:, 1) + shape(2)*x(:, 2)
      tangent = rise(1)*x(:, 1) + rise(2)*x(:, 2)
      if (size(x, 2) == 3) then
         point = point + shape(3)*x(:, 3)
         tangent = tangent + rise(3)*x(:, 3)
      end if
      stretch = max(norm2(tangent), tiny(1.0_wp))
      tangent = tangent/stretch
      normal = [tangent(2), -tangent(1)]
      bend = 0.0_wp
      if (size(x, 2) == 3) then
         bend = dot_product(normal, (x(:, 1) - x(:, 3)) + (x(:, 2) - x(:, 3)))/stretch**2
      end if
   end subroutine edge_frame

   !> N_p(s) and dN_p/ds of an edge of n nodes; zero of the third if there are two.
   pure subroutine edge_functions(n, s, shape, rise)
      integer, intent(in) :: n
      real(wp), intent(in) :: s
      real(wp), intent(out) :: shape(3), rise(3)

      ! Sizes known to the compiler spare it the allocation of results.
      if (n == 3) then
         shape = line_functions(3, s)
         rise = line_derivatives(3, s)
      else
         shape(:2) = line_functions(2, s)
         rise(:2) = line_derivatives(2, s)
         shape(3) = 0.0_wp
         rise(3) = 0.0_wp
      end if
   end subroutine edge_functions

   !> X(s) - origin = r1 + r2 s + r3 s^2.
   pure subroutine edge_polynomial(x, origin, r)
      real(wp), intent(in) :: x(:, :)
      real(wp), intent(in) :: origin(2)
      real(wp), intent(out) :: r(2, 3)

      r(:, 2) = (x(:, 2) - x(:, 1))/2.0_wp
      if (size(x, 2) == 3) then
         r(:, 1) = x(:, 3) - origin
         r(:, 3) = ((x(:, 1) - x(:, 3)) + (x(:, 2) - x(:, 3)))/2.0_wp
      else
         r(:, 1) = ((x(:, 1) - origin) + (x(:, 2) - origin))/2.0_wp
         r(:, 3) = 0.0_wp
      end if
   end subroutine edge_polynomial

   !> Real roots of c0 + c1 s + c2 s^2 without cancellation; two that round-off cannot tell apart
   !> count as one.
   pure subroutine quadratic_roots(c, roots, n_roots)
      real(wp), intent(in) :: c(0:2)
      real(wp), intent(out) :: roots(2)
      integer, intent(out) :: n_roots
      real(wp) :: discriminant, q

      n_roots = 0
      roots = 0.0_wp
      discriminant = c(1)**2 - 4.0_wp*c(0)*c(2)
      if (abs(discriminant) <= round_off*(c(1)**2 + abs(4.0_wp*c(0)*c(2)))) discriminant = 0.0_wp
      if (discriminant < 0.0_wp) return
      q = -(c(1) + sign(sqrt(discriminant), c(1)))/2.0_wp
      if (abs(c(2)) > 0.0_wp) then
         n_roots = 1
         roots(1) = q/c(2)
         if (.not. discriminant > 0.0_wp) return
      end if
      if (.not. abs(q) > 0.0_wp) return
      n_roots = n_roots + 1
      roots(n_roots) = c(0)/q
   end subroutine quadratic_roots

   !> Of a three-node edge: the least of the squared distances at the ends and at the roots of its
   !> derivative, a cubic, each looked for where that is monotonic.
   pure subroutine closest_on_curve(x, point, s, s_free)
      real(wp), intent(in) :: x(:, :)
      real(wp), intent(in) :: point(2)
      real(wp), intent(out) :: s, s_free
      integer :: i, n_roots
      real(wp) :: r(2, 3), f(0:3), roots(2), knots(4), trial(5), least, distance

      call edge_polynomial(x, point, r)
      f = [dot_product(r(:, 2), r(:, 1)), &
            dot_product(r(:, 2), r(:, 2)) + 2.0_wp*dot_product(r(:, 3), r(:, 1)), &
            3.0_wp*dot_product(r(:, 3), r(:, 2)), 2.0_wp*dot_product(r(:, 3), r(:, 3))]
      call quadratic_roots([f(1), 2.0_wp*f(2), 3.0_wp*f(3)], roots, n_roots)
      if (n_roots < 2) roots(n_roots + 1:) = 1.0_wp
      roots = min(max(roots, -1.0_wp), 1.0_wp)
      knots = [-1.0_wp, minval(roots), maxval(roots), 1.0_wp]
      trial(:2) = [-1.0_wp, 1.0_wp]
      do i = 1, 3
         trial(2 + i) = minimum_between(f, knots(i), knots(i + 1))
      end do
      s = 0.0_wp
      least = huge(1.0_wp)
      do i = 1, 5
         distance = sum((r(:, 1) + trial(i)*(r(:, 2) + trial(i)*r(:, 3)))**2)
         if (distance < least) s = trial(i)
         least = min(distance, least)
      end do
      s_free = s
      if (abs(s) < 1.0_wp) return
      i = merge(1, 2, s < 0.0_wp)
      associate (tangent => r(:, 2) + 2.0_wp*s*r(:, 3))
         s_free = s - dot_product(tangent, x(:, i) - point) &
               /max(dot_product(tangent, tangent), tiny(1.0_wp))
      end associate
   end subroutine closest_on_curve

   !> Where f, monotonic between low and high, rises through zero: Newton's method, halving the
   !> bracket where it would leave it; one of the ends if it does not.
   pure function minimum_between(f, low, high) result(s)
      real(wp), intent(in) :: f(0:3), low, high
      real(wp) :: s
      integer :: iteration
      real(wp) :: left, right, value, slope, change

      left = low
      right = high
      s = low
      if (cubic(f, low) >= 0.0_wp) return
      s = high
      if (cubic(f, high) <= 0.0_wp) return
      s = (low + high)/2.0_wp
      do iteration = 1, 80
         value = cubic(f, s)
         if (value > 0.0_wp) right = s
         if (value <= 0.0_wp) left = s
         slope = f(1) + s*(2.0_wp*f(2) + 3.0_wp*s*f(3))
         change = (left + right)/2.0_wp - s
         if (abs(slope)*(right - left) > abs(value)) change = -value/slope
         if (s + change < left .or. s + change > right) change = (left + right)/2.0_wp - s
         s = s + change
         if (abs(change) <= epsilon(1.0_wp)) return
      end do
   end function minimum_between

   pure function cubic(f, s) result(value)
      real(wp), intent(in) :: f(0:3), s
      real(wp) :: value

      value = f(0) + s*(f(1) + s*(f(2) + s*f(3)))
   end function cubic

end module segment_projection
