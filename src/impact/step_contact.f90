!> Contact and friction forces of a step, found together on the compliance of the rows that take
!> part: rows that touch are held at the level of accelerations; rows whose law speaks of the gap at
!> the end of the step take part once they overlap.
module step_contact
   use kinds, only: wp
   use errors, only: error_type, new_error, status_numerical
   use text, only: to_text
   use rough_rows, only: solve_rows
   use constraint_rows, only: row_gaps, row_accelerations, slip_products, slip_rates, &
         slip_increments, sliding_speeds, sticks, gap_size, law_motion, law_closed, law_penalty, &
         law_overlap
   use impact_scene, only: scene_type, contact_motion_type, gap_tolerance
   use row_compliance, only: compliance_type, find_compliance, pushed, join_rates, split_forces
   use contact_room, only: no_room, room_tolerance
   implicit none
   private

   public :: contact_step_type, add_contact_forces, dependent_rows

   !> The step in which forces are sought. The unknown motion is an acceleration; in a static step a
   !> displacement.
   type :: contact_step_type
      logical :: static = .false.
      logical :: explicit = .false.              !! forces at the end do not move the end
      real(wp) :: to_displacement = 1.0_wp       !! beta h^2: displacement by acceleration
      real(wp) :: to_velocity = 1.0_wp           !! gamma h
      logical, allocatable :: held(:)            !! (n_rows) held bilaterally; without it rows push
   end type contact_step_type

   !> Explicit steps (beta = 0) find penalty forces from the predictor: as with so small a beta.
   real(wp), parameter, public :: smallest_beta = 1.0e-12_wp

