!> What a step resolves: periods, waves, contacts; and the step that would do.
module step_explanation
   use kinds, only: wp
   use text, only: to_text, plural
   use memory_shortage, only: check_allocation
   use mesh, only: scheme_implicit, scheme_explicit
   use steps, only: step_type, procedure_static, procedure_dynamic, procedure_frequency
   use structure, only: count_resisting
   use critical_step, only: find_own_limits
   use continuum_bodies, only: body_list_type
   use contact_outlook, only: outlook_type
   use penalty_springs, only: penalty_type, find_penalty, enough_of_penalty
   use increment_count, only: count_increments
   use scene_setup, only: simulation_type
   use explanation_lines, only: lines_type, short
   implicit none
   private

   public :: explain_periods, explain_step

   real(wp), parameter :: pi = acos(-1.0_wp)
   !> The step advised: so many increments in the longest period and in a contact; Courant number 1
   !> where waves count; this part of the critical step.
   real(wp), parameter :: of_period = 20.0_wp, of_contact = 50.0_wp, of_critical = 0.9_wp
   real(wp), parameter :: of_period_in_order_4 = 5.0_wp
   integer, parameter :: most_elements = 50000

contains

   !> Explains what the increments of a step in force resolve.
   subroutine explain_step(self, simulation, i_step, bodies, outlooks, period)
      type(lines_type), intent(inout) :: self
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(body_list_type), intent(in) :: bodies
      type(outlook_type), intent(in) :: outlooks(:)
      real(wp), intent(in) :: period
      type(penalty_type) :: penalty

      associate (step => simulation%model%steps(i_step))
         if (step%procedure /= procedure_dynamic) return
         call explain_waves(self, simulation, step, bodies)
         call explain_contact(self, step, outlooks)
         call find_penalty(simulation, penalty)
         if (penalty%row > 0) call self%add('', 'penalty: the mass '//short(penalty%mass) &
               //' of node '//to_text(simulation%scene%rows%node_id(penalty%row)) &
               //' has the period '//short(penalty%period)//' on its spring' &
               //increments(step, penalty%period)//'; contact lasts half of it')
         call recommend(self, simulation, step, bodies, outlooks, [period, penalty%period])
      end associate
   end subroutine explain_step

   function step_text(simulation, i_step) result(text)
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step
      character(len=:), allocatable :: text
      integer :: n(2)

      associate (step => simulation%model%steps(i_step), &
            structure => simulation%scene%system%structure)
         select case (step%procedure)
         case (procedure_frequency)
            text = 'frequency, '//plural(step%n_modes, 'mode')
            return
         case (procedure_static)
            text = 'static'
         case default
            text = 'dynamic'
         end select
         if (step%direct) then
            text = text//', '//plural(count_increments(step), 'increment')//' of ' &
                  //short(step%dt)//' over '//short(step%duration)
         else
            text = text//', automatic increments from '//short(step%dt)//' on over ' &
                  //short(step%duration)
         end if
         n = [count_resisting(structure, scheme_implicit), &
               count_resisting(structure, scheme_explicit)]
         if (step%procedure /= procedure_dynamic) return
         if (n(2) == 0 .and. n(1) > 0) text = text//', implicit'
         if (n(1) == 0 .and. n(2) > 0) text = text//', explicit'
         if (n(1) > 0 .and. n(2) > 0) text = text//'; '//to_text(n(1))//' elements implicit, ' &
               //to_text(n(2))//' explicit'
      end associate
   end function step_text

   !> The step, its longest and shortest period, each with its increments.
   subroutine explain_periods(self, simulation, i_step, period, costly)
      type(lines_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step
      real(wp), intent(in) :: period
      logical, intent(in) :: costly
      character(len=:), allocatable :: text
      real(wp) :: highest

      call self%add('step '//to_text(i_step), step_text(simulation, i_step))
      associate (step => simulation%model%steps(i_step))
         if (step%procedure == procedure_static) then
            text = 'at rest: no inertia, no waves; dt counts the load'
         else if (period > 0.0_wp) then
            text = 'longest period '//short(period)//' (frequency '//short(1.0_wp/period)//')' &
                  //increments(step, period)
         else if (costly) then
            text = 'longest period: too costly to find here, see *FREQUENCY'
         else if (swings_closed(simulation)) then
            text = 'longest period: none while all gaps are open; springs work once one is closed'
         else
            text = 'longest period: none, nothing is held or connected elastically'
         end if
         highest = maxval(simulation%critical%omega)
         if (step%procedure == procedure_dynamic .and. highest > 0.0_wp) text = text &
               //'; shortest '//short(2.0_wp*pi/highest) &
               //increments(step, 2.0_wp*pi/highest)
      end associate
      call self%add('', text)
   end subroutine explain_periods

   !> Whether a model that has no period of its own has springs with mass on them all the same:
   !> those to contact nodes without mass, which go with the mass until they touch.
   pure logical function swings_closed(simulation)
      type(simulation_type), intent(in) :: simulation

      swings_closed = simulation%scene%rows%n > 0 .and. maxval(simulation%critical%omega) > 0.0_wp
   end function swings_closed

   !> ", 157 increments" of a step with fixed ones.
   pure function increments(step, time) result(text)
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: time
      character(len=:), allocatable :: text

      text = ''
      if (step%procedure == procedure_dynamic .and. step%direct) text = ', ' &
            //to_text(time/step%dt, 3)//' increments'
   end function increments

   !> Courant number and critical steps.
   subroutine explain_waves(self, simulation, step, bodies)
      type(lines_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(step_type), intent(in) :: step
      type(body_list_type), intent(in) :: bodies
      character(len=:), allocatable :: text
      real(wp) :: own

      if (shortest_time(bodies) < huge(1.0_wp)) call self%add('', 'Courant number ' &
            //to_text(step%dt/shortest_time(bodies), 3)//' (step / time of a wave through ' &
            //'the smallest element)')
      text = ''
      associate (structure => simulation%scene%system%structure, &
            explicit => simulation%critical(scheme_explicit)%step)
         if (explicit < huge(1.0_wp)) text = text//'critical step '//short(explicit) &
               //', the step is '//to_text(step%dt/explicit, 3)//' of it; '
         own = own_limit(simulation)
         if (count_resisting(structure, scheme_implicit) > 0 .and. own < huge(1.0_wp)) text = text &
               //'critical step if all were explicit '//short(own)//'; '
      end associate
      if (len(text) > 0) call self%add('', text(:len(text) - 2))
   end subroutine explain_waves

   !> The least critical step that an element has on its own lumped mass, huge where it is not
   !> known.
   real(wp) function own_limit(simulation)
      type(simulation_type), intent(in) :: simulation
      real(wp), allocatable :: limits(:)
      integer :: status

      own_limit = huge(1.0_wp)
      if (simulation%model%elements%n > most_elements) return
      allocate (limits(simulation%model%elements%n), stat=status)
      call check_allocation(status)
      call find_own_limits(simulation%scene%system%structure, limits)
      own_limit = minval([own_limit, limits])
   end function own_limit

   pure real(wp) function shortest_time(bodies)
      type(body_list_type), intent(in) :: bodies

      shortest_time = minval([huge(1.0_wp), bodies%shortest_time])
   end function shortest_time

   !> Increments in the shortest contact.
   subroutine explain_contact(self, step, outlooks)
      type(lines_type), intent(inout) :: self
      type(step_type), intent(in) :: step
      type(outlook_type), intent(in) :: outlooks(:)

      if (.not. step%direct) return
      if (shortest_contact(outlooks) < huge(1.0_wp)) call self%add('', 'a hit of ' &
            //short(shortest_contact(outlooks))//' takes '//to_text(shortest_contact(outlooks) &
            /step%dt, 3)//' increments')
   end subroutine explain_contact

   pure real(wp) function shortest_contact(outlooks)
      type(outlook_type), intent(in) :: outlooks(:)

      shortest_contact = minval([huge(1.0_wp), pack(outlooks%duration, &
            outlooks%duration > 0.0_wp)])
   end function shortest_contact

   !> The least of what periods, waves, contacts and stability allow, with its reason.
   subroutine recommend(self, simulation, step, bodies, outlooks, periods)
      type(lines_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(step_type), intent(in) :: step
      type(body_list_type), intent(in) :: bodies
      type(outlook_type), intent(in) :: outlooks(:)
      real(wp), intent(in) :: periods(2)         !! the longest, that on penalty springs
      real(wp) :: best(6), parts
      character(len=:), allocatable :: text
      integer :: i

      best = huge(1.0_wp)
      parts = merge(of_period_in_order_4, of_period, step%order == 4)
      if (periods(1) > 0.0_wp) best(1) = periods(1)/parts
      if (shortest_contact(outlooks) < huge(1.0_wp)) then
         best(2) = shortest_contact(outlooks)/of_contact
         if (.not. all(outlooks%swings .or. .not. outlooks%known)) best(3) = shortest_time(bodies)
      end if
      associate (explicit => simulation%critical(scheme_explicit)%step)
         if (explicit < huge(1.0_wp)) best(4) = of_critical*explicit
      end associate
      if (.not. periods(1) > 0.0_wp .and. swings_closed(simulation)) best(6) = 2.0_wp*pi &
            /maxval(simulation%critical%omega)/of_period
      if (periods(2) < huge(1.0_wp)) best(5) = periods(2)/enough_of_penalty
      i = minloc(best, dim=1)
      if (.not. best(i) < huge(1.0_wp)) then
         call self%add('', 'recommended step: nothing here vibrates; choose dt by loads and output')
         return
      end if
      select case (i)
      case (1)
         text = 'longest period / '//to_text(parts, 2)
         if (step%order == 2) text = text//', which errs by 0.8 % in it'
      case (2)
         text = 'contact time / 50'
      case (3)
         text = 'Courant number 1: waves of contact go from element to element'
      case (5)
         text = 'period on the penalty spring / 20'
      case (6)
         text = 'shortest period / 20, that of closed gaps'
      case default
         text = '0.9 of the critical step'
      end select
      text = 'recommended step: '//to_text(best(i), 3)//' or less ('//text//')'
      if (step%direct) text = text//trim(merge('; this one is within it', &
            '; this one is larger   ', step%dt <= best(i)*(1.0_wp + 1.0e-9_wp)))
      call self%add('', text)
   end subroutine recommend

end module step_explanation
