!> Sparse symmetric factorization and solution by MUMPS, over all ranks of a parallel run.
!> Amestoy, Duff, L'Excellent, Koster, SIAM J. Matrix Anal. Appl. 23 (2001) 15-41.
!> Rank 0 owns the matrix and asks; before each call of MUMPS it tells the other ranks of it, which
!> wait in `serve_rank_zero`.
module mumps_solver
   use kinds, only: wp, int64
   use errors, only: error_type, new_error, status_numerical
   use text, only: to_text
   use memory_shortage, only: check_allocation
   use sparse_matrix, only: pattern_type, sparse_report_type, pattern_entries, diagonal_places
   use parallel_ranks, only: world, tell_ranks, hear_rank_zero
   implicit none
   private

   public :: mumps_type, mumps_available, analyse, factorize, solve, discard
   public :: serve_rank_zero, dismiss_ranks

   ! the type DMUMPS_STRUC as MUMPS declares it
   include 'dmumps_struc.h'

   interface
      subroutine dmumps(instance)
         import :: dmumps_struc
         implicit none
         type(dmumps_struc), intent(inout) :: instance
      end subroutine dmumps
   end interface

   integer, parameter :: job_end = -2
   integer, parameter :: job_start = -1
   integer, parameter :: job_analyse = 1
   integer, parameter :: job_factorize = 2
   integer, parameter :: job_solve = 3
   !> Not a job of MUMPS: the ranks are dismissed.
   integer, parameter :: job_dismiss = 99

   !> A row whose entries all are below this part of the diagonal counts as zero, as in a skyline.
   real(wp), parameter :: pivot_tolerance = 1.0e-13_wp
   !> Threshold of partial pivoting, of indefinite matrices only.
   real(wp), parameter :: pivot_threshold = 0.01_wp
   !> Approximate minimum fill: of the orderings that MUMPS brings along, it gave the smallest
   !> factors of plane meshes, and is among the fastest.
   integer, parameter :: minimum_fill = 2
   integer, parameter :: most_instances = 64

   !> A matrix in the hands of MUMPS: its analysis, then its factors. Not to be copied.
   type :: mumps_type
      private
      integer :: number = 0                      !! under which the ranks know it
      logical :: analysed = .false.
      type(dmumps_struc), allocatable :: instance
   end type mumps_type