contains

   !> Adds contact forces to the change of the motion. Rows that overlap join until none is left.
   subroutine add_contact_forces(scene, step, from, to, delta, error)
      type(scene_type), intent(inout) :: scene
      type(contact_step_type), intent(in) :: step
      type(contact_motion_type), intent(in) :: from       !! at the start of the step
      type(contact_motion_type), intent(inout) :: to      !! at this Newton iteration
      real(wp), intent(inout) :: delta(:)                 !! (n_freedoms) change of motion
      type(error_type), allocatable, intent(out) :: error
      type(compliance_type) :: compliance
      logical, dimension(scene%rows%n) :: touching, closing, eligible, overlapping
      real(wp) :: gaps(scene%rows%n), free(size(delta)), limit
      integer :: i

      to%lambda = 0.0_wp
      to%tau = 0.0_wp
      touching = to%touching
      if (allocated(step%held)) touching = step%held
      eligible = on_displacement(scene, step) .and. scene%rows%facing .and. .not. &
            (to%touching .or. to%leaving)
      closing = .false.
      limit = 0.0_wp
      if (any(eligible)) limit = gap_tolerance*gap_size(scene%rows, to%motion, 0.0_wp)
      free = delta
      do
         if (any(touching .or. closing)) then
            call find_compliance(scene, pack([(i, i=1, scene%rows%n)], touching .or. closing), &
                  compliance)
            delta = free
            call find_forces(scene, step, from, to, compliance, delta, error)
            if (allocated(error)) return
         end if
         if (.not. any(eligible)) exit
         gaps = row_gaps(scene%rows, to%motion) &
               + step%to_displacement*row_accelerations(scene%rows, delta)
         overlapping = eligible .and. .not. closing .and. gaps < -limit
         if (.not. any(overlapping)) exit
         closing = closing .or. overlapping
      end do
      to%sticking = sticks(scene%rows, to%lambda, to%tau)
   end subroutine add_contact_forces

   !> Rows whose force follows from the gap at the end of the step; in a static step all do. The
   !> fictitious force without friction is found by an iteration of its own.
   pure function on_displacement(scene, step) result(on)
      type(scene_type), intent(in) :: scene
      type(contact_step_type), intent(in) :: step
      logical :: on(scene%rows%n)

      on = scene%rows%law == law_closed .and. (scene%rows%massless .or. .not. step%explicit)
      on = on .or. scene%rows%law == law_penalty
      if (any(scene%rows%friction > 0.0_wp)) on = on .or. scene%rows%law == law_overlap
      on = on .or. step%static
   end function on_displacement

   !> Forces of the rows of a compliance, and the motion they add.
   subroutine find_forces(scene, step, from, to, compliance, delta, error)
      type(scene_type), intent(inout) :: scene
      type(contact_step_type), intent(in) :: step
      type(contact_motion_type), intent(in) :: from
      type(contact_motion_type), intent(inout) :: to
      type(compliance_type), intent(in) :: compliance
      real(wp), intent(inout) :: delta(:)
      type(error_type), allocatable, intent(out) :: error
      real(wp), dimension(size(compliance%w, 1)) :: q, forces
      real(wp) :: w(size(q), size(q))
      logical :: bilateral(compliance%n), solved

      w = compliance%w
      call set_law(scene, step, to%touching, compliance, w)
      q = join_rates(compliance, normal_motion(scene, step, to, delta), &
            slip_motion(scene, step, from, to, delta))
      bilateral = .false.
      if (allocated(step%held)) bilateral = step%held(compliance%rows)
      call solve_rows(w, q, scene%rows%friction(compliance%rows), bilateral, forces, solved)
      if (.not. solved) then
         call dependent_rows(scene, to%motion%t, error)
         return
      end if
      call split_forces(compliance, forces, to%lambda, to%tau)
      delta = delta + pushed(scene, compliance, forces)
      call check_room(scene, compliance, step%to_displacement*(matmul(w, forces) + q), &
            step%to_displacement*maxval(abs(q)), to%motion%t, error)
   end subroutine find_forces

   !> Fictitious forces of rows that no motion can open together do not exist. (Of rows that are
   !> closed the gaps are looked at when they are put right.)
   subroutine check_room(scene, compliance, missing, largest, t, error)
      type(scene_type), intent(in) :: scene
      type(compliance_type), intent(in) :: compliance
      real(wp), intent(in) :: missing(:)         !! gaps that the forces leave less what they should
      real(wp), intent(in) :: largest            !! of the gaps without them
      real(wp), intent(in) :: t
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, compliance%n
         if (scene%rows%law(compliance%rows(i)) /= law_overlap) cycle
         if (missing(i) >= -room_tolerance*largest) cycle
         call no_room(scene%rows%node_id(compliance%rows(i)), t, -missing(i), error)
         return
      end do
   end subroutine check_room

   !> What the law of a row adds to its compliance: the spring of a penalty; for the fictitious
   !> force ((1 + alpha)/alpha) W, so that the overlap left is g_free/(1 + alpha).
   pure subroutine set_law(scene, step, touching, compliance, w)
      type(scene_type), intent(in) :: scene
      type(contact_step_type), intent(in) :: step
      logical, intent(in) :: touching(:)         !! (n_rows) held at the level of accelerations
      type(compliance_type), intent(in) :: compliance
      real(wp), intent(inout) :: w(:, :)
      logical :: pulled(compliance%n)
      real(wp) :: spring, factor
      integer :: i, j

      factor = 1.0_wp + 1.0_wp/scene%settings%return_parameter
      pulled = scene%rows%law(compliance%rows) == law_overlap .and. .not. step%static .and. .not. &
            touching(compliance%rows)
      do j = 1, compliance%n
         do i = 1, compliance%n
            if (pulled(i) .and. pulled(j)) w(i, j) = factor*w(i, j)
         end do
         if (scene%rows%law(compliance%rows(j)) /= law_penalty) cycle
         spring = 1.0_wp/(scene%rows%stiffness(compliance%rows(j))*step%to_displacement)
         w(j, j) = w(j, j) + spring
         if (size(compliance%rough) == 0) cycle
         associate (k => compliance%n + j)
            w(k, k) = w(k, k) + spring
         end associate
      end do
   end subroutine set_law

   !> Motion along the normals without the forces sought: gap accelerations of touching rows, gaps
   !> as accelerations of the others.
   function normal_motion(scene, step, to, delta) result(motion)
      type(scene_type), intent(in) :: scene
      type(contact_step_type), intent(in) :: step
      type(contact_motion_type), intent(in) :: to
      real(wp), intent(in) :: delta(:)
      real(wp) :: motion(scene%rows%n)
      logical :: on(scene%rows%n)

      on = on_displacement(scene, step) .and. .not. to%touching
      motion = merge(row_gaps(scene%rows, to%motion)/step%to_displacement, &
            row_accelerations(scene%rows, to%motion%a), on)
      if (.not. step%static) motion = motion + merge(0.0_wp, scene%curvature, on)
      motion = motion + row_accelerations(scene%rows, delta)
   end function normal_motion

   !> Slip without the forces sought, as accelerations: what is to vanish where a row sticks. With
   !> inertia that is the slip rate at the end of the step; once it sticks the slip acceleration
   !> (asking for the rate again would let the force swing from step to step); without inertia the
   !> slip over the step; with a penalty the slip less what its spring has given before.
   function slip_motion(scene, step, from, to, delta) result(motion)
      type(scene_type), intent(in) :: scene
      type(contact_step_type), intent(in) :: step
      type(contact_motion_type), intent(in) :: from, to
      real(wp), intent(in) :: delta(:)
      real(wp) :: motion(scene%rows%n)
      real(wp) :: jump(scene%rows%n)
      logical, dimension(scene%rows%n) :: by_slip, changed

      motion = 0.0_wp
      if (.not. any(scene%rows%friction > 0.0_wp)) return
      by_slip = scene%rows%massless .or. scene%rows%law == law_penalty .or. step%static
      motion = slip_increments(scene%rows, from%motion, to%motion)
      where (scene%rows%law == law_penalty) motion = motion - from%tau/scene%rows%stiffness
      motion = motion/step%to_displacement
      if (.not. step%static) then
         call find_wall_changes(scene, from%motion%t, to%motion%t, changed, jump)
         where (.not. by_slip) motion = (slip_rates(scene%rows, to%motion) - jump)/step%to_velocity
         where (to%touching .and. from%sticking .and. .not. (by_slip .or. changed .or. &
               scene%rows%law == law_overlap)) motion = slip_products(scene%rows, to%motion%a)
      end if
      motion = motion + slip_products(scene%rows, delta)
   end function slip_motion

   !> What moving walls do to slip rates in a step: whether they change inside it, and by how much
   !> they jump at its end, which is not the step's to answer: what touches is looked at after it.
   pure subroutine find_wall_changes(scene, t_start, t_end, changed, jump)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: t_start, t_end
      logical, intent(out) :: changed(:)         !! (n_rows)
      real(wp), intent(out) :: jump(:)           !! (n_rows)
      real(wp), parameter :: near_end = 1.0e-6_wp   !! parts of the step
      real(wp) :: late(size(jump))

      changed = .false.
      jump = 0.0_wp
      if (.not. any(scene%rows%amplitude > 0)) return
      late = sliding_speeds(scene%rows, t_end - near_end*(t_end - t_start))
      changed = abs(late - sliding_speeds(scene%rows, t_start)) > 0.0_wp
      jump = sliding_speeds(scene%rows, t_end) - late
      where (scene%rows%law == law_overlap) jump = 0.0_wp
   end subroutine find_wall_changes

   !> The error of rows that have no answer.
   subroutine dependent_rows(scene, t, error)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: t
      type(error_type), allocatable, intent(out) :: error

      call new_error(error, status_numerical, 'contact conditions depend on each other at time ' &
            //to_text(t)//' ('//to_text(scene%rows%n)//' rows in all)'//new_line('a') &
            //'  cure: let no node touch the same wall twice, and none fixed along the normal')
   end subroutine dependent_rows

end module step_contact
