!> What an impact method works on: the system in motion, the contact rows, the energy account and
!> the record of events.
module impact_scene
   use kinds, only: wp, int64
   use state_archive, only: archive_type
   use memory_shortage, only: check_allocation
   use text, only: to_text
   use surfaces, only: beta_automatic, method_transformation, method_penalty
   use contact_motion, only: contact_motion_type, new_contact_motion, copy_contact_motion, &
         exchange_motions
   use equation_of_motion, only: system_type
   use energy_ledger, only: ledger_type, record_span, take_back_damping, record_impact, &
         record_friction, record_springs, contact_moves
   use explicit_motion, only: explicit_motion_type
   use compliance_store, only: compliance_store_type, complex_columns_type
   use contact_geometry, only: contact_geometry_type
   use constraint_rows, only: rows_type, row_rates, row_accelerations, row_curvature, &
         acceleration_size, contact_forces, slip_increments, slip_products, wall_work, law_penalty
   implicit none
   private

   public :: scene_type, contact_motion_type, event_type, impact_settings_type, anchor_type
   public :: event_impact, event_capture, event_release, event_contact, event_limit
   public :: new_contact_motion, record_event, record_residual, accept_span, capture_speeds
   public :: note_contact_force, opening_rows, let_go, copy_contact_motion, exchange_motions

   integer, parameter :: event_impact = 1     !! velocity jump
   integer, parameter :: event_capture = 2    !! a row begins sustained contact
   integer, parameter :: event_release = 3    !! a row ends sustained contact
   integer, parameter :: event_contact = 4    !! first overlap: fictitious force, penalty
   integer, parameter :: event_limit = 5      !! the limit of events in a step was reached

   !> Iterations whose residuals are remembered.
   integer, parameter :: max_residuals = 50

   !> Relative tolerances, each on the size of the numbers its quantity is a difference of.
   real(wp), parameter, public :: gap_tolerance = 1.0e-12_wp
   real(wp), parameter, public :: merge_gap_tolerance = 1.0e-9_wp
   real(wp), parameter, public :: rate_tolerance = 1.0e-12_wp
   real(wp), parameter, public :: acceleration_tolerance = 1.0e-12_wp
   !> Impacts and releases this close, in parts of the step, happen together.
   real(wp), parameter, public :: merge_time_tolerance = 1.0e-6_wp

   !> The bounces that are left out shift impulses of their size by their length, an error of second
   !> order; with fourth order this part of the speed makes it a millionth of that.
   real(wp), parameter :: finer_capture = 1.0e-3_wp

   !> One thing that happened in one row.
   type :: event_type
      real(wp) :: time = 0.0_wp
      integer :: kind = 0                        !! one of the event_ parameters
      integer :: row = 0
      real(wp) :: rate_before = 0.0_wp           !! gap rate
      real(wp) :: rate_after = 0.0_wp
      real(wp) :: impulse = 0.0_wp
      real(wp) :: beta = 0.0_wp                  !! of the impact step
      integer(int64) :: n_solves = 0             !! of the run up to then
      integer(int64) :: n_factorizations = 0
   contains
      procedure :: pass_state => pass_event
   end type event_type

   !> What the deck says of the method.
   type :: impact_settings_type
      integer :: method = method_transformation
      integer :: beta_choice = beta_automatic
      real(wp) :: beta = 0.0_wp
      integer :: max_events = 100
      logical :: fictitious = .false.            !! overlapping rows get a fictitious force
      logical :: iterated = .false.              !! found by an iteration: no friction
      logical :: pure = .false.                  !! of some rows without restitution
      real(wp) :: return_parameter = 0.3_wp      !! alpha
      logical :: direct = .false.
      logical :: locate_release = .true.
      logical :: anchored = .false.              !! EVENTS=ANCHOR
      logical :: fourth_order = .false.          !! ORDER=4
   end type impact_settings_type

   !> The step at hand of a motion whose steps begin at events, not at the deck's times: from one
   !> state to another, after which something may happen.
   type :: anchor_type
      logical :: running = .false.               !! the step reaches beyond the deck's time
      real(wp) :: dt = 0.0_wp                    !! every step's size
      type(contact_motion_type) :: from, to
      logical, allocatable :: held(:)            !! (n_rows) rows that touch to the end
      logical, allocatable :: hit(:)             !! (n_rows) rows that are hit then
      logical, allocatable :: release(:)         !! (n_rows) rows that let go then
   contains
      procedure :: pass_state => pass_anchor
   end type anchor_type

   !> Everything an impact method needs besides the motion.
   type :: scene_type
      type(system_type) :: system
      type(rows_type) :: rows
      type(contact_geometry_type) :: geometry
      type(compliance_store_type) :: compliances
      type(complex_columns_type) :: held         !! of steps of fourth order
      type(impact_settings_type) :: settings
      type(ledger_type) :: ledger
      type(explicit_motion_type) :: explicit     !! of steps that are wholly explicit
      type(anchor_type) :: anchor
      type(contact_motion_type) :: spare         !! arrays for the next motion
      type(event_type), allocatable :: events(:) !! grown by doubling
      integer :: n_events = 0                    !! since the last time they were fetched
      real(wp) :: dt = 0.0_wp                    !! of the increment at hand
      real(wp) :: whole_step = 0.0_wp            !! fourth order: the step whose factors are kept
      real(wp), allocatable :: impulse(:)        !! (n_rows) of the increment at hand
      real(wp), allocatable :: curvature(:)      !! (n_rows) part of the gap acceleration at its end
      integer :: n_residuals = 0                 !! Newton iterations of the last solution
      real(wp) :: residuals(max_residuals) = 0.0_wp   !! after each, of the largest force
      integer(int64) :: n_iterations = 0         !! of Newton's method and of the fictitious force
      integer(int64) :: n_cycles = 0             !! of them that did not settle on a set of rows
   contains
      procedure :: pass_state => pass_scene
   end type scene_type

