!> The springs of the penalty method before anything moves: how long the mass of what they hold
!> takes for an oscillation on them, and whether a step resolves it.
module penalty_springs
   use kinds, only: wp
   use constraint_rows, only: rows_type, law_penalty
   use structure, only: diagonal_mass
   use scene_setup, only: simulation_type
   implicit none
   private

   public :: penalty_type, find_penalty, enough_of_penalty

   !> Increments in a period on a penalty spring with which a hit keeps the energy.
   real(wp), parameter :: enough_of_penalty = 20.0_wp

   real(wp), parameter :: pi = acos(-1.0_wp)

   !> The spring on which its mass oscillates fastest.
   type :: penalty_type
      integer :: row = 0                         !! 0: there is none
      real(wp) :: period = huge(1.0_wp)          !! 2 pi / sqrt(k G M^-1 Gt), lumped masses
      real(wp) :: mass = 0.0_wp                  !! 1 / (G M^-1 Gt)
      real(wp) :: stiffness = 0.0_wp
   end type penalty_type

contains

   !> Looks at all rows as they are placed; rows that slide have masses much like these later.
   subroutine find_penalty(simulation, penalty)
      type(simulation_type), intent(in) :: simulation
      type(penalty_type), intent(out) :: penalty
      real(wp), allocatable :: m(:)
      real(wp) :: compliance, period
      integer :: i

      associate (rows => simulation%scene%rows)
         if (.not. any(rows%law(:rows%n) == law_penalty)) return
         m = diagonal_mass(simulation%scene%system%structure)
         do i = 1, rows%n
            if (rows%law(i) /= law_penalty .or. .not. rows%facing(i)) cycle
            compliance = inverse_mass(simulation, m, i)
            if (.not. compliance > 0.0_wp .or. .not. compliance < huge(1.0_wp)) cycle
            period = 2.0_wp*pi/sqrt(rows%stiffness(i)*compliance)
            if (period >= penalty%period) cycle
            penalty = penalty_type(i, period, 1.0_wp/compliance, rows%stiffness(i))
         end do
      end associate
   end subroutine find_penalty

   !> G M^-1 Gt of a row: prescribed freedoms have no share, without mass it is infinite.
   pure real(wp) function inverse_mass(simulation, m, i) result(inverse)
      type(simulation_type), intent(in) :: simulation
      real(wp), intent(in) :: m(:)               !! (n_freedoms) lumped
      integer, intent(in) :: i                   !! the row
      integer :: j, f

      inverse = 0.0_wp
      associate (matrix => simulation%scene%rows%along_normal, &
            map => simulation%scene%system%structure%map)
         do j = matrix%first(i), matrix%first(i + 1) - 1
            f = matrix%freedom(j)
            if (map%prescribed(f) .or. .not. abs(matrix%coefficient(j)) > 0.0_wp) cycle
            if (.not. m(f) > 0.0_wp) then
               inverse = huge(1.0_wp)
               return
            end if
            inverse = inverse + matrix%coefficient(j)**2/m(f)
         end do
      end associate
   end function inverse_mass

end module penalty_springs
