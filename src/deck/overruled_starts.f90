!> Initial conditions that have no effect because `*BOUNDARY` has their freedoms at that time.
module overruled_starts
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use places, only: note_at
   use histories, only: boundary_type, nodal_value_type, motion_displacement, motion_velocity, &
         motion_acceleration
   use steps, only: procedure_dynamic
   use model, only: model_type
   use source_reader, only: add_note
   use text, only: plural
   implicit none
   private

   public :: note_overruled_starts

   !> What *BOUNDARY says of the freedoms (3, n_nodes) in a step.
   type :: held_type
      integer, allocatable :: motion(:, :)       !! kind of condition, 0: none
      real(wp), allocatable :: value(:, :)       !! of a condition that is constant, else huge
   end type held_type

contains

   !> Notes the initial displacements and velocities, the model's and the steps', that are lost.
   subroutine note_overruled_starts(model)
      type(model_type), intent(inout) :: model
      type(held_type) :: held
      integer :: s, status
      logical :: moved

      if (n_values(model) == 0) return
      allocate (held%motion(3, model%nodes%n), source=0, stat=status)
      call check_allocation(status)
      allocate (held%value(3, model%nodes%n), source=0.0_wp, stat=status)
      call check_allocation(status)
      moved = .false.
      do s = 1, size(model%steps)
         call begin_step(held, model, s)
         if (model%steps(s)%procedure /= procedure_dynamic) cycle
         if (s == 1) call note_displacements(model, held)
         if (.not. moved) call note_velocities(model, held, model%initial_velocities, s == 1)
         moved = .true.
         call note_velocities(model, held, model%steps(s)%initial_velocities, .false.)
      end do
   end subroutine note_overruled_starts

   !> Initial values in the deck that are not zero.
   pure function n_values(model) result(n)
      type(model_type), intent(in) :: model
      integer :: n
      integer :: s

      n = count(abs(model%initial_displacements%value) > 0.0_wp) &
            + count(abs(model%initial_velocities%value) > 0.0_wp)
      do s = 1, size(model%steps)
         n = n + count(abs(model%steps(s)%initial_velocities%value) > 0.0_wp)
      end do
   end function n_values

   !> Brings the conditions of a step into force; those of steps before go on.
   subroutine begin_step(held, model, s)
      type(held_type), intent(inout) :: held
      type(model_type), intent(in) :: model
      integer, intent(in) :: s

      if (model%steps(s)%new_boundaries) then
         held%motion = 0
      else if (s == 1) then
         call hold(held, model%boundaries)
      end if
      call hold(held, model%steps(s)%boundaries)
   end subroutine begin_step

   pure subroutine hold(held, boundaries)
      type(held_type), intent(inout) :: held
      type(boundary_type), intent(in) :: boundaries(:)
      integer :: i

      do i = 1, size(boundaries)
         associate (boundary => boundaries(i))
            held%motion(boundary%dof, boundary%node) = boundary%motion
            held%value(boundary%dof, boundary%node) = boundary%value
            if (boundary%amplitude > 0) held%value(boundary%dof, boundary%node) = huge(1.0_wp)
         end associate
      end do
   end subroutine hold

   !> Displacements at the start of a first step that is dynamic; a static one begins at them.
   subroutine note_displacements(model, held)
      type(model_type), intent(inout) :: model
      type(held_type), intent(in) :: held
      logical :: lost(size(model%initial_displacements))
      integer :: i

      do i = 1, size(lost)
         associate (start => model%initial_displacements(i), value => held%value( &
               model%initial_displacements(i)%dof, model%initial_displacements(i)%node))
            lost(i) = held%motion(start%dof, start%node) == motion_displacement &
                  .and. abs(start%value) > 0.0_wp .and. abs(start%value - value) > 0.0_wp
         end associate
      end do
      call note_lost(model, model%initial_displacements, lost, 'displacement')
   end subroutine note_displacements

   !> Velocities at the start of a dynamic step.
   subroutine note_velocities(model, held, starts, first)
      type(model_type), intent(inout) :: model
      type(held_type), intent(in) :: held
      type(nodal_value_type), intent(in) :: starts(:)
      logical, intent(in) :: first               !! TYPE=ACCELERATION goes on from them
      logical :: lost(size(starts))
      integer :: i

      do i = 1, size(lost)
         associate (start => starts(i))
            select case (held%motion(start%dof, start%node))
            case (motion_displacement)
               lost(i) = abs(start%value) > 0.0_wp
            case (motion_velocity)
               lost(i) = abs(start%value) > 0.0_wp .and. &
                     abs(start%value - held%value(start%dof, start%node)) > 0.0_wp
            case (motion_acceleration)
               lost(i) = abs(start%value) > 0.0_wp .and. .not. first
            case default
               lost(i) = .false.
            end select
         end associate
      end do
      call note_lost(model, starts, lost, 'velocity')
   end subroutine note_velocities

   !> One note for all of a list: how many, and where the first of them stands.
   subroutine note_lost(model, starts, lost, what)
      type(model_type), intent(inout) :: model
      type(nodal_value_type), intent(in) :: starts(:)
      logical, intent(in) :: lost(:)
      character(len=*), intent(in) :: what

      if (any(lost)) call add_note(model%notes, note_at(model%source, &
            starts(findloc(lost, .true., dim=1))%place, 'the initial '//what//' of ' &
            //plural(count(lost), 'freedom')//' from here on has no effect: *BOUNDARY gives the ' &
            //'motion there from the start'))
   end subroutine note_lost

end module overruled_starts
