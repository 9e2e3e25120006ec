!> Rehearsals of a dynamic step without output: they find the sizes of increments with which the
!> error of the whole step is what TOLERANCE asks for. The sizes of all increments go up and down
!> together; the error measured with some foretells that with others.
module rehearsal
   use kinds, only: wp
   use state_archive, only: archive_type
   use errors, only: error_type, new_error, status_numerical, status_interrupted
   use text, only: to_text, plural
   use mesh, only: scheme_implicit, scheme_explicit
   use steps, only: step_type
   use surfaces, only: method_transformation
   use stability_limit, only: stable_frequency
   use run_log, only: log_type, say, remark
   use progress, only: place_type, show_progress
   use stop_request, only: watch_type, keep_watch, look_for_stop, stop_run
   use scene_setup, only: simulation_type
   use increments, only: checkpoint_type, keep_state, put_back
   use twin_motion, only: twins_type, twin_settings_type, start_twins, take_fine_increment, &
         compare_twins, step_is_over
   implicit none
   private

   public :: plan_type, trial_type, rehearse, judge, estimated_error, report_tolerance

   !> What one run through the step has shown.
   type :: trial_type
      real(wp) :: size = 1.0_wp                  !! of all increments, 1 in the first rehearsal
      real(wp) :: difference = 0.0_wp            !! of both motions, of the largest displacement
      integer :: n = 0                           !! increments
   contains
      procedure :: pass_state => pass_trial
   end type trial_type

   !> What is asked of a step and how far it has been found out.
   type :: plan_type
      real(wp) :: asked = 0.0_wp                 !! error, of the largest displacement
      logical :: given = .false.                 !! by the deck
      integer :: most = 0                        !! increments
      real(wp) :: dt = 0.0_wp                    !! the deck's first increment
      real(wp) :: local_tolerance = 0.0_wp       !! at size 1
      type(twin_settings_type) :: settings       !! of the size chosen
      type(trial_type) :: last                   !! rehearsal
      type(trial_type) :: base                   !! the first one small enough to show an order
      real(wp) :: size = 1.0_wp                  !! to be taken next
      real(wp) :: order = 2.0_wp                 !! of the error in the size
      logical :: ready = .false.                 !! the next run is the real one
      integer :: n_rehearsals = 0
   contains
      procedure :: pass_state => pass_plan
   end type plan_type

   real(wp), parameter :: default_tolerance = 1.0e-3_wp
   integer, parameter :: default_most = 1000000
   real(wp), parameter :: smallest_share = 1.0e-8_wp   !! of the step, default of dt min
   !> Largest increment, of the largest stable one: the coarse ones are double.
   real(wp), parameter :: stable_share = 0.45_wp
   integer, parameter :: most_rehearsals = 10
   real(wp), parameter :: aim = 0.5_wp                 !! estimate aimed at, of what is asked
   real(wp), parameter :: enough = 0.25_wp             !! an estimate from here on needs no change
   real(wp), parameter :: nothing = 1.0e-13_wp         !! errors below mean nothing
   real(wp), parameter :: round_off = 1.0e-10_wp       !! errors below may be that of impact times
   !> A size this near is foretold by one rehearsal, one farther off by two, which show the order.
   real(wp), parameter :: near = 0.4_wp
   real(wp), parameter :: full_order = 2.0_wp, least_order = 0.5_wp
   !> Measured orders from here on are taken for two, the rest for scatter.
   real(wp), parameter :: nearly_full = 1.3_wp
   real(wp), parameter :: apart = 1.9_wp               !! runs that show an order
   real(wp), parameter :: large_error = 0.2_wp         !! errors above show none
   real(wp), parameter :: same_count = 0.05_wp
   !> Without a TOLERANCE in the deck increments are not made smaller than this beyond all cost.
   real(wp), parameter :: default_least = 1.0_wp/32.0_wp

