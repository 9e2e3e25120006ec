!> Whether surfaces face each other: pairs that can never touch because other sides of a body were
!> named.
module surface_sides
   use kinds, only: wp
   use places, only: note_at
   use model, only: model_type
   use surfaces, only: rigid_plane
   use row_placement, only: nodal_displacements
   use scene_setup, only: simulation_type, add_remark
   implicit none
   private

   public :: doubt_sides

   !> Cosine of the angle beyond which two normals do not face each other.
   real(wp), parameter :: opposed = 1.0e-6_wp
   !> Of longer surfaces every n-th side is looked at.
   integer, parameter :: most_sides = 1000

   !> Middles, outward unit normals and lengths of sides; without sides, points with normal 0.
   type :: side_list_type
      integer :: n = 0
      real(wp), allocatable :: x(:, :), normal(:, :)   !! (2, n)
      real(wp), allocatable :: length(:)
   end type side_list_type

contains

   !> Remarks on the pairs that cannot touch.
   subroutine doubt_sides(simulation)
      type(simulation_type), intent(inout) :: simulation
      real(wp) :: x(3, simulation%model%nodes%n)
      type(side_list_type) :: slave, master
      integer :: p

      if (size(simulation%model%pairs) == 0) return
      associate (model => simulation%model)
         x = model%nodes%x(:, :model%nodes%n) + nodal_displacements( &
               simulation%scene%system%structure%map, simulation%motion%motion%d)
         do p = 1, size(model%pairs)
            associate (pair => model%pairs(p))
               if (pair%target == pair%contactor) cycle
               call list_sides(model, pair%contactor, x, slave)
               if (pair%target > 0) then
                  call list_sides(model, pair%target, x, master)
                  if (may_meet(slave, master)) cycle
               else
                  if (may_meet_wall(model, pair%rigid_target, slave)) cycle
               end if
               call add_remark(simulation, note_at(model%source, pair%place, &
                     facing_text(model, p)))
            end associate
         end do
      end associate
   end subroutine doubt_sides

   !> The sides of a surface, or its nodes.
   subroutine list_sides(model, surface, x, sides)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      real(wp), intent(in) :: x(:, :)            !! (3, n_nodes)
      type(side_list_type), intent(out) :: sides
      real(wp) :: along(2)
      integer :: i, k, stride

      associate (own => model%surfaces(surface))
         if (size(own%edges, 2) == 0) then
            stride = 1 + (size(own%nodes) - 1)/most_sides
            sides%x = x(:2, own%nodes(::stride))
            sides%n = size(sides%x, 2)
            sides%normal = 0.0_wp*sides%x
            sides%length = [(0.0_wp, i=1, sides%n)]
            return
         end if
         stride = 1 + (size(own%edges, 2) - 1)/most_sides
         sides%x = 0.5_wp*(x(:2, own%edges(1, ::stride)) + x(:2, own%edges(2, ::stride)))
         sides%n = size(sides%x, 2)
         sides%normal = sides%x
         sides%length = [(0.0_wp, i=1, sides%n)]
         do i = 1, sides%n
            k = 1 + (i - 1)*stride
            along = x(:2, own%edges(2, k)) - x(:2, own%edges(1, k))
            sides%length(i) = norm2(along)
            sides%normal(:, i) = [along(2), -along(1)]/max(sides%length(i), tiny(1.0_wp))
         end do
      end associate
   end subroutine list_sides

   !> Whether some side of each lies in front of the other, their normals opposed.
   pure logical function may_meet(slave, master)
      type(side_list_type), intent(in) :: slave, master
      integer :: i, j
      real(wp) :: apart(2), room

      may_meet = .true.
      do j = 1, master%n
         do i = 1, slave%n
            if (dot_product(slave%normal(:, i), master%normal(:, j)) > -opposed .and. &
                  slave%length(i) > 0.0_wp) cycle
            apart = slave%x(:, i) - master%x(:, j)
            room = slave%length(i) + master%length(j)
            if (dot_product(master%normal(:, j), apart) < -room) cycle
            if (dot_product(slave%normal(:, i), -apart) < -room) cycle
            return
         end do
      end do
      may_meet = .false.
   end function may_meet

   !> Whether some side of the slave faces a plane or circle.
   pure logical function may_meet_wall(model, wall, slave)
      type(model_type), intent(in) :: model
      integer, intent(in) :: wall
      type(side_list_type), intent(in) :: slave
      real(wp) :: normal(2)
      integer :: i

      may_meet_wall = .true.
      associate (rigid => model%rigid_surfaces(wall))
         do i = 1, slave%n
            normal = rigid%normal(:2)
            if (rigid%kind /= rigid_plane) normal = sign(1.0_wp, rigid%radius) &
                  *(slave%x(:, i) - rigid%point(:2))
            if (dot_product(slave%normal(:, i), normal) <= opposed*norm2(normal)) return
         end do
      end associate
      may_meet_wall = slave%n == 0
   end function may_meet_wall

   pure function facing_text(model, p) result(text)
      type(model_type), intent(in) :: model
      integer, intent(in) :: p                   !! index of the pair
      character(len=:), allocatable :: text
      character(len=:), allocatable :: slave, master
      character(len=*), parameter :: sides = 'side S1 of an element goes from its node 1 to 2, ' &
            //'S2 from 2 to 3, and so on'

      slave = trim(model%surfaces(model%pairs(p)%contactor)%name)
      if (model%pairs(p)%target > 0) then
         master = trim(model%surfaces(model%pairs(p)%target)%name)
         text = 'warning: no side of '//slave//' faces a side of '//master//': the pair cannot ' &
               //'touch, the bodies will pass through each other'//new_line('a')//'  cure: name ' &
               //'the sides on which they meet on both *SURFACE cards ('//sides//')'
      else
         master = trim(model%rigid_surfaces(model%pairs(p)%rigid_target)%name)
         text = 'warning: all sides of '//slave//' face away from '//master//': the body will ' &
               //'pass through it'//new_line('a')//'  cure: name the sides on which the body ' &
               //'meets it on *SURFACE ('//sides//'), or reverse the normal of '//master
      end if
   end function facing_text

end module surface_sides
