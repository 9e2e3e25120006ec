!> Bodies that lie wholly behind a rigid plane, or wholly on the wrong side of a circle: its normal
!> or the sign of its radius is most often the mistake.
module wall_side
   use kinds, only: wp
   use text, only: to_text
   use model, only: model_type
   use surfaces, only: rigid_plane
   use continuum_bodies, only: body_list_type, find_bodies
   implicit none
   private

   public :: lies_behind, wall_cure

contains

   !> Whether all nodes of the bodies that a pair's slave belongs to are behind its rigid surface.
   function lies_behind(model, pair, x, points) result(behind)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair                !! index of the pair
      real(wp), intent(in) :: x(:, :)            !! (3, n_nodes) at the start
      logical, intent(in) :: points              !! nodes of no body count too, which have no inside
      logical :: behind
      type(body_list_type) :: bodies
      logical :: meant(model%nodes%n)
      logical, allocatable :: of_slave(:)
      integer :: i

      behind = .false.
      if (model%pairs(pair)%rigid_target == 0) return
      call find_bodies(bodies, model)
      meant = .false.
      associate (nodes => model%surfaces(model%pairs(pair)%contactor)%nodes)
         meant(nodes) = .true.
         of_slave = [(.false., i=0, bodies%n)]   ! the first stands for nodes of no body
         of_slave(1 + bodies%of_node(nodes)) = .true.
      end associate
      of_slave(1) = .false.
      if (.not. (points .or. any(of_slave))) return
      meant = meant .or. of_slave(1 + bodies%of_node)
      associate (rigid => model%rigid_surfaces(model%pairs(pair)%rigid_target))
         do i = 1, model%nodes%n
            if (.not. meant(i)) cycle
            if (rigid%kind == rigid_plane) then
               if (dot_product(rigid%normal, x(:, i) - rigid%point) >= 0.0_wp) return
            else
               if (sign(1.0_wp, rigid%radius)*(norm2(x(:2, i) - rigid%point(:2)) &
                     - abs(rigid%radius)) >= 0.0_wp) return
            end if
         end do
      end associate
      behind = .true.
   end function lies_behind

   !> The cure for a body behind the rigid surface of a pair.
   pure function wall_cure(model, pair) result(cure)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      character(len=:), allocatable :: cure
      real(wp) :: normal(3)

      associate (rigid => model%rigid_surfaces(model%pairs(pair)%rigid_target))
         if (rigid%kind /= rigid_plane) then
            cure = 'the whole body lies on the solid side of circle '//trim(rigid%name) &
                  //': for bodies inside the circle the radius is negative, for those outside ' &
                  //'positive; write '//to_text(-rigid%radius)//', or move the body'
            return
         end if
         normal = -rigid%normal
         where (.not. abs(normal) > 0.0_wp) normal = 0.0_wp
         cure = 'the whole body lies behind plane '//trim(rigid%name)//', whose normal must ' &
               //'point out of the wall towards the body: write the normal '//to_text(normal(1)) &
               //', '//to_text(normal(2))
         if (abs(normal(3)) > 0.0_wp) cure = cure//', '//to_text(normal(3))
         cure = cure//', or move the body to the other side'
      end associate
   end function wall_cure

end module wall_side
