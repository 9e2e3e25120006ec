!> The motion of a step computed twice side by side: increments of two sizes, the coarse one twice
!> the fine. The fine motion is the result; how far they part measures its error over the whole
!> step, impacts and all (Richardson).
module twin_motion
   use kinds, only: wp
   use state_archive, only: archive_type
   use errors, only: error_type, status_numerical
   use constraint_rows, only: rows_type
   use scene_setup, only: simulation_type
   use increments, only: checkpoint_type, keep_state, put_back, take_increment, &
         add_smallest
   use increment_ladder, only: ladder_type, start_ladder, halve, step_up, lower_limit
   use amplitude_breaks, only: find_breaks, reach_limit
   implicit none
   private

   public :: twins_type, twin_settings_type, start_twins, take_fine_increment, compare_twins, &
         step_is_over

   !> What the sizes of increments follow from.
   type :: twin_settings_type
      real(wp) :: duration = 0.0_wp              !! of the step
      real(wp) :: dt = 0.0_wp                    !! fine increment to be tried first
      real(wp) :: limits(2) = 0.0_wp             !! smallest and largest fine increment
      real(wp) :: local_tolerance = 0.0_wp       !! of a coarse increment's error, relative
      real(wp) :: scale = 0.0_wp                 !! largest displacement known so far
   contains
      procedure :: pass_state => pass_settings
   end type twin_settings_type

   !> Both motions; the simulation's own is the fine one between increments.
   type :: twins_type
      type(twin_settings_type) :: settings
      type(ladder_type) :: ladder                !! of the fine increments
      type(checkpoint_type) :: coarse
      real(wp), allocatable :: breaks(:)         !! points of amplitudes, total times
      integer :: next_break = 1
      real(wp) :: t_start = 0.0_wp               !! total time at the start of the step
      real(wp) :: step_time = 0.0_wp             !! of the fine motion
      real(wp) :: coarse_time = 0.0_wp
      real(wp) :: dt = 0.0_wp                    !! fine increment at hand
      real(wp) :: proven = 0.0_wp                !! the last coarse one whose estimate has passed
      real(wp) :: scale = 0.0_wp                 !! largest displacement met
      real(wp) :: difference = 0.0_wp            !! largest between the motions
      integer :: n = 0                           !! fine increments
      integer :: n_cut = 0                       !! coarse ones tried in vain
   contains
      procedure :: pass_state => pass_twins
   end type twins_type

   !> What is left of a step below this part of it is round-off.
   real(wp), parameter :: round_off = 1.0e-12_wp

