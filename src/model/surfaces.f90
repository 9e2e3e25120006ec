!> Surfaces that may touch, and how they behave when they do.
module surfaces
   use kinds, only: wp
   use places, only: place_type
   use properties, only: name_length
   implicit none
   private

   public :: surface_type, rigid_surface_type, interaction_type, contact_pair_type
   public :: method_transformation, method_fictitious_force, method_penalty, method_lagrange
   public :: beta_automatic, beta_given, rigid_plane, rigid_circle

   integer, parameter :: method_transformation = 1
   integer, parameter :: method_fictitious_force = 2
   integer, parameter :: method_penalty = 3
   integer, parameter :: method_lagrange = 4

   integer, parameter :: rigid_plane = 1
   integer, parameter :: rigid_circle = 2

   integer, parameter :: beta_automatic = 1
   integer, parameter :: beta_given = 2

   !> `*SURFACE`: the nodes that may touch and, for TYPE=ELEMENT, the edges between them. Going
   !> along an edge from its first node to its second, its body lies on the left.
   type :: surface_type
      character(len=name_length) :: name = ''
      integer, allocatable :: nodes(:)           !! node indices, ascending, each once
      !> (3, n) nodes: ends, then the middle one or 0; of no size for TYPE=NODE
      integer, allocatable :: edges(:, :)
      integer, allocatable :: edge_element(:)    !! (n) element index of each edge
      type(place_type) :: place
   end type surface_type

   !> `*RIGID SURFACE`: a plane or a circle, fixed, or moved along a direction by an amplitude.
   type :: rigid_surface_type
      character(len=name_length) :: name = ''
      integer :: kind = rigid_plane
      real(wp) :: point(3) = 0.0_wp              !! a point of the plane, the centre of the circle
      real(wp) :: normal(3) = 0.0_wp             !! outward unit normal of a plane
      real(wp) :: radius = 0.0_wp                !! of a circle; negative: bodies are inside it
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
      logical :: anchored = .false.              !! EVENTS=ANCHOR: steps of one size from events
      integer :: beta_choice = beta_automatic
      real(wp) :: beta = 0.0_wp                  !! beta of the impact step when given
      logical :: has_capture = .false.
      real(wp) :: capture = 0.0_wp               !! speed below which a rebound is captured
      integer :: max_events = 100                !! a step
      real(wp) :: stiffness = 0.0_wp             !! penalty: force by overlap of a node
      real(wp) :: friction = 0.0_wp              !! Coulomb's mu, 0 without
      type(place_type) :: place
   end type interaction_type

   !> `*CONTACT PAIR`: the slave surface against a master surface or a rigid one.
   type :: contact_pair_type
      integer :: contactor = 0                   !! index of the slave surface
      integer :: target = 0                      !! index of the master surface, 0: rigid
      integer :: rigid_target = 0                !! index of the rigid surface, 0: deformable
      integer :: interaction = 0
      logical :: weighted = .false.              !! SURFACE TO SURFACE: rows weighted over edges
      integer :: passes = 1                      !! 2: each surface is slave once
      logical :: redistributed = .false.         !! MASS=REDISTRIBUTED: contact nodes without mass
      logical :: small_sliding = .false.         !! rows as in the undeformed geometry
      logical :: adjust = .false.                !! ADJUST: nodes are moved onto the master surface
      real(wp) :: adjust_distance = 0.0_wp       !! also those that are open by no more than this
      type(place_type) :: place
   end type contact_pair_type

end module surfaces