contains

   !> Whether this module can do what it says.
   pure logical function mumps_available()
      mumps_available = .true.
   end function mumps_available

   !> Finds an order of elimination for a pattern, unless the instance has done so: `discard` it
   !> when the pattern changes. Reports the size of the factor and the operations to come.
   subroutine analyse(self, number, pattern, report, error)
      type(mumps_type), intent(inout) :: self
      integer, intent(in) :: number              !! from 1 to 64, another one for each instance
      type(pattern_type), intent(in), target :: pattern
      type(sparse_report_type), intent(out) :: report
      type(error_type), allocatable, intent(out) :: error
      integer :: status

      if (.not. self%analysed) then
         self%number = number
         allocate (self%instance, stat=status)
         call check_allocation(status)
         self%instance%sym = 2
         call call_ranks(self, job_start)
         call set_options(self%instance)
         self%instance%n = pattern%n
         self%instance%nnz = pattern_entries(pattern)
         self%instance%irn => pattern%row
         self%instance%jcn => pattern%column
         call call_ranks(self, job_analyse)
         nullify (self%instance%irn, self%instance%jcn)
         self%analysed = self%instance%infog(1) >= 0
         if (.not. self%analysed) then
            call explain(self%instance, 'analyse', error)
            return
         end if
      end if
      report%entries = in_full(self%instance%infog(20))
      report%operations = self%instance%rinfog(1)
   end subroutine analyse

   !> Silent, in the order of minimum fill, scaled by the diagonal, vanishing pivots listed.
   subroutine set_options(instance)
      type(dmumps_struc), intent(inout) :: instance

      instance%icntl(1:3) = -1                   ! units of messages
      instance%icntl(4) = 0
      instance%icntl(6) = 0                      ! no permutation to a heavy diagonal
      instance%icntl(7) = minimum_fill
      instance%icntl(8) = -1                     ! scaling given
      instance%icntl(12) = 1                     ! usual treatment of a symmetric matrix
      instance%icntl(13) = 1                     ! no ScaLAPACK: negative pivots are counted
      instance%icntl(14) = 30                    ! room beyond the estimate, in percent
      instance%icntl(24) = 1                     ! look for vanishing pivots
      instance%cntl(1) = pivot_threshold
      instance%cntl(3) = -pivot_tolerance        ! negative: not relative to the norm
   end subroutine set_options

   !> Factorizes the matrix of the given values. A vanishing pivot is for the report, an error is
   !> lack of memory.
   subroutine factorize(self, pattern, values, report, error)
      type(mumps_type), intent(inout) :: self    !! after `analyse`
      type(pattern_type), intent(in), target :: pattern
      real(wp), intent(in), target :: values(:)  !! (entries)
      type(sparse_report_type), intent(out) :: report
      type(error_type), allocatable, intent(out) :: error
      integer :: attempt

      call scale_by_diagonal(self%instance, abs(values(diagonal_places(pattern))))
      associate (instance => self%instance)
         instance%irn => pattern%row
         instance%jcn => pattern%column
         instance%a => values
         do attempt = 1, 4
            call call_ranks(self, job_factorize)
            if (all(instance%infog(1) /= [-8, -9])) exit
            instance%icntl(14) = 3*instance%icntl(14)   ! pivoting wants more room than foreseen
         end do
         nullify (instance%irn, instance%jcn, instance%a)
         report%n_negative = instance%infog(12)
         if (instance%infog(28) > 0) then
            report%zero_pivot = minval(instance%pivnul_list(:instance%infog(28)))
         else if (instance%infog(1) < 0) then
            call explain(instance, 'factorize', error)
         end if
      end associate
   end subroutine factorize

   !> Rows and columns times 1/sqrt(a_ii): MUMPS looks at it again when it solves.
   subroutine scale_by_diagonal(instance, diagonal)
      type(dmumps_struc), intent(inout) :: instance
      real(wp), intent(in) :: diagonal(:)        !! absolute values
      integer :: status

      if (.not. associated(instance%rowsca)) then
         allocate (instance%rowsca(size(diagonal)), stat=status)
         call check_allocation(status)
      end if
      instance%colsca => instance%rowsca
      where (diagonal > 0.0_wp)
         instance%rowsca = 1.0_wp/sqrt(diagonal)
      else where
         instance%rowsca = 1.0_wp
      end where
   end subroutine scale_by_diagonal

   !> Solves for several right-hand sides; b is overwritten by the solutions.
   subroutine solve(self, b, error)
      type(mumps_type), intent(inout) :: self    !! after `factorize`
      real(wp), intent(inout), target, contiguous :: b(:, :)   !! (n, n_right_hand_sides)
      type(error_type), allocatable, intent(out) :: error

      if (size(b, 2) == 0) return
      self%instance%rhs(1:size(b)) => b
      self%instance%nrhs = size(b, 2)
      self%instance%lrhs = size(b, 1)
      call call_ranks(self, job_solve)
      nullify (self%instance%rhs)
      if (self%instance%infog(1) < 0) call explain(self%instance, 'solve', error)
   end subroutine solve

   !> Gives the memory of an instance back; one that has none is left as it is.
   subroutine discard(self)
      type(mumps_type), intent(inout) :: self

      if (.not. allocated(self%instance)) return
      if (associated(self%instance%rowsca)) deallocate (self%instance%rowsca)
      nullify (self%instance%rowsca, self%instance%colsca)
      call call_ranks(self, job_end)
      deallocate (self%instance)
      self%analysed = .false.
   end subroutine discard

   !> Calls MUMPS on all ranks.
   subroutine call_ranks(self, job)
      type(mumps_type), intent(inout) :: self
      integer, intent(in) :: job

      call tell_ranks([job, self%number])
      call call_mumps(self%instance, job)
   end subroutine call_ranks

   subroutine call_mumps(instance, job)
      type(dmumps_struc), intent(inout) :: instance
      integer, intent(in) :: job

      if (job == job_start) then
         instance%comm = world()
         instance%par = 1
         instance%sym = 2
         ! MUMPS looks at some of its settings and results before it gives them their first values
         instance%icntl = 0
         instance%keep = 0
         instance%info = 0
         instance%infog = 0
      end if
      instance%job = job
      call dmumps(instance)
   end subroutine call_mumps

   !> Takes part in the calls of rank 0 until it dismisses the ranks.
   subroutine serve_rank_zero(status)
      integer, intent(out) :: status             !! of the process, as rank 0 has it
      type(mumps_type) :: helpers(most_instances)
      integer :: message(2)

      do
         call hear_rank_zero(message)
         status = message(2)
         if (message(1) == job_dismiss) return
         associate (helper => helpers(message(2)))
            if (message(1) == job_start) then
               allocate (helper%instance, stat=status)
               call check_allocation(status)
            end if
            call call_mumps(helper%instance, message(1))
            if (message(1) == job_end) deallocate (helper%instance)
         end associate
      end do
   end subroutine serve_rank_zero

   !> Rank 0 lets the others end, with its own status.
   subroutine dismiss_ranks(status)
      integer, intent(in) :: status

      call tell_ranks([job_dismiss, status])
   end subroutine dismiss_ranks

   !> Counts beyond the range of integers come as negative millions.
   pure real(wp) function in_full(count)
      integer, intent(in) :: count

      in_full = real(count, wp)
      if (count < 0) in_full = -1.0e6_wp*count
   end function in_full

   subroutine explain(instance, what, error)
      type(dmumps_struc), intent(in) :: instance
      character(len=*), intent(in) :: what
      type(error_type), allocatable, intent(out) :: error

      select case (instance%infog(1))
      case (-7, -8, -9, -13, -19)
         call new_error(error, status_numerical, 'not enough memory to '//what &
               //' the system of equations with MUMPS: the factor has some ' &
               //to_text(8.0e-6_wp*in_full(instance%infog(20)), 3)//' MB'//new_line('a') &
               //'  cure: take a coarser mesh, more ranks or a machine with more memory')
      case default
         call new_error(error, status_numerical, 'MUMPS could not '//what &
               //' the system of equations: its status is '//to_text(instance%infog(1))//', ' &
               //to_text(instance%infog(2))//new_line('a') &
               //'  cure: look the status up in the guide of MUMPS (INFOG), or SOLVER=SKYLINE')
      end select
   end subroutine explain

end module mumps_solver
