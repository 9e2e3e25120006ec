!> Freedoms whose motion the deck gives, through the steps of a run.
module prescribed_motion
   use kinds, only: wp
   use state_archive, only: archive_type
   use memory_shortage, only: check_allocation
   use histories, only: amplitude_type, boundary_type, time_step, &
         motion_displacement, motion_velocity
   use amplitude_value, only: amplitude_at, amplitude_slope, amplitude_integral, &
         amplitude_second_integral, amplitude_start, corner_after
   implicit none
   private

   public :: motion_type, motion_set_type, begin_motions, start_motions, &
         impose_motion, prescribed_freedoms, are_at_rest, next_motion_corner

   !> One prescribed freedom in the step at hand.
   type :: motion_type
      integer :: freedom = 0
      integer :: motion = motion_displacement
      real(wp) :: value = 0.0_wp
      logical :: ramped = .false.           !! from its start value to `value` over the step
      logical :: has_amplitude = .false.
      type(amplitude_type) :: amplitude
      real(wp) :: t_start = 0.0_wp          !! when the condition came into force
      real(wp) :: duration = 1.0_wp         !! over which it is ramped
      real(wp) :: d_start = 0.0_wp, v_start = 0.0_wp
   end type motion_type

   !> All prescribed freedoms, each once.
   type :: motion_set_type
      type(motion_type), allocatable :: motions(:)
   contains
      procedure :: pass_state
   end type motion_set_type

