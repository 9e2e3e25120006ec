!> Amplitudes, boundary conditions, loads, initial conditions, linear constraints.
module histories
   use kinds, only: wp
   use places, only: place_type
   use properties, only: name_length
   implicit none
   private

   public :: amplitude_type, boundary_type, nodal_value_type, gravity_type, base_motion_type
   public :: equation_type, distributed_load_type
   public :: load_pressure, load_body, load_centrifugal
   public :: time_step, time_total
   public :: motion_displacement, motion_velocity, motion_acceleration

   integer, parameter :: time_step = 1
   integer, parameter :: time_total = 2

   integer, parameter :: load_pressure = 1
   integer, parameter :: load_body = 2
   integer, parameter :: load_centrifugal = 3

   integer, parameter :: motion_displacement = 1
   integer, parameter :: motion_velocity = 2
   integer, parameter :: motion_acceleration = 3

   !> `*AMPLITUDE`: piecewise linear in time, constant beyond its ends.
   type :: amplitude_type
      character(len=name_length) :: name = ''
      integer :: time = time_step                !! counted from the step's start or the run's
      real(wp), allocatable :: t(:), a(:)        !! strictly increasing times, values
      type(place_type) :: place
   end type amplitude_type

   !> `*BOUNDARY`: one freedom fixed or moved.
   type :: boundary_type
      integer :: node = 0                        !! node index
      integer :: dof = 0                         !! 1, 2 or 3
      integer :: motion = motion_displacement
      real(wp) :: value = 0.0_wp
      integer :: amplitude = 0
      type(place_type) :: place
   end type boundary_type

   !> `*CLOAD` or an initial condition: a value at one freedom.
   type :: nodal_value_type
      integer :: node = 0
      integer :: dof = 0
      real(wp) :: value = 0.0_wp
      integer :: amplitude = 0
      type(place_type) :: place
   end type nodal_value_type

   !> `*DLOAD` with GRAV: acceleration on the mass of a set of elements.
   type :: gravity_type
      integer :: set = 0                         !! element set, 0: every element
      real(wp) :: acceleration(3) = 0.0_wp       !! size times direction
      integer :: amplitude = 0
      type(place_type) :: place
   end type gravity_type

   !> `*DLOAD` with P1-P4, BX, BY or CENTRIF: a load on the elements of a set.
   type :: distributed_load_type
      integer :: kind = 0                        !! load_pressure, load_body or load_centrifugal
      integer :: set = 0                         !! element set, 0: every element
      integer :: edge = 0                        !! 1 to 4 of a pressure
      real(wp) :: value = 0.0_wp                 !! pressure; omega squared
      real(wp) :: body(3) = 0.0_wp               !! force per volume
      real(wp) :: point(3) = 0.0_wp              !! on the axis of rotation
      real(wp) :: axis(3) = 0.0_wp               !! unit vector
      integer :: amplitude = 0
      type(place_type) :: place
   end type distributed_load_type

   !> `*BASE MOTION`: ground acceleration along one direction; displacements are relative to it.
   type :: base_motion_type
      integer :: dof = 0
      real(wp) :: scale = 1.0_wp
      integer :: amplitude = 0
      type(place_type) :: place
   end type base_motion_type

   !> `*EQUATION`: sum of coefficient times freedom is zero; the first is eliminated.
   type :: equation_type
      integer, allocatable :: node(:), dof(:)
      real(wp), allocatable :: coefficient(:)
      type(place_type) :: place
   end type equation_type

end module histories
