!> Slender bodies of elements that bend badly: linear triangles, and too few quadrilaterals through
!> the thickness. With elements of length l, n of them through the height h, a beam bends as if its
!> stiffness were that of the beam, by the analysis of one element under pure bending, times
!>
!>     CPS4        1 + l**2/(2 (1 + nu) h**2) + nu**2/((1 - nu**2) n**2)
!>     CPE4        1 + (1 - nu) l**2/(2 h**2) + nu**2/((1 - 2 nu) n**2)
!>     with BBAR   1 + (1 - nu) l**2/(2 h**2) - (1 + 2 nu)/(3 n**2)
!>     4R          1 - 1/n**2
!>
!> The terms: parasitic shear; the part 1/n**2 of the bending energy that varies within elements,
!> without lateral strain, without the volumetric one, not seen at all.
module bending_doubts
   use kinds, only: wp
   use text, only: to_text
   use places, only: note_at
   use mesh, only: is_solid_kind, solid_plane, solid_topology, solid_reduced, plane_stress, &
         axisymmetric, tri3, quad4
   use element_types, only: kind_name
   use model, only: model_type
   use continuum_bodies, only: body_list_type
   use wave_speeds, only: element_length, material_of
   use scene_setup, only: simulation_type, add_remark
   implicit none
   private

   public :: doubt_bending, bending_ratio

   !> A body so many times longer than thick may bend; so many triangles through it are too few;
   !> quadrilaterals may err by this part.
   real(wp), parameter :: slender = 4.0_wp, few_triangles = 8.0_wp, much = 0.1_wp

   !> The elements of one body that may bend badly.
   type :: layers_type
      integer :: example = 0                     !! element, 0: there are none
      real(wp) :: smallest = huge(1.0_wp)        !! of triangles, their height
      real(wp) :: along = huge(1.0_wp)           !! smallest extent along the body, and through it
      real(wp) :: through = huge(1.0_wp)
   end type layers_type

