!> What steps of fourth order cannot do.
module order_check
   use kinds, only: wp
   use errors, only: error_type
   use places, only: fail_at
   use model, only: model_type
   use mesh, only: scheme_explicit
   use steps, only: step_type, procedure_dynamic
   use surfaces, only: method_transformation, beta_given
   use structure, only: freedom_name
   use constraint_rows, only: law_motion
   use impact_scene, only: scene_type
   implicit none
   private

   public :: check_order

contains

   !> Steps of fourth order are for linear implicit elements with mass and for frictionless contact
   !> rows that stay as they are, with METHOD=TRANSFORMATION.
   subroutine check_order(model, scene, step, error)
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      type(step_type), intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: what

      if (step%order /= 4 .or. step%procedure /= procedure_dynamic) return
      call find_obstacle(scene, what)
      if (.not. allocated(what)) call find_row_obstacle(scene, what)
      if (allocated(what)) call fail_at(error, model%source, step%order_place, &
            'ORDER=4 cannot do with '//what, 'remove ORDER, or what stands in its way')
   end subroutine check_order

   !> Elements and masses; not allocated if nothing is in the way.
   subroutine find_obstacle(scene, what)
      type(scene_type), intent(in) :: scene
      character(len=:), allocatable, intent(out) :: what
      integer :: f

      associate (structure => scene%system%structure, map => scene%system%structure%map)
         if (any(structure%groups%scheme == scheme_explicit)) then
            what = 'explicit elements'
         else if (.not. structure%is_linear) then
            what = 'nonlinear elements'
         else if (any(scene%system%massless)) then
            do f = 1, map%n_freedoms
               if (map%id(map%dof(f), map%node(f)) == 0) cycle
               if (scene%system%massless(map%id(map%dof(f), map%node(f)))) exit
            end do
            what = 'freedoms without mass: '//freedom_name(structure, f)//' has none'
         end if
      end associate
   end subroutine find_obstacle

   !> The contact rows and what the deck says of impacts.
   subroutine find_row_obstacle(scene, what)
      type(scene_type), intent(in) :: scene
      character(len=:), allocatable, intent(out) :: what

      if (scene%rows%n == 0) return
      associate (rows => scene%rows, settings => scene%settings)
         if (settings%method /= method_transformation) then
            what = 'a METHOD of *IMPACT other than TRANSFORMATION'
         else if (settings%anchored) then
            what = 'EVENTS=ANCHOR of *IMPACT: it steps to every impact anew'
         else if (settings%beta_choice == beta_given) then
            what = 'BETA of *IMPACT: its steps are not Newmark''s'
         else if (rows%moving) then
            what = 'bodies that slide on each other or on a circle (SMALL SLIDING may do)'
         else if (any(rows%amplitude > 0)) then
            what = 'a moving rigid surface'
         else if (any(rows%friction > 0.0_wp)) then
            what = 'friction'
         else if (any(rows%massless) .or. any(rows%law /= law_motion)) then
            what = 'contact nodes without mass'
         end if
      end associate
   end subroutine find_row_obstacle

end module order_check
