!> What one element adds to the effective matrix.
module element_sum
   use kinds, only: wp
   use element_groups, only: group_type, group_mass
   use mesh, only: scheme_implicit
   implicit none
   private

   public :: effective_element, has_implicit_matrix, contributes

contains

   !> c_mass m + c_damping c + c_stiffness k of element e: its mass unless that is lumped, damping
   !> and tangent stiffness if it is implicit.
   pure subroutine effective_element(group, e, local, memory, factors, total)
      type(group_type), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: local(:)           !! displacements of its freedoms
      real(wp), intent(in) :: memory(:)          !! its history, last accepted
      real(wp), intent(in) :: factors(3)         !! c_mass, c_damping, c_stiffness
      real(wp), intent(out) :: total(:, :)
      real(wp) :: part(size(total, 1), size(total, 2))

      total = 0.0_wp
      if (.not. group%lumped .and. abs(factors(1)) > 0.0_wp) then
         call group_mass(group, e, .false., part)
         total = factors(1)*part
      end if
      if (.not. has_implicit_matrix(group)) return
      if (abs(factors(3)) > 0.0_wp) then
         call group%element%stiffness(e, local, memory, part)
         total = total + factors(3)*part
      end if
      if (size(group%damping) > 0) total = total + factors(2)*group%damping(:, :, e)
   end subroutine effective_element

   !> Whether a group adds stiffness or damping to the effective matrix: it is implicit and more
   !> than mere mass.
   pure function has_implicit_matrix(group) result(has)
      type(group_type), intent(in) :: group
      logical :: has

      has = group%scheme == scheme_implicit .and. any(group%element%uses(1))
   end function has_implicit_matrix

   !> Whether elements of a group add anything to c_mass M + c_damping C + c_stiffness K beside
   !> their lumped mass.
   pure function contributes(group, factors)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: factors(3)
      logical :: contributes

      contributes = .not. group%lumped .and. abs(factors(1)) > 0.0_wp
      if (contributes .or. .not. has_implicit_matrix(group)) return
      contributes = abs(factors(3)) > 0.0_wp
      contributes = contributes .or. (size(group%damping) > 0 .and. abs(factors(2)) > 0.0_wp)
   end function contributes

end module element_sum
