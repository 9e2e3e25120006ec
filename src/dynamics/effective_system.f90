!> Effective matrices c_m M + c_c C + c_k K with their factors; the few in use are kept.
module effective_system
   use kinds, only: wp, int64
   use errors, only: error_type, new_error, status_numerical
   use skyline_matrix, only: skyline_type, profile_type, profile_entries, combine
   use skyline_ldlt, only: factorize, solve, solve_many, ldlt_report_type
   use structure, only: structure_type, freedom_name
   use effective_matrix, only: assemble_effective, assemble_sum
   implicit none
   private

   public :: effective_system_type, new_effective_system

   integer, parameter :: n_slots = 4
   !> Largest profile, in entries, whose M, C and K are kept beside the factors.
   integer(int64), parameter :: most_kept = 20000000_int64

   !> One factorized matrix.
   type :: slot_type
      real(wp) :: factors(3) = -1.0_wp            !! c_m, c_c, c_k it was made for
      integer(int64) :: last_use = -1
      type(skyline_type) :: matrix
   end type slot_type

   !> The factorized matrices in use, and what they cost.
   type :: effective_system_type
      private
      type(slot_type) :: slots(n_slots)
      type(skyline_type) :: parts(3)              !! M, C and K of a linear structure, if kept
      logical :: has_parts = .false.
      integer :: current = 1
      integer(int64) :: clock = 0
      integer(int64), public :: n_factorizations = 0
      integer(int64), public :: n_solves = 0
      integer(int64), public :: generation = 0    !! how often all matrices have been dropped
   contains
      procedure :: prepare
      procedure :: solve => solve_current
      procedure :: solve_many => solve_columns
      procedure :: forget
      procedure :: current_factors
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
      type(ldlt_report_type) :: report
      integer :: i

      self%clock = self%clock + 1
      do i = 1, n_slots
         if (any(abs(self%slots(i)%factors - factors) > 0.0_wp)) cycle
         self%current = i
         self%slots(i)%last_use = self%clock
         return
      end do
      self%current = minloc(self%slots%last_use, dim=1)
      associate (slot => self%slots(self%current))
         if (structure%is_linear .and. sum(factors(2:3)) > 0.0_wp .and. &
               profile_entries(profile) <= most_kept) then
            if (.not. self%has_parts) call keep_parts(self, structure, profile, d, history)
            call combine(slot%matrix, factors, self%parts)
         else
            call assemble_effective(structure, profile, d, history, factors, slot%matrix)
         end if
         slot%factors = -1.0_wp
         if (.not. slot%matrix%is_diagonal()) self%n_factorizations = self%n_factorizations + 1
         call factorize(slot%matrix, report)
         if (report%zero_pivot > 0) then
            call name_singular(structure, report%zero_pivot, error)
            return
         end if
         slot%factors = factors
         slot%last_use = self%clock
      end associate
   end subroutine prepare

   !> M, C and K one by one: steps of many lengths, as between impacts, then need no elements.
   subroutine keep_parts(self, structure, profile, d, history)
      class(effective_system_type), intent(inout) :: self
      type(structure_type), intent(in) :: structure
      type(profile_type), intent(in) :: profile
      real(wp), intent(in) :: d(:), history(:)
      real(wp), parameter :: unit(3, 3) = reshape(real([1, 0, 0, 0, 1, 0, 0, 0, 1], wp), [3, 3])
      integer :: i

      do i = 1, 3
         call assemble_sum(structure, profile, d, history, unit(:, i), self%parts(i))
      end do
      self%has_parts = .true.
   end subroutine keep_parts

   subroutine name_singular(structure, equation, error)
      type(structure_type), intent(in) :: structure
      integer, intent(in) :: equation
      type(error_type), allocatable, intent(out) :: error
      integer :: f

      do f = 1, structure%map%n_freedoms
         if (structure%map%id(structure%map%dof(f), structure%map%node(f)) == equation) exit
      end do
      call new_error(error, status_numerical, 'singular system: '//freedom_name(structure, f) &
            //' can move without resistance'//new_line('a') &
            //'  cure: hold it with *BOUNDARY, or connect it with an element that has stiffness')
   end subroutine name_singular

   !> Solves with the matrix last prepared; b is overwritten.
   subroutine solve_current(self, b)
      class(effective_system_type), intent(inout) :: self
      real(wp), intent(inout) :: b(:)             !! (n_eq)

      self%n_solves = self%n_solves + 1
      call solve(self%slots(self%current)%matrix, b)
   end subroutine solve_current

   !> Solves for several right-hand sides with the matrix last prepared; b is overwritten.
   subroutine solve_columns(self, b)
      class(effective_system_type), intent(inout) :: self
      real(wp), intent(inout), contiguous :: b(:, :)   !! (n_eq, right-hand sides)

      self%n_solves = self%n_solves + size(b, 2)
      call solve_many(self%slots(self%current)%matrix, b)
   end subroutine solve_columns

end module effective_system
