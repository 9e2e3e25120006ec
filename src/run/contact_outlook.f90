!> What can be said of contact pairs before anything moves: how large their surfaces are, how far
!> apart, when they will touch and for how long.
module contact_outlook
   use kinds, only: wp
   use text, only: to_text
   use model, only: model_type
   use surfaces, only: surface_type
   use constraint_rows, only: row_rates, row_accelerations
   use mesh, only: element_mass, scheme_implicit, scheme_explicit
   use structure, only: elastic_force
   use wave_speeds, only: is_continuum
   use initial_contact, only: gaps_at_start
   use continuum_bodies, only: body_list_type
   use scene_setup, only: simulation_type
   implicit none
   private

   public :: outlook_type, look_out, surface_length, side_spacing, contact_time, duration_text

   !> Gaps below this part of the size of the bodies are none; cosine from which a direction is
   !> along another.
   real(wp), parameter :: touching = 1.0e-9_wp, along = 0.5_wp
   real(wp), parameter :: half_pi = acos(0.0_wp)
   !> What resists a translation with this part of what it does when bent is free.
   real(wp), parameter :: free = 1.0e-9_wp

   !> The outlook of one pair, or of the gap elements of one set.
   type :: outlook_type
      integer :: model_pair = 0                  !! index of the model's pair, 0: gap elements
      integer :: n_rows = 0
      integer :: nearest = 0                     !! row of the smallest gap, 0: none faces a partner
      real(wp) :: gap = 0.0_wp                   !! the smallest
      integer :: first = 0                       !! row that touches first, 0: none closes
      real(wp) :: first_time = 0.0_wp            !! gap over closing speed
      real(wp) :: closing_speed = 0.0_wp         !! of that row
      real(wp) :: duration = 0.0_wp              !! of the contact
      logical :: known = .false.                 !! the duration is
      logical :: swings = .false.                !! a stiff body on a soft one; else it is 2 L / c
   end type outlook_type

