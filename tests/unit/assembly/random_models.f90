!> Random frames of all kinds of elements, and their matrices assembled in full.
module random_models
   use kinds, only: wp
   use dof_map, only: dof_map_type
   use element_groups, only: group_type
   use histories, only: equation_type
   use mesh, only: scheme_implicit, scheme_explicit, mass_lumped, mass_consistent
   use model, only: model_type
   use random_numbers, only: random_integer, random_real, random_vector
   use small_models, only: start_model, add_node, add_mass, add_spring1, add_spring2, add_springa, &
         add_dashpot1, add_dashpot2, add_dashpota, add_truss, add_group, add_equation
   use structure, only: structure_type
   implicit none
   private

   public :: build_random_frame, dense_matrices_of, dense_transformation, fresh_history

   integer, parameter :: n_nodes = 8

contains

   !> Trusses, springs, dashpots and masses between eight nodes in space: every third element
   !> explicit and lumped, every third implicit and consistent, every third implicit and lumped;
   !> two constraints.
   subroutine build_random_frame(model)
      type(model_type), intent(out) :: model
      integer :: i, nodes(2)

      call start_model(model)
      do i = 1, n_nodes
         call add_node(model, random_vector(3))
      end do
      do i = 1, n_nodes - 1
         call add_truss(model, [i, i + 1], random_real(0.1_wp, 1.0_wp), 1.5_wp + random_vector(4))
         nodes = random_pair()
         call add_springa(model, nodes, random_real(0.5_wp, 5.0_wp))
      end do
      do i = 1, 4
         call add_spring1(model, random_integer(1, n_nodes), random_integer(1, 3), 2.0_wp)
         call add_spring2(model, random_pair(), random_integer(1, 3), random_real(0.5_wp, 5.0_wp))
         call add_dashpot1(model, random_integer(1, n_nodes), random_integer(1, 3), 0.7_wp)
         call add_dashpot2(model, random_pair(), random_integer(1, 3), random_real(0.5_wp, 5.0_wp))
         call add_dashpota(model, random_pair(), random_real(0.5_wp, 5.0_wp))
         call add_mass(model, random_integer(1, n_nodes), random_real(0.5_wp, 5.0_wp))
      end do
      call add_group(model, [(i, i=1, model%elements%n, 3)], scheme_explicit, 0)
      call add_group(model, [(i, i=2, model%elements%n, 3)], scheme_implicit, mass_consistent)
      call add_group(model, [(i, i=3, model%elements%n, 3)], scheme_implicit, mass_lumped)
      call add_equation(model, [1, 4, 6], [1, 2, 3], [2.0_wp, -1.0_wp, 3.0_wp])
      call add_equation(model, [5, 4], [3, 2], [1.0_wp, -0.5_wp])
   end subroutine build_random_frame

   !> Two different nodes.
   function random_pair() result(nodes)
      integer :: nodes(2)

      nodes(1) = random_integer(1, n_nodes)
      nodes(2) = modulo(nodes(1) + random_integer(0, n_nodes - 2), n_nodes) + 1
   end function random_pair

   !> M, C and K on freedoms, C and K of the groups of a scheme only.
   subroutine dense_matrices_of(structure, scheme, m, c, k)
      type(structure_type), intent(in) :: structure
      integer, intent(in) :: scheme
      real(wp), allocatable, intent(out) :: m(:, :), c(:, :), k(:, :)
      integer :: g, e, n

      n = structure%map%n_freedoms
      allocate (m(n, n), c(n, n), k(n, n))
      m = 0.0_wp
      c = 0.0_wp
      k = 0.0_wp
      do g = 1, size(structure%groups)
         do e = 1, size(structure%groups(g)%member)
            call add_dense(structure%groups(g), e, scheme, m, c, k)
         end do
      end do
   end subroutine dense_matrices_of

   subroutine add_dense(group, e, scheme, m, c, k)
      type(group_type), intent(in) :: group
      integer, intent(in) :: e, scheme
      real(wp), intent(inout) :: m(:, :), c(:, :), k(:, :)
      real(wp), allocatable :: part(:, :), zero(:), history(:)
      integer, allocatable :: rows(:), freedoms(:)
      integer :: i, n

      n = 3*group%element%n_nodes
      allocate (part(n, n), zero(n), history(group%element%n_history))
      zero = 0.0_wp
      history = 0.0_wp
      rows = pack([(i, i=1, n)], group%lm(:, e) > 0)
      freedoms = group%lm(rows, e)
      call group%element%mass(e, group%lumped, part)
      m(freedoms, freedoms) = m(freedoms, freedoms) + part(rows, rows)
      if (group%scheme /= scheme) return
      call group%element%damping(e, part)
      c(freedoms, freedoms) = c(freedoms, freedoms) + part(rows, rows)
      call group%element%stiffness(e, zero, history, part)
      k(freedoms, freedoms) = k(freedoms, freedoms) + part(rows, rows)
   end subroutine add_dense

   !> The history of a structure that was never loaded.
   pure function fresh_history(structure) result(history)
      type(structure_type), intent(in) :: structure
      real(wp) :: history(structure%n_history)

      history = 0.0_wp
   end function fresh_history

   !> T in full, from the constraints as the model has them.
   function dense_transformation(map, equations) result(t)
      type(dof_map_type), intent(in) :: map
      type(equation_type), intent(in) :: equations(:)
      real(wp) :: t(map%n_freedoms, map%n_eq)
      integer :: f, i, j, column

      t = 0.0_wp
      do f = 1, map%n_freedoms
         column = map%id(map%dof(f), map%node(f))
         if (column > 0) t(f, column) = 1.0_wp
      end do
      do i = 1, size(equations)
         associate (equation => equations(i))
            f = map%freedom(equation%dof(1), equation%node(1))
            do j = 2, size(equation%node)
               column = map%id(equation%dof(j), equation%node(j))
               if (column > 0) t(f, column) = -equation%coefficient(j)/equation%coefficient(1)
            end do
         end associate
      end do
   end function dense_transformation

end module random_models
