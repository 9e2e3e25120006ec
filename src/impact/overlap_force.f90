!> The fictitious force on overlapping rows: the force that would pull them back by
!> alpha times their overlap, statically on the effective stiffness with all else free.
module overlap_force
   use kinds, only: wp
   use errors, only: error_type, new_error, status_numerical
   use memory_shortage, only: check_allocation
   use complementarity, only: solve_complementarity, solve_equality
   use constraint_rows, only: row_gaps, row_accelerations, gap_size, law_overlap
   use impact_scene, only: scene_type, contact_motion_type, gap_tolerance
   use row_compliance, only: compliance_type, find_compliance, unit_motions
   use contact_room, only: no_room, room_tolerance
   implicit none
   private

   public :: add_overlap_force

   !> The iteration has ended when forces change by no more than this part.
   real(wp), parameter :: force_tolerance = 1.0e-14_wp
   !> Where alpha is so close to one that more rounds are needed, the fixed point is solved for.
   integer, parameter :: most_rounds = 10000

   !> Overlapping rows with the rows in sustained contact held beside them.
   type :: overlap_type
      integer, allocatable :: rows(:), held(:)
      real(wp), allocatable :: x(:, :)           !! (n_freedoms, n) acceleration by unit forces
      real(wp), allocatable :: w(:, :)           !! (n, n) G K*^-1 Gt, displacement by unit forces
      real(wp), allocatable :: yield(:, :)       !! (n_held, n) change of the held rows' forces
   end type overlap_type

