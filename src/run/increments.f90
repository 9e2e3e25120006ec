!> Increments of a step: fixed, or in static steps automatic with cut-back and growth. An increment
!> that is not accepted leaves no trace: all that it touches is put back from a checkpoint.
module increments
   use kinds, only: wp
   use state_archive, only: archive_type
   use errors, only: error_type, new_error, status_numerical
   use text, only: to_text
   use cost_account, only: enter, leave, phase_contact, phase_other
   use steps, only: step_type
   use energy_ledger, only: ledger_type
   use constraint_rows, only: rows_type
   use impact_scene, only: contact_motion_type, accept_span
   use constrained_step, only: solve_statically
   use scene_setup, only: simulation_type
   implicit none
   private

   public :: control_type, start_control, take_increment, take_automatic_increment
   public :: checkpoint_type, keep_state, put_back, add_smallest

   !> All that an increment changes.
   type :: checkpoint_type
      type(contact_motion_type) :: motion
      type(ledger_type) :: ledger
      type(rows_type), allocatable :: rows       !! where they move with the bodies
      integer :: n_events = 0
   contains
      procedure :: pass_state => pass_checkpoint
   end type checkpoint_type

   !> Automatic choice of static increments.
   type :: control_type
      real(wp) :: dt = 0.0_wp                    !! to be tried next
      real(wp) :: dt_min = 0.0_wp, dt_max = 0.0_wp
      integer :: n_easy = 0                      !! increments in a row that went easily
      integer :: n_cut = 0                       !! increments tried in vain
   contains
      procedure :: pass_state => pass_control
   end type control_type

   real(wp), parameter :: smallest_share = 1.0e-5_wp   !! of the step, default of dt min
   real(wp), parameter :: cut_factor = 0.25_wp         !! after a failure to converge
   real(wp), parameter :: growth_factor = 1.5_wp
   integer, parameter :: easy_iterations = 5
   integer, parameter :: easy_increments = 2

