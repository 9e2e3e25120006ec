!> Values to record at one time, on nodes, elements and contact rows.
module snapshot
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use element_interface, only: n_recovered
   use reactions, only: reaction_forces
   use constraint_rows, only: row_gaps
   use impact_scene, only: scene_type, contact_motion_type
   use gap_probe, only: not_a_number
   implicit none
   private

   public :: snapshot_type, take_snapshot, on_nodes, element_values, point_values
   public :: state_none, state_open, state_stuck, state_sliding

   !> What a contact node does.
   integer, parameter :: state_none = 0       !! no contact node
   integer, parameter :: state_open = 1
   integer, parameter :: state_stuck = 2      !! touching, sticking if there is friction
   integer, parameter :: state_sliding = 3    !! touching, with friction, and sliding

   !> Motion and forces on freedoms; gaps and forces of contact rows.
   type :: snapshot_type
      real(wp) :: time = 0.0_wp
      real(wp), allocatable :: u(:), v(:), a(:), rf(:), cf(:)   !! (n_freedoms)
      real(wp), allocatable :: history(:)                       !! (n_history)
      real(wp), allocatable :: lambda(:), tau(:), impulse(:)    !! (n_rows)
      real(wp), allocatable :: gap(:)                           !! (n_rows) NaN without a partner
      real(wp), allocatable :: pressure(:)                      !! (n_rows) zero unless asked for
      real(wp), allocatable :: force(:, :)                      !! (3, n_rows) likewise
      real(wp), allocatable :: slip(:)                          !! (n_rows) path so far
      integer, allocatable :: state(:)                          !! (n_rows) state_ parameters
   end type snapshot_type

contains

   !> Takes down a state; reactions only when asked for, since they cost an internal force.
   subroutine take_snapshot(self, scene, motion, with_reactions)
      type(snapshot_type), intent(out) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      logical, intent(in) :: with_reactions
      integer :: status

      self%time = motion%motion%t
      self%u = motion%motion%d
      self%v = motion%motion%v
      self%a = motion%motion%a
      self%history = motion%motion%history
      self%lambda = motion%lambda
      self%gap = row_gaps(scene%rows, motion%motion)
      where (.not. scene%rows%facing) self%gap = not_a_number()
      self%pressure = 0.0_wp*self%lambda
      allocate (self%force(3, scene%rows%n), stat=status)
      call check_allocation(status)
      self%force = 0.0_wp
      self%slip = motion%slip
      self%state = row_states(scene, motion)
      self%impulse = scene%impulse
      self%cf = motion%force
      self%tau = motion%tau
      self%rf = 0.0_wp*self%u
      if (with_reactions) self%rf = reaction_forces(scene%system, motion%motion, self%cf)
   end subroutine take_snapshot

   !> What the contactors of all rows do.
   pure function row_states(scene, motion) result(states)
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      integer :: states(scene%rows%n)

      states = state_open
      where (motion%touching .or. motion%lambda > 0.0_wp) states = state_stuck
      where (motion%lambda > 0.0_wp .and. scene%rows%friction > 0.0_wp .and. .not. &
            motion%sticking) states = state_sliding
   end function row_states

   !> Values on freedoms as three components a node, zero where a freedom does not exist.
   pure function on_nodes(freedom, values) result(vectors)
      integer, intent(in) :: freedom(:, :)       !! (3, n_nodes)
      real(wp), intent(in) :: values(:)          !! (n_freedoms)
      real(wp) :: vectors(3, size(freedom, 2))
      integer :: i, j

      vectors = 0.0_wp
      do j = 1, size(freedom, 2)
         do i = 1, 3
            if (freedom(i, j) > 0) vectors(i, j) = values(freedom(i, j))
         end do
      end do
   end function on_nodes

   !> Stresses and the rest of an element of a group, their means over its volume.
   function element_values(scene, group, e, snapshot) result(values)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: group, e
      type(snapshot_type), intent(in) :: snapshot
      real(wp) :: values(n_recovered)
      real(wp) :: points(n_recovered, scene%system%structure%groups(group)%element%n_points)

      points = point_values(scene, group, e, snapshot)
      values = matmul(points, scene%system%structure%groups(group)%element%point_shares(e))
   end function element_values

   !> Stresses and the rest at the points of an element of a group.
   function point_values(scene, group, e, snapshot) result(values)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: group, e
      type(snapshot_type), intent(in) :: snapshot
      real(wp) :: values(n_recovered, scene%system%structure%groups(group)%element%n_points)
      real(wp) :: d(size(scene%system%structure%groups(group)%lm, 1))
      integer :: i, first, n

      scene%system%cost%stress_updates = scene%system%cost%stress_updates + 1
      associate (g => scene%system%structure%groups(group))
         d = 0.0_wp
         do i = 1, size(d)
            if (g%lm(i, e) > 0) d(i) = snapshot%u(g%lm(i, e))
         end do
         n = g%element%n_history
         first = g%history_start + (e - 1)*n + 1
         call g%element%recover(e, d, snapshot%history(first:first + n - 1), values)
      end associate
   end function point_values

end module snapshot
