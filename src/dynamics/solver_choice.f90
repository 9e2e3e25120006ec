!> SOLVER=AUTO: the skyline or the sparse solver, whichever should cost less over a step, from the
!> profile, the analysis of the sparse matrix and the number of factorizations and solutions.
!>
!> A skyline of n columns with the mean height h takes n h entries and n h^2 operations. Nested
!> dissection of a plane mesh whose separators have some h equations takes of the order of
!> n log h entries and n h operations (George, SIAM J. Numer. Anal. 10 (1973) 345-363); a chain or
!> a narrow strip, where h is small, gains nothing. The constants are those of plane meshes of
!> quadratic elements, the speeds those of a processor of 50 GFLOP/s; only their ratio decides.
module solver_choice
   use kinds, only: wp
   use text, only: to_text, plural
   use steps, only: solver_auto, solver_skyline, solver_mumps
   use skyline_matrix, only: profile_type, profile_entries, profile_cost
   use sparse_matrix, only: sparse_report_type
   implicit none
   private

   public :: work_type, choice_type, first_choice, refine_choice

   real(wp), parameter :: skyline_operation = 1.0_wp/27.0e9_wp   !! seconds each
   real(wp), parameter :: skyline_entry = 1.3e-9_wp              !! in a solution
   real(wp), parameter :: sparse_operation = 6.3e-11_wp
   real(wp), parameter :: sparse_entry = 2.1e-8_wp               !! in a factorization
   real(wp), parameter :: sparse_solve_entry = 3.3e-9_wp
   real(wp), parameter :: sparse_analysis_entry = 0.8e-8_wp
   !> A skyline that takes no more than this is not worth a thought.
   real(wp), parameter :: negligible = 0.05_wp
   !> The sparse solver must be cheaper by this factor.
   real(wp), parameter :: clearly = 0.8_wp

   !> What a step will want.
   type :: work_type
      integer :: wanted = solver_auto            !! of the deck
      real(wp) :: n_factorizations = 1.0_wp
      real(wp) :: n_solves = 1.0_wp
   end type work_type

   !> Seconds.
   type :: cost_type
      real(wp) :: analysis = 0.0_wp
      real(wp) :: factor = 0.0_wp
      real(wp) :: solve = 0.0_wp
   end type cost_type

   !> What was chosen and why.
   type :: choice_type
      integer :: taken = solver_skyline
      logical :: open = .false.                  !! the analysis of the sparse matrix is to decide
      character(len=:), allocatable :: text      !! for the log; empty where nothing was to choose
      type(work_type) :: work
      type(cost_type) :: skyline
   end type choice_type

contains

   !> The choice as far as the profile tells.
   subroutine first_choice(self, profile, work, available)
      type(choice_type), intent(out) :: self
      type(profile_type), intent(in) :: profile
      type(work_type), intent(in) :: work
      logical, intent(in) :: available           !! the sparse solver is part of the program
      type(cost_type) :: sparse

      self%work = work
      self%text = ''
      if (profile_entries(profile) == profile%n .or. work%wanted == solver_skyline) return
      self%open = work%wanted == solver_mumps
      if (self%open) return
      self%skyline%factor = skyline_operation*profile_cost(profile)
      self%skyline%solve = skyline_entry*real(profile_entries(profile), wp)
      if (total(self%skyline, work) < negligible) then
         self%text = 'SOLVER=AUTO: skyline, its work takes less than '//to_text(negligible)//' s'
         return
      end if
      sparse = guess_sparse(profile)
      self%open = total(sparse, work) < total(self%skyline, work)
      if (self%open .and. available) return
      call explain(self, sparse)
      if (self%open) self%text = self%text//', MUMPS would be taken, but is not built in'
      self%open = .false.
   end subroutine first_choice

   !> The choice when the sparse matrix has been analysed.
   subroutine refine_choice(self, report)
      type(choice_type), intent(inout) :: self
      type(sparse_report_type), intent(in) :: report
      type(cost_type) :: sparse

      self%open = .false.
      if (self%work%wanted == solver_mumps) then
         self%taken = solver_mumps
         self%text = 'SOLVER=MUMPS: '//to_text(report%entries, 3)//' entries in the factor, ' &
               //to_text(report%operations, 3)//' operations'
         return
      end if
      sparse = cost_of(report%entries, report%operations)
      self%taken = merge(solver_mumps, solver_skyline, &
            total(sparse, self%work) < clearly*total(self%skyline, self%work))
      call explain(self, sparse)
   end subroutine refine_choice

   !> The sparse factor of a mesh with this profile, by the mean height of the columns that count.
   pure type(cost_type) function guess_sparse(profile)
      type(profile_type), intent(in) :: profile
      real(wp) :: height, n, entries, operations

      height = profile_cost(profile)/real(profile_entries(profile), wp)
      n = real(profile_entries(profile), wp)/height
      entries = n*max(min(height, 25.0_wp), 21.0_wp*log(height)/log(2.0_wp) - 91.0_wp)
      operations = n*height*min(height, 45.0_wp)
      guess_sparse = cost_of(entries, operations)
   end function guess_sparse

   pure type(cost_type) function cost_of(entries, operations)
      real(wp), intent(in) :: entries, operations

      cost_of%analysis = sparse_analysis_entry*entries
      cost_of%factor = sparse_entry*entries + sparse_operation*operations
      cost_of%solve = sparse_solve_entry*entries
   end function cost_of

   pure real(wp) function total(cost, work)
      type(cost_type), intent(in) :: cost
      type(work_type), intent(in) :: work

      total = cost%analysis + work%n_factorizations*cost%factor + work%n_solves*cost%solve
   end function total

   !> The reason, in numbers.
   subroutine explain(self, sparse)
      type(choice_type), intent(inout) :: self
      type(cost_type), intent(in) :: sparse

      self%text = 'SOLVER=AUTO: '//trim(merge('skyline', 'MUMPS  ', self%taken == solver_skyline)) &
            //', foreseen are '//counted(self%work%n_factorizations, 'factorization')//' and ' &
            //counted(self%work%n_solves, 'solution')//';'//new_line('a') &
            //'    skyline '//seconds(self%skyline)//', sparse '//seconds(sparse)

   contains

      function seconds(cost) result(text)
         type(cost_type), intent(in) :: cost
         character(len=:), allocatable :: text

         text = to_text(total(cost, self%work), 2)//' s ('//to_text(cost%factor, 2)//' and ' &
               //to_text(cost%solve, 2)//' s each)'
      end function seconds

   end subroutine explain

   pure function counted(n, word) result(text)
      real(wp), intent(in) :: n
      character(len=*), intent(in) :: word
      character(len=:), allocatable :: text

      text = plural(int(min(n, 2.0e9_wp)), word)
   end function counted

end module solver_choice
