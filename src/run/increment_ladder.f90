!> Sizes of increments on a ladder: only halved and doubled, so that factorized matrices are met
!> again, and not up and down with every swing of the motion.
module increment_ladder
   use kinds, only: wp
   use state_archive, only: archive_type
   implicit none
   private

   public :: ladder_type, start_ladder, halve, step_up, lower_limit

   !> The size of the next increment and when it may grow.
   type :: ladder_type
      real(wp) :: dt = 0.0_wp                    !! to be tried next
      real(wp) :: dt_min = 0.0_wp, dt_max = 0.0_wp
      integer :: n_easy = 0                      !! increments in a row that could have been larger
      integer :: n_needed = 2                    !! of them before one is larger
      integer :: n_since = -1                    !! since it was doubled, -1: long ago
      integer :: n_changes = 0
   contains
      procedure :: pass_state
   end type ladder_type

   !> Twice the increment makes eight times the local error: errors below this part may grow.
   real(wp), parameter :: easy_ratio = 0.7_wp/8.0_wp
   integer, parameter :: fewest_needed = 2, most_needed = 64
   !> A doubling that holds for so many times the increments it has waited for was right.
   integer, parameter :: proof = 8

contains

   !> All of it.
   subroutine pass_state(self, archive)
      class(ladder_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%pass('dt', self%dt)
      call archive%pass('dt_min', self%dt_min)
      call archive%pass('dt_max', self%dt_max)
      call archive%pass('n_easy', self%n_easy)
      call archive%pass('n_needed', self%n_needed)
      call archive%pass('n_since', self%n_since)
      call archive%pass('n_changes', self%n_changes)
   end subroutine pass_state

   !> A ladder through dt.
   pure subroutine start_ladder(self, dt, limits)
      type(ladder_type), intent(out) :: self
      real(wp), intent(in) :: dt
      real(wp), intent(in) :: limits(2)          !! smallest and largest increment

      self%dt_min = limits(1)
      self%dt_max = limits(2)
      self%dt = min(max(dt, self%dt_min), self%dt_max)
   end subroutine start_ladder

   !> Whether nothing smaller may be tried. An increment stretched to the end of a step is above the
   !> ladder's smallest, which is tried no more then.
   pure logical function lower_limit(self, dt)
      type(ladder_type), intent(in) :: self
      real(wp), intent(in) :: dt

      lower_limit = dt <= self%dt_min .or. self%dt <= self%dt_min
   end function lower_limit

   !> Half of an increment that was too large. One that had just been doubled in smooth motion has
   !> to wait longer the next time.
   pure subroutine halve(self, dt, smooth)
      type(ladder_type), intent(inout) :: self
      real(wp), value :: dt                      !! what was tried (a copy: self%dt)
      logical, intent(in) :: smooth              !! nothing happened in it

      if (smooth .and. self%n_since >= 0) self%n_needed = min(2*self%n_needed, most_needed)
      self%n_since = -1
      self%n_easy = 0
      self%n_changes = self%n_changes + 1
      do
         self%dt = self%dt/2.0_wp
         if (self%dt < dt) exit
      end do
      self%dt = max(self%dt, self%dt_min)
   end subroutine halve

   !> After an increment of the ladder's size that was good: doubles it if errors have been small.
   pure subroutine step_up(self, ratio)
      type(ladder_type), intent(inout) :: self
      real(wp), intent(in) :: ratio              !! local error over what is allowed

      self%n_easy = self%n_easy + 1
      if (ratio > easy_ratio) self%n_easy = 0
      if (self%n_since >= 0) then
         self%n_since = self%n_since + 1
         if (self%n_since > proof*self%n_needed) then
            self%n_needed = max(fewest_needed, self%n_needed/2)
            self%n_since = -1
         end if
      end if
      if (self%n_easy < self%n_needed .or. 2.0_wp*self%dt > self%dt_max) return
      self%dt = 2.0_wp*self%dt
      self%n_easy = 0
      self%n_since = 0
      self%n_changes = self%n_changes + 1
   end subroutine step_up

end module increment_ladder