contains

   !> Brings the conditions of a step into force. Earlier ones go on: with an amplitude on total
   !> time by it, else as they are.
   subroutine begin_motions(self, boundaries, freedom, amplitudes, keep, span, static)
      type(motion_set_type), intent(inout) :: self
      type(boundary_type), intent(in) :: boundaries(:)
      integer, intent(in) :: freedom(:, :)             !! (3, n_nodes)
      type(amplitude_type), intent(in) :: amplitudes(:)
      logical, intent(in) :: keep                      !! whether earlier conditions go on
      real(wp), intent(in) :: span(2)                  !! start and length of the step
      logical, intent(in) :: static
      type(motion_type), allocatable :: list(:)
      integer :: where_is(maxval(freedom)), i, f, n, status

      n = 0
      where_is = 0
      allocate (list(size(boundaries) + n_motions(self)), stat=status)
      call check_allocation(status)
      do i = 1, merge(n_motions(self), 0, keep)
         n = n + 1
         list(n) = self%motions(i)
         call hold(list(n), span(1))
         where_is(list(n)%freedom) = n
      end do
      do i = 1, size(boundaries)
         f = freedom(boundaries(i)%dof, boundaries(i)%node)
         if (f == 0) cycle
         if (where_is(f) == 0) then
            n = n + 1
            where_is(f) = n
         end if
         list(where_is(f)) = new_motion(boundaries(i), f, amplitudes, span, static)
      end do
      self%motions = list(:n)
   end subroutine begin_motions

   !> What conditions have taken from the motion; the rest is the deck's.
   subroutine pass_state(self, archive)
      class(motion_set_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call archive%pass_fixed('value', self%motions%value)
      call archive%pass_fixed('d_start', self%motions%d_start)
      call archive%pass_fixed('v_start', self%motions%v_start)
   end subroutine pass_state

   !> Tells the conditions that came into force at time t where their freedoms were then.
   pure subroutine start_motions(self, t, d, v)
      type(motion_set_type), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: d(:), v(:)               !! (n_freedoms)
      integer :: i

      do i = 1, size(self%motions)
         associate (motion => self%motions(i))
            if (motion%t_start < t) cycle
            motion%d_start = d(motion%freedom)
            motion%v_start = v(motion%freedom)
         end associate
      end do
   end subroutine start_motions

   pure function n_motions(self) result(n)
      type(motion_set_type), intent(in) :: self
      integer :: n

      n = 0
      if (allocated(self%motions)) n = size(self%motions)
   end function n_motions

   pure function new_motion(boundary, f, amplitudes, span, static) result(motion)
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: f
      type(amplitude_type), intent(in) :: amplitudes(:)
      real(wp), intent(in) :: span(2)
      logical, intent(in) :: static
      type(motion_type) :: motion

      motion%freedom = f
      motion%motion = boundary%motion
      motion%value = boundary%value
      motion%has_amplitude = boundary%amplitude > 0
      if (motion%has_amplitude) motion%amplitude = amplitudes(boundary%amplitude)
      motion%ramped = static .and. .not. motion%has_amplitude &
            .and. motion%motion == motion_displacement
      motion%t_start = span(1)
      motion%duration = span(2)
   end function new_motion

   !> What an earlier step's condition does in a later one: goes on by total time, or with the
   !> displacement, velocity or acceleration that it has at the end of its step, from where
   !> `start_motions` finds it.
   pure subroutine hold(motion, t)
      type(motion_type), intent(inout) :: motion
      real(wp), intent(in) :: t
      real(wp) :: d, v, a

      if (motion%has_amplitude .and. motion%amplitude%time /= time_step) return
      call evaluate(motion, t, d, v, a)
      select case (motion%motion)
      case (motion_displacement)
         motion%value = d
      case (motion_velocity)
         motion%value = v
      case default
         motion%value = a
      end select
      motion%has_amplitude = .false.
      motion%ramped = .false.
      motion%t_start = t
   end subroutine hold

   !> Which freedoms are prescribed.
   pure function prescribed_freedoms(self, n_freedoms) result(prescribed)
      type(motion_set_type), intent(in) :: self
      integer, intent(in) :: n_freedoms
      logical :: prescribed(n_freedoms)

      prescribed = .false.
      prescribed(self%motions%freedom) = .true.
   end function prescribed_freedoms

   !> Writes the prescribed entries of d, v and a at total time t.
   pure subroutine impose_motion(self, t, d, v, a)
      type(motion_set_type), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: d(:), v(:), a(:)   !! (n_freedoms)
      integer :: i, f

      do i = 1, size(self%motions)
         f = self%motions(i)%freedom
         call evaluate(self%motions(i), t, d(f), v(f), a(f))
      end do
   end subroutine impose_motion

   !> Whether all prescribed freedoms are where they have to be and stay there.
   pure function are_at_rest(self, d, v, a) result(rest)
      type(motion_set_type), intent(in) :: self
      real(wp), intent(in) :: d(:), v(:), a(:)         !! (n_freedoms)
      logical :: rest
      integer :: i, f

      rest = .false.
      do i = 1, size(self%motions)
         associate (motion => self%motions(i))
            f = motion%freedom
            if (abs(v(f)) + abs(a(f)) > 0.0_wp .or. motion%ramped) return
            if (motion%motion == motion_displacement) then
               if (abs(d(f) - motion%value) > 0.0_wp) return
               if (motion%has_amplitude .and. abs(motion%value) > 0.0_wp) return
            else if (abs(motion%value) + abs(d(f) - motion%d_start) > 0.0_wp) then
               return
            else if (motion%motion /= motion_velocity .and. abs(motion%v_start) > 0.0_wp) then
               return
            end if
         end associate
      end do
      rest = .true.
   end function are_at_rest

   !> The first total time after t at which an amplitude of a motion has a corner, huge if none has.
   pure function next_motion_corner(self, t) result(corner)
      type(motion_set_type), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp) :: corner
      integer :: i

      corner = huge(corner)
      do i = 1, size(self%motions)
         associate (motion => self%motions(i))
            if (motion%has_amplitude) corner = min(corner, &
                  corner_after(motion%amplitude, motion%t_start, t))
         end associate
      end do
   end function next_motion_corner

   pure subroutine evaluate(motion, t, d, v, a)
      type(motion_type), intent(in) :: motion
      real(wp), intent(in) :: t
      real(wp), intent(out) :: d, v, a
      real(wp) :: elapsed, factor(4)   !! amplitude's second and first integral, value, slope

      elapsed = t - motion%t_start
      factor = [elapsed**2/2.0_wp, elapsed, 1.0_wp, 0.0_wp]
      if (motion%ramped) factor(3:4) = [elapsed, 1.0_wp]/motion%duration
      if (motion%has_amplitude) factor = amplitude_factors(motion, t)
      a = 0.0_wp
      select case (motion%motion)
      case (motion_displacement)
         d = motion%value*factor(3)
         if (motion%ramped) d = motion%d_start + (motion%value - motion%d_start)*factor(3)
         v = motion%value*factor(4)
         if (motion%ramped) v = 0.0_wp
      case (motion_velocity)
         d = motion%d_start + motion%value*factor(2)
         v = motion%value*factor(3)
         a = motion%value*factor(4)
      case default
         d = motion%d_start + motion%v_start*elapsed + motion%value*factor(1)
         v = motion%v_start + motion%value*factor(2)
         a = motion%value*factor(3)
      end select
   end subroutine evaluate

   !> Amplitude integrated from the condition's start on.
   pure function amplitude_factors(motion, t) result(factor)
      type(motion_type), intent(in) :: motion
      real(wp), intent(in) :: t
      real(wp) :: factor(4)
      real(wp) :: from, to, first

      associate (start => amplitude_start(motion%amplitude, motion%t_start))
         from = motion%t_start - start
         to = t - start
      end associate
      first = amplitude_integral(motion%amplitude, from)
      factor(1) = amplitude_second_integral(motion%amplitude, to) &
            - amplitude_second_integral(motion%amplitude, from) - first*(to - from)
      factor(2) = amplitude_integral(motion%amplitude, to) - first
      factor(3) = amplitude_at(motion%amplitude, to)
      factor(4) = amplitude_slope(motion%amplitude, to)
   end function amplitude_factors

end module prescribed_motion