contains

   !> The control of a step from its data line.
   pure subroutine start_control(self, step)
      type(control_type), intent(out) :: self
      type(step_type), intent(in) :: step

      self%dt = step%dt
      self%dt_min = step%dt_min
      if (.not. self%dt_min > 0.0_wp) self%dt_min = min(step%dt, smallest_share*step%duration)
      self%dt_max = step%dt_max
      if (.not. self%dt_max > 0.0_wp) self%dt_max = step%duration
   end subroutine start_control

   !> All of it.
   subroutine pass_control(self, archive)
      class(control_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%pass('dt', self%dt)
      call archive%pass('dt_min', self%dt_min)
      call archive%pass('dt_max', self%dt_max)
      call archive%pass('n_easy', self%n_easy)
      call archive%pass('n_cut', self%n_cut)
   end subroutine pass_control

   !> All of it.
   subroutine pass_checkpoint(self, archive, rows)
      class(checkpoint_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive
      type(rows_type), intent(in) :: rows        !! of the scene, for what stays the same

      call archive%enter('motion')
      call self%motion%pass_state(archive)
      call archive%leave()
      call archive%enter('ledger')
      call self%ledger%pass_state(archive)
      call archive%leave()
      call archive%pass('n_events', self%n_events)
      if (.not. rows%moving) return
      if (archive%reading) self%rows = rows
      call archive%enter('rows')
      call self%rows%pass_state(archive)
      call archive%leave()
   end subroutine pass_checkpoint

   !> Keeps the state before an increment.
   subroutine keep_state(simulation, checkpoint)
      type(simulation_type), intent(in) :: simulation
      type(checkpoint_type), intent(out) :: checkpoint

      checkpoint%motion = simulation%motion
      checkpoint%ledger = simulation%scene%ledger
      if (simulation%scene%rows%moving) checkpoint%rows = simulation%scene%rows
      checkpoint%n_events = simulation%scene%n_events
   end subroutine keep_state

   !> Puts the state back as if the increment had not been tried.
   subroutine put_back(simulation, checkpoint)
      type(simulation_type), intent(inout) :: simulation
      type(checkpoint_type), intent(in) :: checkpoint

      simulation%motion = checkpoint%motion
      simulation%scene%ledger = checkpoint%ledger
      if (allocated(checkpoint%rows)) simulation%scene%rows = checkpoint%rows
      simulation%scene%n_events = checkpoint%n_events
      simulation%scene%impulse = 0.0_wp
   end subroutine put_back

   !> One increment by the step's procedure.
   subroutine take_increment(simulation, dt, error)
      type(simulation_type), intent(inout) :: simulation
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      integer :: outer

      simulation%scene%impulse = 0.0_wp
      simulation%scene%dt = dt
      call enter(simulation%scene%system%cost, merge(phase_contact, phase_other, &
            simulation%scene%rows%n > 0), outer)
      if (simulation%scene%system%static) then
         call take_static_increment(simulation, dt, error)
      else
         call simulation%method%advance(simulation%scene, simulation%motion, dt, error)
      end if
      call leave(simulation%scene%system%cost, outer)
   end subroutine take_increment

   subroutine take_static_increment(simulation, dt, error)
      type(simulation_type), intent(inout) :: simulation
      real(wp), intent(in) :: dt
      type(error_type), allocatable, intent(out) :: error
      type(contact_motion_type) :: next

      call solve_statically(simulation%scene, simulation%motion, dt, next, error)
      if (allocated(error)) return
      call accept_span(simulation%scene, simulation%motion, next)
      simulation%motion = next
   end subroutine take_static_increment

   !> One accepted static increment of at most `remaining`: tried, cut back where it does not
   !> converge, and the size of the next one chosen.
   subroutine take_automatic_increment(simulation, control, remaining, dt, error)
      type(simulation_type), intent(inout) :: simulation
      type(control_type), intent(inout) :: control
      real(wp), intent(in) :: remaining          !! to the end of the step
      real(wp), intent(out) :: dt                !! what was taken
      type(error_type), allocatable, intent(out) :: error
      type(checkpoint_type) :: checkpoint
      integer :: iterations

      call keep_state(simulation, checkpoint)
      do
         dt = min(control%dt, remaining)
         ! no sliver at the end of the step
         if (remaining - dt < 0.1_wp*dt) dt = remaining
         iterations = int(simulation%scene%n_iterations)
         call take_increment(simulation, dt, error)
         iterations = int(simulation%scene%n_iterations) - iterations
         if (.not. allocated(error)) exit
         if (error%status /= status_numerical) return
         call put_back(simulation, checkpoint)
         call cut_back(control, dt, error)
         if (allocated(error)) return
      end do
      call choose_next(control, dt, iterations)
   end subroutine take_automatic_increment

   !> Chooses a smaller increment; at the smallest one the run stops.
   subroutine cut_back(control, dt, error)
      type(control_type), intent(inout) :: control
      real(wp), intent(in) :: dt                 !! what was tried
      type(error_type), allocatable, intent(inout) :: error

      control%n_cut = control%n_cut + 1
      control%n_easy = 0
      control%dt = cut_factor*dt
      if (control%dt >= control%dt_min) then
         deallocate (error)
      else
         call add_smallest(error, dt, control%dt_min)
      end if
   end subroutine cut_back

   !> Says of a failure that smaller increments have been tried.
   subroutine add_smallest(error, dt, dt_min)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), intent(in) :: dt, dt_min
      character(len=:), allocatable :: cause

      cause = error%message
      call new_error(error, status_numerical, cause//new_line('a') &
            //'  the increment was cut back to '//to_text(dt)//'; the smallest allowed is ' &
            //to_text(dt_min))
   end subroutine add_smallest

   !> Growth after increments that went easily, by the count of iterations. Small changes are not
   !> worth a new factorization.
   pure subroutine choose_next(control, dt, iterations)
      type(control_type), intent(inout) :: control
      real(wp), intent(in) :: dt
      integer, intent(in) :: iterations

      control%n_easy = control%n_easy + 1
      if (iterations > easy_iterations) control%n_easy = 0
      if (control%n_easy < easy_increments) return
      ! the last increment of a step may be shorter than what is tried next
      control%dt = min(control%dt_max, max(control%dt, growth_factor*dt))
      control%n_easy = 0
   end subroutine choose_next

end module increments
