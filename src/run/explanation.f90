!> What a deck means physically, in one screen: `carom check DECK --explain`.
module explanation
   use kinds, only: wp
   use text, only: to_text, plural
   use model, only: model_type
   use mesh, only: is_solid_kind, solid_plane
   use dof_map, only: dof_map_type
   use structure, only: diagonal_mass
   use structure_energy, only: strain_energy, group_kinetic_energy
   use continuum_bodies, only: body_list_type
   use contact_outlook, only: outlook_type, look_out, surface_length, side_spacing, &
         duration_text
   use wave_speeds, only: longitudinal_speed, shear_speed, element_length, &
         speed_name, material_of
   use scene_setup, only: simulation_type
   use step_explanation, only: explain_periods, explain_step
   use explanation_lines, only: lines_type, short
   implicit none
   private

   public :: explain_start

   !> So many materials and pairs are listed.
   integer, parameter :: most_materials = 3, most_pairs = 3

   !> Elements of one material and class together.
   type :: waves_type
      integer :: material = 0, kind = 0
      integer :: shortest = 0                    !! element through which a wave goes soonest
      real(wp) :: length = huge(1.0_wp)          !! of it
      integer :: body = 0                        !! the largest that has them
   end type waves_type

contains

   !> Explains the model in its first step, which is in force, and that step.
   subroutine explain_start(self, simulation, i_step, bodies, period, costly)
      type(lines_type), intent(inout) :: self
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(body_list_type), intent(in) :: bodies
      real(wp), intent(in) :: period             !! the longest of the step, 0: not known
      logical, intent(in) :: costly              !! since it takes too long to find
      type(outlook_type), allocatable :: outlooks(:)

      call look_out(simulation, i_step, bodies, outlooks)
      if (i_step == 1) then
         call explain_model(self, simulation, bodies)
         call explain_materials(self, simulation%model, bodies)
         call explain_pairs(self, simulation, outlooks)
      end if
      call explain_periods(self, simulation, i_step, period, costly)
      call explain_step(self, simulation, i_step, bodies, outlooks, period)
   end subroutine explain_start

   !> Sizes, mass, energies: wrong units show here.
   subroutine explain_model(self, simulation, bodies)
      type(lines_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(body_list_type), intent(in) :: bodies
      real(wp) :: kinetic, strain, box(3)
      integer :: g

      associate (model => simulation%model, structure => simulation%scene%system%structure, &
            state => simulation%motion%motion)
         if (len_trim(model%heading) > 0) call self%add('deck', &
               model%heading(:scan(model%heading//new_line('a'), new_line('a')) - 1))
         box = maxval(model%nodes%x(:, :model%nodes%n), dim=2) &
               - minval(model%nodes%x(:, :model%nodes%n), dim=2)
         call self%add('model', plural(model%nodes%n, 'node')//', ' &
               //plural(model%elements%n, 'element')//bodies_text(bodies)//', ' &
               //plural(structure%map%n_freedoms, 'freedom')//'; extent ' &
               //extent_text(box)//'; mass '//short(moving_mass(structure%map, &
               diagonal_mass(structure))))
         kinetic = 0.0_wp
         do g = 1, size(structure%groups)
            kinetic = kinetic + group_kinetic_energy(structure%groups(g), state%v)
         end do
         strain = strain_energy(structure, state%d, state%history)
         call self%add('start', 'kinetic energy '//short(kinetic)//', strain energy ' &
               //short(strain)//', largest velocity '//short(maxval([0.0_wp, abs(state%v)])))
      end associate
   end subroutine explain_model

   !> "2 by 1", and "by 3" where there is a third dimension.
   pure function extent_text(box) result(text)
      real(wp), intent(in) :: box(3)
      character(len=:), allocatable :: text

      text = short(box(1))//' by '//short(box(2))
      if (box(3) > 0.0_wp) text = text//' by '//short(box(3))
   end function extent_text

   pure function bodies_text(bodies) result(text)
      type(body_list_type), intent(in) :: bodies
      character(len=:), allocatable :: text

      text = ''
      if (bodies%n == 1) text = ' in 1 deforming body'
      if (bodies%n > 1) text = ' in '//to_text(bodies%n)//' deforming bodies'
   end function bodies_text

   !> The mass along that direction along which most of it can move.
   pure real(wp) function moving_mass(map, m)
      type(dof_map_type), intent(in) :: map
      real(wp), intent(in) :: m(:)               !! (n_freedoms)
      integer :: i

      moving_mass = maxval([(sum(m, mask=map%dof == i), i=1, 3)])
   end function moving_mass

   !> Waves in every material.
   subroutine explain_materials(self, model, bodies)
      type(lines_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(body_list_type), intent(in) :: bodies
      type(waves_type), allocatable :: waves(:)
      integer :: i

      call gather_waves(model, bodies, waves)
      do i = 1, min(most_materials, size(waves))
         call explain_waves(self, model, bodies, waves(i))
      end do
      if (size(waves) > most_materials) call self%add('', 'and ' &
            //to_text(size(waves) - most_materials)//' more kinds of material and element')
   end subroutine explain_materials

   subroutine gather_waves(model, bodies, waves)
      type(model_type), intent(in) :: model
      type(body_list_type), intent(in) :: bodies
      type(waves_type), allocatable, intent(out) :: waves(:)
      type(waves_type) :: one
      integer :: e, i
      real(wp) :: length

      waves = [waves_type ::]
      do e = 1, model%elements%n
         if (material_of(model, e) == 0) cycle
         do i = 1, size(waves)
            if (waves(i)%material == material_of(model, e) .and. &
                  class_of(waves(i)%kind) == class_of(model%elements%kind(e))) exit
         end do
         if (i > size(waves)) then
            one%material = material_of(model, e)
            one%kind = model%elements%kind(e)
            one%body = bodies%of_element(e)
            waves = [waves, one]
         end if
         length = element_length(model, e)
         if (length < waves(i)%length*(1.0_wp - 1.0e-9_wp)) then
            waves(i)%length = length
            waves(i)%shortest = e
         end if
         if (size_of(bodies, bodies%of_element(e)) > size_of(bodies, waves(i)%body)) then
            waves(i)%body = bodies%of_element(e)
         end if
      end do
   end subroutine gather_waves

   !> Plane strain, plane stress, around an axis, or 0 for bars: what wave speeds depend on.
   pure integer function class_of(kind)
      integer, intent(in) :: kind

      class_of = 0
      if (is_solid_kind(kind)) class_of = solid_plane(kind)
   end function class_of

   pure real(wp) function size_of(bodies, b)
      type(body_list_type), intent(in) :: bodies
      integer, intent(in) :: b

      size_of = maxval(bodies%high(:, b) - bodies%low(:, b))
   end function size_of

   subroutine explain_waves(self, model, bodies, waves)
      type(lines_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(body_list_type), intent(in) :: bodies
      type(waves_type), intent(in) :: waves
      real(wp) :: c, extent
      character(len=:), allocatable :: text

      associate (material => model%materials(waves%material))
         text = trim(material%name)//': E '//short(material%young)//', nu ' &
               //short(material%poisson)
         c = longitudinal_speed(material, waves%kind)
         if (.not. c > 0.0_wp) then
            call self%add('material', text//', without a density: no waves; smallest element ' &
                  //short(waves%length))
            return
         end if
         text = text//', density '//short(material%density)//'; wave speed '//short(c)//' (' &
               //speed_name(waves%kind)//')'
         if (is_solid_kind(waves%kind)) text = text//', shear '//short(shear_speed(material))
         call self%add('material', text)
         extent = size_of(bodies, waves%body)
         call self%add('', 'a wave takes '//short(extent/c)//' through the body ('//short(extent) &
               //'), '//short(waves%length/c)//' through element ' &
               //to_text(model%elements%id(waves%shortest))//', the smallest (' &
               //short(waves%length)//')')
      end associate
   end subroutine explain_waves

   subroutine explain_pairs(self, simulation, outlooks)
      type(lines_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(outlook_type), intent(in) :: outlooks(:)
      integer :: p, n

      n = 0
      do p = 1, size(outlooks)
         if (outlooks(p)%n_rows == 0) cycle
         n = n + 1
         if (n > most_pairs) cycle
         call self%add('contact', trim(simulation%contact%names(p))//': ' &
               //surfaces_text(simulation%model, outlooks(p)))
         call explain_gap(self, simulation, outlooks(p))
      end do
      if (n > most_pairs) call self%add('', 'and '//to_text(n - most_pairs)//' more contact pairs')
   end subroutine explain_pairs

   !> Nodes, lengths and spacings of both surfaces.
   function surfaces_text(model, outlook) result(text)
      type(model_type), intent(in) :: model
      type(outlook_type), intent(in) :: outlook
      character(len=:), allocatable :: text
      real(wp) :: spacing

      if (outlook%model_pair == 0) then
         text = plural(outlook%n_rows, 'gap element')
         return
      end if
      associate (pair => model%pairs(outlook%model_pair))
         text = 'slave '//surface_text(model, pair%contactor)
         if (pair%target == 0) then
            text = text//' on a rigid surface'
         else if (pair%target == pair%contactor) then
            text = text//' on itself'
         else
            text = text//'; master '//surface_text(model, pair%target)
            spacing = side_spacing(model, model%surfaces(pair%contactor))
            if (spacing > 0.0_wp) text = text//'; spacing slave / master ' &
                  //to_text(spacing/side_spacing(model, model%surfaces(pair%target)), 2)
         end if
      end associate
   end function surfaces_text

   function surface_text(model, surface) result(text)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      character(len=:), allocatable :: text

      associate (own => model%surfaces(surface))
         text = plural(size(own%nodes), 'node')
         if (size(own%edges, 2) > 0) text = text//', '//plural(size(own%edges, 2), 'side') &
               //' of '//short(surface_length(model, own)/size(own%edges, 2))//' on ' &
               //short(surface_length(model, own))
      end associate
   end function surface_text

   subroutine explain_gap(self, simulation, outlook)
      type(lines_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(outlook_type), intent(in) :: outlook
      character(len=:), allocatable :: text

      if (outlook%nearest == 0) then
         call self%add('', 'no node faces the other surface yet')
         return
      end if
      text = 'smallest gap '//short(outlook%gap)//' at node ' &
            //to_text(simulation%scene%rows%node_id(outlook%nearest))
      if (outlook%first == 0) then
         text = text//', not closing at the start'
      else
         text = text//'; touches after '//short(outlook%first_time)
         if (simulation%model%steps(1)%direct) text = text//' ('//to_text(outlook%first_time &
               /simulation%model%steps(1)%dt, 3)//' increments)'
         text = text//' with speed '//short(outlook%closing_speed)
      end if
      call self%add('', text//not_foreseen(simulation, outlook%first > 0))
      if (outlook%known) call self%add('', 'a hit lasts about '//duration_text(outlook, 4) &
            //', longer where bodies are round or soft')
   end subroutine explain_gap

   !> What a gap does beside closing by its speed and by gravity at once.
   pure function not_foreseen(simulation, closes) result(text)
      type(simulation_type), intent(in) :: simulation
      logical, intent(in) :: closes              !! by those
      character(len=:), allocatable :: text

      text = ''
      associate (step => simulation%model%steps(1))
         if (size(step%base_motions) > 0) then
            text = '*BASE MOTION'
         else if (any(step%gravity%amplitude > 0)) then
            text = 'gravity by its amplitude'
         else
            return
         end if
      end associate
      if (closes) then
         text = ', without '//text//', which moves it too'
      else
         text = '; '//text//' moves it later: when it closes is not foreseen here'
      end if
   end function not_foreseen

end module explanation
