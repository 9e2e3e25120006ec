!> Applied loads through the steps of a run: nodal forces, gravity, base motion.
module external_load
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use state_archive, only: archive_type
   use histories, only: amplitude_type, time_step, distributed_load_type, load_body, &
         load_centrifugal
   use amplitude_value, only: amplitude_at, amplitude_start, corner_after
   use model, only: model_type
   use steps, only: step_type, procedure_static
   use structure, only: structure_type
   use load_patterns, only: distributed_pattern, gravity_pattern, base_pattern
   implicit none
   private

   public :: load_set_type, begin_loads, load_at, next_load_corner
   public :: add_reactions, set_reactions

   !> A pattern of forces times a factor of time.
   type :: load_type
      integer :: kind = 0                        !! one of the kind_ parameters
      integer :: set = 0                         !! element set of gravity or a distributed load
      integer :: label = 0                       !! edge of a pressure, negative for other kinds
      real(wp), allocatable :: pattern(:)        !! (n_freedoms) at full size
      real(wp), allocatable :: start(:)          !! (n_freedoms) what it is ramped from
      logical :: ramped = .false.
      logical :: going = .false.                 !! dropped: it goes down over a static step
      logical :: has_amplitude = .false.
      type(amplitude_type) :: amplitude
      real(wp) :: t_start = 0.0_wp
      real(wp) :: duration = 1.0_wp
   end type load_type

   integer, parameter :: kind_point = 1
   integer, parameter :: kind_gravity = 2
   integer, parameter :: kind_base = 3
   integer, parameter :: kind_distributed = 4
   integer, parameter :: kind_reaction = 5

   !> All loads in force.
   type :: load_set_type
      type(load_type), allocatable :: loads(:)
   contains
      procedure :: pass_state
   end type load_set_type