contains

   !> Adds the fictitious forces of overlapping rows to the change of the acceleration. The set of
   !> overlapping rows grows until no free row overlaps.
   subroutine add_overlap_force(scene, beta_dt2, to, delta, error)
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: beta_dt2                    !! beta h^2
      type(contact_motion_type), intent(inout) :: to      !! at the start of the Newton iteration
      real(wp), intent(inout) :: delta(:)                 !! (n_freedoms) change of acceleration
      type(error_type), allocatable, intent(out) :: error
      type(overlap_type) :: overlap
      real(wp), dimension(scene%rows%n) :: free_gaps, gaps
      logical, dimension(scene%rows%n) :: overlapping, eligible
      real(wp), allocatable :: lambda(:)
      real(wp) :: limit
      integer :: status

      eligible = scene%rows%facing .and. scene%rows%law == law_overlap .and. .not. &
            (to%touching .or. to%leaving)
      free_gaps = row_gaps(scene%rows, to%motion) + beta_dt2*row_accelerations(scene%rows, delta)
      limit = gap_tolerance*gap_size(scene%rows, to%motion, 0.0_wp)
      gaps = free_gaps
      overlapping = .false.
      allocate (lambda(0), stat=status)
      call check_allocation(status)
      do while (any(eligible .and. .not. overlapping .and. gaps < -limit))
         overlapping = overlapping .or. (eligible .and. gaps < -limit)
         call find_overlap(scene, beta_dt2, to, overlapping, overlap, error)
         if (allocated(error)) return
         call find_forces(scene, overlap%w, free_gaps(overlap%rows), lambda, error)
         if (allocated(error)) return
         call check_room(scene, overlap, free_gaps(overlap%rows), lambda, to%motion%t, error)
         if (allocated(error)) return
         gaps = free_gaps + beta_dt2*row_accelerations(scene%rows, matmul(overlap%x, lambda))
      end do
      if (.not. any(overlapping)) return
      to%lambda(overlap%rows) = lambda
      to%lambda(overlap%held) = to%lambda(overlap%held) + matmul(overlap%yield, lambda)
      delta = delta + matmul(overlap%x, lambda)
   end subroutine add_overlap_force

   !> Compliance of the overlapping rows while those in sustained contact stay closed.
   subroutine find_overlap(scene, beta_dt2, to, overlapping, overlap, error)
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: beta_dt2
      type(contact_motion_type), intent(in) :: to
      logical, intent(in) :: overlapping(:)
      type(overlap_type), intent(out) :: overlap
      type(error_type), allocatable, intent(out) :: error
      type(compliance_type) :: all
      integer :: i, j, n, m, status
      logical :: solved

      overlap%rows = pack([(i, i=1, scene%rows%n)], overlapping)
      overlap%held = pack([(i, i=1, scene%rows%n)], to%touching .and. to%lambda > 0.0_wp)
      n = size(overlap%rows)
      m = size(overlap%held)
      call find_compliance(scene, [overlap%rows, overlap%held], all)
      allocate (overlap%yield(m, n), stat=status)
      call check_allocation(status)
      associate (w => all%w, x => unit_motions(scene, all))
         do j = 1, n
            call solve_equality(w(n + 1:, n + 1:), w(n + 1:, j), overlap%yield(:, j), solved)
            if (.not. solved) then
               call no_compliance(error)
               return
            end if
         end do
         overlap%x = x(:, :n) + matmul(x(:, n + 1:), overlap%yield)
         overlap%w = beta_dt2*(w(:n, :n) + matmul(w(:n, n + 1:), overlap%yield))
      end associate
   end subroutine find_overlap

   !> The fixed point of the iteration, by iterating, or directly from
   !> 0 <= lambda, ((1 + alpha)/alpha) W lambda + g_free >= 0, which is also the answer where the
   !> iteration's set of overlapping rows cycles, or ends with a row that pulls.
   subroutine find_forces(scene, w, free_gaps, lambda, error)
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: w(:, :)
      real(wp), intent(in) :: free_gaps(:)
      real(wp), allocatable, intent(out) :: lambda(:)
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: alpha
      logical :: solved
      integer :: status

      allocate (lambda(size(free_gaps)), stat=status)
      call check_allocation(status)
      if (.not. scene%settings%direct) then
         call iterate_forces(scene, w, free_gaps, lambda, solved)
         if (solved .and. all(lambda >= 0.0_wp)) return
         scene%n_cycles = scene%n_cycles + 1
      end if
      alpha = scene%settings%return_parameter
      call solve_complementarity((1.0_wp + alpha)/alpha*w, free_gaps, lambda, solved)
      if (.not. solved) call no_compliance(error)
   end subroutine find_forces

   !> Rows that no motion can open together have no such forces.
   subroutine check_room(scene, overlap, free_gaps, lambda, t, error)
      type(scene_type), intent(in) :: scene
      type(overlap_type), intent(in) :: overlap
      real(wp), intent(in) :: free_gaps(:), lambda(:)
      real(wp), intent(in) :: t
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: missing(size(lambda)), alpha
      integer :: worst

      alpha = scene%settings%return_parameter
      missing = free_gaps + (1.0_wp + alpha)/alpha*matmul(overlap%w, lambda)
      worst = minloc(missing, dim=1)
      if (missing(worst) >= -room_tolerance*maxval(abs(free_gaps))) return
      call no_room(scene%rows%node_id(overlap%rows(worst)), t, -missing(worst), error)
   end subroutine check_room

   !> P from the overlap of the iteration at hand alone: lambda = W^-1 alpha (-g) on the rows with
   !> g < 0, then g = g_free + W lambda. Each round leaves alpha times the distance to the end.
   subroutine iterate_forces(scene, w, free_gaps, lambda, converged)
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: w(:, :), free_gaps(:)
      real(wp), intent(out) :: lambda(:)
      logical, intent(out) :: converged
      real(wp) :: gaps(size(lambda)), previous(size(lambda))
      integer :: i, max_rounds

      max_rounds = min(100 + ceiling(-80.0_wp/log(scene%settings%return_parameter)), most_rounds)
      gaps = free_gaps
      lambda = 0.0_wp
      do i = 1, max_rounds
         previous = lambda
         call pull_back(scene%settings%return_parameter, w, gaps, lambda, converged)
         if (.not. converged) return
         scene%n_iterations = scene%n_iterations + 1
         gaps = free_gaps + matmul(w, lambda)
         converged = maxval(abs(lambda - previous)) <= force_tolerance*maxval(abs(lambda))
         if (converged) return
      end do
   end subroutine iterate_forces

   !> lambda = W^-1 alpha (-g) on the overlapping rows, none on the others.
   pure subroutine pull_back(alpha, w, gaps, lambda, solved)
      real(wp), intent(in) :: alpha, w(:, :), gaps(:)
      real(wp), intent(out) :: lambda(:)
      logical, intent(out) :: solved
      integer :: rows(count(gaps < 0.0_wp)), i
      real(wp) :: force(count(gaps < 0.0_wp))

      rows = pack([(i, i=1, size(gaps))], gaps < 0.0_wp)
      call solve_equality(w(rows, rows), alpha*gaps(rows), force, solved)
      lambda = 0.0_wp
      lambda(rows) = force
   end subroutine pull_back

   subroutine no_compliance(error)
      type(error_type), allocatable, intent(out) :: error

      call new_error(error, status_numerical, &
            'the contact rows have no compliance of their own: rows depend on each other'// &
            new_line('a') &
            //'  cure: let no node touch the same wall twice, and none that is fixed'// &
            ' along the normal; beta must not be zero')
   end subroutine no_compliance

end module overlap_force
