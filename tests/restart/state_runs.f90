!> Runs of a deck without files, increment by increment, for tests of their states.
module state_runs
   use kinds, only: wp, int64
   use errors, only: error_type
   use state_archive, only: archive_type
   use steps, only: procedure_frequency
   use deck_reader, only: read_deck, definition_type
   use energy_ledger, only: close_increment
   use run_log, only: log_type
   use stop_request, only: watch_type
   use scene_setup, only: simulation_type, initial_motion
   use deck_check, only: preview_type, prepare
   use step_start, only: start_step
   use increment_checks, only: needs_energies
   use course, only: course_type, begin_course
   use course_increments, only: take_next
   use increment_end, only: count_events
   implicit none
   private

   public :: run_type, open_run, take_one, compare_archives

   !> A run and where it is.
   type :: run_type
      type(simulation_type) :: simulation
      type(course_type) :: course
      type(log_type) :: log
      type(watch_type) :: watch
   end type run_type

contains

   !> Reads and builds a deck up to the start of its first step, as the program does.
   subroutine open_run(self, deck, definitions, error)
      type(run_type), intent(out) :: self
      character(len=*), intent(in) :: deck       !! path
      type(definition_type), intent(in) :: definitions(:)
      type(error_type), allocatable, intent(out) :: error
      type(preview_type) :: preview

      self%log%terminal = .false.
      call read_deck(self%simulation%model, deck, definitions, error)
      if (allocated(error)) return
      call prepare(self%simulation, self%log, .false., preview, error)
      if (allocated(error)) return
      associate (system => self%simulation%scene%system)
         deallocate (system%motions%motions, system%loads%loads)
      end associate
      call initial_motion(self%simulation, error)
   end subroutine open_run

   !> One increment, or the start of a step.
   recursive subroutine take_one(self, taken, error)
      type(run_type), intent(inout) :: self
      logical, intent(out) :: taken              !! false at the end of the run
      type(error_type), allocatable, intent(out) :: error

      taken = .false.
      associate (simulation => self%simulation, course => self%course)
         if (course%step == 0) call begin_course(course, 1, simulation%motion%motion%t)
         if (simulation%model%steps(course%step)%procedure == procedure_frequency) return
         if (.not. course%entered) then
            call start_step(simulation, course%step, error)
            course%entered = .true.
            taken = .not. allocated(error)
            if (course%step == 1) simulation%scene%n_events = 0
            return
         end if
         call take_next(simulation, course, self%log, self%watch, taken, error)
         if (allocated(error)) return
         if (taken) then
            call finish(self)
            return
         end if
         if (course%step == size(simulation%model%steps)) return
         if (simulation%model%steps(course%step + 1)%procedure == procedure_frequency) return
         call begin_course(course, course%step + 1, simulation%motion%motion%t)
         call take_one(self, taken, error)
      end associate
   end subroutine take_one

   !> What the end of an increment does to the simulation.
   subroutine finish(self)
      type(run_type), intent(inout) :: self

      associate (simulation => self%simulation, course => self%course)
         associate (step => simulation%model%steps(course%step))
            if (course%step_time >= step%duration .or. needs_energies(step%requests, &
                  course%increment)) call close_increment(simulation%scene%ledger, &
                  simulation%scene%system, simulation%motion%motion)
         end associate
         call count_events(simulation)
         simulation%scene%n_events = 0
      end associate
   end subroutine finish

   !> Names of entries that are not the same to the bit, or only in one archive.
   subroutine compare_archives(one, other, names)
      type(archive_type), intent(in) :: one, other
      character(len=:), allocatable, intent(out) :: names   !! parted by blanks
      integer :: i, j

      names = ''
      do i = 1, one%n
         do j = 1, other%n
            if (one%entries(i)%name == other%entries(j)%name) exit
         end do
         if (j > other%n) then
            names = names//' '//one%entries(i)%name
         else if (.not. same(one, i, other, j)) then
            names = names//' '//one%entries(i)%name
         end if
      end do
      do j = 1, other%n
         do i = 1, one%n
            if (one%entries(i)%name == other%entries(j)%name) exit
         end do
         if (i > one%n) names = names//' '//other%entries(j)%name
      end do
   end subroutine compare_archives

   pure logical function same(one, i, other, j)
      type(archive_type), intent(in) :: one, other
      integer, intent(in) :: i, j

      same = .false.
      associate (a => one%entries(i), b => other%entries(j))
         if (allocated(a%reals) .neqv. allocated(b%reals)) return
         if (allocated(a%reals)) then
            if (size(a%reals) /= size(b%reals)) return
            same = all(transfer(a%reals, [0_int64]) == transfer(b%reals, [0_int64]))
         else
            if (size(a%integers) /= size(b%integers)) return
            same = all(a%integers == b%integers)
         end if
      end associate
   end function same

end module state_runs