contains

   !> All of it.
   subroutine pass_trial(self, archive)
      class(trial_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%pass('size', self%size)
      call archive%pass('difference', self%difference)
      call archive%pass('n', self%n)
   end subroutine pass_trial

   !> All of it.
   subroutine pass_plan(self, archive)
      class(plan_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%pass('asked', self%asked)
      call archive%pass('given', self%given)
      call archive%pass('most', self%most)
      call archive%pass('dt', self%dt)
      call archive%pass('local_tolerance', self%local_tolerance)
      call archive%pass('size', self%size)
      call archive%pass('order', self%order)
      call archive%pass('ready', self%ready)
      call archive%pass('n_rehearsals', self%n_rehearsals)
      call archive%enter('settings')
      call self%settings%pass_state(archive)
      call archive%leave()
      call archive%enter('last')
      call self%last%pass_state(archive)
      call archive%leave()
      call archive%enter('base')
      call self%base%pass_state(archive)
      call archive%leave()
   end subroutine pass_plan

   !> Chooses the increments of a step; the simulation is then where it was.
   subroutine rehearse(simulation, i_step, log, watch, plan, error)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(log_type), intent(inout) :: log
      type(watch_type), intent(inout) :: watch
      type(plan_type), intent(out) :: plan
      type(error_type), allocatable, intent(out) :: error
      type(checkpoint_type) :: start
      type(trial_type) :: trial

      call begin_plan(plan, simulation, simulation%model%steps(i_step))
      call keep_state(simulation, start)
      do while (.not. plan%ready)
         trial%size = plan%size
         call try_out(simulation, i_step, log, watch, plan, trial, error)
         if (allocated(error)) then
            if (error%status == status_interrupted) call put_back(simulation, start)
            return
         end if
         call put_back(simulation, start)
         call say(log, '  rehearsal: '//plural(trial%n, 'increment')//', estimated error ' &
               //to_text(estimated_error(trial, plan%base, plan%order), 3))
         call judge(plan, trial)
         if (plan%given .and. wanted_count(plan) > real(plan%most, wp)) then
            call refuse(plan, wanted_count(plan), error)
            return
         end if
      end do
      call set_sizes(plan)
   end subroutine rehearse

   !> What the deck asks for, and a first guess that is rather too coarse.
   subroutine begin_plan(self, simulation, step)
      type(plan_type), intent(out) :: self
      type(simulation_type), intent(in) :: simulation
      type(step_type), intent(in) :: step
      real(wp) :: stable

      self%given = step%tolerance > 0.0_wp
      self%asked = merge(step%tolerance, default_tolerance, self%given)
      self%most = merge(step%max_increments, default_most, step%max_increments > 0)
      self%dt = step%dt
      self%local_tolerance = min(1.0e-2_wp, max(1.0e-7_wp, 300.0_wp*self%asked**1.5_wp))
      self%settings%duration = step%duration
      associate (limits => self%settings%limits)
         limits = [step%dt_min, step%dt_max]
         if (.not. limits(1) > 0.0_wp) limits(1) = min(step%dt, smallest_share*step%duration)
         if (.not. limits(2) > 0.0_wp) limits(2) = step%duration
         limits(2) = min(limits(2), stable_share*simulation%critical(scheme_explicit)%step)
         stable = stable_frequency(simulation%scene%system%newmark)
         associate (omega => simulation%critical(scheme_implicit)%omega)
            if (stable > 0.0_wp .and. stable < sqrt(huge(stable)) .and. omega > 0.0_wp) then
               limits(2) = min(limits(2), stable_share*stable/omega)
            end if
         end associate
         limits(1) = min(limits(1), limits(2))
      end associate
      ! the other methods find impacts at the ends of increments only
      if (simulation%scene%rows%n > 0 .and. simulation%scene%settings%method &
            /= method_transformation) then
         self%order = 1.0_wp
      end if
      call set_sizes(self)
   end subroutine begin_plan

   !> First increment and local tolerance (third power of the increment) of the size chosen.
   pure subroutine set_sizes(self)
      type(plan_type), intent(inout) :: self

      self%settings%dt = self%dt*self%size
      self%settings%local_tolerance = self%local_tolerance*self%size**3
   end subroutine set_sizes

   !> The step with one size.
   subroutine try_out(simulation, i_step, log, watch, plan, trial, error)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(log_type), intent(inout) :: log
      type(watch_type), intent(inout) :: watch
      type(plan_type), intent(inout) :: plan
      type(trial_type), intent(inout) :: trial
      type(error_type), allocatable, intent(out) :: error
      type(twins_type) :: twins
      real(wp) :: t
      logical :: asked

      t = simulation%motion%motion%t
      call set_sizes(plan)
      call start_twins(twins, simulation, plan%settings)
      do while (.not. step_is_over(twins))
         call take_fine_increment(twins, simulation, error)
         if (allocated(error)) return
         simulation%scene%n_events = 0
         call compare_twins(twins, simulation)
         call keep_watch(watch)
         if (watch%pace%fresh .and. log%progress%shown) call show_progress(log%progress, &
               watch%pace%now, place_type(step=i_step, rehearsal=plan%n_rehearsals + 1, &
               increment=twins%n, share=twins%step_time/plan%settings%duration))
         call look_for_stop(watch, asked)
         if (asked) then
            call stop_run(watch, 'in a rehearsal of step '//to_text(i_step), t, error)
            return
         end if
         if (twins%n <= plan%most) cycle
         call refuse(plan, real(twins%n, wp), error)
         return
      end do
      plan%settings%scale = twins%scale
      trial%n = twins%n
      trial%difference = 0.0_wp
      if (twins%scale > 0.0_wp) trial%difference = twins%difference/twins%scale
      plan%n_rehearsals = plan%n_rehearsals + 1
   end subroutine try_out

   !> Size and readiness from one more rehearsal.
   pure subroutine judge(self, trial)
      type(plan_type), intent(inout) :: self
      type(trial_type), intent(in) :: trial
      real(wp) :: estimate, target
      logical :: forced, trusted

      self%order = measured_order(trial, self%base, self%order)
      estimate = estimated_error(trial, self%base, self%order)
      trusted = self%last%n > 0
      ! limits of the increment, or events, leave no choice
      forced = self%last%n > 0 .and. abs(trial%n/real(max(1, self%last%n), wp) - 1.0_wp) < &
            same_count .and. abs(log(trial%size/self%last%size)) >= log(1.5_wp)
      self%last = trial
      if (self%base%n == 0 .and. trial%difference <= large_error) self%base = trial
      self%size = trial%size
      self%ready = estimate <= max(nothing, min(round_off, 0.1_wp*self%asked)) .or. forced .or. &
            self%n_rehearsals >= most_rehearsals .or. &
            (estimate <= self%asked .and. estimate >= enough*self%asked)
      if (self%ready) return
      target = trial%size*(aim*self%asked/estimate)**(1.0_wp/self%order)
      if (.not. self%given) target = max(target, default_least)
      self%size = target
      self%ready = (trusted .or. (target >= near*trial%size .and. estimate < large_error)) .and. &
            target >= trial%size/4.0_wp .and. target <= 1.5_wp*trial%size
      if (self%ready) return
      if (target < trial%size) self%size = max(min(2.5_wp*target, trial%size/2.0_wp), &
            trial%size/4.0_wp)
   end subroutine judge

   !> Order of the error in the number of increments by two runs, if they differ enough; else as it
   !> was. (Increments of a size twice as large need not be half as many: they are on a ladder.)
   pure function measured_order(trial, base, order) result(measured)
      type(trial_type), intent(in) :: trial, base
      real(wp), intent(in) :: order
      real(wp) :: measured, growth

      measured = order
      if (base%n == 0 .or. trial%n == 0) return
      growth = log(real(trial%n, wp)/real(base%n, wp))
      if (abs(growth) < log(apart)) return
      if (min(trial%difference, base%difference) <= nothing) return
      measured = max(log(base%difference/trial%difference)/growth, least_order)
      if (measured > nearly_full) measured = full_order
   end function measured_order

   !> Error of the fine motion by Richardson, of the largest displacement.
   pure function estimated_error(trial, base, order) result(estimate)
      type(trial_type), intent(in) :: trial, base
      real(wp), intent(in) :: order              !! if both runs do not show one
      real(wp) :: estimate

      estimate = trial%difference/(2.0_wp**measured_order(trial, base, order) - 1.0_wp)
   end function estimated_error

   !> Increments that what is asked will take at least.
   pure function wanted_count(self) result(n)
      type(plan_type), intent(in) :: self
      real(wp) :: n
      real(wp) :: order, estimate

      n = real(self%last%n, wp)
      if (self%last%difference > 1.0_wp) return
      order = self%order
      if (self%last%difference > large_error) order = full_order
      estimate = self%last%difference/(2.0_wp**order - 1.0_wp)
      n = n*max(1.0_wp, estimate/(aim*self%asked))**(1.0_wp/order)
   end function wanted_count

   subroutine refuse(plan, n, error)
      type(plan_type), intent(in) :: plan
      real(wp), intent(in) :: n                  !! increments, or more
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: limit

      limit = 'INC='//to_text(plan%most)//' allows'
      if (plan%most == default_most) limit = 'without INC a step has at most ' &
            //to_text(plan%most)//' automatic ones'
      call new_error(error, status_numerical, 'TOLERANCE='//to_text(plan%asked, 3) &
            //' takes '//to_text(n, 3)//' increments or more; '//limit//new_line('a') &
            //'  cure: ask for a larger TOLERANCE, or raise INC on *STEP')
   end subroutine refuse

   !> What was done and how well, at the end of the real run.
   subroutine report_tolerance(plan, twins, i_step, log)
      type(plan_type), intent(in) :: plan
      type(twins_type), intent(in) :: twins
      integer, intent(in) :: i_step
      type(log_type), intent(inout) :: log
      type(trial_type) :: trial
      real(wp) :: estimate

      trial%size = plan%size
      trial%n = twins%n
      if (twins%scale > 0.0_wp) trial%difference = twins%difference/twins%scale
      estimate = estimated_error(trial, plan%base, plan%order)
      call say(log, 'step '//to_text(i_step)//': '//plural(twins%n, 'automatic increment')//', ' &
            //to_text(twins%ladder%n_changes)//' changes of size, ' &
            //plural(plan%n_rehearsals, 'rehearsal')//' before')
      call say(log, '  estimated error '//to_text(estimate, 3) &
            //' of the largest displacement, asked '//to_text(plan%asked, 3))
      if (estimate > plan%asked) then
         call remark(log, 'warning: step '//to_text(i_step) &
               //' is probably less accurate than asked')
      end if
   end subroutine report_tolerance

end module rehearsal
