!> Reactions at nodes whose displacement is given by points of a curve: between two of them the
!> velocity is constant, all acceleration is in its jumps, and the inertia of what moves shows in no
!> reaction.
module driven_reactions
   use kinds, only: wp
   use text, only: to_text
   use places, only: note_at
   use histories, only: amplitude_type, motion_displacement
   use steps, only: step_type, procedure_dynamic, request_node_print, request_node_file, quantity_rf
   use model, only: model_type
   use structure, only: diagonal_mass
   use scene_setup, only: simulation_type, add_remark
   implicit none
   private

   public :: doubt_reactions

   !> So many corners make a curve of points; ramps and pulses of straight lines have fewer.
   integer, parameter :: corners_of_curve = 3
   real(wp), parameter :: straight = 1.0e-9_wp   !! part of the slopes that a corner changes

contains

   !> A remark on the first such node of a step whose reactions are asked for.
   subroutine doubt_reactions(simulation, i_step)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      real(wp), allocatable :: m(:)
      integer :: i, f

      associate (model => simulation%model, step => simulation%model%steps(i_step), &
            structure => simulation%scene%system%structure)
         if (step%procedure /= procedure_dynamic) return
         if (.not. any(step%boundaries%amplitude > 0)) return
         m = diagonal_mass(structure)
         do i = 1, size(step%boundaries)
            associate (one => step%boundaries(i))
               if (one%amplitude == 0 .or. one%motion /= motion_displacement) cycle
               if (.not. abs(one%value) > 0.0_wp) cycle
               if (.not. is_curve(model%amplitudes(one%amplitude))) cycle
               f = structure%map%freedom(one%dof, one%node)
               if (f == 0) cycle
               if (.not. m(f) > 0.0_wp .or. .not. asks_reaction(model, step, one%node)) cycle
               call add_remark(simulation, note_at(model%source, one%place, 'warning: the ' &
                     //'displacement of node '//to_text(model%nodes%id(one%node))//' goes ' &
                     //'straight from point to point of '//trim(model%amplitudes( &
                     one%amplitude)%name)//', without acceleration: its reaction RF lacks the ' &
                     //'inertia of the mass '//to_text(m(f), 4)//' there'//new_line('a') &
                     //'  cure: TYPE=VELOCITY or TYPE=ACCELERATION with the derivative of the ' &
                     //'curve; or add mass times acceleration to RF'))
               return
            end associate
         end do
      end associate
   end subroutine doubt_reactions

   !> Whether an amplitude is a curve by points.
   pure logical function is_curve(amplitude)
      type(amplitude_type), intent(in) :: amplitude
      real(wp) :: slopes(2)
      integer :: i, n

      n = 0
      associate (t => amplitude%t, a => amplitude%a)
         do i = 2, size(t) - 1
            slopes = [(a(i) - a(i - 1))/(t(i) - t(i - 1)), (a(i + 1) - a(i))/(t(i + 1) - t(i))]
            if (abs(slopes(2) - slopes(1)) > straight*maxval(abs(slopes))) n = n + 1
            if (n == corners_of_curve) exit
         end do
      end associate
      is_curve = n == corners_of_curve
   end function is_curve

   !> Whether the reaction at a node is printed or filed.
   pure logical function asks_reaction(model, step, node)
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      integer, intent(in) :: node
      integer :: i

      asks_reaction = .true.
      do i = 1, size(step%requests)
         associate (request => step%requests(i))
            if (all(request%kind /= [request_node_print, request_node_file])) cycle
            if (.not. request%wanted(quantity_rf)) cycle
            if (request%set == 0) return
            if (any(model%node_sets(request%set)%members == node)) return
         end associate
      end do
      asks_reaction = .false.
   end function asks_reaction

end module driven_reactions
