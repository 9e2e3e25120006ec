!> Loads and initial conditions need freedoms that exist.
module named_freedoms
   use kinds, only: wp
   use errors, only: error_type
   use text, only: to_text
   use places, only: fail_at
   use model, only: model_type
   use histories, only: nodal_value_type
   implicit none
   private

   public :: check_named_freedoms

contains

   !> Error: a value, not zero, at a freedom that does not exist.
   subroutine check_named_freedoms(model, freedom, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: freedom(:, :)       !! (3, n_nodes), 0 where there is none
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      call check_values(model%initial_displacements, 'initial displacement')
      call check_values(model%initial_velocities, 'initial velocity')
      do i = 1, size(model%steps)
         call check_values(model%steps(i)%loads, 'load')
         call check_values(model%steps(i)%initial_velocities, 'initial velocity')
      end do

   contains

      subroutine check_values(values, what)
         type(nodal_value_type), intent(in) :: values(:)
         character(len=*), intent(in) :: what
         integer :: k

         if (allocated(error)) return
         do k = 1, size(values)
            if (freedom(values(k)%dof, values(k)%node) > 0) cycle
            if (.not. abs(values(k)%value) > 0.0_wp) cycle
            call fail_at(error, model%source, values(k)%place, what//' on node ' &
                  //to_text(model%nodes%id(values(k)%node))//', freedom ' &
                  //to_text(values(k)%dof) &
                  //', which does not exist: no element there can move that way', &
                  'load a direction that an element or a mass has')
            return
         end do
      end subroutine check_values

   end subroutine check_named_freedoms

end module named_freedoms
