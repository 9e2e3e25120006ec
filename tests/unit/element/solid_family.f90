!> Solids of every plane, topology and quadrature, alone and in patches with random inner nodes.
module solid_family
   use kinds, only: wp
   use elastic, only: plane_stress
   use random_numbers, only: random_matrix
   use solid, only: solid_type, new_solid, solid_material_type
   use solid_geometry, only: solid_shape_type
   use topology, only: tri3, tri6, quad4, quad8, count_corners, count_nodes, &
         node_coordinates, same_corners, shape_functions
   implicit none
   private

   public :: n_shapes, get_shape, shape_name, one_element, random_element, make_patch, patch_group
   public :: material_of, eigenvalues, in_plane_part, solution

   !> Plane 1 to 3 times tri3, quad4, quad4 reduced, quad4 B-bar, tri6, quad8, quad8 reduced.
   integer, parameter :: n_shapes = 21

contains

   !> Shape i of the family; `exists` is false for B-bar in plane stress.
   subroutine get_shape(i, shape, exists)
      integer, intent(in) :: i
      type(solid_shape_type), intent(out) :: shape
      logical, intent(out) :: exists
      integer, parameter :: topologies(7) = [tri3, quad4, quad4, quad4, tri6, quad8, quad8]
      integer :: j

      j = modulo(i - 1, 7) + 1
      shape%plane = (i - 1)/7 + 1
      shape%topology = topologies(j)
      shape%reduced = j == 3 .or. j == 7
      shape%b_bar = j == 4
      shape%thickness = 0.7_wp
      exists = .not. (shape%b_bar .and. shape%plane == plane_stress)
   end subroutine get_shape

   pure function shape_name(shape) result(name)
      type(solid_shape_type), intent(in) :: shape
      character(len=:), allocatable :: name
      character(len=3), parameter :: planes(3) = ['CPE', 'CPS', 'CAX']

      name = planes(shape%plane)//achar(48 + count_nodes(shape%topology))
      if (shape%reduced) name = name//'R'
      if (shape%b_bar) name = name//' B-bar'
   end function shape_name

   !> Steel-like numbers near one; hardening isotropic or kinematic where it is plastic.
   pure function material_of(plastic, kinematic, poisson) result(material)
      logical, intent(in) :: plastic, kinematic
      real(wp), intent(in) :: poisson
      type(solid_material_type) :: material

      material%young = 20.0_wp
      material%poisson = poisson
      material%density = 1.3_wp
      material%damping_alpha = 0.2_wp
      material%damping_beta = 0.1_wp
      material%plastic = plastic
      material%kinematic = kinematic
      if (plastic) material%hardening = reshape([0.0_wp, 0.1_wp, 0.01_wp, 0.2_wp, &
            0.1_wp, 0.3_wp], [2, 3])
   end function material_of

   !> Nodes of one element: the natural square or triangle, shrunk, set off from the axis, and moved
   !> at random by up to a given amount.
   function random_element(shape, amount) result(x)
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: amount
      real(wp), allocatable :: x(:, :)

      x = 0.5_wp*node_coordinates(shape%topology)
      x = x + amount*random_matrix(2, size(x, 2))
      x(1, :) = x(1, :) + 1.5_wp
   end function random_element

   subroutine one_element(shape, material, amount, element)
      type(solid_shape_type), intent(in) :: shape
      type(solid_material_type), intent(in) :: material
      real(wp), intent(in) :: amount            !! of distortion
      type(solid_type), intent(out) :: element
      real(wp), allocatable :: x(:, :)

      x = random_element(shape, amount)
      call new_solid(element, shape, reshape(x, [2, size(x, 2), 1]), material, .true.)
   end subroutine one_element

   !> A rectangle from (1, -1) to (3, 1) of 3x3 cells with straight edges and inner corners moved at
   !> random, triangles two a cell; middle nodes in the middle.
   subroutine make_patch(shape, x, ien, inner)
      type(solid_shape_type), intent(in) :: shape
      real(wp), allocatable, intent(out) :: x(:, :)       !! (2, nodes)
      integer, allocatable, intent(out) :: ien(:, :)      !! (n_nodes, elements)
      logical, allocatable, intent(out) :: inner(:)       !! (nodes) not on the boundary
      real(wp) :: corner(2, 0:3, 0:3)
      integer :: i, j

      do j = 0, 3
         do i = 0, 3
            corner(:, i, j) = [1.0_wp, -1.0_wp] + 2.0_wp/3.0_wp*[i, j]
            if (modulo(i, 3)*modulo(j, 3) == 0) cycle
            corner(:, i:i, j) = corner(:, i:i, j) + 0.12_wp*random_matrix(2, 1)
         end do
      end do
      allocate (x(2, 0), ien(count_nodes(shape%topology), 0))
      do j = 0, 2
         do i = 0, 2
            associate (a => corner(:, i, j), b => corner(:, i + 1, j), &
                  c => corner(:, i + 1, j + 1), d => corner(:, i, j + 1))
               if (count_corners(shape%topology) == 4) then
                  call add_element(shape, reshape([a, b, c, d], [2, 4]), x, ien)
               else
                  call add_element(shape, reshape([a, b, c], [2, 3]), x, ien)
                  call add_element(shape, reshape([a, c, d], [2, 3]), x, ien)
               end if
            end associate
         end do
      end do
      inner = abs(x(1, :) - 2.0_wp) < 0.9999_wp .and. abs(x(2, :)) < 0.9999_wp
   end subroutine make_patch

   subroutine add_element(shape, corner, x, ien)
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: corner(:, :)
      real(wp), allocatable, intent(inout) :: x(:, :)
      integer, allocatable, intent(inout) :: ien(:, :)
      real(wp), allocatable :: xi(:, :)
      real(wp) :: place(2)
      integer :: node(size(ien, 1)), i, j

      xi = node_coordinates(shape%topology)
      do i = 1, size(node)
         place = matmul(corner, shape_functions(same_corners(shape%topology), xi(:, i)))
         node(i) = 0
         do j = 1, size(x, 2)
            if (norm2(x(:, j) - place) < 1.0e-9_wp) node(i) = j
         end do
         if (node(i) > 0) cycle
         x = reshape([x, place], [2, size(x, 2) + 1])
         node(i) = size(x, 2)
      end do
      ien = reshape([ien, node], [size(node), size(ien, 2) + 1])
   end subroutine add_element

   !> The elements of a patch as a group.
   subroutine patch_group(shape, x, ien, material, element)
      type(solid_shape_type), intent(in) :: shape
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: ien(:, :)
      type(solid_material_type), intent(in) :: material
      type(solid_type), intent(out) :: element
      real(wp) :: corners(2, size(ien, 1), size(ien, 2))
      integer :: e

      do e = 1, size(ien, 2)
         corners(:, :, e) = x(:, ien(:, e))
      end do
      call new_solid(element, shape, corners, material, .false.)
   end subroutine patch_group

   !> Rows and columns of directions 1 and 2.
   pure function in_plane_part(matrix) result(part)
      real(wp), intent(in) :: matrix(:, :)
      real(wp) :: part(2*size(matrix, 1)/3, 2*size(matrix, 1)/3)
      integer :: keep(size(part, 1)), i

      keep = [(3*((i - 1)/2) + 1 + modulo(i - 1, 2), i=1, size(keep))]
      part = matrix(keep, keep)
   end function in_plane_part

   !> Eigenvalues of a symmetric matrix by Jacobi's rotations.
   pure function eigenvalues(matrix) result(lambda)
      real(wp), intent(in) :: matrix(:, :)
      real(wp) :: lambda(size(matrix, 1))
      real(wp) :: a(size(matrix, 1), size(matrix, 1)), row(size(matrix, 1)), t, c, s, theta
      integer :: sweep, i, j

      a = matrix
      do sweep = 1, 30
         do i = 1, size(a, 1) - 1
            do j = i + 1, size(a, 1)
               if (abs(a(i, j)) <= 1.0e-20_wp*maxval(abs(matrix))) cycle
               theta = (a(j, j) - a(i, i))/(2.0_wp*a(i, j))
               t = sign(1.0_wp, theta)/(abs(theta) + sqrt(theta**2 + 1.0_wp))
               c = 1.0_wp/sqrt(t**2 + 1.0_wp)
               s = t*c
               row = a(i, :)
               a(i, :) = c*row - s*a(j, :)
               a(j, :) = s*row + c*a(j, :)
               row = a(:, i)
               a(:, i) = c*row - s*a(:, j)
               a(:, j) = s*row + c*a(:, j)
            end do
         end do
      end do
      lambda = [(a(i, i), i=1, size(lambda))]
   end function eigenvalues

   !> x of a x = b for a symmetric positive definite matrix, by elimination.
   pure function solution(matrix, b) result(x)
      real(wp), intent(in) :: matrix(:, :), b(:)
      real(wp) :: x(size(b))
      real(wp) :: a(size(b), size(b)), factor
      integer :: i, j

      a = matrix
      x = b
      do j = 1, size(x)
         do i = j + 1, size(x)
            factor = a(i, j)/a(j, j)
            a(i, j:) = a(i, j:) - factor*a(j, j:)
            x(i) = x(i) - factor*x(j)
         end do
      end do
      do j = size(x), 1, -1
         x(j) = (x(j) - dot_product(a(j, j + 1:), x(j + 1:)))/a(j, j)
      end do
   end function solution

end module solid_family
