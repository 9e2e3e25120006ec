!> The state of a run between two increments: collected into an archive, and put into a simulation
!> that has been built anew from the same deck, which then goes on to the bit as the other.
!>
!> What the deck says is not in the archive: conditions and loads of the steps up to the present one
!> are brought into force again. Nor are matrices and what has been solved with them; the archive
!> says which there were, and they are made again from the same numbers.
module run_state
   use kinds, only: wp
   use errors, only: error_type, new_error, status_file
   use text, only: to_text
   use places, only: fail_at
   use state_archive, only: archive_type
   use explicit_motion, only: go_on_explicitly
   use kept_solutions, only: kept_solutions_type, note_kept, drop_kept, make_again
   use scene_setup, only: simulation_type, begin_step
   use course, only: course_type
   use state_structure, only: pass_structure
   implicit none
   private

   public :: collect_state, restore_state, rewind_state

   !> An increment's end that differs by less than this part of an increment from a whole number of
   !> them is one: as in `last_increment`.
   real(wp), parameter :: whole_tolerance = 1.0e-6_wp

contains

   !> All that later increments depend on.
   subroutine collect_state(simulation, course, archive)
      type(simulation_type), intent(inout) :: simulation   !! as it was
      type(course_type), intent(inout) :: course           !! as it was
      type(archive_type), intent(out) :: archive
      type(kept_solutions_type) :: kept
      type(error_type), allocatable :: error
      integer :: n

      archive%reading = .false.
      call pass_structure(simulation, course%step, archive, error)
      call note_kept(kept, simulation%scene)
      call pass_course(simulation, course, archive)
      call pass_all(simulation, kept, archive)
      call pass_counts(simulation, archive)
      n = archive%n + 1
      call archive%pass('counts/entries', n)
   end subroutine collect_state

   !> Puts the state into a simulation at its start. Errors: the archive is not one of this deck,
   !> the deck ends the step before the time reached.
   subroutine restore_state(simulation, course, archive, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(out) :: course
      type(archive_type), intent(inout) :: archive
      type(error_type), allocatable, intent(out) :: error
      type(kept_solutions_type) :: kept
      integer :: n

      archive%reading = .true.
      n = 0
      call archive%pass('counts/entries', n)
      call archive%demand('counts/entries', archive%n >= n)
      call check_archive(archive, error)
      if (allocated(error)) return
      call pass_course(simulation, course, archive)
      call check_archive(archive, error)
      if (allocated(error)) return
      call check_place(simulation, course, error)
      if (allocated(error)) return
      call pass_structure(simulation, course%step, archive, error)
      if (allocated(error)) return
      call check_archive(archive, error)
      if (allocated(error)) return
      call begin_again(simulation, course%step, error)
      if (allocated(error)) return
      call pass_all(simulation, kept, archive)
      call check_archive(archive, error)
      if (allocated(error)) return
      call check_sizes(simulation, error)
      if (allocated(error)) return
      ! once more: the rows of its checkpoint are like those of the step in force
      call pass_course(simulation, course, archive)
      call go_on_explicitly(simulation%scene%explicit, simulation%scene%system, &
            simulation%motion%motion)
      call make_again(kept, simulation%scene, simulation%motion%motion, error)
      if (allocated(error)) return
      call pass_counts(simulation, archive)
      call check_archive(archive, error)
      if (allocated(error)) return
      call lengthen(simulation, course, error)
   end subroutine restore_state

   !> Back to a state of this very run, in the same step.
   subroutine rewind_state(simulation, course, archive, error)
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(inout) :: course
      type(archive_type), intent(inout) :: archive
      type(error_type), allocatable, intent(out) :: error
      type(kept_solutions_type) :: kept

      archive%reading = .true.
      call drop_kept(simulation%scene)
      call pass_all(simulation, kept, archive)
      call pass_course(simulation, course, archive)
      call go_on_explicitly(simulation%scene%explicit, simulation%scene%system, &
            simulation%motion%motion)
      call make_again(kept, simulation%scene, simulation%motion%motion, error)
      if (allocated(error)) return
      call pass_counts(simulation, archive)
      call check_archive(archive, error)
   end subroutine rewind_state

   subroutine pass_course(simulation, course, archive)
      type(simulation_type), intent(in) :: simulation
      type(course_type), intent(inout) :: course
      type(archive_type), intent(inout) :: archive

      call archive%enter('course')
      call course%pass_state(archive, simulation%scene%rows)
      call archive%leave()
   end subroutine pass_course

   !> Everything but counts.
   subroutine pass_all(simulation, kept, archive)
      type(simulation_type), intent(inout) :: simulation
      type(kept_solutions_type), intent(inout) :: kept
      type(archive_type), intent(inout) :: archive

      call archive%enter('motion')
      call simulation%motion%pass_state(archive)
      call archive%leave()
      call archive%enter('conditions')
      call simulation%scene%system%motions%pass_state(archive)
      call simulation%scene%system%loads%pass_state(archive)
      call archive%leave()
      call simulation%scene%pass_state(archive)
      call archive%enter('kept')
      call kept%pass_state(archive)
      call archive%leave()
      call archive%enter('events')
      call archive%pass('most_touching', simulation%most_touching)
      call archive%pass('has_met', simulation%has_met)
      call archive%leave()
   end subroutine pass_all

   !> What has been counted so far; making matrices again counts too, so this comes last.
   subroutine pass_counts(simulation, archive)
      type(simulation_type), intent(inout) :: simulation
      type(archive_type), intent(inout) :: archive
      integer :: i

      call archive%enter('counts')
      do i = 1, size(simulation%n_events)
         call archive%pass('events_'//to_text(i), simulation%n_events(i))
      end do
      call archive%pass('iterations', simulation%scene%n_iterations)
      call archive%pass('cycles', simulation%scene%n_cycles)
      call simulation%scene%system%matrices%pass_counts(archive)
      call simulation%scene%system%cost%pass_state(archive)
      call archive%leave()
   end subroutine pass_counts

   !> Brings the steps up to one into force as the run did, but at the initial motion: what they
   !> took from the motion then is in the archive.
   subroutine begin_again(simulation, i_step, error)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, i_step
         call begin_step(simulation, i, error)
         if (allocated(error)) return
         simulation%motion%motion%t = simulation%motion%motion%t &
               + simulation%model%steps(i)%duration
      end do
   end subroutine begin_again

   !> The step is there and reaches at least as far as the run.
   subroutine check_place(simulation, course, error)
      type(simulation_type), intent(in) :: simulation
      type(course_type), intent(in) :: course
      type(error_type), allocatable, intent(out) :: error

      if (course%step < 1 .or. course%step > size(simulation%model%steps)) then
         call new_error(error, status_file, 'the run has got to step '//to_text(course%step) &
               //', the deck has '//to_text(size(simulation%model%steps))//new_line('a') &
               //'  cure: go on with the deck that the run was started with')
      else if (simulation%model%steps(course%step)%duration < course%step_time) then
         call new_error(error, status_file, 'the run has got to time ' &
               //to_text(course%step_time)//' of step '//to_text(course%step) &
               //', which in the deck ends at ' &
               //to_text(simulation%model%steps(course%step)%duration)//new_line('a') &
               //'  cure: let the step last longer, or start the run anew')
      end if
   end subroutine check_place

   !> An entry that is missing or has another size than the deck's.
   subroutine check_archive(archive, error)
      type(archive_type), intent(in) :: archive
      type(error_type), allocatable, intent(out) :: error

      if (.not. allocated(archive%problem)) return
      call new_error(error, status_file, 'the state of the run does not fit the deck: `' &
            //archive%problem//'` is missing or has another size'//new_line('a') &
            //'  cure: go on with the deck and the program that the run was started with')
   end subroutine check_archive

   !> The motion is that of the deck's structure and contact rows.
   subroutine check_sizes(simulation, error)
      type(simulation_type), intent(in) :: simulation
      type(error_type), allocatable, intent(out) :: error
      logical :: fits

      associate (motion => simulation%motion, structure => simulation%scene%system%structure, &
            n => simulation%scene%rows%n)
         fits = all([size(motion%motion%d), size(motion%motion%v), size(motion%motion%a), &
               size(motion%force), size(motion%jump), size(motion%left_out)] &
               == structure%map%n_freedoms)
         fits = fits .and. size(motion%motion%history) == structure%n_history
         fits = fits .and. all([size(motion%lambda), size(motion%tau), size(motion%slip), &
               size(motion%entry_speed), size(motion%touching), size(motion%sticking), &
               size(motion%leaving)] == n)
      end associate
      if (fits) return
      call new_error(error, status_file, 'the state of the run is that of another model' &
            //new_line('a')//'  cure: go on with the deck that the run was started with')
   end subroutine check_sizes

   !> The deck may let a step last longer than the run knew. What has been done stays; after a last
   !> increment that was shorter, increments are counted from its end. Error: the sizes of the
   !> increments were found for a TOLERANCE over the shorter time.
   subroutine lengthen(simulation, course, error)
      type(simulation_type), intent(in) :: simulation
      type(course_type), intent(inout) :: course
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: whole

      associate (step => simulation%model%steps(course%step))
         if (.not. step%duration > course%duration) return
         whole = course%origin + (course%increment - course%counted_from)*step%dt
         if (abs(whole - course%step_time) > whole_tolerance*step%dt) then
            course%origin = course%step_time
            course%counted_from = course%increment
         end if
         if (course%twins%n == 0) return
         call fail_at(error, simulation%model%source, step%time_place, 'a step with TOLERANCE ' &
               //'cannot last longer than before: its increments were chosen for an end at ' &
               //to_text(course%duration), 'leave the step as it was and let another one follow')
      end associate
   end subroutine lengthen

end module run_state