contains

   !> All of it.
   subroutine pass_event(self, archive)
      class(event_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%pass('time', self%time)
      call archive%pass('kind', self%kind)
      call archive%pass('row', self%row)
      call archive%pass('rate_before', self%rate_before)
      call archive%pass('rate_after', self%rate_after)
      call archive%pass('impulse', self%impulse)
      call archive%pass('beta', self%beta)
      call archive%pass('n_solves', self%n_solves)
      call archive%pass('n_factorizations', self%n_factorizations)
   end subroutine pass_event

   !> All of it.
   subroutine pass_anchor(self, archive)
      class(anchor_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%pass('running', self%running)
      call archive%pass('dt', self%dt)
      call archive%enter('from')
      call self%from%pass_state(archive)
      call archive%leave()
      call archive%enter('to')
      call self%to%pass_state(archive)
      call archive%leave()
      call archive%pass('held', self%held)
      call archive%pass('hit', self%hit)
      call archive%pass('release', self%release)
   end subroutine pass_anchor

   !> What is neither the deck's nor kept of solutions nor counted; without the conditions.
   subroutine pass_scene(self, archive)
      class(scene_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%enter('ledger')
      call self%ledger%pass_state(archive)
      call archive%leave()
      call archive%enter('rows')
      call self%rows%pass_state(archive)
      call archive%leave()
      call archive%enter('search')
      call self%geometry%pass_state(archive)
      call archive%leave()
      call archive%enter('explicit')
      call self%explicit%pass_state(archive)
      call archive%leave()
      call archive%enter('anchor')
      call self%anchor%pass_state(archive)
      call archive%leave()
      call archive%enter('scene')
      call archive%pass('dt', self%dt)
      call archive%pass('whole_step', self%whole_step)
      call archive%pass('curvature', self%curvature)
      call archive%leave()
      call pass_events(self, archive)
   end subroutine pass_scene

   !> Events that have not been fetched: those at the start of a step wait for its first increment.
   subroutine pass_events(self, archive)
      class(scene_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive
      integer :: i, status

      call archive%enter('waiting')
      call archive%pass('n', self%n_events)
      if (archive%reading .and. self%n_events > 0) then
         if (allocated(self%events)) deallocate (self%events)
         allocate (self%events(max(16, self%n_events)), stat=status)
         call check_allocation(status)
      end if
      do i = 1, self%n_events
         call archive%enter(to_text(i))
         call self%events(i)%pass_state(archive)
         call archive%leave()
      end do
      call archive%leave()
   end subroutine pass_events

   !> Remembers the residual after a Newton iteration.
   pure subroutine record_residual(scene, iteration, residual)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: iteration
      real(wp), intent(in) :: residual           !! relative

      scene%n_iterations = scene%n_iterations + 1
      scene%n_residuals = min(iteration, max_residuals)
      scene%residuals(scene%n_residuals) = residual
   end subroutine record_residual

   !> Notes an event, and how much has been solved until then.
   pure subroutine record_event(scene, event)
      type(scene_type), intent(inout) :: scene
      type(event_type), intent(in) :: event
      type(event_type), allocatable :: longer(:)
      integer :: status

      if (.not. allocated(scene%events)) then
         allocate (scene%events(16), stat=status)
         call check_allocation(status)
      end if
      if (scene%n_events == size(scene%events)) then
         allocate (longer(2*size(scene%events)), stat=status)
         call check_allocation(status)
         longer(:scene%n_events) = scene%events
         call move_alloc(longer, scene%events)
      end if
      scene%n_events = scene%n_events + 1
      scene%events(scene%n_events) = event
      scene%events(scene%n_events)%n_solves = scene%system%matrices%n_solves
      scene%events(scene%n_events)%n_factorizations = scene%system%matrices%n_factorizations
   end subroutine record_event

   !> Keeps the contact forces that the acceleration holds.
   pure subroutine note_contact_force(scene, motion)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(inout) :: motion

      motion%force = contact_forces(scene%rows, motion%lambda, motion%tau, size(motion%motion%d))
   end subroutine note_contact_force

   !> Takes a span of smooth motion as it is: its works, slip and contact impulses are booked.
   subroutine accept_span(scene, from, to)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: from
      type(contact_motion_type), intent(inout) :: to
      real(wp), dimension(scene%rows%n) :: slip, share, tau
      real(wp) :: force(size(from%force)), work
      logical :: springs

      springs = scene%settings%method == method_penalty
      force = from%force
      if (allocated(from%carried)) force = force + from%carried
      call record_span(scene%ledger, scene%system, from%motion, to%motion, force, to%force, &
            springs)
      call take_back_damping(scene%ledger, from%motion, to%motion, from%left_out)
      scene%impulse = scene%impulse + (to%motion%t - from%motion%t)*(from%lambda &
            + scene%system%newmark%gamma*(to%lambda - from%lambda))
      share = scene%system%newmark%gamma
      where (scene%rows%massless .or. scene%system%static .or. springs) share = 0.5_wp
      tau = from%tau + share*(to%tau - from%tau)
      if (any(scene%rows%amplitude > 0)) then
         work = wall_work(scene%rows, from%motion, to%motion, &
               from%lambda + share*(to%lambda - from%lambda), tau)
         call record_impact(scene%ledger, work, work)
      end if
      call record_springs(scene%ledger, [spring_energy(scene, to%lambda), &
            spring_energy(scene, to%tau)])
      if (.not. any(scene%rows%friction > 0.0_wp)) return
      slip = slip_increments(scene%rows, from%motion, to%motion)
      call record_friction(scene%ledger, -dot_product(tau, slip + slip_products(scene%rows, &
            contact_moves(scene%system, from%motion, to%motion, springs) &
            - (to%motion%d - from%motion%d))))
      where (to%lambda > 0.0_wp) to%slip = to%slip + abs(slip)
   end subroutine accept_span

   !> Energy of contact springs under forces along them.
   pure function spring_energy(scene, force) result(energy)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: force(:)           !! (n_rows)
      real(wp) :: energy
      integer :: i

      energy = 0.0_wp
      do i = 1, scene%rows%n
         if (scene%rows%law(i) /= law_penalty) cycle
         energy = energy + force(i)**2/(2.0_wp*scene%rows%stiffness(i))
      end do
   end function spring_energy

   !> Speed below which a rebound is captured, by rows: the deck's, or such that all the bounces
   !> that
   !> would follow, 2 u / (closing (1 - e)) long together, fit into one step.
   pure function capture_speeds(scene, a, dt) result(limits)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: a(:)               !! (n_freedoms) acceleration after the impact
      real(wp), intent(in) :: dt                 !! the whole step
      real(wp) :: limits(scene%rows%n)

      limits = dt/2.0_wp*max(0.0_wp, -row_accelerations(scene%rows, a)) &
            *max(1.0e-3_wp, 1.0_wp - scene%rows%restitution)
      if (scene%settings%fourth_order) limits = finer_capture*limits
      where (scene%rows%capture >= 0.0_wp) limits = scene%rows%capture
   end function capture_speeds

   !> Touching rows that nothing presses and that open.
   pure function opening_rows(scene, from, to) result(opening)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: from, to
      logical :: opening(scene%rows%n)

      opening = from%touching .and. .not. to%lambda > 0.0_wp .and. &
            row_accelerations(scene%rows, to%motion%a) + row_curvature(scene%rows, to%motion) > &
            acceleration_tolerance*acceleration_size(scene%rows, to%motion%a)
   end function opening_rows

   !> Rows touch no more.
   subroutine let_go(scene, motion, opening)
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(inout) :: motion
      logical, intent(in) :: opening(:)          !! (n_rows)
      real(wp) :: rates(scene%rows%n)
      integer :: i

      if (.not. any(opening)) return
      rates = row_rates(scene%rows, motion%motion)
      motion%touching = motion%touching .and. .not. opening
      do i = 1, scene%rows%n
         if (opening(i)) call record_event(scene, event_type(motion%motion%t, event_release, i, &
               rates(i), rates(i), 0.0_wp, scene%system%newmark%beta))
      end do
   end subroutine let_go

end module impact_scene
