!> The start of a step: its conditions and loads come into force, the first acceleration is found.
module step_start
   use kinds, only: wp
   use errors, only: error_type
   use external_load, only: load_at, set_reactions
   use energy_ledger, only: open_ledger, close_increment
   use reactions, only: reactions_at
   use contact_impulses, only: restart_acceleration
   use slip_state, only: review_sticking
   use anchored_impacts, only: lift_anchor
   use scene_setup, only: simulation_type, begin_step, meet_conditions
   implicit none
   private

   public :: start_step

contains

   !> Brings step i_step into force and gives a dynamic step its acceleration and first contacts.
   subroutine start_step(simulation, i_step, error)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: load_before(:)
      logical, allocatable :: held_before(:)
      real(wp) :: before

      before = simulation%scene%ledger%total
      if (i_step > 1) then
         load_before = load_now(simulation)
         held_before = simulation%held
      end if
      call begin_step(simulation, i_step, error)
      if (allocated(error)) return
      call meet_conditions(simulation, error)
      if (allocated(error)) return
      if (simulation%scene%system%static) then
         simulation%motion%motion%v = 0.0_wp
         simulation%motion%motion%a = 0.0_wp
         if (i_step > 1) call let_supports_go(simulation, held_before)
      end if
      call lift_anchor(simulation%scene, simulation%motion, error)
      if (allocated(error)) return
      associate (scene => simulation%scene)
         if (i_step == 1) then
            call open_ledger(scene%ledger, scene%system, simulation%motion%motion)
         else
            ! what conditions give or take at the start of a later step comes from outside
            call close_increment(scene%ledger, scene%system, simulation%motion%motion)
            scene%ledger%external_work = scene%ledger%external_work + scene%ledger%total - before
         end if
         if (starts_anew(simulation, i_step)) then
            call simulation%method%start(scene, simulation%motion, &
                  simulation%model%steps(i_step)%dt, error)
            if (allocated(error)) return
         else if (i_step > 1 .and. .not. scene%system%static) then
            call go_on(simulation, load_before, held_before, error)
            if (allocated(error)) return
         end if
         if (i_step == 1) call close_increment(scene%ledger, scene%system, &
               simulation%motion%motion)
      end associate
   end subroutine start_step

   !> A support that a static step drops leaves its reaction as a load that goes down over the step:
   !> without it all that the support has held would go in the first increment.
   subroutine let_supports_go(simulation, held_before)
      type(simulation_type), intent(inout) :: simulation
      logical, intent(in) :: held_before(:)      !! (n_freedoms) prescribed in the step before

      if (.not. any(held_before .and. .not. simulation%held)) return
      associate (system => simulation%scene%system)
         call set_reactions(system%loads, reactions_at(system, simulation%motion%motion, &
               simulation%motion%force, held_before .and. .not. simulation%held))
      end associate
   end subroutine let_supports_go

   !> The applied forces at the time reached.
   function load_now(simulation) result(force)
      type(simulation_type), intent(in) :: simulation
      real(wp) :: force(simulation%scene%system%structure%map%n_freedoms)

      force = load_at(simulation%scene%system%loads, size(force), simulation%motion%motion%t)
   end function load_now

   !> A load that jumps where one dynamic step goes on from another, a support that goes or comes,
   !> or one that slides away under what stuck to it, changes the acceleration at once; carried on,
   !> the old one would take half of the jump off the first increment.
   subroutine go_on(simulation, load_before, held_before, error)
      type(simulation_type), intent(inout) :: simulation
      real(wp), intent(in) :: load_before(:)     !! (n_freedoms) at this time, in the step before
      logical, intent(in) :: held_before(:)      !! (n_freedoms) prescribed in it
      type(error_type), allocatable, intent(out) :: error
      real(wp), parameter :: round_off = 1.0e-12_wp
      logical :: anew

      anew = .not. (all(held_before .eqv. simulation%held) .and. maxval(abs(load_now(simulation) &
            - load_before)) <= round_off*maxval(abs(load_before)))
      if (.not. anew) call review_sticking(simulation%scene, simulation%motion, anew, error)
      if (allocated(error) .or. .not. anew) return
      call restart_acceleration(simulation%scene, simulation%motion, error)
      simulation%motion%fresh = .true.
   end subroutine go_on

   !> A dynamic step finds its own acceleration unless it goes on from another dynamic step.
   pure function starts_anew(simulation, i_step) result(anew)
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step
      logical :: anew

      anew = .false.
      if (simulation%scene%system%static) return
      anew = i_step == 1
      if (anew) return
      anew = simulation%model%steps(i_step - 1)%procedure &
            /= simulation%model%steps(i_step)%procedure
      anew = anew .or. size(simulation%model%steps(i_step)%initial_velocities) > 0
   end function starts_anew

end module step_start
