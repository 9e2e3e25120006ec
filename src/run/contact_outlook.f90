!> What can be said of contact pairs before anything moves: how large their surfaces are, how far
!> apart, when they will touch and for how long.
module contact_outlook
   use kinds, only: wp
   use model, only: model_type
   use surfaces, only: surface_type
   use constraint_rows, only: row_rates
   use initial_contact, only: gaps_at_start
   use continuum_bodies, only: body_list_type
   use scene_setup, only: simulation_type
   implicit none
   private

   public :: outlook_type, look_out, surface_length, side_spacing, contact_time

   !> Gaps below this part of the size of the bodies are none; cosine from which a direction is
   !> along another.
   real(wp), parameter :: touching = 1.0e-9_wp, along = 0.5_wp

   !> The outlook of one pair, or of the gap elements of one set.
   type :: outlook_type
      integer :: model_pair = 0                  !! index of the model's pair, 0: gap elements
      integer :: n_rows = 0
      integer :: nearest = 0                     !! row of the smallest gap, 0: none faces a partner
      real(wp) :: gap = 0.0_wp                   !! the smallest
      integer :: first = 0                       !! row that touches first, 0: none closes
      real(wp) :: first_time = 0.0_wp            !! gap over closing speed
      real(wp) :: closing_speed = 0.0_wp         !! of that row
      real(wp) :: duration = 0.0_wp              !! a wave to and fro through a body, 0: not known
      integer :: body = 0                        !! that body
   end type outlook_type

contains

   !> Looks at every pair in the state reached, by the velocities it has.
   subroutine look_out(simulation, bodies, outlooks)
      type(simulation_type), intent(inout) :: simulation
      type(body_list_type), intent(in) :: bodies
      type(outlook_type), allocatable, intent(out) :: outlooks(:)   !! by the names of the pairs
      real(wp), dimension(simulation%scene%rows%n) :: gaps, rates
      integer :: i, p
      type(outlook_type) :: none

      outlooks = [(none, i=1, size(simulation%contact%names))]
      if (simulation%scene%rows%n == 0) return
      call gaps_at_start(simulation%scene, simulation%motion%motion, gaps)
      rates = row_rates(simulation%scene%rows, simulation%motion%motion)
      do i = 1, size(gaps)
         associate (row => simulation%contact%rows(i), one => outlooks(simulation%contact &
               %rows(i)%pair))
            one%model_pair = row%model_pair
            one%n_rows = one%n_rows + 1
            if (.not. simulation%scene%rows%facing(i)) cycle
            if (one%nearest == 0 .or. gaps(i) < one%gap) then
               one%nearest = i
               one%gap = gaps(i)
            end if
            if (.not. rates(i) < 0.0_wp) cycle
            if (one%first > 0 .and. one%first_time <= -gaps(i)/rates(i)) cycle
            one%first = i
            one%first_time = max(0.0_wp, -gaps(i)/rates(i))
            one%closing_speed = -rates(i)
         end associate
      end do
      do p = 1, size(outlooks)
         call find_duration(simulation, bodies, outlooks(p))
      end do
   end subroutine look_out

   !> The shorter of the times 2 L / c of those of both bodies that are free to rebound, L along the
   !> normal; nothing for surfaces that touch already and do not close.
   subroutine find_duration(simulation, bodies, one)
      type(simulation_type), intent(in) :: simulation
      type(body_list_type), intent(in) :: bodies
      type(outlook_type), intent(inout) :: one
      integer :: partners(2), i
      real(wp) :: time

      if (one%nearest == 0) return
      if (one%first == 0 .and. one%gap <= touching*maxval([0.0_wp, bodies%high &
            - bodies%low])) return
      partners = 0
      associate (row => simulation%contact%rows(one%nearest), model => simulation%model)
         partners(1) = bodies%of_node(row%node)
         if (row%other > 0) partners(2) = bodies%of_node(row%other)
         if (row%model_pair > 0) partners(2) = partner_body(model, bodies, row%model_pair, row%pass)
      end associate
      do i = 1, 2
         if (partners(i) == 0) cycle
         if (is_held(simulation, bodies, partners(i), simulation%scene%rows%normal(:, &
               one%nearest))) cycle
         time = contact_time(bodies, partners(i), simulation%scene%rows%normal(:, one%nearest))
         if (.not. time > 0.0_wp) cycle
         if (one%body > 0 .and. time >= one%duration) cycle
         one%duration = time
         one%body = partners(i)
      end do
   end subroutine find_duration

   !> Whether a node of a body is held, or moved, along a direction.
   pure logical function is_held(simulation, bodies, b, direction)
      type(simulation_type), intent(in) :: simulation
      type(body_list_type), intent(in) :: bodies
      integer, intent(in) :: b
      real(wp), intent(in) :: direction(3)
      integer :: f

      is_held = .true.
      associate (map => simulation%scene%system%structure%map)
         do f = 1, map%n_freedoms
            if (.not. map%prescribed(f) .or. bodies%of_node(map%node(f)) /= b) cycle
            if (abs(direction(map%dof(f))) > along) return
         end do
      end associate
      is_held = .false.
   end function is_held

   !> The body of the first side of a pair's master, 0 if that is rigid.
   pure integer function partner_body(model, bodies, pair, pass)
      type(model_type), intent(in) :: model
      type(body_list_type), intent(in) :: bodies
      integer, intent(in) :: pair, pass
      integer :: surface

      partner_body = 0
      surface = model%pairs(pair)%target
      if (pass == 2) surface = model%pairs(pair)%contactor
      if (surface > 0) partner_body = bodies%of_element(model%surfaces(surface)%edge_element(1))
   end function partner_body

   !> How long a free body that is hit along a direction stays in contact: a wave to and fro.
   pure real(wp) function contact_time(bodies, b, direction)
      type(body_list_type), intent(in) :: bodies
      integer, intent(in) :: b
      real(wp), intent(in) :: direction(3)

      contact_time = 2.0_wp*bodies%transit_time(b, direction)
   end function contact_time

   !> Length of all sides of a surface, straight between their nodes; 0 for one of nodes.
   pure real(wp) function surface_length(model, surface) result(length)
      type(model_type), intent(in) :: model
      type(surface_type), intent(in) :: surface
      integer :: i

      length = 0.0_wp
      if (.not. allocated(surface%edges)) return
      do i = 1, size(surface%edges, 2)
         associate (nodes => surface%edges(:, i), x => model%nodes%x)
            if (nodes(3) == 0) then
               length = length + norm2(x(:, nodes(2)) - x(:, nodes(1)))
            else
               length = length + norm2(x(:, nodes(3)) - x(:, nodes(1))) &
                     + norm2(x(:, nodes(2)) - x(:, nodes(3)))
            end if
         end associate
      end do
   end function surface_length

   !> Mean distance of neighbouring nodes of a surface, 0 for one of nodes.
   pure real(wp) function side_spacing(model, surface) result(spacing)
      type(model_type), intent(in) :: model
      type(surface_type), intent(in) :: surface
      integer :: n

      spacing = 0.0_wp
      if (.not. allocated(surface%edges)) return
      n = size(surface%edges, 2) + count(surface%edges(3, :) > 0)
      if (n > 0) spacing = surface_length(model, surface)/real(n, wp)
   end function side_spacing

end module contact_outlook
