!> How far elements turn and stretch in a run. The equations are those of small displacements: a
!> rotation by w strains an element by about w**2/2 that in truth does not strain at all.
module shape_watch
   use kinds, only: wp, int64
   use text, only: to_text
   use mesh, only: element_mass, element_truss, element_springa, element_dashpota, is_solid_kind
   use wave_speeds, only: is_continuum
   use model, only: model_type
   use dof_map, only: dof_map_type
   use scene_setup, only: simulation_type
   use run_log, only: log_type, warn
   implicit none
   private

   public :: shape_type, watch_shapes

   !> Rotations (rad) and strains from which results are not to be relied on: the one errs by 3 % in
   !> every length, the other leaves a length but half or makes it one and a half.
   real(wp), parameter :: large_rotation = 0.25_wp, large_strain = 0.5_wp
   !> Looks in a step.
   real(wp), parameter :: looks = 50.0_wp
   !> What flies free of forces may turn this far: its velocities and energies remain exact, but it
   !> is drawn too large, and would meet others too early.
   real(wp), parameter :: large_in_flight = 1.0_wp
   integer, parameter :: turned = 1, stretched = 2
   real(wp), parameter :: limits(2) = [large_rotation, large_strain]

   !> The largest rotation and the largest strain that were met.
   type :: shape_type
      real(wp) :: next = 0.0_wp                  !! total time of the next look
      real(wp) :: largest(2) = 0.0_wp
      real(wp) :: first_time(2) = 0.0_wp         !! when the limit was passed
      integer :: element(2) = 0                  !! index
      logical :: told(2) = .false.
   end type shape_type