contains

   !> Remarks on bodies.
   subroutine doubt_bending(simulation, bodies)
      type(simulation_type), intent(inout) :: simulation
      type(body_list_type), intent(in) :: bodies
      type(layers_type) :: layers(bodies%n)
      integer :: b

      call gather_layers(simulation%model, bodies, layers)
      do b = 1, bodies%n
         if (layers(b)%example == 0) cycle
         if (.not. may_bend(simulation%model, bodies, b, layers(b)%example)) cycle
         if (solid_topology(simulation%model%elements%kind(layers(b)%example)) == tri3) then
            call doubt_triangles(simulation, bodies, b, layers(b))
         else
            call doubt_quads(simulation, bodies, b, layers(b))
         end if
      end do
   end subroutine doubt_bending

   !> What the linear elements of each body measure; the first of them tells their kind.
   subroutine gather_layers(model, bodies, layers)
      type(model_type), intent(in) :: model
      type(body_list_type), intent(in) :: bodies
      type(layers_type), intent(inout) :: layers(:)   !! (bodies%n)
      real(wp) :: extent(2)
      integer :: e, b, long

      do e = 1, model%elements%n
         if (.not. is_solid_kind(model%elements%kind(e))) cycle
         if (all(solid_topology(model%elements%kind(e)) /= [tri3, quad4])) cycle
         b = bodies%of_element(e)
         associate (nodes => model%elements%nodes(model%elements%first(e): &
               model%elements%first(e + 1) - 1))
            extent = maxval(model%nodes%x(:2, nodes), 2) - minval(model%nodes%x(:2, nodes), 2)
         end associate
         long = maxloc(bodies%high(:2, b) - bodies%low(:2, b), dim=1)
         associate (one => layers(b))
            if (one%example == 0) one%example = e
            one%smallest = min(one%smallest, element_length(model, e))
            one%along = min(one%along, extent(long))
            one%through = min(one%through, extent(3 - long))
         end associate
      end do
   end subroutine gather_layers

   !> Whether a body is slender, and free to bend: not a solid shaft around the axis, nor held
   !> across its length all along.
   pure logical function may_bend(model, bodies, b, e)
      type(model_type), intent(in) :: model
      type(body_list_type), intent(in) :: bodies
      integer, intent(in) :: b                   !! body
      integer, intent(in) :: e                   !! one of its elements
      real(wp) :: extent(2)

      extent = bodies%high(:2, b) - bodies%low(:2, b)
      may_bend = maxval(extent) >= slender*minval(extent)
      if (solid_plane(model%elements%kind(e)) == axisymmetric .and. extent(2) > extent(1)) then
         may_bend = may_bend .and. bodies%low(1, b) > 0.0_wp
      end if
      if (may_bend) may_bend = .not. is_guided(model, bodies, b, minloc(extent, dim=1))
   end function may_bend

   !> Whether every node of a body is held in a direction from the first step on.
   pure logical function is_guided(model, bodies, b, dof)
      type(model_type), intent(in) :: model
      type(body_list_type), intent(in) :: bodies
      integer, intent(in) :: b                   !! body
      integer, intent(in) :: dof
      logical :: held(model%nodes%n)

      held = .false.
      associate (always => model%boundaries, first => model%steps(1)%boundaries)
         held(pack(always%node, always%dof == dof)) = .true.
         held(pack(first%node, first%dof == dof)) = .true.
      end associate
      is_guided = all(held .or. bodies%of_node(:model%nodes%n) /= b)
   end function is_guided

   subroutine doubt_triangles(simulation, bodies, b, layers)
      type(simulation_type), intent(inout) :: simulation
      type(body_list_type), intent(in) :: bodies
      integer, intent(in) :: b
      type(layers_type), intent(in) :: layers
      real(wp) :: thick

      thick = minval(bodies%high(:2, b) - bodies%low(:2, b))
      if (thick >= few_triangles*layers%smallest) return
      call doubt(simulation, bodies, b, layers%example, ' are far too stiff in bending (they ' &
            //'lock)', nint(thick/layers%smallest), 'mesh with '//quadratic(simulation%model &
            %elements%kind(layers%example))//', two through the thickness do')
   end subroutine doubt_triangles

   subroutine doubt_quads(simulation, bodies, b, layers)
      type(simulation_type), intent(inout) :: simulation
      type(body_list_type), intent(in) :: bodies
      integer, intent(in) :: b
      type(layers_type), intent(in) :: layers
      real(wp) :: thick, ratio
      integer :: n
      logical :: averaged

      thick = minval(bodies%high(:2, b) - bodies%low(:2, b))
      n = max(1, nint(thick/layers%through))
      associate (model => simulation%model, e => layers%example, &
            kind => simulation%model%elements%kind(layers%example))
         averaged = model%sections(model%elements%section(e))%b_bar
         ratio = bending_ratio(model%materials(material_of(model, e))%poisson, kind, averaged, &
               layers%along/thick, n)
         if (ratio > 1.0_wp + much) then
            call doubt(simulation, bodies, b, e, ' are about '//percent(ratio - 1.0_wp) &
                  //' too stiff in bending', n, finer(kind, averaged))
         else if (.not. ratio > 0.0_wp) then
            call doubt(simulation, bodies, b, e, ' in one layer resist bending by their ' &
                  //'hourglass control only, far too little', n, finer(kind, averaged))
         else if (1.0_wp/ratio > 1.0_wp + much) then
            call doubt(simulation, bodies, b, e, ' are about '//percent(1.0_wp/ratio - 1.0_wp) &
                  //' too soft in bending', n, finer(kind, averaged))
         end if
      end associate
   end subroutine doubt_quads

   !> Stiffness in bending of quadrilaterals by that of the beam.
   pure real(wp) function bending_ratio(nu, kind, averaged, slenderness, n) result(ratio)
      real(wp), intent(in) :: nu                 !! Poisson's ratio
      integer, intent(in) :: kind
      logical, intent(in) :: averaged            !! BBAR=YES
      real(wp), intent(in) :: slenderness        !! element's length by the body's thickness
      integer, intent(in) :: n                   !! elements through the thickness
      real(wp) :: share

      share = 1.0_wp/real(n, wp)**2
      if (solid_reduced(kind)) then
         ratio = 1.0_wp - share
      else if (solid_plane(kind) == plane_stress) then
         ratio = 1.0_wp + slenderness**2/(2.0_wp*(1.0_wp + nu)) + share*nu**2/(1.0_wp - nu**2)
      else
         ratio = 1.0_wp + 0.5_wp*(1.0_wp - nu)*slenderness**2
         if (averaged) then
            ratio = ratio - share*(1.0_wp + 2.0_wp*nu)/3.0_wp
         else
            ratio = ratio + share*nu**2/(1.0_wp - 2.0_wp*nu)
         end if
      end if
   end function bending_ratio

   !> The mesh that does.
   pure function finer(kind, averaged) result(cure)
      integer, intent(in) :: kind
      logical, intent(in) :: averaged
      character(len=:), allocatable :: cure

      if (solid_reduced(kind)) then
         cure = 'take four or more through the thickness'
      else
         cure = 'take three or more through the thickness, no longer than a third of it'
         if (solid_plane(kind) /= plane_stress .and. .not. averaged) cure = cure &
               //' and with BBAR=YES on *SOLID SECTION'
      end if
      cure = cure//', or mesh with '//quadratic(kind)//', two through the thickness do'
   end function finer

   subroutine doubt(simulation, bodies, b, e, fault, n, cure)
      type(simulation_type), intent(inout) :: simulation
      type(body_list_type), intent(in) :: bodies
      integer, intent(in) :: b                   !! body
      integer, intent(in) :: e                   !! element that stands for it
      character(len=*), intent(in) :: fault, cure
      integer, intent(in) :: n                   !! elements through the thickness
      real(wp) :: extent(2)

      extent = bodies%high(:2, b) - bodies%low(:2, b)
      associate (model => simulation%model)
         call add_remark(simulation, note_at(model%source, model%sections(model%elements &
               %section(e))%place, 'warning: '//kind_name(model%elements%kind(e))//fault &
               //', and the body of element '//to_text(model%elements%id(e))//', ' &
               //to_text(maxval(extent), 3)//' long and '//to_text(minval(extent), 3) &
               //' thick, has at most '//to_text(n)//' of them through its thickness' &
               //new_line('a')//'  cure: where it bends, '//cure))
      end associate
   end subroutine doubt

   !> "CPE6 or CPE8", of quadrilaterals "CPE8R or CPE8".
   pure function quadratic(kind) result(names)
      integer, intent(in) :: kind
      character(len=:), allocatable :: names
      character(len=3) :: family

      family = kind_name(kind)
      names = family//'6 or '//family//'8'
      if (solid_topology(kind) == quad4) names = family//'8R or '//family//'8'
   end function quadratic

   pure function percent(part) result(text)
      real(wp), intent(in) :: part
      character(len=:), allocatable :: text

      text = to_text(100.0_wp*part, 2)//' %'
   end function percent

end module bending_doubts
