!> Displacement, velocity and acceleration at one time.
module motion_state
   use kinds, only: wp
   use state_archive, only: archive_type
   implicit none
   private

   public :: state_type, newmark_type, predict, hold, correct
   public :: copy_state, exchange_states, exchange

   !> Motion of all freedoms at total time t.
   type :: state_type
      real(wp) :: t = 0.0_wp
      real(wp), allocatable :: d(:), v(:), a(:)   !! (n_freedoms)
      real(wp), allocatable :: history(:)         !! (n_history) memory of the elements
   contains
      procedure :: pass_state
   end type state_type

   !> Parameters of the time integration: Newmark's and that of Hilber, Hughes and Taylor.
   type :: newmark_type
      real(wp) :: gamma = 0.5_wp
      real(wp) :: beta = 0.25_wp
      real(wp) :: alpha = 0.0_wp                  !! -1/3 to 0
   end type newmark_type

contains

   !> All of it.
   subroutine pass_state(self, archive)
      class(state_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%pass('t', self%t)
      call archive%pass('d', self%d)
      call archive%pass('v', self%v)
      call archive%pass('a', self%a)
      call archive%pass('history', self%history)
   end subroutine pass_state

   !> d~ = d + h v + h^2/2 (1 - 2 beta) a,  v~ = v + h (1 - gamma) a  (Hughes and Liu);
   !> the acceleration starts at zero.
   pure subroutine predict(newmark, state, dt, trial)
      type(newmark_type), intent(in) :: newmark
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: dt
      type(state_type), intent(inout) :: trial    !! its arrays are used again

      trial%t = state%t + dt
      trial%d = state%d + dt*state%v + dt**2/2.0_wp*(1.0_wp - 2.0_wp*newmark%beta)*state%a
      trial%v = state%v + dt*(1.0_wp - newmark%gamma)*state%a
      trial%a = 0.0_wp*state%a
      trial%history = state%history
   end subroutine predict

   !> Freedoms that stay where they are, with the velocity and acceleration that Newmark's rule has
   !> for it: a = -v/(beta h) - (1/(2 beta) - 1) a0. beta > 0.
   pure subroutine hold(newmark, state, dt, held, trial)
      type(newmark_type), intent(in) :: newmark
      type(state_type), intent(in) :: state       !! at the start of the step
      real(wp), intent(in) :: dt
      logical, intent(in) :: held(:)              !! (n_freedoms)
      type(state_type), intent(inout) :: trial    !! from `predict`

      associate (gamma => newmark%gamma, beta => newmark%beta)
         where (held)
            trial%d = state%d
            trial%v = (1.0_wp - gamma/beta)*state%v + dt*(1.0_wp - gamma/(2.0_wp*beta))*state%a
            trial%a = -state%v/(beta*dt) - (1.0_wp/(2.0_wp*beta) - 1.0_wp)*state%a
         end where
      end associate
   end subroutine hold

   !> d = d~ + beta h^2 a,  v = v~ + gamma h a, for a change of the acceleration.
   pure subroutine correct(newmark, dt, delta_a, trial)
      type(newmark_type), intent(in) :: newmark
      real(wp), intent(in) :: dt
      real(wp), intent(in) :: delta_a(:)          !! (n_freedoms)
      type(state_type), intent(inout) :: trial

      trial%a = trial%a + delta_a
      trial%v = trial%v + newmark%gamma*dt*delta_a
      trial%d = trial%d + newmark%beta*dt**2*delta_a
   end subroutine correct

   !> Copies a state into the arrays of another, where it has them.
   pure subroutine copy_state(from, to)
      type(state_type), intent(in) :: from
      type(state_type), intent(inout) :: to

      to%t = from%t
      to%d = from%d
      to%v = from%v
      to%a = from%a
      to%history = from%history
   end subroutine copy_state

   !> Exchanges two states; nothing is copied.
   pure subroutine exchange_states(one, other)
      type(state_type), intent(inout) :: one, other
      real(wp) :: t

      t = one%t
      one%t = other%t
      other%t = t
      call exchange(one%d, other%d)
      call exchange(one%v, other%v)
      call exchange(one%a, other%a)
      call exchange(one%history, other%history)
   end subroutine exchange_states

   !> Exchanges two arrays.
   pure subroutine exchange(one, other)
      real(wp), allocatable, intent(inout) :: one(:), other(:)
      real(wp), allocatable :: kept(:)

      call move_alloc(one, kept)
      call move_alloc(other, one)
      call move_alloc(kept, other)
   end subroutine exchange

end module motion_state
