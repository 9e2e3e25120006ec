!> The longest period of free vibration of a step in force, as far as it is cheap to find.
module longest_period
   use kinds, only: wp
   use errors, only: error_type
   use mesh, only: scheme_implicit, scheme_explicit
   use skyline_matrix, only: profile_entries, profile_cost, profile_type
   use equation_order, only: order_equations, ordering_type
   use eigen_analysis, only: modes_type, find_modes
   use eigen_solver, only: small
   use scene_setup, only: simulation_type
   implicit none
   private

   public :: find_longest_period, period_seconds

   !> Seconds on a processor of today: of five factorizations by operation, of all else by entry of
   !> the profile, of a small model by equation cubed; each found by a run that does little else.
   real(wp), parameter :: factor_operation = 5.0_wp/27.0e9_wp
   real(wp), parameter :: profile_entry = 1.2e-6_wp
   real(wp), parameter :: condensed_entry = 3.0e-9_wp
   !> Modes asked for: one more than bodies can have rigid ones, then more as long as all are such.
   integer, parameter :: rigid_modes = 3, most_modes = 36
   !> Squared frequencies below this part of the highest are those of rigid motion.
   real(wp), parameter :: rigid = 1.0e-13_wp
   real(wp), parameter :: pi = acos(-1.0_wp)

contains

   !> Longest period of elastic motion, gaps open, about the state reached, prescribed freedoms at
   !> rest, all elements with their mass as it is. Zero if there is none, or if it would take longer
   !> than allowed.
   subroutine find_longest_period(simulation, n_bodies, seconds, period, costly)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: n_bodies            !! deforming ones
      real(wp), intent(in) :: seconds            !! allowed
      real(wp), intent(out) :: period
      logical, intent(out) :: costly             !! it would have taken longer
      integer, allocatable :: scheme(:)
      type(profile_type) :: profile
      type(ordering_type) :: ordering

      period = 0.0_wp
      costly = .false.
      associate (system => simulation%scene%system, n_eq => &
            simulation%scene%system%structure%map%n_eq)
         if (n_eq == 0) return
         scheme = system%structure%groups%scheme
         if (.not. any(scheme == scheme_explicit)) then
            call search(simulation, system%profile, n_bodies, seconds, period, costly)
            return
         end if
         ! a profile has an entry an equation at least: to order them may be too much already
         costly = n_eq > small .and. profile_entry*real(n_eq, wp) > seconds
         if (costly) return
         system%structure%groups%scheme = scheme_implicit
         call order_equations(system%structure, simulation%held, simulation%model%equations, &
               profile, ordering)
         call search(simulation, profile, n_bodies, seconds, period, costly)
         system%structure%groups%scheme = scheme
         call order_equations(system%structure, simulation%held, simulation%model%equations, &
               system%profile, simulation%ordering)
      end associate
   end subroutine find_longest_period

   !> About what the modes take.
   pure real(wp) function period_seconds(profile)
      type(profile_type), intent(in) :: profile

      if (profile%n <= small) then
         period_seconds = condensed_entry*real(profile%n, wp)**3
      else
         period_seconds = factor_operation*profile_cost(profile) &
               + profile_entry*real(profile_entries(profile), wp)
      end if
   end function period_seconds

   subroutine search(simulation, profile, n_bodies, seconds, period, costly)
      type(simulation_type), intent(in) :: simulation
      type(profile_type), intent(in) :: profile
      integer, intent(in) :: n_bodies
      real(wp), intent(in) :: seconds
      real(wp), intent(out) :: period
      logical, intent(out) :: costly
      type(modes_type) :: modes
      type(error_type), allocatable :: error
      real(wp) :: highest, spent
      integer :: n, i

      period = 0.0_wp
      costly = .false.
      highest = maxval(simulation%critical%omega)
      n = 1 + rigid_modes*max(1, min(n_bodies, most_modes/rigid_modes))
      spent = 0.0_wp
      do
         spent = spent + period_seconds(profile)
         costly = spent > seconds
         if (costly) return
         associate (motion => simulation%motion%motion)
            call find_modes(simulation%scene%system%structure, profile, motion%d, motion%history, &
                  min(n, profile%n), modes, error)
         end associate
         if (allocated(error)) return
         do i = 1, modes%n
            if (modes%eigenvalue(i) <= rigid*highest**2) cycle
            period = 2.0_wp*pi/sqrt(modes%eigenvalue(i))
            return
         end do
         if (modes%n < n) return
         costly = n >= most_modes
         if (costly) return
         n = 3*n
      end do
   end subroutine search

end module longest_period
