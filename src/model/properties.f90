!> Materials and sections: what an element is made of.
module properties
   use kinds, only: wp
   use name_map, only: name_length
   use places, only: place_type
   implicit none
   private

   public :: name_length, material_type, table_type, section_type
   public :: section_solid, section_spring, section_dashpot, section_mass, section_gap

   integer, parameter :: section_solid = 1
   integer, parameter :: section_spring = 2
   integer, parameter :: section_dashpot = 3
   integer, parameter :: section_mass = 4
   integer, parameter :: section_gap = 5

   !> A piecewise linear law y(x), x strictly increasing; constant beyond its ends.
   type :: table_type
      integer :: n = 0
      real(wp), allocatable :: x(:), y(:)
   end type table_type

   !> Linear elastic isotropic material with Rayleigh damping C = alpha M + beta K.
   type :: material_type
      character(len=name_length) :: name = ''
      logical :: has_elastic = .false.
      logical :: has_density = .false.
      logical :: has_damping = .false.
      real(wp) :: young = 0.0_wp               !! E
      real(wp) :: poisson = 0.0_wp             !! nu
      real(wp) :: density = 0.0_wp             !! rho
      logical :: has_plastic = .false.
      logical :: kinematic = .false.           !! hardening: kinematic, else isotropic
      type(table_type) :: hardening            !! yield stress y over equivalent plastic strain x
      real(wp) :: damping_alpha = 0.0_wp       !! mass-proportional, 1/time
      real(wp) :: damping_beta = 0.0_wp        !! stiffness-proportional, time
      type(place_type) :: place
   end type material_type

   !> What a section card says of the elements of a set.
   type :: section_type
      integer :: kind = 0                      !! one of the section_ parameters
      integer :: set = 0                       !! index of the element set
      integer :: material = 0                  !! index of the material, solid sections
      real(wp) :: area = 0.0_wp                !! truss area or plane thickness
      logical :: b_bar = .false.               !! volumetric strain averaged (CPE4, CAX4)
      integer :: dof(2) = 0                    !! directions at its nodes, springs and dashpots 1, 2
      real(wp) :: coefficient = 0.0_wp         !! k of a linear spring, c of a dashpot, m of a mass
      logical :: nonlinear = .false.
      type(table_type) :: force                !! force y over elongation x of a nonlinear spring
      real(wp) :: clearance = 0.0_wp           !! initial opening of a gap element
      real(wp) :: normal(3) = 0.0_wp           !! unit normal of a gap, from its node 1 to node 2
      integer :: interaction = 0               !! index of the surface interaction of a gap
      type(place_type) :: place
   end type section_type

end module properties
