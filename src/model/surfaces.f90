!> Surfaces that may touch, and how they behave when they do.
module surfaces
   use kinds, only: wp
   use places, only: place_type
   use properties, only: name_length
   implicit none
   private

   public :: surface_type, rigid_surface_type, interaction_type, contact_pair_type
   public :: method_transformation, method_fictitious_force
   public :: beta_automatic, beta_given

   integer, parameter :: method_transformation = 1
   integer, parameter :: method_fictitious_force = 2

   integer, parameter :: beta_automatic = 1
   integer, parameter :: beta_given = 2

   !> `*SURFACE, TYPE=NODE`: the nodes that may touch.
   type :: surface_type
      character(len=name_length) :: name = ''
      integer, allocatable :: nodes(:)           !! node indices
      type(place_type) :: place
   end type surface_type

   !> `*RIGID SURFACE, TYPE=PLANE`: fixed, or moved along a direction by an amplitude.
   type :: rigid_surface_type
      character(len=name_length) :: name = ''
      real(wp) :: point(3) = 0.0_wp
      real(wp) :: normal(3) = 0.0_wp             !! outward unit normal
      integer :: amplitude = 0                   !! 0: at rest
      real(wp) :: motion(3) = 0.0_wp             !! displacement at amplitude 1
      type(place_type) :: place
   end type rigid_surface_type

   !> `*SURFACE INTERACTION` with its `*IMPACT`.
   type :: interaction_type
      character(len=name_length) :: name = ''
      logical :: has_impact = .false.            !! an `*IMPACT` card was given
      integer :: method = method_transformation
      logical :: has_restitution = .false.       !! absent: sustained contact
      real(wp) :: restitution = 0.0_wp           !! e in [0, 1]
      real(wp) :: return_parameter = 0.3_wp      !! alpha in (0, 1), fictitious force
      logical :: direct = .false.                !! fictitious force solved directly
      integer :: beta_choice = beta_automatic
      real(wp) :: beta = 0.0_wp                  !! beta of the impact step when given
      logical :: has_capture = .false.
      real(wp) :: capture = 0.0_wp               !! speed below which a rebound is captured
      integer :: max_events = 100                !! a step
      type(place_type) :: place
   end type interaction_type

   !> `*CONTACT PAIR`: the nodes of a surface against a rigid plane.
   type :: contact_pair_type
      integer :: contactor = 0                   !! index of the surface
      integer :: rigid_target = 0                !! index of the rigid surface
      integer :: interaction = 0
      type(place_type) :: place
   end type contact_pair_type

end module surfaces
