!> Free vibrations about a state: K phi = omega^2 M phi, phi on freedoms, prescribed ones at rest.
module eigen_analysis
   use kinds, only: wp
   use errors, only: error_type, new_error, status_numerical
   use text, only: to_text
   use memory_shortage, only: check_allocation
   use skyline_matrix, only: skyline_type, profile_type
   use eigen_solver, only: eigen_type, find_eigenvalues, outcome_found, outcome_singular, &
         outcome_indefinite
   use dof_map, only: expand
   use structure, only: structure_type, inertia_force, freedom_name
   use effective_matrix, only: assemble_sum
   implicit none
   private

   public :: modes_type, find_modes, keep_modes_up_to

   real(wp), parameter :: pi = acos(-1.0_wp)

   !> Modes by ascending frequency; fewer than asked for if no more exist.
   type :: modes_type
      integer :: n = 0
      real(wp), allocatable :: eigenvalue(:)        !! (n) omega^2
      real(wp), allocatable :: frequency(:)         !! (n) per time; negative for omega^2 < 0
      real(wp), allocatable :: shape(:, :)          !! (n_freedoms, n) of unit modal mass
      real(wp), allocatable :: effective_mass(:, :) !! (3, n) (phi M r)^2, r a unit translation
      real(wp) :: moving_mass(3) = 0.0_wp           !! r M r, the sum over all modes
      real(wp), allocatable :: residual(:)          !! (n) relative, of K phi - omega^2 M phi
      real(wp) :: shift = 0.0_wp                    !! sigma of K - sigma M
      integer :: n_factorizations = 0
      logical :: condensed = .false.                !! by LAPACK, not Lanczos' method
   end type modes_type

contains

   !> Finds the lowest modes of the implicit groups. Errors: freedoms with neither stiffness nor
   !> mass, a structure unstable without mass, no convergence.
   subroutine find_modes(structure, profile, d, history, n_modes, modes, error)
      type(structure_type), intent(in) :: structure
      type(profile_type), intent(in) :: profile
      real(wp), intent(in) :: d(:)                  !! (n_freedoms) where the tangent is taken
      real(wp), intent(in) :: history(:)            !! (n_history) there
      integer, intent(in) :: n_modes
      type(modes_type), intent(out) :: modes
      type(error_type), allocatable, intent(out) :: error
      type(skyline_type) :: stiffness, mass
      type(eigen_type) :: eigen
      integer :: i, status

      call assemble_sum(structure, profile, d, history, [0.0_wp, 0.0_wp, 1.0_wp], stiffness)
      call assemble_sum(structure, profile, d, history, [1.0_wp, 0.0_wp, 0.0_wp], mass)
      call find_eigenvalues(stiffness, mass, n_modes, eigen)
      if (eigen%outcome /= outcome_found) then
         call explain(structure, eigen, error)
         return
      end if
      modes%n = size(eigen%lambda)
      modes%eigenvalue = eigen%lambda
      modes%frequency = sign(sqrt(abs(eigen%lambda))/(2.0_wp*pi), eigen%lambda)
      modes%residual = eigen%residual
      modes%shift = eigen%sigma
      modes%n_factorizations = eigen%n_factorizations
      modes%condensed = eigen%condensed
      allocate (modes%shape(structure%map%n_freedoms, modes%n), stat=status)
      call check_allocation(status)
      do i = 1, modes%n
         modes%shape(:, i) = upright(expand(structure%map, eigen%x(:, i)))
      end do
      call find_effective_mass(structure, modes)
   end subroutine find_modes

   !> Leaves out the modes above a frequency.
   subroutine keep_modes_up_to(modes, highest)
      type(modes_type), intent(inout) :: modes
      real(wp), intent(in) :: highest               !! cycles per time
      integer :: n

      n = count(modes%frequency <= highest)
      modes%n = n
      modes%eigenvalue = modes%eigenvalue(:n)
      modes%frequency = modes%frequency(:n)
      modes%residual = modes%residual(:n)
      modes%shape = modes%shape(:, :n)
      modes%effective_mass = modes%effective_mass(:, :n)
   end subroutine keep_modes_up_to

   !> The mode or its opposite, so that its first largest component is positive.
   pure function upright(shape) result(turned)
      real(wp), intent(in) :: shape(:)
      real(wp) :: turned(size(shape))
      real(wp) :: largest
      integer :: i

      turned = shape
      largest = maxval(abs(shape))
      do i = 1, size(shape)
         if (abs(shape(i)) < (1.0_wp - 1.0e-6_wp)*largest) cycle
         if (shape(i) < 0.0_wp) turned = -shape
         return
      end do
   end function upright

   !> What takes part in each mode when the supports move along x, y or z.
   subroutine find_effective_mass(structure, modes)
      type(structure_type), intent(in) :: structure
      type(modes_type), intent(inout) :: modes
      real(wp), dimension(structure%map%n_freedoms) :: translation, inertia
      integer :: i, j, status

      allocate (modes%effective_mass(3, modes%n), stat=status)
      call check_allocation(status)
      do i = 1, 3
         translation = merge(1.0_wp, 0.0_wp, structure%map%dof == i &
               .and. .not. structure%map%prescribed)
         inertia = inertia_force(structure, translation)
         modes%moving_mass(i) = dot_product(translation, inertia)
         do j = 1, modes%n
            modes%effective_mass(i, j) = dot_product(modes%shape(:, j), inertia)**2
         end do
      end do
   end subroutine find_effective_mass

   subroutine explain(structure, eigen, error)
      type(structure_type), intent(in) :: structure
      type(eigen_type), intent(in) :: eigen
      type(error_type), allocatable, intent(out) :: error
      integer :: f

      select case (eigen%outcome)
      case (outcome_singular)
         do f = 1, structure%map%n_freedoms
            if (structure%map%id(structure%map%dof(f), structure%map%node(f)) &
                  == eigen%equation) exit
         end do
         call new_error(error, status_numerical, 'no frequencies: '//freedom_name(structure, f) &
               //' can move without resistance and has no mass'//new_line('a') &
               //'  cure: give it a mass, hold it with *BOUNDARY, or connect it with an element ' &
               //'that has stiffness')
      case (outcome_indefinite)
         call new_error(error, status_numerical, 'no frequencies: the structure is unstable, its ' &
               //'stiffness is not positive where there is no mass'//new_line('a') &
               //'  cure: look for springs of negative stiffness at nodes without mass')
      case default
         call new_error(error, status_numerical, 'the frequencies have not converged; largest ' &
               //'relative residual '//to_text(maxval([eigen%residual, 0.0_wp])) &
               //new_line('a')//'  cure: ask for another number of modes; look for masses and ' &
               //'stiffnesses many orders of magnitude apart')
      end select
   end subroutine explain

end module eigen_analysis