contains

   !> Looks at all elements in the state reached; at the end of a step says what was too large.
   subroutine watch_shapes(self, simulation, duration, last, log)
      type(shape_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      real(wp), intent(in) :: duration           !! of the step
      logical, intent(in) :: last                !! it ends here
      type(log_type), intent(inout) :: log

      call look_at_shapes(self, simulation)
      self%next = simulation%motion%motion%t + merge(0.0_wp, duration/looks, last)
      if (last) call warn_of_shapes(self, simulation, log)
   end subroutine watch_shapes

   subroutine look_at_shapes(self, simulation)
      type(shape_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      real(wp) :: shape(2)
      logical :: flies
      integer :: e, i

      associate (motion => simulation%motion%motion, model => simulation%model)
         flies = is_free(simulation)
         do e = 1, model%elements%n
            shape = shape_of(model, simulation%scene%system%structure%map, motion%d, e)
            if (flies .and. shape(turned) <= large_in_flight) shape(turned) = 0.0_wp
            do i = 1, 2
               if (.not. shape(i) > self%largest(i)) cycle
               if (shape(i) > limits(i) .and. self%largest(i) <= limits(i)) then
                  self%first_time(i) = motion%t
               end if
               self%largest(i) = shape(i)
               self%element(i) = e
            end do
         end do
      end associate
   end subroutine look_at_shapes

   !> Whether nothing holds what there is: no support, spring or contact.
   pure logical function is_free(simulation)
      type(simulation_type), intent(in) :: simulation

      associate (kinds => simulation%model%elements%kind(:simulation%model%elements%n))
         is_free = all(is_continuum(kinds) .or. kinds == element_mass) .and. &
               .not. any(simulation%scene%system%structure%map%prescribed) .and. &
               .not. any(simulation%motion%touching .or. simulation%motion%lambda > 0.0_wp)
      end associate
   end function is_free

   !> Rotation and strain of an element, zero where neither has a meaning. What a spring strains is
   !> its law's affair.
   pure function shape_of(model, map, d, e) result(shape)
      type(model_type), intent(in) :: model
      type(dof_map_type), intent(in) :: map
      real(wp), intent(in) :: d(:)               !! (n_freedoms)
      integer, intent(in) :: e                   !! element index
      real(wp) :: shape(2)

      shape = 0.0_wp
      associate (kind => model%elements%kind(e), nodes => model%elements%nodes( &
            model%elements%first(e):model%elements%first(e + 1) - 1))
         if (is_solid_kind(kind)) then
            shape = shape_of_solid(model%nodes%x(:2, nodes), moved(map, d, nodes))
         else if (kind == element_truss .or. kind == element_springa .or. &
               kind == element_dashpota) then
            shape = shape_of_line(model%nodes%x(:, nodes), moved(map, d, nodes))
            if (kind /= element_truss) shape(stretched) = 0.0_wp
         end if
      end associate
   end function shape_of

   !> Displacements of nodes, (3, size(nodes)).
   pure function moved(map, d, nodes) result(u)
      type(dof_map_type), intent(in) :: map
      real(wp), intent(in) :: d(:)
      integer, intent(in) :: nodes(:)
      real(wp) :: u(3, size(nodes))
      integer :: i, k

      u = 0.0_wp
      do i = 1, size(nodes)
         do k = 1, 3
            if (map%freedom(k, nodes(i)) > 0) u(k, i) = d(map%freedom(k, nodes(i)))
         end do
      end do
   end function moved

   !> Of the mean displacement gradient G of a solid, the least squares fit to its nodes: the
   !> skew part, and the principal strain of largest size.
   pure function shape_of_solid(x, u) result(shape)
      real(wp), intent(in) :: x(:, :)            !! (2, n)
      real(wp), intent(in) :: u(:, :)            !! (3, n)
      real(wp) :: shape(2)
      real(wp), dimension(2, size(x, 2)) :: arm, path
      real(wp) :: a(2, 2), g(2, 2), mean, radius

      arm = x - spread(sum(x, 2)/size(x, 2), 2, size(x, 2))
      path = u(:2, :) - spread(sum(u(:2, :), 2)/size(x, 2), 2, size(x, 2))
      a = matmul(arm, transpose(arm))
      g(:, 1) = [a(2, 2), -a(1, 2)]
      g(:, 2) = [-a(2, 1), a(1, 1)]
      g = matmul(matmul(path, transpose(arm)), g)/(a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1))
      mean = 0.5_wp*(g(1, 1) + g(2, 2))
      radius = 0.5_wp*hypot(g(1, 1) - g(2, 2), g(1, 2) + g(2, 1))
      shape(turned) = 0.5_wp*abs(g(2, 1) - g(1, 2))
      shape(stretched) = abs(mean) + radius
   end function shape_of_solid

   !> Of a line between two nodes: their relative displacement across and along it, by its length.
   pure function shape_of_line(x, u) result(shape)
      real(wp), intent(in) :: x(:, :), u(:, :)   !! (3, 2)
      real(wp) :: shape(2)
      real(wp) :: line(3), path(3), along

      shape = 0.0_wp
      line = x(:, 2) - x(:, 1)
      if (.not. norm2(line) > 0.0_wp) return
      path = (u(:, 2) - u(:, 1))/norm2(line)
      along = dot_product(path, line)/norm2(line)
      shape(turned) = norm2(path - along*line/norm2(line))
      shape(stretched) = abs(along)
   end function shape_of_line

   !> Says what was too large, once.
   subroutine warn_of_shapes(self, simulation, log)
      type(shape_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(log_type), intent(inout) :: log
      logical :: new(2)

      new = self%largest > limits .and. .not. self%told
      self%told = self%told .or. new
      associate (id => simulation%model%elements%id)
         if (new(turned)) call warn(log, 'element ' &
               //to_text(id(self%element(turned)))//' turns by up to ' &
               //to_text(self%largest(turned), 2)//' rad: displacements are taken for small, a ' &
               //'rotation w stretches what it turns by w**2/2, and from here on the results ' &
               //'are not reliable'//new_line('a')//'  cure: stop where rotations reach 0.2, or ' &
               //'hold what turns; large rotations are beyond this program', .true., &
               self%first_time(turned), 1_int64)
         if (new(stretched)) call warn(log, 'the strain of element ' &
               //to_text(id(self%element(stretched)))//' reaches '//to_text(self%largest( &
               stretched), 2)//': strains are taken for small, and from here on the ' &
               //'results are not reliable'//new_line('a')//'  cure: check the units, loads ' &
               //'and supports; large strains are beyond this program', .true., &
               self%first_time(stretched), 1_int64)
      end associate
   end subroutine warn_of_shapes

end module shape_watch
