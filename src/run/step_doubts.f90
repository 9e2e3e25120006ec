!> Dynamic steps of fixed increments too long for what they are to show: the longest period, or the
!> time that bodies stay in contact.
module step_doubts
   use kinds, only: wp
   use text, only: to_text
   use places, only: note_at
   use mesh, only: scheme_implicit
   use steps, only: procedure_dynamic
   use structure, only: count_resisting
   use continuum_bodies, only: body_list_type
   use contact_outlook, only: outlook_type, look_out, duration_text
   use driven_reactions, only: doubt_reactions
   use penalty_springs, only: penalty_type, find_penalty, enough_of_penalty
   use scene_setup, only: simulation_type, add_remark
   implicit none
   private

   public :: doubt_step, may_be_too_long

   !> Increments in the longest period or in a contact below which neither is resolved, and what is
   !> advised; the trapezoidal rule lengthens periods by 0.8 and 0.13 %.
   real(wp), parameter :: least_increments = 20.0_wp, least_of_contact = 10.0_wp, &
         good_increments = 50.0_wp
   !> Increments in a period of a mass on its penalty spring: with fewer a hit adds some hundredths
   !> of the energy and more, with 0.4 and fewer many times it.
   real(wp), parameter :: least_of_penalty = 4.0_wp
   !> With ORDER=4 so many times fewer do.
   real(wp), parameter :: of_fourth_order = 4.0_wp

contains

   !> Whether a step has fixed increments that no critical step limits.
   logical function may_be_too_long(simulation, i_step)
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step

      associate (step => simulation%model%steps(i_step))
         may_be_too_long = step%procedure == procedure_dynamic .and. step%direct .and. &
               count_resisting(simulation%scene%system%structure, scheme_implicit) > 0
      end associate
   end function may_be_too_long

   !> Remarks on a step that is in force.
   subroutine doubt_step(simulation, i_step, bodies, period)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(body_list_type), intent(in) :: bodies
      real(wp), intent(in) :: period             !! the longest, 0: not known
      type(outlook_type), allocatable :: outlooks(:)
      real(wp) :: dt, shortest
      character(len=:), allocatable :: text
      integer :: p

      call doubt_penalty(simulation, i_step)
      call doubt_reactions(simulation, i_step)
      if (.not. may_be_too_long(simulation, i_step)) return
      associate (step => simulation%model%steps(i_step))
         dt = step%dt
         if (step%order == 4) dt = dt/of_fourth_order
      end associate
      if (simulation%scene%rows%n > 0 .and. i_step == 1 .and. bodies%n > 0) then
         call look_out(simulation, i_step, bodies, outlooks)
         shortest = huge(1.0_wp)
         do p = 1, size(outlooks)
            if (.not. outlooks(p)%known .or. outlooks(p)%first == 0) cycle
            if (outlooks(p)%duration >= shortest) cycle
            shortest = outlooks(p)%duration
            text = duration_text(outlooks(p), 3)
         end do
         if (shortest < least_of_contact*dt) then
            call remark('a contact that lasts about '//text, shortest)
            return
         end if
      end if
      if (period > 0.0_wp .and. period < least_increments*dt) call remark('the longest period, ' &
            //to_text(period, 3), period)

   contains

      subroutine remark(what, time)
         character(len=*), intent(in) :: what
         real(wp), intent(in) :: time

         call add_remark(simulation, note_at(simulation%model%source, &
               simulation%model%steps(i_step)%time_place, 'warning: the step ' &
               //to_text(simulation%model%steps(i_step)%dt)//' is too large for '//what &
               //': that is '//to_text(time/simulation%model%steps(i_step)%dt, &
               2)//' increments'//new_line('a')//'  cure: take a step of about ' &
               //to_text(time/good_increments*simulation%model%steps(i_step)%dt/dt, 2) &
               //'; carom check --explain says what it has to resolve'))
      end subroutine remark

   end subroutine doubt_step

   !> A step that does not resolve the springs of the penalty method.
   subroutine doubt_penalty(simulation, i_step)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(penalty_type) :: penalty
      real(wp) :: dt, ratio

      associate (step => simulation%model%steps(i_step))
         if (step%procedure /= procedure_dynamic .or. .not. step%direct) return
         dt = step%dt
      end associate
      call find_penalty(simulation, penalty)
      if (penalty%row == 0) return
      ratio = penalty%period/dt
      if (.not. ratio < least_of_penalty) return
      call add_remark(simulation, note_at(simulation%model%source, &
            simulation%model%steps(i_step)%time_place, 'warning: the step '//to_text(dt) &
            //' is too large for the penalty spring of node ' &
            //to_text(simulation%scene%rows%node_id(penalty%row))//': the mass ' &
            //to_text(penalty%mass, 3)//' there has the period '//to_text(penalty%period, 3) &
            //' on STIFFNESS='//to_text(penalty%stiffness)//', '//to_text(ratio, 2) &
            //' increments; contact may give energy to it'//new_line('a') &
            //'  cure: a step of about '//to_text(penalty%period/enough_of_penalty, 2) &
            //', STIFFNESS='//to_text(penalty%stiffness*(ratio/enough_of_penalty)**2, 2) &
            //', or METHOD=TRANSFORMATION'))
   end subroutine doubt_penalty

end module step_doubts