contains

   !> What loads have taken from the motion, the reactions of supports that go; the rest is the
   !> deck's.
   subroutine pass_state(self, archive)
      class(load_set_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive
      integer :: i

      do i = 1, size(self%loads)
         if (self%loads(i)%kind == kind_reaction) call archive%pass_fixed('reactions', &
               self%loads(i)%start)
      end do
   end subroutine pass_state

   !> Brings the loads of a step into force. Loads of earlier steps go on unless the step says
   !> OP=NEW or loads the same freedom anew; without an amplitude a load is ramped over a static
   !> step and applied at once in a dynamic one. What OP=NEW drops goes in the same way.
   subroutine begin_loads(self, structure, model, i_step, t)
      type(load_set_type), intent(inout) :: self
      type(structure_type), intent(in) :: structure
      type(model_type), intent(in) :: model
      integer, intent(in) :: i_step
      real(wp), intent(in) :: t                  !! total time at the start of the step
      integer :: i, status

      if (.not. allocated(self%loads)) then
         allocate (self%loads(0), stat=status)
         call check_allocation(status)
      end if
      associate (step => model%steps(i_step))
         call hold_earlier(self, step, t)
         call add_point_loads(self, structure, model, step, t)
         call add_gravity(self, structure, model, step, t)
         call add_distributed(self, structure, model, step, t)
         do i = 1, size(step%base_motions)
            call append(self, kind_base, base_pattern(structure, step%base_motions(i)%dof, &
                  step%base_motions(i)%scale))
            call give_time(self%loads(size(self%loads)), model, step%base_motions(i)%amplitude, t, &
                  step)
         end do
      end associate
   end subroutine begin_loads

   !> Keeps what goes on: an amplitude on total time goes on by it, all else stays as it is. What a
   !> static step drops is ramped down from its size. A base motion ends with its step.
   subroutine hold_earlier(self, step, t)
      type(load_set_type), intent(inout) :: self
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: t
      type(load_type), allocatable :: kept(:)
      real(wp) :: weight(2)
      logical :: keep, going
      integer :: i, n, status

      allocate (kept(size(self%loads)), stat=status)
      call check_allocation(status)
      n = 0
      do i = 1, size(self%loads)
         keep = self%loads(i)%kind /= kind_base
         if (self%loads(i)%kind == kind_point) keep = .not. step%new_loads
         if (self%loads(i)%kind == kind_gravity) keep = .not. step%new_gravity
         if (self%loads(i)%kind == kind_distributed) keep = .not. step%new_distributed
         going = .not. keep .and. step%procedure == procedure_static .and. &
               self%loads(i)%kind /= kind_base
         if (self%loads(i)%going .or. .not. (keep .or. going)) cycle
         n = n + 1
         kept(n) = self%loads(i)
         if (keep .and. kept(n)%has_amplitude .and. kept(n)%amplitude%time /= time_step) cycle
         weight = weights(self%loads(i), t)
         kept(n)%pattern = weight(1)*self%loads(i)%start + weight(2)*self%loads(i)%pattern
         kept(n)%has_amplitude = .false.
         kept(n)%ramped = .false.
         if (going) call let_down(kept(n), step%duration, t)
      end do
      self%loads = kept(:n)
   end subroutine hold_earlier

   !> Ramps a load from its pattern down to nothing.
   pure subroutine let_down(load, duration, t)
      type(load_type), intent(inout) :: load
      real(wp), intent(in) :: duration           !! of the step
      real(wp), intent(in) :: t                  !! total time at its start

      load%start = load%pattern
      load%pattern = 0.0_wp
      load%ramped = .true.
      load%going = .true.
      load%t_start = t
      load%duration = duration
   end subroutine let_down

   !> Makes room for the reactions of supports that a static step drops: they go down over it.
   subroutine add_reactions(self, n_freedoms, duration, t)
      type(load_set_type), intent(inout) :: self
      integer, intent(in) :: n_freedoms
      real(wp), intent(in) :: duration           !! of the step
      real(wp), intent(in) :: t                  !! total time at its start
      real(wp) :: none(n_freedoms)

      none = 0.0_wp
      call append(self, kind_reaction, none)
      call let_down(self%loads(size(self%loads)), duration, t)
   end subroutine add_reactions

   !> Gives supports that go the reactions they have had.
   pure subroutine set_reactions(self, reaction)
      type(load_set_type), intent(inout) :: self
      real(wp), intent(in) :: reaction(:)        !! (n_freedoms)
      integer :: i

      do i = 1, size(self%loads)
         if (self%loads(i)%kind == kind_reaction) self%loads(i)%start = reaction
      end do
   end subroutine set_reactions

   !> Gravity on a set replaces that of earlier steps on the same set.
   subroutine add_gravity(self, structure, model, step, t)
      type(load_set_type), intent(inout) :: self
      type(structure_type), intent(in) :: structure
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: t
      integer :: i, n_earlier

      n_earlier = size(self%loads)
      do i = 1, size(step%gravity)
         call append(self, kind_gravity, gravity_pattern(structure, model, step%gravity(i)%set, &
               step%gravity(i)%acceleration))
         self%loads(size(self%loads))%set = step%gravity(i)%set
         call replace_earlier(self, n_earlier, model, step, step%gravity(i)%amplitude, t)
      end do
   end subroutine add_gravity

   !> Pressures, body forces and rotations; each replaces that of earlier steps with its set and
   !> label.
   subroutine add_distributed(self, structure, model, step, t)
      type(load_set_type), intent(inout) :: self
      type(structure_type), intent(in) :: structure
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: t
      integer :: i, n_earlier

      n_earlier = size(self%loads)
      do i = 1, size(step%distributed)
         associate (load => step%distributed(i))
            call append(self, kind_distributed, distributed_pattern(structure, model, load))
            self%loads(size(self%loads))%set = load%set
            self%loads(size(self%loads))%label = label_of(load)
            call replace_earlier(self, n_earlier, model, step, load%amplitude, t)
         end associate
      end do
   end subroutine add_distributed

   !> What tells distributed loads on one set apart: the edge, the direction of a body force.
   pure function label_of(load) result(label)
      type(distributed_load_type), intent(in) :: load
      integer :: label

      label = load%edge
      if (load%kind == load_body) label = -1 - findloc(abs(load%body) > 0.0_wp, .true., dim=1)
      if (load%kind == load_centrifugal) label = -9
   end function label_of

   !> The load appended last takes the place of those of the same kind, set and label among the
   !> first `n_earlier`: ramped, it starts from their size.
   subroutine replace_earlier(self, n_earlier, model, step, amplitude, t)
      type(load_set_type), intent(inout) :: self
      integer, intent(in) :: n_earlier
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      integer, intent(in) :: amplitude
      real(wp), intent(in) :: t
      real(wp) :: weight(2)
      integer :: j, last

      last = size(self%loads)
      call give_time(self%loads(last), model, amplitude, t, step)
      do j = 1, n_earlier
         if (self%loads(j)%kind /= self%loads(last)%kind) cycle
         if (self%loads(j)%set /= self%loads(last)%set) cycle
         if (self%loads(j)%label /= self%loads(last)%label) cycle
         weight = weights(self%loads(j), t)
         if (self%loads(last)%ramped) self%loads(last)%start = self%loads(last)%start &
               + weight(1)*self%loads(j)%start + weight(2)*self%loads(j)%pattern
         self%loads(j)%start = 0.0_wp
         self%loads(j)%pattern = 0.0_wp
      end do
   end subroutine replace_earlier

   !> Loads on one freedom in one step add up; they replace those of earlier steps there.
   subroutine add_point_loads(self, structure, model, step, t)
      type(load_set_type), intent(inout) :: self
      type(structure_type), intent(in) :: structure
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: t
      real(wp), dimension(structure%map%n_freedoms) :: earlier, pattern, start
      integer :: i, f, a, last

      earlier = 0.0_wp
      do i = 1, size(step%loads)
         f = structure%map%freedom(step%loads(i)%dof, step%loads(i)%node)
         if (f > 0) call take_over(self, f, t, earlier)
      end do
      do a = 0, size(model%amplitudes)
         pattern = 0.0_wp
         start = 0.0_wp
         if (.not. any(step%loads%amplitude == a)) cycle
         do i = 1, size(step%loads)
            if (step%loads(i)%amplitude /= a) cycle
            f = structure%map%freedom(step%loads(i)%dof, step%loads(i)%node)
            if (f == 0) cycle               ! a load of zero may name a freedom that is none
            pattern(f) = pattern(f) + step%loads(i)%value
            start(f) = earlier(f)
         end do
         call append(self, kind_point, pattern)
         last = size(self%loads)
         call give_time(self%loads(last), model, a, t, step)
         if (self%loads(last)%ramped) self%loads(last)%start = start
      end do
   end subroutine add_point_loads

   !> Removes earlier point loads on freedom f and remembers their size.
   subroutine take_over(self, f, t, earlier)
      type(load_set_type), intent(inout) :: self
      integer, intent(in) :: f
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: earlier(:)
      integer :: i

      do i = 1, size(self%loads)
         if (self%loads(i)%kind /= kind_point) cycle
         earlier(f) = earlier(f) + dot_product(weights(self%loads(i), t), &
               [self%loads(i)%start(f), self%loads(i)%pattern(f)])
         self%loads(i)%start(f) = 0.0_wp
         self%loads(i)%pattern(f) = 0.0_wp
      end do
   end subroutine take_over

   subroutine append(self, kind, pattern)
      type(load_set_type), intent(inout) :: self
      integer, intent(in) :: kind
      real(wp), intent(in) :: pattern(:)
      type(load_type), allocatable :: longer(:)
      integer :: n, status

      n = size(self%loads)
      allocate (longer(n + 1), stat=status)
      call check_allocation(status)
      longer(:n) = self%loads
      longer(n + 1)%kind = kind
      longer(n + 1)%pattern = pattern
      longer(n + 1)%start = 0.0_wp*pattern
      call move_alloc(longer, self%loads)
   end subroutine append

   pure subroutine give_time(load, model, amplitude, t, step)
      type(load_type), intent(inout) :: load
      type(model_type), intent(in) :: model
      integer, intent(in) :: amplitude
      real(wp), intent(in) :: t
      type(step_type), intent(in) :: step

      load%t_start = t
      load%duration = step%duration
      load%has_amplitude = amplitude > 0
      if (load%has_amplitude) load%amplitude = model%amplitudes(amplitude)
      load%ramped = step%procedure == procedure_static .and. .not. load%has_amplitude
   end subroutine give_time

   !> All applied forces at total time t.
   pure function load_at(self, n_freedoms, t) result(force)
      type(load_set_type), intent(in) :: self
      integer, intent(in) :: n_freedoms
      real(wp), intent(in) :: t
      real(wp) :: force(n_freedoms)
      real(wp) :: weight(2)
      integer :: i

      force = 0.0_wp
      do i = 1, size(self%loads)
         weight = weights(self%loads(i), t)
         if (abs(weight(1)) > 0.0_wp) force = force + weight(1)*self%loads(i)%start
         force = force + weight(2)*self%loads(i)%pattern
      end do
   end function load_at

   !> The first total time after t at which an amplitude of a load has a corner, huge if none has.
   pure function next_load_corner(self, t) result(corner)
      type(load_set_type), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp) :: corner
      integer :: i

      corner = huge(corner)
      do i = 1, size(self%loads)
         associate (load => self%loads(i))
            if (load%has_amplitude) corner = min(corner, &
                  corner_after(load%amplitude, load%t_start, t))
         end associate
      end do
   end function next_load_corner

   !> Shares of a load's start and pattern in its size at time t.
   pure function weights(load, t) result(weight)
      type(load_type), intent(in) :: load
      real(wp), intent(in) :: t
      real(wp) :: weight(2)

      weight = [0.0_wp, 1.0_wp]
      if (load%ramped) then
         weight(2) = (t - load%t_start)/load%duration
         weight(1) = 1.0_wp - weight(2)
      else if (load%has_amplitude) then
         weight(2) = amplitude_at(load%amplitude, t - amplitude_start(load%amplitude, &
               load%t_start))
      end if
   end function weights

end module external_load
