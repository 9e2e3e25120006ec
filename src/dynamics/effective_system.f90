!> Effective matrices c_m M + c_c C + c_k K with their factors; the few in use are kept. A matrix is
!> a skyline or, for the sparse solver, values in a pattern of its own.
module effective_system
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use kinds, only: wp, int64
   use errors, only: error_type, new_error, status_numerical
   use state_archive, only: archive_type
   use clock, only: seconds_now
   use memory_shortage, only: check_allocation
   use steps, only: solver_mumps
   use skyline_matrix, only: skyline_type, profile_type, profile_entries, new_profile, &
         new_skyline, combine
   use skyline_ldlt, only: factorize_skyline => factorize, solve_skyline => solve, &
         solve_skylines => solve_many, ldlt_report_type
   use sparse_matrix, only: pattern_type, sparse_report_type, is_same, diagonal_places
   use mumps_solver, only: mumps_type, mumps_available, analyse, discard, &
         factorize_sparse => factorize, solve_sparse => solve
   use structure, only: structure_type, freedom_name, is_explicit
   use effective_matrix, only: assemble_effective, assemble_sum, count_coupled, count_parts
   use sparse_effective, only: find_pattern, assemble_sparse, fill_empty_diagonal
   use solver_choice, only: work_type, choice_type, first_choice, refine_choice
   implicit none
   private

   public :: effective_system_type, new_effective_system, most_kept, name_singular

   integer, parameter :: n_slots = 4
   !> Largest profile, in entries, whose M, C and K are kept beside the factors.
   integer(int64), parameter :: most_kept = 20000000_int64
   real(wp), parameter :: unit(3, 3) = reshape(real([1, 0, 0, 0, 1, 0, 0, 0, 1], wp), [3, 3])

   !> One factorized matrix.
   type :: slot_type
      real(wp) :: factors(3) = -1.0_wp            !! c_m, c_c, c_k it was made for
      integer(int64) :: last_use = -1
      logical :: is_sparse = .false.              !! its factors are with the sparse solver
      type(skyline_type) :: matrix
      type(mumps_type) :: sparse
   end type slot_type

   !> Values of a sparse matrix.
   type :: values_type
      real(wp), allocatable :: values(:)
   end type values_type

   !> The factorized matrices in use, and what they cost.
   type :: effective_system_type
      private
      type(slot_type) :: slots(n_slots)
      type(skyline_type) :: parts(3)              !! M, C and K of a linear structure, if kept
      type(values_type) :: sparse_parts(3)        !! the same in the pattern
      type(pattern_type) :: pattern
      type(choice_type), public :: choice         !! of the solver, this step
      logical :: has_parts = .false.
      logical :: counts_solves = .true.           !! false: the mass of explicit elements divides
      integer :: current = 1
      integer(int64) :: clock = 0
      integer(int64), public :: n_factorizations = 0
      integer(int64), public :: n_solves = 0
      integer(int64), public :: n_assembled = 0   !! element matrices worked out
      integer(int64), public :: generation = 0    !! how often all matrices have been dropped
      real(wp), public :: factor_seconds = 0.0_wp   !! elapsed in factorizations
   contains
      procedure :: begin
      procedure :: prepare
      procedure :: solve => solve_current
      procedure :: solve_many
      procedure :: forget
      procedure :: release
      procedure :: current_factors
      procedure :: kept_factors
      procedure :: pass_counts
   end type effective_system_type