contains

   !> All of it.
   subroutine pass_settings(self, archive)
      class(twin_settings_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%pass('duration', self%duration)
      call archive%pass('dt', self%dt)
      call archive%pass('local_tolerance', self%local_tolerance)
      call archive%pass('scale', self%scale)
      call archive%pass_fixed('limits', self%limits)
   end subroutine pass_settings

   !> All of it.
   subroutine pass_twins(self, archive, rows)
      class(twins_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive
      type(rows_type), intent(in) :: rows        !! of the scene

      call archive%enter('settings')
      call self%settings%pass_state(archive)
      call archive%leave()
      call archive%enter('ladder')
      call self%ladder%pass_state(archive)
      call archive%leave()
      call archive%enter('coarse')
      call self%coarse%pass_state(archive, rows)
      call archive%leave()
      call archive%pass('breaks', self%breaks)
      call archive%pass('next_break', self%next_break)
      call archive%pass('t_start', self%t_start)
      call archive%pass('step_time', self%step_time)
      call archive%pass('coarse_time', self%coarse_time)
      call archive%pass('dt', self%dt)
      call archive%pass('proven', self%proven)
      call archive%pass('scale', self%scale)
      call archive%pass('difference', self%difference)
      call archive%pass('n', self%n)
      call archive%pass('n_cut', self%n_cut)
   end subroutine pass_twins

   !> Both motions begin where the simulation is.
   subroutine start_twins(self, simulation, settings)
      type(twins_type), intent(out) :: self
      type(simulation_type), intent(in) :: simulation
      type(twin_settings_type), intent(in) :: settings

      self%settings = settings
      self%scale = max(settings%scale, maxval(abs(simulation%motion%motion%d)))
      self%t_start = simulation%motion%motion%t
      call start_ladder(self%ladder, settings%dt, settings%limits)
      call find_breaks(simulation, self%t_start + [0.0_wp, settings%duration], self%breaks)
      call keep_state(simulation, self%coarse)
   end subroutine start_twins

   pure logical function step_is_over(self)
      type(twins_type), intent(in) :: self

      step_is_over = self%step_time >= self%settings%duration
   end function step_is_over

   !> One increment of the fine motion; where that has caught up with the coarse one, the coarse one
   !> goes ahead first.
   subroutine take_fine_increment(self, simulation, error)
      type(twins_type), intent(inout) :: self
      type(simulation_type), intent(inout) :: simulation
      type(error_type), allocatable, intent(out) :: error
      type(checkpoint_type) :: fine
      real(wp) :: ahead

      if (self%coarse_time <= self%step_time) then
         call keep_state(simulation, fine)
         call lead(self, simulation, error)
         if (allocated(error)) return
         call put_back(simulation, fine)
      else
         call keep_state(simulation, fine)
      end if
      do
         call take_increment(simulation, self%dt, error)
         if (.not. allocated(error)) exit
         if (error%status /= status_numerical .or. lower_limit(self%ladder, self%dt)) return
         deallocate (error)
         ! not what the ladder foresaw: the fine motion alone goes in smaller increments
         call put_back(simulation, fine)
         call halve(self%ladder, self%dt, .false.)
         self%dt = self%dt/2.0_wp
      end do
      self%n = self%n + 1
      ahead = self%coarse_time - (self%step_time + self%dt)
      self%step_time = self%step_time + self%dt
      if (ahead <= round_off*self%settings%duration) self%step_time = self%coarse_time
      simulation%motion%motion%t = self%t_start + self%step_time
   end subroutine take_fine_increment

   !> One accepted increment of the coarse motion.
   subroutine lead(self, simulation, error)
      type(twins_type), intent(inout) :: self
      type(simulation_type), intent(inout) :: simulation
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: dt, ratio, left, limit

      left = self%settings%duration - self%step_time
      call reach_limit(self%breaks, self%t_start + self%step_time, self%next_break, limit)
      do
         dt = within(self, left)
         if (self%t_start + self%step_time + dt > limit .and. &
               .not. lower_limit(self%ladder, dt/2.0_wp)) then
            call halve(self%ladder, dt/2.0_wp, .false.)
            cycle
         end if
         call put_back(simulation, self%coarse)
         call take_increment(simulation, dt, error)
         if (.not. allocated(error)) then
            ratio = local_error(self, simulation, dt)
            if (ratio <= 1.0_wp .or. lower_limit(self%ladder, dt/2.0_wp)) exit
         else if (error%status /= status_numerical) then
            return
         else if (lower_limit(self%ladder, dt/2.0_wp)) then
            call add_smallest(error, dt/2.0_wp, self%ladder%dt_min)
            return
         else
            deallocate (error)
         end if
         self%n_cut = self%n_cut + 1
         call halve(self%ladder, dt/2.0_wp, simulation%scene%n_events == self%coarse%n_events)
      end do
      if (ratio > 0.0_wp) self%proven = dt
      if (dt >= 2.0_wp*self%ladder%dt) call step_up(self%ladder, ratio)
      self%dt = dt/2.0_wp
      self%coarse_time = self%step_time + dt
      if (dt >= left) self%coarse_time = self%settings%duration
      simulation%motion%motion%t = self%t_start + self%coarse_time
      self%scale = max(self%scale, maxval(abs(simulation%motion%motion%d)))
      call keep_state(simulation, self%coarse)
      self%coarse%n_events = 0
   end subroutine lead

   !> The ladder's coarse increment, fitted to what is left of the step: no sliver at its end.
   pure function within(self, left) result(dt)
      type(twins_type), intent(in) :: self
      real(wp), intent(in) :: left
      real(wp) :: dt

      dt = 2.0_wp*self%ladder%dt
      if (left - dt >= 0.1_wp*dt) return
      dt = left
      if (left > 2.0_wp*self%ladder%dt_max*(1.0_wp + round_off)) dt = left/2.0_wp
   end function within

   !> Local error of the displacement over what is allowed: for Newmark's method
   !> (beta - 1/6) h^2 (a1 - a0). After an event, where the acceleration may jump, that may be no
   !> error at all: an increment as long as the last one without passes too.
   function local_error(self, simulation, dt) result(ratio)
      type(twins_type), intent(in) :: self
      type(simulation_type), intent(in) :: simulation
      real(wp), intent(in) :: dt                 !! of the coarse increment
      real(wp) :: ratio
      real(wp) :: weight, scale

      ratio = 0.0_wp
      associate (from => self%coarse%motion%motion, to => simulation%motion%motion)
         weight = max(abs(simulation%scene%system%newmark%beta - 1.0_wp/6.0_wp), 1.0_wp/12.0_wp)
         scale = max(self%scale, maxval(abs(to%d)))
         if (.not. scale > 0.0_wp) return
         ratio = weight*dt**2*maxval(abs(to%a - from%a))/(self%settings%local_tolerance*scale)
         if (ratio < round_off/self%settings%local_tolerance) ratio = 0.0_wp
      end associate
      if (simulation%scene%n_events > self%coarse%n_events .and. dt <= self%proven) then
         ratio = min(ratio, 1.0_wp)
      end if
   end function local_error

   !> After an increment of the fine motion: how far the motions are apart where they meet.
   pure subroutine compare_twins(self, simulation)
      type(twins_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      real(wp) :: apart

      associate (d => simulation%motion%motion%d)
         self%scale = max(self%scale, maxval(abs(d)))
         if (self%step_time < self%coarse_time) return
         apart = maxval(abs(d - self%coarse%motion%motion%d))
         ! what is not a number counts as very far
         if (.not. apart <= huge(apart)) apart = huge(apart)
         self%difference = max(self%difference, apart)
      end associate
   end subroutine compare_twins

end module twin_motion
