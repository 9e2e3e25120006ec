!> What a run does: steps with their loads and what they record.
module steps
   use kinds, only: wp
   use places, only: place_type
   use properties, only: name_length
   use histories, only: boundary_type, nodal_value_type, gravity_type, base_motion_type, &
         distributed_load_type
   implicit none
   private

   public :: step_type, request_type, is_frame_request
   public :: procedure_static, procedure_dynamic, procedure_frequency
   public :: solver_auto, solver_skyline, solver_mumps
   public :: request_node_print, request_node_file, request_element_print, request_element_file
   public :: request_contact_print, request_contact_file, request_energy_print
   public :: quantity_u, quantity_v, quantity_a, quantity_rf, quantity_s, quantity_e
   public :: quantity_ener, quantity_cf, quantity_cdis, quantity_peeq, n_quantities
   public :: quantity_cpress, quantity_cslip, quantity_cstate, quantity_names

   integer, parameter :: procedure_static = 1
   integer, parameter :: procedure_dynamic = 2
   integer, parameter :: procedure_frequency = 3

   integer, parameter :: solver_auto = 1
   integer, parameter :: solver_skyline = 2
   integer, parameter :: solver_mumps = 3

   integer, parameter :: request_node_print = 1
   integer, parameter :: request_node_file = 2
   integer, parameter :: request_element_print = 3
   integer, parameter :: request_element_file = 4
   integer, parameter :: request_contact_print = 5
   integer, parameter :: request_contact_file = 6
   integer, parameter :: request_energy_print = 7

   integer, parameter :: quantity_u = 1
   integer, parameter :: quantity_v = 2
   integer, parameter :: quantity_a = 3
   integer, parameter :: quantity_rf = 4
   integer, parameter :: quantity_s = 5
   integer, parameter :: quantity_e = 6
   integer, parameter :: quantity_ener = 7
   integer, parameter :: quantity_cf = 8
   integer, parameter :: quantity_cdis = 9
   integer, parameter :: quantity_peeq = 10
   integer, parameter :: quantity_cpress = 11
   integer, parameter :: quantity_cslip = 12
   integer, parameter :: quantity_cstate = 13
   integer, parameter :: n_quantities = 13
   !> The names of their fields.
   character(len=6), parameter :: quantity_names(n_quantities) = [character(len=6) :: 'U', 'V', &
         'A', 'RF', 'S', 'E', 'ENER', 'CF', 'CDIS', 'PEEQ', 'CPRESS', 'CSLIP', 'CSTATE']

   !> One PRINT or FILE card.
   type :: request_type
      integer :: kind = 0                        !! one of the request_ parameters
      integer :: set = 0                         !! node or element set; 0: all
      integer :: frequency = 1                   !! every so many increments
      logical :: wanted(n_quantities) = .false.  !! by quantity_
      real(wp) :: balance_limit = 0.0_wp         !! energy print: stop beyond it; 0: never
      type(place_type) :: place
   end type request_type

   !> `*STEP` to `*END STEP`.
   type :: step_type
      character(len=name_length) :: name = ''
      integer :: procedure = procedure_dynamic
      integer :: solver = solver_auto            !! one of the solver_ parameters
      integer :: max_increments = 0              !! INC, 0: no limit
      logical :: direct = .false.                !! fixed increments
      logical :: explicit = .false.              !! every group explicit in this step
      integer :: order = 2                       !! 4: Gauss' method instead of Newmark's
      real(wp) :: gamma = 0.5_wp                 !! Newmark
      real(wp) :: beta = 0.25_wp
      real(wp) :: alpha = 0.0_wp                 !! HHT, -1/3 to 0
      real(wp) :: dt = 0.0_wp
      real(wp) :: duration = 0.0_wp
      real(wp) :: dt_min = 0.0_wp                !! automatic increments: the smallest, 0: default
      real(wp) :: dt_max = 0.0_wp                !! the largest, 0: T
      real(wp) :: tolerance = 0.0_wp             !! error asked of a dynamic step, 0: default
      integer :: n_modes = 0                     !! frequency steps: so many modes at most,
      real(wp) :: highest_frequency = 0.0_wp     !! of frequencies up to this; 0: all
      integer :: restart_frequency = 0           !! increments between states kept, 0: none
      logical :: new_boundaries = .false.        !! OP=NEW: those of earlier steps are dropped
      logical :: new_loads = .false.
      logical :: new_gravity = .false.
      type(boundary_type), allocatable :: boundaries(:)
      type(nodal_value_type), allocatable :: loads(:)
      type(gravity_type), allocatable :: gravity(:)
      type(distributed_load_type), allocatable :: distributed(:)
      logical :: new_distributed = .false.
      type(base_motion_type), allocatable :: base_motions(:)
      type(nodal_value_type), allocatable :: initial_displacements(:)
      type(nodal_value_type), allocatable :: initial_velocities(:)
      type(request_type), allocatable :: requests(:)
      type(place_type) :: place                  !! of `*STEP`
      type(place_type) :: procedure_place        !! of `*DYNAMIC` or `*STATIC`
      type(place_type) :: solver_place           !! of SOLVER, if given
      type(place_type) :: order_place            !! of ORDER, if given
      type(place_type) :: time_place             !! of the line with dt, T
   end type step_type

contains

   !> Whether a request is one for frames.
   pure logical function is_frame_request(request)
      type(request_type), intent(in) :: request

      is_frame_request = any(request%kind == [request_node_file, request_element_file, &
            request_contact_file])
   end function is_frame_request

end module steps
