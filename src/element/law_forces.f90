!> Forces of one solid whose material has a law, with the energy that it holds and what it has lost:
!> what an explicit step asks of every element, without a tangent.
module law_forces
   use kinds, only: wp
   use point_law, only: point_law_type
   use solid_kinematics, only: kinematics_type
   implicit none
   private

   public :: find_law_forces, add_hourglass_forces

contains

   !> Forces of an element at displacements u, and its state there from the last accepted one.
   pure subroutine find_law_forces(law, kinematics, shape, u, state, updated, force, energy)
      class(point_law_type), intent(in) :: law
      type(kinematics_type), intent(in) :: kinematics
      integer, intent(in) :: shape                 !! of the element, in `kinematics`
      real(wp), intent(in), contiguous :: u(:, :)  !! (2, nodes)
      real(wp), intent(in) :: state(law%n_state, size(kinematics%volume, 1))
      real(wp), intent(out) :: updated(law%n_state, size(kinematics%volume, 1))
      real(wp), intent(out), contiguous :: force(:, :)   !! (2, nodes)
      real(wp), intent(inout) :: energy(2)         !! energies stored and lost are added
      real(wp) :: strain(4), stress(4), mean, dilatation
      integer :: p

      dilatation = 0.0_wp
      if (kinematics%b_bar) dilatation = sum(kinematics%dilatation(:, :, shape)*u)
      mean = 0.0_wp
      force = 0.0_wp
      do p = 1, size(kinematics%volume, 1)
         associate (g => kinematics%gradient(:, :, p, shape), v => kinematics%volume(p, shape))
            strain = strain_of(size(u, 2), g, u)
            if (kinematics%b_bar) strain(1:3) = strain(1:3) &
                  + (dilatation - (strain(1) + strain(2) + strain(3)))/3.0_wp
            call law%update(strain, state(:, p), stress, updated(:, p))
            energy(1) = energy(1) + v*law%stored_energy(strain, updated(:, p), stress)
            energy(2) = energy(2) + v*law%dissipated(updated(:, p))
            stress = v*stress
            if (kinematics%b_bar) then
               mean = mean + (stress(1) + stress(2) + stress(3))/3.0_wp
               stress(1:3) = stress(1:3) - (stress(1) + stress(2) + stress(3))/3.0_wp
            end if
            call add_force_of(size(u, 2), g, stress, force)
         end associate
      end do
      if (kinematics%b_bar) force = force + mean*kinematics%dilatation(:, :, shape)
   end subroutine find_law_forces

   pure function strain_of(n, g, u) result(strain)
      integer, intent(in) :: n
      real(wp), intent(in) :: g(3, n), u(2, n)
      real(wp) :: strain(4)
      integer :: i

      strain = 0.0_wp
      do i = 1, n
         strain(1) = strain(1) + g(1, i)*u(1, i)
         strain(2) = strain(2) + g(2, i)*u(2, i)
         strain(3) = strain(3) + g(3, i)*u(1, i)
         strain(4) = strain(4) + g(2, i)*u(1, i) + g(1, i)*u(2, i)
      end do
   end function strain_of

   pure subroutine add_force_of(n, g, stress, force)
      integer, intent(in) :: n
      real(wp), intent(in) :: g(3, n), stress(4)
      real(wp), intent(inout) :: force(2, n)
      integer :: i

      do i = 1, n
         force(1, i) = force(1, i) + g(1, i)*stress(1) + g(3, i)*stress(3) + g(2, i)*stress(4)
         force(2, i) = force(2, i) + g(2, i)*stress(2) + g(1, i)*stress(4)
      end do
   end subroutine add_force_of

   !> Adds what an elastic resistance against hourglass patterns gives.
   pure subroutine add_hourglass_forces(stiffness, gamma, u, force, energy)
      real(wp), intent(in) :: stiffness
      real(wp), intent(in) :: gamma(:)             !! (nodes)
      real(wp), intent(in) :: u(:, :)              !! (2, nodes)
      real(wp), intent(inout) :: force(:, :)       !! (2, nodes)
      real(wp), intent(inout) :: energy            !! strain energy
      real(wp) :: amount(2)
      integer :: i

      amount = matmul(u, gamma)
      do i = 1, size(gamma)
         force(:, i) = force(:, i) + stiffness*gamma(i)*amount
      end do
      energy = energy + stiffness*sum(amount**2)/2.0_wp
   end subroutine add_hourglass_forces

end module law_forces
