!> The law of the material of a group of solids.
module solid_law
   use memory_shortage, only: check_allocation
   use j2_plastic, only: j2_type, new_j2
   use point_law, only: point_law_type
   use solid_material, only: solid_material_type
   implicit none
   private

   public :: make_law

contains

   !> The one place that turns a material into its law; a linear elastic one has none.
   subroutine make_law(material, plane, law)
      type(solid_material_type), intent(in) :: material
      integer, intent(in) :: plane               !! plane_strain, plane_stress or axisymmetric
      class(point_law_type), allocatable, intent(out) :: law

      if (material%plastic) call make_j2(material, plane, law)
   end subroutine make_law

   subroutine make_j2(material, plane, law)
      type(solid_material_type), intent(in) :: material
      integer, intent(in) :: plane
      class(point_law_type), allocatable, intent(out) :: law
      type(j2_type), allocatable :: made
      integer :: status

      allocate (made, stat=status)
      call check_allocation(status)
      call new_j2(made, [material%young, material%poisson], plane, material%kinematic, &
            material%hardening(1, :), material%hardening(2, :))
      call move_alloc(made, law)
   end subroutine make_j2

end module solid_law
