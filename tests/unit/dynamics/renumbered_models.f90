!> Models for the tests of frequencies and of the order of equations.
module renumbered_models
   use kinds, only: wp
   use model, only: model_type
   use random_numbers, only: random_integer, random_real
   use small_models, only: start_model, add_node, add_spring1, add_spring2, add_mass, add_truss, &
         add_boundary, add_equation
   implicit none
   private

   public :: row_of_masses, bar, shuffled_grid

contains

   !> Masses along x with springs between neighbours, k(1) holding the first.
   function row_of_masses(m, k) result(model)
      real(wp), intent(in) :: m(:), k(:)
      type(model_type) :: model
      integer :: i

      call start_model(model)
      do i = 1, size(m)
         call add_node(model, [real(i, wp), 0.0_wp, 0.0_wp])
      end do
      call add_spring1(model, 1, 1, k(1))
      do i = 2, size(m)
         call add_spring2(model, [i - 1, i], 1, k(i))
      end do
      do i = 1, size(m)
         call add_mass(model, i, m(i))
      end do
   end function row_of_masses

   !> Trusses of length dx end to end along x, of E, rho, and Rayleigh's factors, area 1.
   function bar(n_elements, dx, material) result(model)
      integer, intent(in) :: n_elements
      real(wp), intent(in) :: dx, material(4)
      type(model_type) :: model
      integer :: i

      call start_model(model)
      do i = 0, n_elements
         call add_node(model, [dx*real(i, wp), 0.0_wp, 0.0_wp])
      end do
      do i = 1, n_elements
         call add_truss(model, [i, i + 1], 1.0_wp, material)
      end do
   end function bar

   !> A plane truss of nx by ny nodes with diagonals, its nodes in a random order; one corner fixed,
   !> another held across, and a pair of nodes tied to each other.
   function shuffled_grid(nx, ny) result(model)
      integer, intent(in) :: nx, ny
      type(model_type) :: model
      integer :: node(nx, ny), name(nx*ny), i, j, k
      real(wp) :: x(3, nx*ny)

      name = [(i, i=1, nx*ny)]
      do i = nx*ny, 2, -1
         j = random_integer(1, i)
         name([i, j]) = name([j, i])
      end do
      node = reshape(name, [nx, ny])
      call start_model(model)
      do j = 1, ny
         do i = 1, nx
            x(:, node(i, j)) = [real(i, wp), real(j, wp), 0.0_wp]
         end do
      end do
      do k = 1, nx*ny
         call add_node(model, x(:, k))
      end do
      do j = 1, ny
         do i = 1, nx
            if (i < nx) call brace(node(i, j), node(i + 1, j))
            if (j < ny) call brace(node(i, j), node(i, j + 1))
            if (i < nx .and. j < ny) call brace(node(i, j), node(i + 1, j + 1))
         end do
      end do
      call add_boundary(model, node(1, 1), 1)
      call add_boundary(model, node(1, 1), 2)
      call add_boundary(model, node(nx, 1), 2)
      call add_equation(model, [node(nx, ny), node(1, ny)], [1, 1], [1.0_wp, -1.0_wp])

   contains

      subroutine brace(a, b)
         integer, intent(in) :: a, b

         call add_truss(model, [a, b], random_real(1.0_wp, 2.0_wp), &
               [10.0_wp, 1.0_wp, 0.0_wp, 0.0_wp])
      end subroutine brace

   end function shuffled_grid

end module renumbered_models
