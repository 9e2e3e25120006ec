!> What a group of solids asks of a material that is not linear elastic: at a point, the stress for
!> a strain. A law keeps nothing of a point itself: it gets the state of the last accepted increment
!> and hands back the updated one. Components are 11 22 33 12 with engineering shear strain; in
!> plane stress the law finds strain 33 by itself and strain(3) is not looked at. Time is not known.
module point_law
   use kinds, only: wp
   implicit none
   private

   public :: point_law_type

   !> A law and its numbers, the same for all points of a group.
   type, abstract :: point_law_type
      integer :: n_state = 0             !! variables that a point remembers; all start at zero
      integer :: plane = 0               !! plane_strain, plane_stress or axisymmetric
   contains
      procedure(update_interface), deferred :: update
      procedure(stress_interface), deferred :: stress_at
      procedure(number_interface), deferred :: thickness_strain
      procedure :: stored_energy
      procedure :: dissipated
      procedure :: plastic_measure
   end type point_law_type

   abstract interface
      !> Stress, state and, if asked for, tangent after going from the last accepted state to a
      !> strain. The tangent is the derivative of this stress and symmetric; at a state of zeros and
      !> no strain it is the stiffest that the law has.
      pure subroutine update_interface(self, strain, state, stress, updated, tangent)
         import :: point_law_type, wp
         implicit none
         class(point_law_type), intent(in) :: self
         real(wp), intent(in) :: strain(4)
         real(wp), intent(in) :: state(self%n_state)
         real(wp), intent(out) :: stress(4)
         real(wp), intent(out) :: updated(self%n_state)
         real(wp), intent(out), optional :: tangent(4, 4)
      end subroutine update_interface

      !> Stress at a strain whose state is known.
      pure function stress_interface(self, strain, state) result(stress)
         import :: point_law_type, wp
         implicit none
         class(point_law_type), intent(in) :: self
         real(wp), intent(in) :: strain(4)
         real(wp), intent(in) :: state(self%n_state)   !! updated to the strain
         real(wp) :: stress(4)
      end function stress_interface

      !> In plane stress, strain 33 where stress 33 is zero.
      pure function number_interface(self, strain, state) result(number)
         import :: point_law_type, wp
         implicit none
         class(point_law_type), intent(in) :: self
         real(wp), intent(in) :: strain(4)
         real(wp), intent(in) :: state(self%n_state)   !! updated to the strain
         real(wp) :: number
      end function number_interface
   end interface

contains

   !> Energy a volume that comes back when the stress is taken away: stress : strain/2 where nothing
   !> of the strain stays.
   pure function stored_energy(self, strain, state, stress) result(energy)
      class(point_law_type), intent(in) :: self
      real(wp), intent(in) :: strain(4)
      real(wp), intent(in) :: state(self%n_state)
      real(wp), intent(in) :: stress(4)          !! of the strain and state
      real(wp) :: energy

      energy = dot_product(stress, strain)/2.0_wp
   end function stored_energy

   !> Energy a volume that is lost so far; with the stored energy it adds up to the work done on the
   !> point (by the trapezoidal rule over increments, if the account is to close to round-off).
   pure function dissipated(self, state) result(energy)
      class(point_law_type), intent(in) :: self
      real(wp), intent(in) :: state(self%n_state)
      real(wp) :: energy

      energy = 0.0_wp
   end function dissipated

   !> Equivalent plastic strain, for PEEQ in results.
   pure function plastic_measure(self, state) result(peeq)
      class(point_law_type), intent(in) :: self
      real(wp), intent(in) :: state(self%n_state)
      real(wp) :: peeq

      peeq = 0.0_wp
   end function plastic_measure

end module point_law
