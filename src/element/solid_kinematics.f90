!> Strains from displacements of plane or axisymmetric solids, and forces from stresses, for each of
!> the shapes that a group's elements have.
!> Components are 11 22 33 12 with engineering shear strain; 33 is the hoop of axisymmetric solids.
module solid_kinematics
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use elastic, only: axisymmetric
   use quadrature, only: rule_type, stiffness_rule
   use solid_geometry, only: solid_shape_type, map_derivatives, depth_at
   use topology, only: quad4, shape_functions
   implicit none
   private

   public :: kinematics_type, new_kinematics

   !> Computed once for small displacements.
   type :: kinematics_type
      real(wp), allocatable :: gradient(:, :, :, :)  !! (3, nodes, points, elements) dN/dx dN/dy N/r
      real(wp), allocatable :: volume(:, :)          !! (points, elements) share of each point
      real(wp), allocatable :: dilatation(:, :, :)   !! (2, nodes, elements) mean; empty: no B-bar
      real(wp), allocatable :: hourglass(:, :)       !! (nodes, elements) gamma, empty: not needed
      logical :: b_bar = .false.
   contains
      procedure :: strain_at
      procedure :: add_force
      procedure :: strain_matrix
      procedure :: stiffness
   end type kinematics_type

contains

   pure subroutine new_kinematics(self, shape, x)
      type(kinematics_type), intent(out) :: self
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :, :)        !! (2, nodes, elements) without faults
      type(rule_type) :: rule
      integer :: e, n, m, status

      rule = stiffness_rule(shape%topology, shape%reduced)
      n = size(x, 2)
      m = size(x, 3)
      self%b_bar = shape%b_bar
      allocate (self%gradient(3, n, rule%n, m), self%volume(rule%n, m), stat=status)
      call check_allocation(status)
      allocate (self%dilatation(2, n, merge(m, 0, shape%b_bar)), stat=status)
      call check_allocation(status)
      allocate (self%hourglass(n, merge(m, 0, shape%topology == quad4 .and. shape%reduced)), &
            stat=status)
      call check_allocation(status)
      do e = 1, m
         if (shape%plane == axisymmetric .and. size(self%hourglass, 2) > 0) then
            call place_mean_point(self, shape, x(:, :, e), e)
         else
            call place_points(self, shape, rule, x(:, :, e), e)
         end if
         if (size(self%dilatation, 3) > 0) call average_dilatation(self, e)
         if (size(self%hourglass, 2) > 0) call find_hourglass(self, x(:, :, e), e)
      end do
   end subroutine new_kinematics

   pure subroutine place_points(self, shape, rule, x, e)
      type(kinematics_type), intent(inout) :: self
      type(solid_shape_type), intent(in) :: shape
      type(rule_type), intent(in) :: rule
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: e
      real(wp) :: n(size(x, 2)), det_j, r
      integer :: p

      do p = 1, rule%n
         n = shape_functions(shape%topology, rule%point(:, p))
         r = dot_product(n, x(1, :))
         call map_derivatives(shape%topology, x, rule%point(:, p), &
               self%gradient(1:2, :, p, e), det_j)
         self%gradient(3, :, p, e) = 0.0_wp
         if (shape%plane == axisymmetric) self%gradient(3, :, p, e) = n/r
         self%volume(p, e) = rule%weight(p)*det_j*depth_at(shape, r)
      end do
   end subroutine place_points

   !> The one point of an axisymmetric quadrilateral: gradients averaged over the volume. Those at
   !> the
   !> centre would not keep a distorted mesh in balance under constant stresses, since the hoop's
   !> share is not what the point sees.
   pure subroutine place_mean_point(self, shape, x, e)
      type(kinematics_type), intent(inout) :: self
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: e
      type(rule_type) :: rule
      real(wp) :: n(size(x, 2)), gradient(2, size(x, 2)), det_j, r, share
      integer :: p

      rule = stiffness_rule(shape%topology, .false.)
      self%gradient(:, :, 1, e) = 0.0_wp
      self%volume(1, e) = 0.0_wp
      do p = 1, rule%n
         n = shape_functions(shape%topology, rule%point(:, p))
         r = dot_product(n, x(1, :))
         call map_derivatives(shape%topology, x, rule%point(:, p), gradient, det_j)
         share = rule%weight(p)*det_j*depth_at(shape, r)
         self%volume(1, e) = self%volume(1, e) + share
         self%gradient(1:2, :, 1, e) = self%gradient(1:2, :, 1, e) + share*gradient
         self%gradient(3, :, 1, e) = self%gradient(3, :, 1, e) + share*n/r
      end do
      self%gradient(:, :, 1, e) = self%gradient(:, :, 1, e)/self%volume(1, e)
   end subroutine place_mean_point

   !> Volumetric strain averaged over the element, per displacement (Hughes, The Finite Element
   !> Method, section 4.5.2: B-bar with mean dilatation).
   pure subroutine average_dilatation(self, e)
      type(kinematics_type), intent(inout) :: self
      integer, intent(in) :: e
      integer :: p

      self%dilatation(:, :, e) = 0.0_wp
      do p = 1, size(self%volume, 1)
         associate (g => self%gradient(:, :, p, e), share => self%volume(p, e))
            self%dilatation(1, :, e) = self%dilatation(1, :, e) + share*(g(1, :) + g(3, :))
            self%dilatation(2, :, e) = self%dilatation(2, :, e) + share*g(2, :)
         end associate
      end do
      self%dilatation(:, :, e) = self%dilatation(:, :, e)/sum(self%volume(:, e))
   end subroutine average_dilatation

   !> The displacement pattern that the one point does not see, orthogonal to all linear fields
   !> (Flanagan and Belytschko 1981), times the square root of volume and sum of gradients squared.
   pure subroutine find_hourglass(self, x, e)
      type(kinematics_type), intent(inout) :: self
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: e
      real(wp), parameter :: h(4) = [1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp]

      associate (g => self%gradient(1:2, :, 1, e))
         self%hourglass(:, e) = (h - matmul(matmul(x, h), g))/4.0_wp &
               *sqrt(self%volume(1, e)*sum(g**2))
      end associate
   end subroutine find_hourglass

   pure function strain_at(self, p, e, u) result(strain)
      class(kinematics_type), intent(in) :: self
      integer, intent(in) :: p, e               !! point and element
      real(wp), intent(in) :: u(:, :)           !! (2, nodes) displacements
      real(wp) :: strain(4)
      integer :: i

      strain = 0.0_wp
      do i = 1, size(u, 2)
         associate (g => self%gradient(:, i, p, e))
            strain(1) = strain(1) + g(1)*u(1, i)
            strain(2) = strain(2) + g(2)*u(2, i)
            strain(3) = strain(3) + g(3)*u(1, i)
            strain(4) = strain(4) + g(2)*u(1, i) + g(1)*u(2, i)
         end associate
      end do
      if (.not. self%b_bar) return
      strain(1:3) = strain(1:3) + (sum(self%dilatation(:, :, e)*u) - sum(strain(1:3)))/3.0_wp
   end function strain_at

   !> Adds the nodal forces that a stress at a point makes.
   pure subroutine add_force(self, p, e, stress, force)
      class(kinematics_type), intent(in) :: self
      integer, intent(in) :: p, e               !! point and element
      real(wp), intent(in) :: stress(4)
      real(wp), intent(inout) :: force(:, :)    !! (2, nodes)
      real(wp) :: s(4), mean
      integer :: i

      s = self%volume(p, e)*stress
      if (self%b_bar) then
         mean = sum(s(1:3))/3.0_wp
         s(1:3) = s(1:3) - mean
         force = force + mean*self%dilatation(:, :, e)
      end if
      do i = 1, size(force, 2)
         associate (g => self%gradient(:, i, p, e))
            force(1, i) = force(1, i) + g(1)*s(1) + g(3)*s(3) + g(2)*s(4)
            force(2, i) = force(2, i) + g(2)*s(2) + g(1)*s(4)
         end associate
      end do
   end subroutine add_force

   !> Strains over displacements, the latter node after node.
   pure function strain_matrix(self, p, e) result(b)
      class(kinematics_type), intent(in) :: self
      integer, intent(in) :: p, e               !! point and element
      real(wp) :: b(4, 2*size(self%gradient, 2))
      integer :: i

      b = 0.0_wp
      do i = 1, size(self%gradient, 2)
         associate (g => self%gradient(:, i, p, e))
            b(:, 2*i - 1) = [g(1), 0.0_wp, g(3), g(2)]
            b(:, 2*i) = [0.0_wp, g(2), 0.0_wp, g(1)]
            if (.not. self%b_bar) cycle
            b(1:3, 2*i - 1) = b(1:3, 2*i - 1) + (self%dilatation(1, i, e) - g(1) - g(3))/3.0_wp
            b(1:3, 2*i) = b(1:3, 2*i) + (self%dilatation(2, i, e) - g(2))/3.0_wp
         end associate
      end do
   end function strain_matrix

   !> Stiffness of an element with the same stress over strain at all points.
   pure function stiffness(self, e, elastic, hourglass_stiffness) result(matrix)
      class(kinematics_type), intent(in) :: self
      integer, intent(in) :: e                  !! element
      real(wp), intent(in) :: elastic(4, 4)
      real(wp), intent(in) :: hourglass_stiffness
      real(wp) :: matrix(2*size(self%gradient, 2), 2*size(self%gradient, 2))
      real(wp) :: b(4, size(matrix, 1)), stress(4)
      integer :: p, i, j

      matrix = 0.0_wp
      do p = 1, size(self%volume, 1)
         b = self%strain_matrix(p, e)
         do j = 1, size(b, 2)
            stress = self%volume(p, e)*matmul(elastic, b(:, j))
            do i = 1, size(b, 2)
               matrix(i, j) = matrix(i, j) + dot_product(b(:, i), stress)
            end do
         end do
      end do
      if (size(self%hourglass, 2) == 0) return
      do j = 1, size(self%hourglass, 1)
         do i = 1, 2
            matrix(i::2, 2*j - 2 + i) = matrix(i::2, 2*j - 2 + i) &
                  + hourglass_stiffness*self%hourglass(:, e)*self%hourglass(j, e)
         end do
      end do
   end function stiffness

end module solid_kinematics
