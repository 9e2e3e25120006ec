!> One group of every kind of element, at random places and with random properties.
module element_family
   use kinds, only: wp
   use axial_kinematics, only: one_freedom, two_freedoms, line_of_action
   use dashpot, only: dashpot_type, new_dashpot
   use element_interface, only: element_type
   use point_mass, only: point_mass_type, new_point_mass
   use random_numbers, only: random_integer, random_matrix, random_real, random_vector
   use spring, only: spring_type, new_spring
   use truss, only: truss_type, new_truss, truss_material_type
   implicit none
   private

   public :: member_type, build_family, random_lines, random_table
   public :: fresh_history, find_force, find_stiffness, energy_at

   integer, parameter :: n_elements = 5

   !> A group with what has to be known of it in a test.
   type :: member_type
      character(len=20) :: name = ''
      class(element_type), allocatable :: element
      logical :: grounded = .false.      !! held in space: a translation strains it
   end type member_type

contains

   !> Every kind: SPRING1 SPRING2 SPRINGA, linear and by table, DASHPOT1 2 A, MASS, truss lumped and
   !> consistent.
   subroutine build_family(family)
      type(member_type), allocatable, intent(out) :: family(:)
      integer :: i

      allocate (family(12))
      do i = 1, 2
         call make_springs(family(3*i - 2:3*i), by_table=i == 2)
      end do
      call make_dashpots(family(7:9))
      call make_mass(family(10))
      call make_truss(family(11), .true.)
      call make_truss(family(12), .false.)
   end subroutine build_family

   subroutine make_springs(members, by_table)
      type(member_type), intent(inout) :: members(3)
      logical, intent(in) :: by_table
      type(spring_type), allocatable :: spring
      real(wp), allocatable :: u(:), f(:)
      integer :: i

      do i = 1, 3
         allocate (spring)
         if (by_table) then
            call random_table(u, f)
            call new_spring(spring, random_shapes(i), 0.0_wp, u, f)
         else
            call new_spring(spring, random_shapes(i), random_real(1.0_wp, 9.0_wp))
         end if
         members(i)%name = merge('nonlinear ', 'linear    ', by_table)//'SPRING'//'12A'(i:i)
         members(i)%grounded = i == 1
         call move_alloc(spring, members(i)%element)
      end do
   end subroutine make_springs

   subroutine make_dashpots(members)
      type(member_type), intent(inout) :: members(3)
      type(dashpot_type), allocatable :: dashpot
      integer :: i

      do i = 1, 3
         allocate (dashpot)
         call new_dashpot(dashpot, random_shapes(i), random_real(1.0_wp, 9.0_wp))
         members(i)%name = 'DASHPOT'//'12A'(i:i)
         members(i)%grounded = i == 1
         call move_alloc(dashpot, members(i)%element)
      end do
   end subroutine make_dashpots

   subroutine make_mass(member)
      type(member_type), intent(inout) :: member
      type(point_mass_type), allocatable :: mass

      allocate (mass)
      call new_point_mass(mass, 2.0_wp + random_vector(n_elements))
      member%name = 'MASS'
      call move_alloc(mass, member%element)
   end subroutine make_mass

   subroutine make_truss(member, lumped)
      type(member_type), intent(inout) :: member
      logical, intent(in) :: lumped
      type(truss_type), allocatable :: truss
      type(truss_material_type) :: material
      real(wp), allocatable :: b(:, :), length(:)

      material%young = random_real(10.0_wp, 20.0_wp)
      material%density = random_real(1.0_wp, 2.0_wp)
      material%area = random_real(0.1_wp, 0.2_wp)
      material%damping_alpha = random_real(0.1_wp, 1.0_wp)
      material%damping_beta = random_real(0.1_wp, 1.0_wp)
      call random_lines(n_elements, b, length)
      allocate (truss)
      call new_truss(truss, b, length, material, lumped)
      member%name = 'truss, '//merge('lumped    ', 'consistent', lumped)
      call move_alloc(truss, member%element)
   end subroutine make_truss

   !> b of the kinds 1 (node to ground), 2 (freedom to freedom) and 3 (along a line).
   function random_shapes(kind) result(b)
      integer, intent(in) :: kind
      real(wp), allocatable :: b(:, :), length(:)
      integer :: e, dof

      if (kind == 3) then
         call random_lines(n_elements, b, length)
         return
      end if
      allocate (b(3*kind, n_elements))
      do e = 1, n_elements
         dof = random_integer(1, 3)
         if (kind == 1) b(:, e) = one_freedom(dof)
         if (kind == 2) b(:, e) = two_freedoms([dof, dof])
      end do
   end function random_shapes

   !> b and length along n random lines in space.
   subroutine random_lines(n, b, length)
      integer, intent(in) :: n
      real(wp), allocatable, intent(out) :: b(:, :), length(:)
      integer :: e

      allocate (b(6, n), length(n))
      do e = 1, n
         call line_of_action(random_matrix(3, 2), b(:, e), length(e))
      end do
   end subroutine random_lines

   !> The history of elements that were never loaded.
   pure function fresh_history(element) result(history)
      class(element_type), intent(in) :: element
      real(wp) :: history(element%n_history, element%n_elements)

      history = 0.0_wp
   end function fresh_history

   !> Internal forces of elements that go straight to displacements d.
   pure subroutine find_force(element, d, force)
      class(element_type), intent(in) :: element
      real(wp), intent(in) :: d(:, :)
      real(wp), intent(out) :: force(:, :)
      real(wp) :: updated(element%n_history, element%n_elements)

      call element%internal_force(d, fresh_history(element), force, updated)
   end subroutine find_force

   !> Tangent stiffness of element e, never loaded before, at displacements d.
   pure subroutine find_stiffness(element, e, d, matrix)
      class(element_type), intent(in) :: element
      integer, intent(in) :: e
      real(wp), intent(in) :: d(:)
      real(wp), intent(out) :: matrix(:, :)
      real(wp) :: history(element%n_history, element%n_elements)

      history = fresh_history(element)
      call element%stiffness(e, d, history(:, e), matrix)
   end subroutine find_stiffness

   !> Strain energy of elements that went straight to displacements d.
   pure function energy_at(element, d) result(energy)
      class(element_type), intent(in) :: element
      real(wp), intent(in) :: d(:, :)
      real(wp) :: energy
      real(wp) :: force(size(d, 1), size(d, 2)), updated(element%n_history, element%n_elements)

      call element%internal_force(d, fresh_history(element), force, updated)
      energy = element%strain_energy(d, updated)
   end function energy_at

   !> A table through the origin's neighbourhood whose force grows with the elongation.
   subroutine random_table(u, f)
      real(wp), allocatable, intent(out) :: u(:), f(:)
      integer :: n, i

      n = random_integer(2, 7)
      allocate (u(n), f(n))
      u(1) = random_real(-1.0_wp, -0.2_wp)
      f(1) = random_real(-3.0_wp, 1.0_wp)
      do i = 2, n
         u(i) = u(i - 1) + random_real(0.1_wp, 0.6_wp)
         f(i) = f(i - 1) + random_real(0.0_wp, 2.0_wp)
      end do
   end subroutine random_table

end module element_family
