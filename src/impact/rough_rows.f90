!> Forces or impulses of contact rows from their compliance: complementary, held, or by Coulomb's
!> law.
module rough_rows
   use kinds, only: wp
   use complementarity, only: solve_complementarity, solve_equality
   use frictional_complementarity, only: solve_friction
   implicit none
   private

   public :: solve_rows

contains

   !> Solves r = W x + q with x, r >= 0 complementary along the normals, r = 0 in held rows; with
   !> friction W, q, x hold the tangential directions behind the normal ones. `sense` is the sign of
   !> the slip where it is known. `solved` is false if there is no answer.
   subroutine solve_rows(w, q, friction, held, x, solved, sense)
      real(wp), intent(in) :: w(:, :)            !! (n, n), with friction (2 n, 2 n)
      real(wp), intent(in) :: q(:)
      real(wp), intent(in) :: friction(:)        !! (n) mu
      logical, intent(in) :: held(:)             !! (n)
      real(wp), intent(out) :: x(:)
      logical, intent(out) :: solved
      integer, intent(in), optional :: sense(:)  !! (n) 0: not known
      integer :: slips(size(friction))

      slips = 0
      if (present(sense)) slips = sense
      if (size(q) == 2*size(friction)) then
         call solve_friction(w, q, friction, held, slips, x, solved)
      else if (all(held)) then
         call solve_equality(w, q, x, solved)
      else if (.not. any(held)) then
         call solve_complementarity(w, q, x, solved)
      else
         call solve_smooth(w, q, held, x, solved)
      end if
   end subroutine solve_rows

   !> Some rows held, some complementary, no friction.
   subroutine solve_smooth(w, q, held, x, solved)
      real(wp), intent(in) :: w(:, :), q(:)
      logical, intent(in) :: held(:)
      real(wp), intent(out) :: x(:)
      logical, intent(out) :: solved
      real(wp) :: full_w(2*size(q), 2*size(q)), full_q(2*size(q)), full_x(2*size(q)), &
            friction(size(q))
      integer :: sense(size(q)), i, n

      n = size(q)
      sense = 0
      friction = 0.0_wp
      full_w = 0.0_wp
      full_q = 0.0_wp
      full_w(:n, :n) = w
      full_q(:n) = q
      do i = 1, n
         full_w(n + i, n + i) = w(i, i)
      end do
      call solve_friction(full_w, full_q, friction, held, sense, full_x, solved)
      x = full_x(:n)
   end subroutine solve_smooth

end module rough_rows
