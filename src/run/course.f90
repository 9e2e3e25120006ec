!> Where a run is: the step, the increments taken in it, and what chooses the next one.
module course
   use kinds, only: wp
   use text, only: to_text
   use state_archive, only: archive_type
   use steps, only: step_type
   use constraint_rows, only: rows_type
   use increment_count, only: count_increments, last_increment
   use increments, only: control_type
   use twin_motion, only: twins_type
   use rehearsal, only: plan_type
   implicit none
   private

   public :: course_type, begin_course, is_fresh, find_next, place_name

   !> The place of a run between two increments. `control` serves static automatic increments,
   !> `plan` and `twins` a TOLERANCE.
   type :: course_type
      integer :: step = 0                        !! in force, 0 before the first one
      logical :: entered = .false.               !! it has begun, its start is recorded
      integer :: increment = 0                   !! the last one taken, 0 at the start of the step
      real(wp) :: t_start = 0.0_wp               !! total time at the start of the step
      real(wp) :: step_time = 0.0_wp             !! reached
      real(wp) :: dt = 0.0_wp                    !! size of the last increment
      real(wp) :: duration = 0.0_wp              !! of the step, as the last increment knew it
      integer :: counted_from = 0                !! increment after which fixed ones are counted
      real(wp) :: origin = 0.0_wp                !! step time at the end of that one
      type(control_type) :: control
      type(plan_type) :: plan
      type(twins_type) :: twins
   contains
      procedure :: pass_state
   end type course_type

contains

   !> All of it.
   subroutine pass_state(self, archive, rows)
      class(course_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive
      type(rows_type), intent(in) :: rows        !! of the scene
      logical :: twice                           !! the motion is computed twice, for a TOLERANCE

      call archive%pass('step', self%step)
      call archive%pass('entered', self%entered)
      call archive%pass('increment', self%increment)
      call archive%pass('t_start', self%t_start)
      call archive%pass('step_time', self%step_time)
      call archive%pass('dt', self%dt)
      call archive%pass('duration', self%duration)
      call archive%pass('counted_from', self%counted_from)
      call archive%pass('origin', self%origin)
      call archive%enter('control')
      call self%control%pass_state(archive)
      call archive%leave()
      twice = self%twins%n > 0
      call archive%pass('twice', twice)
      if (archive%reading) call forget_twins(self%plan, self%twins)
      if (.not. twice) return
      call archive%enter('plan')
      call self%plan%pass_state(archive)
      call archive%leave()
      call archive%enter('twins')
      call self%twins%pass_state(archive, rows)
      call archive%leave()
   end subroutine pass_state

   !> No TOLERANCE so far.
   subroutine forget_twins(plan, twins)
      type(plan_type), intent(out) :: plan
      type(twins_type), intent(out) :: twins

      plan%n_rehearsals = 0
      twins%n = 0
   end subroutine forget_twins

   !> At the start of a step.
   pure subroutine begin_course(self, i_step, t)
      type(course_type), intent(out) :: self
      integer, intent(in) :: i_step
      real(wp), intent(in) :: t                  !! total time

      self%step = i_step
      self%t_start = t
   end subroutine begin_course

   !> Whether nothing of the step has been done yet.
   pure logical function is_fresh(self)
      type(course_type), intent(in) :: self

      is_fresh = self%increment == 0
   end function is_fresh

   !> Where it is, in words.
   pure function place_name(self) result(name)
      type(course_type), intent(in) :: self
      character(len=:), allocatable :: name

      if (self%increment == 0) then
         name = 'at the start of step '//to_text(self%step)
      else
         name = 'after increment '//to_text(self%increment)//' of step '//to_text(self%step)
      end if
   end function place_name

   !> Size and end of the next increment where all have one size but the last one, which is shorter
   !> if they do not fill the step. At the end of the step none is left.
   pure subroutine find_next(self, step, dt, step_time, left)
      type(course_type), intent(in) :: self
      type(step_type), intent(in) :: step
      real(wp), intent(out) :: dt
      real(wp), intent(out) :: step_time         !! at its end
      logical, intent(out) :: left               !! there is one
      integer :: i, n

      n = count_increments(step, self%origin)
      i = self%increment - self%counted_from + 1
      left = i <= n .and. self%step_time < step%duration
      dt = step%dt
      ! counted, not summed up: no drift of time over many increments
      step_time = self%origin + i*step%dt
      if (i < n) return
      step_time = step%duration
      dt = last_increment(step, n, self%origin)
   end subroutine find_next

end module course
