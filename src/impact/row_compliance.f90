!> Compliance of contact rows on the effective matrix at hand, by back-substitutions.
module row_compliance
   use kinds, only: wp
   use equation_of_motion, only: solve_motion
   use constraint_rows, only: row_accelerations, row_vector
   use impact_scene, only: scene_type
   implicit none
   private

   public :: find_compliance

contains

   !> X = A^-1 Gt and W = G X for some rows, with the matrix last prepared (its motion solution).
   subroutine find_compliance(scene, active, w, x)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: active(:)
      real(wp), allocatable, intent(out) :: w(:, :)    !! (n_active, n_active)
      real(wp), allocatable, intent(out) :: x(:, :)    !! (n_freedoms, n_active)
      real(wp) :: products(scene%rows%n)
      integer :: j, n

      n = scene%system%structure%map%n_freedoms
      allocate (x(n, size(active)), w(size(active), size(active)))
      do j = 1, size(active)
         x(:, j) = solve_motion(scene%system, row_vector(scene%rows, active(j), n))
         products = row_accelerations(scene%rows, x(:, j))
         w(:, j) = products(active)
      end do
      w = (w + transpose(w))/2.0_wp
   end subroutine find_compliance

end module row_compliance
