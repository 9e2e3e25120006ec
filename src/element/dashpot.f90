!> DASHPOT1, DASHPOT2, DASHPOTA: force proportional to the rate of elongation.
module dashpot
   use kinds, only: wp
   use element_interface, only: element_type
   use axial_kinematics, only: rank_one
   implicit none
   private

   public :: dashpot_type, new_dashpot

   !> Dashpots of one coefficient.
   type, extends(element_type) :: dashpot_type
      real(wp), allocatable :: b(:, :)      !! (3 n_nodes, n_elements) elongation = b . d
      real(wp) :: c = 0.0_wp                !! force over rate of elongation
   contains
      procedure :: uses
      procedure :: damping
   end type dashpot_type

contains

   !> A group of dashpots.
   pure subroutine new_dashpot(self, b, c)
      type(dashpot_type), intent(out) :: self
      real(wp), intent(in) :: b(:, :)       !! (3 n_nodes, n_elements)
      real(wp), intent(in) :: c             !! force over rate of elongation

      self%n_nodes = size(b, 1)/3
      self%n_elements = size(b, 2)
      self%b = b
      self%c = c
   end subroutine new_dashpot

   !> The freedoms with a share in the elongation.
   pure function uses(self, e) result(used)
      class(dashpot_type), intent(in) :: self
      integer, intent(in) :: e
      logical :: used(3*self%n_nodes)

      used = abs(self%b(:, e)) > 0.0_wp
   end function uses

   !> c b bt.
   pure subroutine damping(self, e, matrix)
      class(dashpot_type), intent(in) :: self
      integer, intent(in) :: e
      real(wp), intent(out) :: matrix(:, :)

      call rank_one(self%c, self%b(:, e), matrix)
   end subroutine damping

end module dashpot
