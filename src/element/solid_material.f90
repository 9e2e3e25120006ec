!> What the material of plane and axisymmetric solids is made of.
module solid_material
   use kinds, only: wp
   implicit none
   private

   public :: solid_material_type, hourglass_share

   !> Stiffness against hourglass modes of a four-node quadrilateral with one point, as a share of
   !> shear modulus times volume times the gradients squared; it stays elastic.
   real(wp), parameter :: hourglass_share = 0.05_wp

   !> Properties that the solids of a group share.
   type :: solid_material_type
      real(wp) :: young = 0.0_wp
      real(wp) :: poisson = 0.0_wp
      real(wp) :: density = 0.0_wp
      real(wp) :: damping_alpha = 0.0_wp            !! C = alpha M + beta K elastic
      real(wp) :: damping_beta = 0.0_wp
      logical :: plastic = .false.
      logical :: kinematic = .false.
      real(wp), allocatable :: hardening(:, :)      !! (2, n) plastic strain and yield stress
   end type solid_material_type

end module solid_material
