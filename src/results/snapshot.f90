!> Values to record at one time, on nodes, elements and contact rows.
module snapshot
   use kinds, only: wp
   use motion_state, only: state_type
   use reactions, only: reaction_forces
   use constraint_rows, only: row_forces, row_gaps
   use impact_scene, only: scene_type, contact_motion_type
   implicit none
   private

   public :: snapshot_type, take_snapshot, on_nodes, element_values

   !> Motion and forces on freedoms; gaps and forces of contact rows.
   type :: snapshot_type
      real(wp) :: time = 0.0_wp
      real(wp), allocatable :: u(:), v(:), a(:), rf(:), cf(:)   !! (n_freedoms)
      real(wp), allocatable :: lambda(:), gap(:), impulse(:)    !! (n_rows)
   end type snapshot_type

contains

   !> Takes down a state; reactions only when asked for, since they cost an internal force.
   subroutine take_snapshot(self, scene, motion, with_reactions)
      type(snapshot_type), intent(out) :: self
      type(scene_type), intent(in) :: scene
      type(contact_motion_type), intent(in) :: motion
      logical, intent(in) :: with_reactions

      self%time = motion%motion%t
      self%u = motion%motion%d
      self%v = motion%motion%v
      self%a = motion%motion%a
      self%lambda = motion%lambda
      self%gap = row_gaps(scene%rows, motion%motion)
      self%impulse = scene%impulse
      self%cf = row_forces(scene%rows, motion%lambda, size(self%u))
      self%rf = 0.0_wp*self%u
      if (with_reactions) self%rf = reaction_forces(scene%system, motion%motion, self%cf)
   end subroutine take_snapshot

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

   !> Axial stress, axial strain, energy density of an element of a group.
   pure function element_values(scene, group, e, u) result(values)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: group, e
      real(wp), intent(in) :: u(:)               !! (n_freedoms)
      real(wp) :: values(3)
      real(wp) :: d(size(scene%system%structure%groups(group)%lm, 1))
      integer :: i

      associate (g => scene%system%structure%groups(group))
         d = 0.0_wp
         do i = 1, size(d)
            if (g%lm(i, e) > 0) d(i) = u(g%lm(i, e))
         end do
         values = g%element%stress(e, d)
      end associate
   end function element_values

end module snapshot
