!> Motion with its contact forces, between whatever happens: what an impact method takes forward.
module contact_motion
   use kinds, only: wp
   use state_archive, only: archive_type
   use motion_state, only: state_type, copy_state, exchange_states, exchange
   implicit none
   private

   public :: contact_motion_type, new_contact_motion, copy_contact_motion, exchange_motions

   !> Motion with its contact forces.
   type :: contact_motion_type
      type(state_type) :: motion
      real(wp), allocatable :: lambda(:)         !! (n_rows) contact forces, positive in compression
      real(wp), allocatable :: tau(:)            !! (n_rows) friction forces along the tangents
      real(wp), allocatable :: force(:)          !! (n_freedoms) contact forces in the acceleration
      real(wp), allocatable :: carried(:)        !! (n_freedoms) other forces in it, from a jump
      logical, allocatable :: touching(:)        !! (n_rows) in sustained contact
      logical, allocatable :: sticking(:)        !! (n_rows) in contact without slip
      real(wp), allocatable :: slip(:)           !! (n_rows) path of slip so far
      real(wp), allocatable :: entry_speed(:)    !! (n_rows) fictitious force: approach speed
      logical, allocatable :: leaving(:)         !! (n_rows) fictitious force: on its way out
      logical :: fresh = .false.                 !! acceleration just restarted, no time since
      real(wp), allocatable :: jump(:)           !! (n_freedoms) of the velocity, no time since
      real(wp), allocatable :: left_out(:)       !! (n_freedoms) damping forces not in `a`
   contains
      procedure :: pass_state
   end type contact_motion_type

contains

   !> A motion at rest at the origin, nothing in contact.
   pure subroutine new_contact_motion(self, n_freedoms, n_rows, n_history)
      type(contact_motion_type), intent(out) :: self
      integer, intent(in) :: n_freedoms, n_rows, n_history
      integer :: i

      self%motion%d = [(0.0_wp, i=1, n_freedoms)]
      self%motion%v = self%motion%d
      self%motion%a = self%motion%d
      self%motion%history = [(0.0_wp, i=1, n_history)]
      self%lambda = [(0.0_wp, i=1, n_rows)]
      self%entry_speed = self%lambda
      self%tau = self%lambda
      self%slip = self%lambda
      self%force = self%motion%d
      self%jump = self%motion%d
      self%left_out = self%motion%d
      self%touching = [(.false., i=1, n_rows)]
      self%leaving = self%touching
      self%sticking = self%touching
   end subroutine new_contact_motion

   !> All of it.
   subroutine pass_state(self, archive)
      class(contact_motion_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call self%motion%pass_state(archive)
      call archive%pass('lambda', self%lambda)
      call archive%pass('tau', self%tau)
      call archive%pass('force', self%force)
      call archive%pass('carried', self%carried)
      call archive%pass('touching', self%touching)
      call archive%pass('sticking', self%sticking)
      call archive%pass('slip', self%slip)
      call archive%pass('entry_speed', self%entry_speed)
      call archive%pass('leaving', self%leaving)
      call archive%pass('fresh', self%fresh)
      call archive%pass('jump', self%jump)
      call archive%pass('left_out', self%left_out)
   end subroutine pass_state

   !> Copies a motion into the arrays of another, where it has them.
   pure subroutine copy_contact_motion(from, to)
      type(contact_motion_type), intent(in) :: from
      type(contact_motion_type), intent(inout) :: to

      call copy_state(from%motion, to%motion)
      to%lambda = from%lambda
      to%tau = from%tau
      to%force = from%force
      if (allocated(to%carried)) deallocate (to%carried)
      if (allocated(from%carried)) to%carried = from%carried
      to%touching = from%touching
      to%sticking = from%sticking
      to%slip = from%slip
      to%entry_speed = from%entry_speed
      to%leaving = from%leaving
      to%fresh = from%fresh
      to%jump = from%jump
      to%left_out = from%left_out
   end subroutine copy_contact_motion

   !> Exchanges two motions; nothing is copied.
   pure subroutine exchange_motions(one, other)
      type(contact_motion_type), intent(inout) :: one, other
      logical :: fresh

      call exchange_states(one%motion, other%motion)
      call exchange(one%lambda, other%lambda)
      call exchange(one%tau, other%tau)
      call exchange(one%force, other%force)
      call exchange(one%carried, other%carried)
      call exchange_marks(one%touching, other%touching)
      call exchange_marks(one%sticking, other%sticking)
      call exchange(one%slip, other%slip)
      call exchange(one%entry_speed, other%entry_speed)
      call exchange_marks(one%leaving, other%leaving)
      fresh = one%fresh
      one%fresh = other%fresh
      other%fresh = fresh
      call exchange(one%jump, other%jump)
      call exchange(one%left_out, other%left_out)
   end subroutine exchange_motions

   pure subroutine exchange_marks(one, other)
      logical, allocatable, intent(inout) :: one(:), other(:)
      logical, allocatable :: kept(:)

      call move_alloc(one, kept)
      call move_alloc(other, one)
      call move_alloc(kept, other)
   end subroutine exchange_marks

end module contact_motion
