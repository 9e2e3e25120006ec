!> Small models with contact made into scenes, as a run would do it.
module small_scenes
   use kinds, only: wp
   use contact_models, only: add_interaction
   use contact_pairs, only: contact_pair_list_type, find_contact_rows
   use contact_geometry, only: new_contact_geometry
   use constraint_rows, only: row_vector
   use row_placement, only: new_rows
   use energy_ledger, only: open_ledger
   use errors, only: error_type
   use impact_factory, only: make_impact_method
   use impact_method, only: impact_method_type
   use impact_scene, only: scene_type, contact_motion_type, new_contact_motion
   use mesh, only: scheme_implicit
   use model, only: model_type
   use small_models, only: start_model, add_node, add_mass, add_spring1, add_step
   use small_systems, only: start_system
   use structure, only: inertia_force, elastic_force
   use surfaces, only: interaction_type, beta_given
   implicit none
   private

   public :: start_scene, free_masses, dense_rows, dense_mass, dense_stiffness, n_events
   public :: plain_impact, bounce

contains

   !> The scene at rest at the start of the model's first step, and its method.
   subroutine start_scene(scene, motion, model, error, method)
      type(scene_type), intent(out) :: scene
      type(contact_motion_type), intent(out) :: motion
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      class(impact_method_type), allocatable, intent(out), optional :: method
      class(impact_method_type), allocatable :: made
      type(contact_pair_list_type) :: list
      integer :: i

      call find_contact_rows(model, list, error)
      if (allocated(error)) return
      call start_system(scene%system, motion%motion, model, error)
      if (allocated(error)) return
      call new_contact_geometry(scene%geometry, model, list)
      call new_rows(scene%rows, scene%geometry, list, model, scene%system%structure, error)
      if (allocated(error)) return
      call make_impact_method(model, list, made, scene%settings, error)
      if (allocated(error)) return
      if (present(method)) call move_alloc(made, method)
      scene%impulse = [(0.0_wp, i=1, scene%rows%n)]
      scene%curvature = scene%impulse
      call new_contact_motion(motion, scene%system%structure%map%n_freedoms, scene%rows%n, &
            scene%system%structure%n_history)
      call open_ledger(scene%ledger, scene%system, motion%motion)
   end subroutine start_scene

   !> Masses at x = 1, 2, ... that nothing connects, each with a spring to the ground (0: none), and
   !> an interaction; a dynamic step of 10.
   function free_masses(m, k, interaction) result(model)
      real(wp), intent(in) :: m(:), k(:)
      type(interaction_type), intent(in) :: interaction
      type(model_type) :: model
      integer :: i

      call start_model(model)
      call add_interaction(model, interaction)
      do i = 1, size(m)
         call add_node(model, [real(i, wp), 0.0_wp, 0.0_wp])
      end do
      do i = 1, size(m)
         call add_spring1(model, i, 1, k(i))
         call add_mass(model, i, m(i))
      end do
      call add_step(model, 10.0_wp)
   end function free_masses

   !> `*IMPACT` without restitution, every impact step with beta = 1/4.
   function plain_impact() result(interaction)
      type(interaction_type) :: interaction

      interaction%beta_choice = beta_given
      interaction%beta = 0.25_wp
   end function plain_impact

   !> The same with a restitution coefficient; no rebound is captured.
   function bounce(e) result(interaction)
      real(wp), intent(in) :: e
      type(interaction_type) :: interaction

      interaction = plain_impact()
      interaction%has_restitution = .true.
      interaction%restitution = e
      interaction%has_capture = .true.
      interaction%capture = 0.0_wp
   end function bounce

   !> G in full.
   function dense_rows(scene) result(g)
      type(scene_type), intent(in) :: scene
      real(wp) :: g(scene%rows%n, scene%system%structure%map%n_freedoms)
      integer :: i

      do i = 1, scene%rows%n
         g(i, :) = row_vector(scene%rows, i, size(g, 2))
      end do
   end function dense_rows

   !> M in full, column by column.
   function dense_mass(scene) result(m)
      type(scene_type), intent(in) :: scene
      real(wp), allocatable :: m(:, :)
      real(wp) :: unit(scene%system%structure%map%n_freedoms)
      integer :: j

      allocate (m(size(unit), size(unit)))
      do j = 1, size(unit)
         unit = 0.0_wp
         unit(j) = 1.0_wp
         m(:, j) = inertia_force(scene%system%structure, unit)
      end do
   end function dense_mass

   !> K of the implicit elements in full, of a linear structure.
   function dense_stiffness(scene) result(k)
      type(scene_type), intent(in) :: scene
      real(wp), allocatable :: k(:, :)
      real(wp) :: unit(scene%system%structure%map%n_freedoms)
      real(wp), dimension(scene%system%structure%n_history) :: history, updated
      integer :: j

      allocate (k(size(unit), size(unit)))
      k = 0.0_wp
      history = 0.0_wp
      updated = history
      do j = 1, size(unit)
         unit = 0.0_wp
         unit(j) = 1.0_wp
         call elastic_force(scene%system%structure, scheme_implicit, unit, history, k(:, j), &
               updated)
      end do
   end function dense_stiffness

   !> How many events of a kind were recorded.
   integer function n_events(scene, kind)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: kind

      n_events = 0
      if (scene%n_events > 0) n_events = count(scene%events(:scene%n_events)%kind == kind)
   end function n_events

end module small_scenes
