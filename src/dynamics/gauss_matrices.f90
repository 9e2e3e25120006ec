!> Factors of M + C/s + K/s^2 for steps of the two-stage Gauss method, s = r/h complex. The one of
!> the whole step stays; those of the parts of steps between events take turns in a few places.
module gauss_matrices
   use kinds, only: wp, int64
   use errors, only: error_type
   use clock, only: seconds_now
   use memory_shortage, only: check_allocation
   use skyline_matrix, only: profile_type, skyline_type, profile_entries
   use complex_skyline, only: complex_skyline_type, new_complex_skyline, column_values
   use structure, only: structure_type
   use effective_matrix, only: assemble_sum, count_parts
   use effective_system, only: effective_system_type, name_singular
   implicit none
   private

   public :: gauss_matrices_type, prepare_gauss, solve_gauss, kept_gauss_steps, drop_gauss

   integer, parameter :: n_slots = 4
   real(wp), parameter :: unit(3, 3) = reshape(real([1, 0, 0, 0, 1, 0, 0, 0, 1], wp), [3, 3])
   !> A complex factorization or solution counts as that many real ones: so many multiplications.
   integer(int64), parameter, public :: real_operations = 4

   !> One factorized matrix.
   type :: slot_type
      real(wp) :: dt = -1.0_wp
      integer(int64) :: last_use = -1
      type(complex_skyline_type) :: matrix
   end type slot_type

   !> The factors in use; the first slot is that of the whole step.
   type :: gauss_matrices_type
      private
      type(slot_type) :: slots(n_slots)
      real(wp), allocatable :: parts(:, :)        !! (entries, 3) M, C and K by columns
      integer(int64) :: generation = -1           !! of the matrices of the effective system
      integer(int64) :: clock = 0
      integer :: current = 1
   end type gauss_matrices_type

contains

   !> Makes M + C/s + K/s^2 ready, from the store if it is there. A vanishing pivot is an error that
   !> names the node and freedom.
   subroutine prepare_gauss(self, matrices, structure, profile, s, dt, whole, error)
      type(gauss_matrices_type), intent(inout) :: self
      type(effective_system_type), intent(inout) :: matrices   !! counts
      type(structure_type), intent(in) :: structure
      type(profile_type), intent(in) :: profile
      complex(wp), intent(in) :: s
      real(wp), intent(in) :: dt                  !! that s belongs to
      logical, intent(in) :: whole                !! the whole step, not a part of one
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: started
      integer :: i, zero_pivot

      if (self%generation /= matrices%generation) call drop_all(self, matrices%generation)
      self%clock = self%clock + 1
      do i = 1, n_slots
         if (abs(self%slots(i)%dt - dt) > 0.0_wp) cycle
         self%current = i
         self%slots(i)%last_use = self%clock
         return
      end do
      self%current = 1
      if (.not. whole) self%current = 1 + minloc(self%slots(2:)%last_use, dim=1)
      if (.not. allocated(self%parts)) then
         call assemble_parts(self, structure, profile)
         matrices%n_assembled = matrices%n_assembled + count_parts(structure)
      end if
      started = seconds_now()
      associate (slot => self%slots(self%current))
         slot%dt = -1.0_wp
         if (slot%matrix%n == 0) call new_complex_skyline(slot%matrix, profile)
         call slot%matrix%combine([(1.0_wp, 0.0_wp), 1.0_wp/s, 1.0_wp/s**2], self%parts)
         call slot%matrix%factorize(zero_pivot)
         if (.not. slot%matrix%is_diagonal()) matrices%n_factorizations &
               = matrices%n_factorizations + real_operations
         matrices%factor_seconds = matrices%factor_seconds + seconds_now() - started
         if (zero_pivot > 0) then
            call name_singular(structure, zero_pivot, error)
            return
         end if
         slot%dt = dt
         slot%last_use = self%clock
      end associate
   end subroutine prepare_gauss

   !> Steps whose factors are in the store, the one used last at the end.
   pure subroutine kept_gauss_steps(self, matrices, dt, whole)
      type(gauss_matrices_type), intent(in) :: self
      type(effective_system_type), intent(in) :: matrices
      real(wp), allocatable, intent(out) :: dt(:)
      logical, allocatable, intent(out) :: whole(:)   !! it has the place of whole steps
      logical :: left(n_slots)
      integer :: i, j, status

      left = self%slots%dt > 0.0_wp .and. self%generation == matrices%generation
      allocate (dt(count(left)), whole(count(left)), stat=status)
      call check_allocation(status)
      do i = 1, size(dt)
         j = minloc(self%slots%last_use, dim=1, mask=left)
         dt(i) = self%slots(j)%dt
         whole(i) = j == 1
         left(j) = .false.
      end do
   end subroutine kept_gauss_steps

   !> Empties the store.
   subroutine drop_gauss(self)
      type(gauss_matrices_type), intent(out) :: self

      self%current = 1
   end subroutine drop_gauss

   !> The structure or its equations have changed.
   subroutine drop_all(self, generation)
      type(gauss_matrices_type), intent(out) :: self
      integer(int64), intent(in) :: generation

      self%generation = generation
   end subroutine drop_all

   subroutine assemble_parts(self, structure, profile)
      type(gauss_matrices_type), intent(inout) :: self
      type(structure_type), intent(in) :: structure
      type(profile_type), intent(in) :: profile
      type(skyline_type) :: matrix
      real(wp) :: d(structure%map%n_freedoms), history(structure%n_history)
      integer :: i, status

      d = 0.0_wp
      history = 0.0_wp
      allocate (self%parts(profile_entries(profile), 3), stat=status)
      call check_allocation(status)
      do i = 1, 3
         call assemble_sum(structure, profile, d, history, unit(:, i), matrix)
         call column_values(matrix, profile, self%parts(:, i))
      end do
   end subroutine assemble_parts

   !> Solves with the matrix last prepared; b is overwritten.
   subroutine solve_gauss(self, matrices, b)
      type(gauss_matrices_type), intent(in) :: self
      type(effective_system_type), intent(inout) :: matrices   !! counts
      complex(wp), intent(inout), contiguous :: b(:)           !! (n_eq)

      call self%slots(self%current)%matrix%solve(b)
      matrices%n_solves = matrices%n_solves + real_operations
   end subroutine solve_gauss

end module gauss_matrices
