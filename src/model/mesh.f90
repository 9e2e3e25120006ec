!> Nodes, elements and sets as the deck gives them.
module mesh
   use kinds, only: wp
   use integer_map, only: integer_map_type
   use places, only: place_type
   use properties, only: name_length
   implicit none
   private

   public :: node_table_type, element_table_type, set_type, element_group_type
   public :: element_mass, element_spring1, element_spring2, element_springa
   public :: element_dashpot1, element_dashpot2, element_dashpota, element_truss, element_gap
   public :: element_line, is_solid_kind, solid_plane, solid_topology, solid_reduced
   public :: plane_strain, plane_stress, axisymmetric, tri3, quad4, tri6, quad8
   public :: scheme_implicit, scheme_explicit, scheme_automatic, mass_lumped, mass_consistent

   integer, parameter :: element_mass = 1
   integer, parameter :: element_spring1 = 2
   integer, parameter :: element_spring2 = 3
   integer, parameter :: element_springa = 4
   integer, parameter :: element_dashpot1 = 5
   integer, parameter :: element_dashpot2 = 6
   integer, parameter :: element_dashpota = 7
   integer, parameter :: element_truss = 8
   integer, parameter :: element_gap = 9

   !> A line of two or three nodes without a section: it marks a boundary and carries nothing.
   integer, parameter :: element_line = 10

   !> Solids have kinds 100 plane + 10 topology + 1 if the quadrature is reduced: CPE4R is 121.
   integer, parameter :: plane_strain = 1, plane_stress = 2, axisymmetric = 3
   integer, parameter :: tri3 = 1, quad4 = 2, tri6 = 3, quad8 = 4

   integer, parameter :: scheme_implicit = 1
   integer, parameter :: scheme_explicit = 2
   integer, parameter :: scheme_automatic = 3   !! explicit where stable at the step, else implicit
   integer, parameter :: mass_lumped = 1
   integer, parameter :: mass_consistent = 2

   !> All nodes, in the order of the deck.
   type :: node_table_type
      integer :: n = 0
      integer, allocatable :: id(:)              !! (n) the deck's ids
      real(wp), allocatable :: x(:, :)           !! (3, n)
      type(place_type), allocatable :: place(:)  !! (n)
      type(integer_map_type) :: index_of         !! deck id to index
   end type node_table_type

   !> All elements, in the order of the deck; nodes as indices, compressed.
   type :: element_table_type
      integer :: n = 0
      integer, allocatable :: id(:)              !! (n) the deck's ids
      integer, allocatable :: kind(:)            !! (n) one of the element_ parameters
      integer, allocatable :: first(:)           !! (n+1) element e has nodes(first(e):first(e+1)-1)
      integer, allocatable :: nodes(:)           !! node indices
      integer, allocatable :: section(:)         !! (n) index of its section, 0 without one
      type(place_type), allocatable :: place(:)  !! (n)
      type(integer_map_type) :: index_of         !! deck id to index
   end type element_table_type

   !> A named set of nodes or elements; members are indices, ascending, each once.
   type :: set_type
      character(len=name_length) :: name = ''
      integer, allocatable :: members(:)
      type(place_type) :: place
   end type set_type

   !> `*ELEMENT GROUP`: how the elements of a set are integrated in time.
   type :: element_group_type
      integer :: set = 0
      integer :: scheme = scheme_implicit
      integer :: mass = 0                        !! mass_ parameter, 0: not said
      type(place_type) :: place
   end type element_group_type

contains

   !> Whether a kind is that of a plane or axisymmetric solid.
   pure elemental function is_solid_kind(kind) result(solid)
      integer, intent(in) :: kind
      logical :: solid

      solid = kind > 100
   end function is_solid_kind

   !> plane_strain, plane_stress or axisymmetric.
   pure elemental function solid_plane(kind) result(plane)
      integer, intent(in) :: kind
      integer :: plane

      plane = kind/100
   end function solid_plane

   !> tri3, quad4, tri6 or quad8.
   pure elemental function solid_topology(kind) result(topology)
      integer, intent(in) :: kind
      integer :: topology

      topology = modulo(kind, 100)/10
   end function solid_topology

   !> Whether the quadrature is reduced (the R names).
   pure elemental function solid_reduced(kind) result(reduced)
      integer, intent(in) :: kind
      logical :: reduced

      reduced = modulo(kind, 10) == 1
   end function solid_reduced

end module mesh