contains

   !> An empty store of matrices.
   subroutine new_effective_system(self)
      type(effective_system_type), intent(out) :: self

      self%current = 1
   end subroutine new_effective_system

   !> Drops every matrix: the profile, the groups or the tangent have changed.
   subroutine forget(self)
      class(effective_system_type), intent(inout) :: self
      integer :: i

      self%generation = self%generation + 1
      self%has_parts = .false.
      do i = 1, n_slots
         self%slots(i)%factors = -1.0_wp
         self%slots(i)%last_use = -1
      end do
   end subroutine forget

   !> c_m, c_c, c_k of the matrix last prepared.
   pure function current_factors(self) result(factors)
      class(effective_system_type), intent(in) :: self
      real(wp) :: factors(3)

      factors = self%slots(self%current)%factors
   end function current_factors

   !> c_m, c_c, c_k of all matrices in the store, the one used last at the end.
   pure subroutine kept_factors(self, factors)
      class(effective_system_type), intent(in) :: self
      real(wp), allocatable, intent(out) :: factors(:, :)   !! (3, n)
      logical :: left(n_slots)
      integer :: i, j, status

      left = self%slots%last_use >= 0
      do i = 1, n_slots
         left(i) = left(i) .and. all(self%slots(i)%factors >= 0.0_wp)
      end do
      allocate (factors(3, count(left)), stat=status)
      call check_allocation(status)
      do i = 1, size(factors, 2)
         j = minloc(self%slots%last_use, dim=1, mask=left)
         factors(:, i) = self%slots(j)%factors
         left(j) = .false.
      end do
   end subroutine kept_factors

   !> What has been done so far.
   subroutine pass_counts(self, archive)
      class(effective_system_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%pass('n_factorizations', self%n_factorizations)
      call archive%pass('n_solves', self%n_solves)
      call archive%pass('n_assembled', self%n_assembled)
   end subroutine pass_counts

   !> Begins a step: drops every matrix and chooses the solver for the work to come. The analysis
   !> of a sparse matrix stays where the pattern is that of the step before.
   subroutine begin(self, structure, profile, work, error)
      class(effective_system_type), intent(inout) :: self
      type(structure_type), intent(in) :: structure
      type(profile_type), intent(in) :: profile
      type(work_type), intent(in) :: work
      type(error_type), allocatable, intent(out) :: error
      type(sparse_report_type) :: report
      type(pattern_type) :: pattern

      call self%forget()
      self%counts_solves = profile_entries(profile) > profile%n .or. .not. is_explicit(structure)
      call first_choice(self%choice, profile, work, mumps_available())
      if (self%choice%open) then
         call find_pattern(structure, pattern)
         if (.not. is_same(pattern, self%pattern)) then
            call self%release()
            self%pattern = pattern
         end if
         call analyse(self%slots(1)%sparse, 1, self%pattern, report, error)
         if (allocated(error)) return
         call refine_choice(self%choice, report)
      end if
      if (self%choice%taken /= solver_mumps) call self%release()
   end subroutine begin

   !> Gives back what the sparse solver holds.
   subroutine release(self)
      class(effective_system_type), intent(inout) :: self
      type(pattern_type) :: empty
      integer :: i

      call self%forget()
      self%pattern = empty
      do i = 1, n_slots
         call discard(self%slots(i)%sparse)
      end do
   end subroutine release

   !> Makes c_m M + c_c C + c_k K the matrix that `solve` uses, from the store if it is there.
   !> A vanishing pivot is an error that names the node and freedom.
   subroutine prepare(self, structure, profile, d, history, factors, error)
      class(effective_system_type), intent(inout) :: self
      type(structure_type), intent(in) :: structure
      type(profile_type), intent(in) :: profile
      real(wp), intent(in) :: d(:)                !! (n_freedoms) where the tangent is taken
      real(wp), intent(in) :: history(:)          !! (n_history) last accepted
      real(wp), intent(in) :: factors(3)          !! c_m, c_c, c_k
      type(error_type), allocatable, intent(out) :: error
      integer :: i, zero_pivot

      self%clock = self%clock + 1
      do i = 1, n_slots
         if (any(abs(self%slots(i)%factors - factors) > 0.0_wp)) cycle
         self%current = i
         self%slots(i)%last_use = self%clock
         return
      end do
      self%current = minloc(self%slots%last_use, dim=1)
      self%slots(self%current)%factors = -1.0_wp
      zero_pivot = 0
      if (self%choice%taken == solver_mumps) then
         call fill_sparse(self, structure, d, history, factors, zero_pivot, error)
      else
         call fill_skyline(self, structure, profile, d, history, factors)
      end if
      if (allocated(error)) return
      if (.not. self%slots(self%current)%is_sparse) call factorize_columns(self, zero_pivot)
      if (zero_pivot > 0) then
         call name_singular(structure, zero_pivot, error)
         return
      end if
      self%slots(self%current)%factors = factors
      self%slots(self%current)%last_use = self%clock
   end subroutine prepare

   !> Assembles the current matrix as a skyline.
   subroutine fill_skyline(self, structure, profile, d, history, factors)
      class(effective_system_type), intent(inout) :: self
      type(structure_type), intent(in) :: structure
      type(profile_type), intent(in) :: profile
      real(wp), intent(in) :: d(:), history(:), factors(3)
      integer :: i

      associate (slot => self%slots(self%current))
         slot%is_sparse = .false.
         if (.not. keeps_parts(structure, factors) .or. profile_entries(profile) > most_kept) then
            call assemble_effective(structure, profile, d, history, factors, slot%matrix)
            self%n_assembled = self%n_assembled + count_coupled(structure, factors)
            return
         end if
         if (.not. self%has_parts) then
            do i = 1, 3
               call assemble_sum(structure, profile, d, history, unit(:, i), self%parts(i))
            end do
            self%n_assembled = self%n_assembled + count_parts(structure)
            self%has_parts = .true.
         end if
         call combine(slot%matrix, factors, self%parts)
      end associate
   end subroutine fill_skyline

   !> Factorizes the current skyline.
   subroutine factorize_columns(self, zero_pivot)
      class(effective_system_type), intent(inout) :: self
      integer, intent(out) :: zero_pivot          !! an equation, 0 if none
      type(ldlt_report_type) :: report
      real(wp) :: started

      associate (matrix => self%slots(self%current)%matrix)
         if (.not. matrix%is_diagonal()) self%n_factorizations = self%n_factorizations + 1
         started = seconds_now()
         call factorize_skyline(matrix, report)
         self%factor_seconds = self%factor_seconds + seconds_now() - started
         zero_pivot = report%zero_pivot
      end associate
   end subroutine factorize_columns

   !> Assembles the current matrix in the pattern and factorizes it; a mass matrix that turns out
   !> diagonal becomes a skyline, still to be factorized.
   subroutine fill_sparse(self, structure, d, history, factors, zero_pivot, error)
      class(effective_system_type), intent(inout) :: self
      type(structure_type), intent(in) :: structure
      real(wp), intent(in) :: d(:), history(:), factors(3)
      integer, intent(out) :: zero_pivot          !! an equation, 0 if none
      type(error_type), allocatable, intent(out) :: error
      type(sparse_report_type) :: report
      real(wp), allocatable :: values(:)
      real(wp) :: started

      zero_pivot = 0
      call sum_sparse(self, structure, d, history, factors, values)
      associate (slot => self%slots(self%current))
         slot%is_sparse = any(factors(2:3) > 0.0_wp)
         if (.not. slot%is_sparse) then
            call fill_empty_diagonal(self%pattern, values)
            slot%is_sparse = count(abs(values) > 0.0_wp) > self%pattern%n
         end if
         if (.not. slot%is_sparse) then
            call make_diagonal(slot%matrix, values(diagonal_places(self%pattern)))
            return
         end if
         started = seconds_now()
         call analyse(slot%sparse, self%current, self%pattern, report, error)
         if (allocated(error)) return
         call factorize_sparse(slot%sparse, self%pattern, values, report, error)
         self%factor_seconds = self%factor_seconds + seconds_now() - started
         self%n_factorizations = self%n_factorizations + 1
         zero_pivot = report%zero_pivot
      end associate
   end subroutine fill_sparse

   !> c_m M + c_c C + c_k K in the pattern, from M, C and K if the structure is linear.
   subroutine sum_sparse(self, structure, d, history, factors, values)
      class(effective_system_type), intent(inout) :: self
      type(structure_type), intent(in) :: structure
      real(wp), intent(in) :: d(:), history(:), factors(3)
      real(wp), allocatable, intent(out) :: values(:)
      integer :: i

      if (.not. keeps_parts(structure, factors)) then
         call assemble_sparse(structure, self%pattern, d, history, factors, values)
         self%n_assembled = self%n_assembled + count_coupled(structure, factors)
         return
      end if
      if (.not. self%has_parts) then
         do i = 1, 3
            call assemble_sparse(structure, self%pattern, d, history, unit(:, i), &
                  self%sparse_parts(i)%values)
         end do
         self%n_assembled = self%n_assembled + count_parts(structure)
         self%has_parts = .true.
      end if
      associate (parts => self%sparse_parts)
         values = factors(1)*parts(1)%values + factors(2)*parts(2)%values &
               + factors(3)*parts(3)%values
      end associate
   end subroutine sum_sparse

   !> Whether M, C and K are kept one by one: steps of many lengths, as between impacts, then need
   !> no elements.
   pure logical function keeps_parts(structure, factors)
      type(structure_type), intent(in) :: structure
      real(wp), intent(in) :: factors(3)

      keeps_parts = structure%is_linear .and. sum(factors(2:3)) > 0.0_wp
   end function keeps_parts

   pure subroutine make_diagonal(matrix, values)
      type(skyline_type), intent(out) :: matrix
      real(wp), intent(in) :: values(:)
      type(profile_type) :: profile
      integer :: j

      call new_profile(profile, size(values))
      call new_skyline(matrix, profile)
      do j = 1, size(values)
         call matrix%add(j, j, values(j))
      end do
   end subroutine make_diagonal

   !> The error of an equation without resistance.
   subroutine name_singular(structure, equation, error)
      type(structure_type), intent(in) :: structure
      integer, intent(in) :: equation
      type(error_type), allocatable, intent(out) :: error
      integer :: f

      do f = 1, structure%map%n_freedoms
         if (structure%map%id(structure%map%dof(f), structure%map%node(f)) == equation) exit
      end do
      call new_error(error, status_numerical, 'singular system: '//freedom_name(structure, f) &
            //' can move without resistance, or with one that is lost in the round-off of the ' &
            //'stiffness around it'//new_line('a') &
            //'  cure: hold it with *BOUNDARY, or connect it with an element that has stiffness; ' &
            //'where stiffnesses differ by 1e13, write *EQUATION instead of the stiff element')
   end subroutine name_singular

   !> Solves with the matrix last prepared; b is overwritten.
   subroutine solve_current(self, b)
      class(effective_system_type), intent(inout) :: self
      real(wp), intent(inout), contiguous :: b(:)      !! (n_eq)

      call solve_columns(self, size(b), 1, b)
   end subroutine solve_current

   !> Solves for several right-hand sides with the matrix last prepared; b is overwritten.
   subroutine solve_many(self, b)
      class(effective_system_type), intent(inout) :: self
      real(wp), intent(inout), contiguous :: b(:, :)   !! (n_eq, right-hand sides)

      call solve_columns(self, size(b, 1), size(b, 2), b)
   end subroutine solve_many

   !> Should the sparse solver fail, for want of memory, the solution is not a number.
   subroutine solve_columns(self, n, n_columns, b)
      class(effective_system_type), intent(inout) :: self
      integer, intent(in) :: n, n_columns
      real(wp), intent(inout) :: b(n, n_columns)
      type(error_type), allocatable :: failure

      associate (slot => self%slots(self%current))
         if (slot%is_sparse) then
            call solve_sparse(slot%sparse, b, failure)
            if (allocated(failure)) b = ieee_value(b, ieee_quiet_nan)
         else if (n_columns == 1) then
            call solve_skyline(slot%matrix, b(:, 1))
         else
            call solve_skylines(slot%matrix, b)
         end if
      end associate
      if (self%counts_solves) self%n_solves = self%n_solves + n_columns
   end subroutine solve_columns

end module effective_system