contains

   !> Looks at every pair in the state reached, by the velocities it has and free fall; in a static
   !> step nothing moves by itself.
   subroutine look_out(simulation, i_step, bodies, outlooks)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step              !! in force
      type(body_list_type), intent(in) :: bodies
      type(outlook_type), allocatable, intent(out) :: outlooks(:)   !! by the names of the pairs
      real(wp), dimension(simulation%scene%rows%n) :: gaps, rates, falls
      real(wp) :: time
      integer :: i, p
      type(outlook_type) :: none

      outlooks = [(none, i=1, size(simulation%contact%names))]
      if (simulation%scene%rows%n == 0) return
      call gaps_at_start(simulation%scene, simulation%motion%motion, gaps)
      rates = 0.0_wp
      falls = 0.0_wp
      if (.not. simulation%scene%system%static) then
         rates = row_rates(simulation%scene%rows, simulation%motion%motion)
         falls = row_accelerations(simulation%scene%rows, free_fall(simulation, i_step))
      end if
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
            time = time_to_close(max(0.0_wp, gaps(i)), -rates(i), -falls(i))
            if (.not. time < huge(1.0_wp)) cycle
            if (one%first > 0 .and. one%first_time <= time) cycle
            one%first = i
            one%first_time = time
            one%closing_speed = -rates(i) - falls(i)*time
         end associate
      end do
      do p = 1, size(outlooks)
         call find_duration(simulation, bodies, outlooks(p))
      end do
   end subroutine look_out

   !> When a gap that closes at a speed and an acceleration is shut, huge if never.
   pure real(wp) function time_to_close(gap, speed, acceleration) result(time)
      real(wp), intent(in) :: gap, speed, acceleration
      real(wp) :: square

      time = huge(1.0_wp)
      square = speed**2 + 2.0_wp*acceleration*gap
      if (square < 0.0_wp .or. speed + sqrt(max(0.0_wp, square)) <= 0.0_wp) return
      time = 2.0_wp*gap/(speed + sqrt(square))
   end function time_to_close

   !> Gravity of a step as the acceleration of all freedoms, if it acts on everything at once and
   !> nothing holds the model against it: a translation strains no element. Else zero.
   function free_fall(simulation, i_step) result(a)
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step
      real(wp), dimension(simulation%scene%system%structure%map%n_freedoms) :: a, bent
      integer :: i

      a = 0.0_wp
      associate (map => simulation%scene%system%structure%map, &
            loads => simulation%model%steps(i_step)%gravity)
         do i = 1, size(loads)
            if (loads(i)%amplitude > 0 .or. .not. acts_on_all(simulation%model, loads(i)%set)) cycle
            a = a + loads(i)%acceleration(map%dof)
         end do
         bent = a*[(real(1 - 2*modulo(map%node(i), 2), wp), i=1, size(a))]
         if (any(map%prescribed .and. abs(a) > 0.0_wp)) a = 0.0_wp
         if (.not. any(abs(a) > 0.0_wp)) return
         if (resistance(simulation, a) > free*resistance(simulation, bent)) a = 0.0_wp
      end associate
   end function free_fall

   !> Largest elastic force of displacements.
   real(wp) function resistance(simulation, d)
      type(simulation_type), intent(in) :: simulation
      real(wp), intent(in) :: d(:)               !! (n_freedoms)
      real(wp) :: force(size(d)), updated(size(simulation%motion%motion%history))

      force = 0.0_wp
      associate (structure => simulation%scene%system%structure, &
            history => simulation%motion%motion%history)
         updated = history
         call elastic_force(structure, scheme_implicit, d, history, force, updated)
         call elastic_force(structure, scheme_explicit, d, history, force, updated)
      end associate
      resistance = maxval([0.0_wp, abs(force)])
   end function resistance

   !> Whether a set has all elements with mass; 0 stands for all elements.
   pure logical function acts_on_all(model, set)
      type(model_type), intent(in) :: model
      integer, intent(in) :: set
      logical :: left(model%elements%n)

      left = is_continuum(model%elements%kind(:model%elements%n)) .or. &
            model%elements%kind(:model%elements%n) == element_mass
      if (set > 0) left(model%element_sets(set)%members) = .false.
      acts_on_all = set == 0 .or. .not. any(left)
   end function acts_on_all

   !> How long the bodies stay in contact; nothing for surfaces that touch already and do not
   !> close.
   subroutine find_duration(simulation, bodies, one)
      type(simulation_type), intent(in) :: simulation
      type(body_list_type), intent(in) :: bodies
      type(outlook_type), intent(inout) :: one
      integer :: partners(2), i
      real(wp) :: times(2)
      logical :: held(2)

      if (one%nearest == 0) return
      if (one%first == 0 .and. one%gap <= touching*maxval([0.0_wp, bodies%high &
            - bodies%low])) return
      partners = 0
      associate (row => simulation%contact%rows(one%nearest), model => simulation%model, &
            normal => simulation%scene%rows%normal(:, one%nearest))
         partners(1) = bodies%of_node(row%node)
         if (row%other > 0) partners(2) = bodies%of_node(row%other)
         if (row%model_pair > 0) partners(2) = partner_body(model, bodies, row%model_pair, row%pass)
         times = 0.0_wp
         held = .true.
         do i = 1, 2
            if (partners(i) == 0) cycle
            times(i) = contact_time(bodies, partners(i), normal)
            held(i) = is_held(simulation, bodies, partners(i), normal)
         end do
      end associate
      if (all(times > 0.0_wp)) then
         call last_together(times, bodies%impedance(partners), held, one)
      else if (.not. held(1) .or. .not. held(2)) then
         one%duration = maxval(times, mask=.not. held)
      end if
      one%known = one%duration > 0.0_wp
   end subroutine find_duration

   !> Two bodies, each with its time 2 L / c. They part with the wave that comes back in the body of
   !> lower impedance z. One in the other, Z, takes but a part of the force away, which fades about
   !> as exp(-2 z t/(Z T)), T the time of that body; on a soft body that is held, the stiff one
   !> swings as a mass on a spring for half a period, (pi/2) sqrt(Z T t/z), for T at least.
   pure subroutine last_together(times, impedances, held, one)
      real(wp), intent(in) :: times(2), impedances(2)
      logical, intent(in) :: held(2)             !! held or moved along the normal
      type(outlook_type), intent(inout) :: one
      real(wp) :: fading, ratio
      integer :: soft, stiff

      if (all(held)) return
      soft = minloc(impedances, dim=1)
      stiff = 3 - soft
      if (held(stiff)) then
         one%duration = times(soft)
         return
      end if
      ratio = impedances(stiff)/impedances(soft)
      fading = times(stiff)*max(1.0_wp, 0.5_wp*ratio)
      if (held(soft)) then
         one%duration = max(times(stiff), min(fading, half_pi*sqrt(ratio*product(times))))
         one%swings = one%duration > times(stiff)
      else
         one%duration = min(times(soft), fading)
         one%swings = fading < times(soft) .and. fading > times(stiff)
      end if
   end subroutine last_together

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

   !> "2 L / c = 0.667", "0.00075 (a stiff body on a soft one)".
   pure function duration_text(one, digits) result(text)
      type(outlook_type), intent(in) :: one
      integer, intent(in) :: digits
      character(len=:), allocatable :: text

      text = to_text(one%duration, digits)
      if (one%swings) then
         text = text//' (a stiff body on a soft one)'
      else
         text = '2 L / c = '//text
      end if
   end function duration_text

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
