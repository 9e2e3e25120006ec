!> Friction acts along one line: the tangent of a surface in the x-y plane. Where a node can slide
!> off that line it would slide for nothing, so such a deck is refused.
module friction_line
   use kinds, only: wp
   use errors, only: error_type
   use text, only: to_text
   use places, only: fail_at
   use model, only: model_type
   use contact_pairs, only: contact_pair_list_type, row_fixed
   use constraint_rows, only: rows_type
   implicit none
   private

   public :: check_friction

   !> Normals with a smaller part along z lie in the plane.
   real(wp), parameter :: round_off = 1.0e-9_wp
   character(len=*), parameter :: cure = 'turn the model so that all sliding is in the x-y ' &
         //'plane, or leave *FRICTION away'

contains

   !> Errors: friction on a wall whose normal leaves the x-y plane, or at a node that the deck
   !> itself sets in motion along z.
   subroutine check_friction(model, list, rows, freedom, error)
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(in) :: list
      type(rows_type), intent(in) :: rows
      integer, intent(in) :: freedom(:, :)       !! (3, n_nodes), 0 where there is none
      type(error_type), allocatable, intent(out) :: error
      logical :: driven(size(freedom, 2))
      integer :: i

      if (.not. any(rows%friction > 0.0_wp)) return
      call mark_driven(model, freedom, driven)
      do i = 1, rows%n
         if (.not. rows%friction(i) > 0.0_wp) cycle
         associate (row => list%rows(i))
            if (row%kind == row_fixed .and. abs(row%normal(3)) > round_off) then
               call fail_at(error, model%source, row%place, 'friction on a surface whose normal ' &
                     //'has a z component: it acts along one line, in the x-y plane', cure)
               return
            end if
            if (.not. driven(row%node)) cycle
            call fail_at(error, model%source, row%place, 'friction at node ' &
                  //to_text(model%nodes%id(row%node))//', which moves along z: it acts along one ' &
                  //'line, in the x-y plane', cure)
            return
         end associate
      end do
   end subroutine check_friction

   !> Nodes with a freedom along z that a velocity, a load, a condition, gravity or the base moves.
   subroutine mark_driven(model, freedom, driven)
      type(model_type), intent(in) :: model
      integer, intent(in) :: freedom(:, :)
      logical, intent(out) :: driven(:)          !! (n_nodes)
      integer :: s, i

      driven = .false.
      associate (start => model%initial_velocities, held => model%boundaries)
         call mark(start%dof, start%node, start%value)
         call mark(held%dof, held%node, held%value)
      end associate
      do s = 1, size(model%steps)
         associate (step => model%steps(s))
            call mark(step%initial_velocities%dof, step%initial_velocities%node, &
                  step%initial_velocities%value)
            call mark(step%loads%dof, step%loads%node, step%loads%value)
            call mark(step%boundaries%dof, step%boundaries%node, step%boundaries%value)
            do i = 1, size(step%gravity)
               if (abs(step%gravity(i)%acceleration(3)) > 0.0_wp) driven = .true.
            end do
            if (any(step%base_motions%dof == 3)) driven = .true.
         end associate
      end do
      driven = driven .and. freedom(3, :) > 0

   contains

      subroutine mark(dof, node, value)
         integer, intent(in) :: dof(:), node(:)
         real(wp), intent(in) :: value(:)

         driven(pack(node, dof == 3 .and. abs(value) > 0.0_wp)) = .true.
      end subroutine mark

   end subroutine mark_driven

end module friction_line
