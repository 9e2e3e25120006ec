!> Applied loads through the steps of a run: nodal forces, gravity, base motion.
module external_load
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use histories, only: amplitude_type, time_step, distributed_load_type, load_pressure, &
         load_body, load_centrifugal
   use amplitude_value, only: amplitude_at, amplitude_start, corner_after
   use model, only: model_type
   use steps, only: step_type, procedure_static
   use structure, only: structure_type, inertia_force
   implicit none
   private

   public :: load_set_type, begin_loads, load_at, next_load_corner

   !> A pattern of forces times a factor of time.
   type :: load_type
      integer :: kind = 0                        !! one of the kind_ parameters
      integer :: set = 0                         !! element set of gravity or a distributed load
      integer :: label = 0                       !! edge of a pressure, negative for other kinds
      real(wp), allocatable :: pattern(:)        !! (n_freedoms) at full size
      real(wp), allocatable :: start(:)          !! (n_freedoms) what it is ramped from
      logical :: ramped = .false.
      logical :: has_amplitude = .false.
      type(amplitude_type) :: amplitude
      real(wp) :: t_start = 0.0_wp
      real(wp) :: duration = 1.0_wp
   end type load_type

   integer, parameter :: kind_point = 1
   integer, parameter :: kind_gravity = 2
   integer, parameter :: kind_base = 3
   integer, parameter :: kind_distributed = 4

   !> All loads in force.
   type :: load_set_type
      type(load_type), allocatable :: loads(:)
   end type load_set_type

contains

   !> Brings the loads of a step into force. Loads of earlier steps go on unless the step says
   !> OP=NEW or loads the same freedom anew; without an amplitude a load is ramped over a static
   !> step and applied at once in a dynamic one.
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

   !> Keeps what goes on: an amplitude on total time goes on by it, all else stays as it is. A
   !> base motion ends with its step.
   subroutine hold_earlier(self, step, t)
      type(load_set_type), intent(inout) :: self
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: t
      type(load_type), allocatable :: kept(:)
      real(wp) :: weight(2)
      logical :: keep
      integer :: i, n, status

      allocate (kept(size(self%loads)), stat=status)
      call check_allocation(status)
      n = 0
      do i = 1, size(self%loads)
         keep = self%loads(i)%kind /= kind_base
         if (self%loads(i)%kind == kind_point) keep = .not. step%new_loads
         if (self%loads(i)%kind == kind_gravity) keep = .not. step%new_gravity
         if (self%loads(i)%kind == kind_distributed) keep = .not. step%new_distributed
         if (.not. keep) cycle
         n = n + 1
         kept(n) = self%loads(i)
         if (kept(n)%has_amplitude .and. kept(n)%amplitude%time /= time_step) cycle
         weight = weights(self%loads(i), t)
         kept(n)%pattern = weight(1)*self%loads(i)%start + weight(2)*self%loads(i)%pattern
         kept(n)%has_amplitude = .false.
         kept(n)%ramped = .false.
      end do
      self%loads = kept(:n)
   end subroutine hold_earlier

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

   !> Nodal forces of a distributed load on the elements of its set (0: all).
   function distributed_pattern(structure, model, load) result(pattern)
      type(structure_type), intent(in) :: structure
      type(model_type), intent(in) :: model
      type(distributed_load_type), intent(in) :: load
      real(wp) :: pattern(structure%map%n_freedoms)
      logical :: member(model%elements%n), exists
      real(wp), allocatable :: local(:)
      integer :: g, e, status

      member = load%set == 0
      if (load%set > 0) member(model%element_sets(load%set)%members) = .true.
      pattern = 0.0_wp
      do g = 1, size(structure%groups)
         associate (group => structure%groups(g))
            allocate (local(size(group%lm, 1)), stat=status)
            call check_allocation(status)
            do e = 1, size(group%member)
               if (.not. member(group%member(e))) cycle
               select case (load%kind)
               case (load_pressure)
                  call group%element%edge_load(e, load%edge, load%value, local, exists)
               case (load_body)
                  call group%element%body_load(e, load%body, local)
               case default
                  call group%element%centrifugal_load(e, load%value, load%point, load%axis, local)
               end select
               call scatter_one(group%lm(:, e), local, pattern)
            end do
            deallocate (local)
         end associate
      end do
   end function distributed_pattern

   pure subroutine scatter_one(lm, local, force)
      integer, intent(in) :: lm(:)
      real(wp), intent(in) :: local(:)
      real(wp), intent(inout) :: force(:)
      integer :: i

      do i = 1, size(lm)
         if (lm(i) > 0) force(lm(i)) = force(lm(i)) + local(i)
      end do
   end subroutine scatter_one

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

   !> M times the acceleration, on the elements of a set (0: all). Weight stays with the elements:
   !> where contact nodes have lost their mass, they keep their load.
   function gravity_pattern(structure, model, set, acceleration) result(pattern)
      type(structure_type), intent(in) :: structure
      type(model_type), intent(in) :: model
      integer, intent(in) :: set
      real(wp), intent(in) :: acceleration(3)
      real(wp) :: pattern(structure%map%n_freedoms)
      logical :: member(model%elements%n)
      real(wp), allocatable :: m(:, :)
      integer :: g, e, i, status

      member = set == 0
      if (set > 0) member(model%element_sets(set)%members) = .true.
      pattern = 0.0_wp
      do g = 1, size(structure%groups)
         associate (group => structure%groups(g))
            i = size(group%lm, 1)
            allocate (m(i, i), stat=status)
            call check_allocation(status)
            do e = 1, size(group%member)
               if (.not. member(group%member(e))) cycle
               call group%element%mass(e, group%lumped, m)
               m(:, 1) = matmul(m, [(acceleration(modulo(i - 1, 3) + 1), i=1, size(m, 1))])
               do i = 1, size(m, 1)
                  if (group%lm(i, e) == 0) cycle
                  pattern(group%lm(i, e)) = pattern(group%lm(i, e)) + m(i, 1)
               end do
            end do
            deallocate (m)
         end associate
      end do
   end function gravity_pattern

   !> -M r: inertia of a ground acceleration of unit size along one direction.
   function base_pattern(structure, dof, scale) result(pattern)
      type(structure_type), intent(in) :: structure
      integer, intent(in) :: dof
      real(wp), intent(in) :: scale
      real(wp) :: pattern(structure%map%n_freedoms)
      real(wp) :: along(structure%map%n_freedoms)

      along = merge(scale, 0.0_wp, structure%map%dof == dof)
      pattern = -inertia_force(structure, along)
   end function base_pattern

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
