!> The element types of the deck, by name: what kind they become and how many nodes they have.
module element_types
   use mesh, only: element_mass, element_spring1, element_spring2, element_springa
   use mesh, only: element_dashpot1, element_dashpot2, element_dashpota, element_truss, element_gap
   use mesh, only: element_line, plane_strain, plane_stress, axisymmetric
   use mesh, only: tri3, quad4, tri6, quad8
   use words, only: word_length
   implicit none
   private

   public :: type_names, kinds_of_types, nodes_of_types, most_nodes, kind_name

   integer, parameter :: n_types = 30
   integer, parameter :: most_nodes = 8

   !> Names of the types; of those with one kind the first is the one that messages use.
   character(len=word_length), parameter :: type_names(n_types) = [character(len=word_length) :: &
         'MASS', 'SPRING1', 'SPRING2', 'SPRINGA', 'DASHPOT1', 'DASHPOT2', 'DASHPOTA', &
         'T2D2', 'T3D2', 'T3D3', 'T2D3', 'GAPUNI', &
         'CPE3', 'CPE4', 'CPE6', 'CPE8', 'CPE4R', 'CPE8R', &
         'CPS3', 'CPS4', 'CPS6', 'CPS8', 'CPS4R', 'CPS8R', &
         'CAX3', 'CAX4', 'CAX6', 'CAX8', 'CAX4R', 'CAX8R']

   !> Topology and quadrature of the six types of one plane, as they add to a kind.
   integer, parameter :: shapes(6) = [10*tri3, 10*quad4, 10*tri6, 10*quad8, 10*quad4 + 1, &
         10*quad8 + 1]

   integer, parameter :: kinds_of_types(n_types) = [element_mass, element_spring1, &
         element_spring2, element_springa, element_dashpot1, element_dashpot2, element_dashpota, &
         element_truss, element_truss, element_line, element_line, element_gap, &
         100*plane_strain + shapes, 100*plane_stress + shapes, 100*axisymmetric + shapes]

   integer, parameter :: solid_nodes(6) = [3, 4, 6, 8, 4, 8]
   integer, parameter :: nodes_of_types(n_types) = [1, 1, 2, 2, 1, 2, 2, 2, 2, 3, 3, 2, &
         solid_nodes, solid_nodes, solid_nodes]

contains

   !> The name of an element kind, for messages.
   pure function kind_name(kind) result(name)
      integer, intent(in) :: kind   !! an element_ parameter or the kind of a solid
      character(len=:), allocatable :: name
      integer :: i

      do i = 1, n_types
         if (kinds_of_types(i) /= kind) cycle
         name = trim(type_names(i))
         return
      end do
      name = 'of an unknown type'
   end function kind_name

end module element_types
