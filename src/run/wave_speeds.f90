!> Speeds of elastic waves in the materials of elements, and the lengths of elements that a wave has
!> to go through.
module wave_speeds
   use kinds, only: wp
   use properties, only: material_type
   use mesh, only: element_truss, is_solid_kind, solid_plane, solid_topology, plane_strain, &
         plane_stress, tri3, tri6
   use model, only: model_type
   implicit none
   private

   public :: is_continuum, longitudinal_speed, shear_speed, element_length, speed_name
   public :: material_of

contains

   !> Whether elements of a kind are pieces of a material: solids and trusses.
   pure elemental function is_continuum(kind) result(is)
      integer, intent(in) :: kind
      logical :: is

      is = is_solid_kind(kind) .or. kind == element_truss
   end function is_continuum

   !> Index of the material of an element that is a piece of one; 0 for others.
   pure integer function material_of(model, e)
      type(model_type), intent(in) :: model
      integer, intent(in) :: e                   !! element index

      material_of = 0
      if (.not. is_continuum(model%elements%kind(e))) return
      if (model%elements%section(e) == 0) return
      material_of = model%sections(model%elements%section(e))%material
   end function material_of

   !> Speed at which a pulse runs ahead: in a bar sqrt(E/rho), in plane stress
   !> sqrt(E/((1 - nu^2) rho)), in plane strain and around an axis that of the unbounded body,
   !> sqrt(E (1 - nu)/((1 + nu)(1 - 2 nu) rho)). Zero without a density.
   pure real(wp) function longitudinal_speed(material, kind) result(c)
      type(material_type), intent(in) :: material
      integer, intent(in) :: kind                !! of the element
      real(wp) :: modulus

      c = 0.0_wp
      if (.not. material%density > 0.0_wp) return
      modulus = material%young
      if (is_solid_kind(kind)) then
         associate (nu => material%poisson)
            if (solid_plane(kind) == plane_stress) then
               modulus = modulus/(1.0_wp - nu**2)
            else
               modulus = modulus*(1.0_wp - nu)/((1.0_wp + nu)*(1.0_wp - 2.0_wp*nu))
            end if
         end associate
      end if
      c = sqrt(modulus/material%density)
   end function longitudinal_speed

   !> sqrt(G/rho), zero without a density.
   pure real(wp) function shear_speed(material) result(c)
      type(material_type), intent(in) :: material

      c = 0.0_wp
      if (material%density > 0.0_wp) c = sqrt(material%young &
            /(2.0_wp*(1.0_wp + material%poisson)*material%density))
   end function shear_speed

   !> What the longitudinal speed of a kind of elements is that of.
   pure function speed_name(kind) result(name)
      integer, intent(in) :: kind
      character(len=:), allocatable :: name

      name = 'bar'
      if (.not. is_solid_kind(kind)) return
      select case (solid_plane(kind))
      case (plane_strain)
         name = 'plane strain'
      case (plane_stress)
         name = 'plane stress'
      case default
         name = 'axisymmetric'
      end select
   end function speed_name

   !> Length of a truss; smallest height of a solid: its area over its longest side, of a triangle
   !> twice that. Sides are straight between corners.
   pure real(wp) function element_length(model, e) result(length)
      type(model_type), intent(in) :: model
      integer, intent(in) :: e                   !! element index
      real(wp) :: x(2, 4), area, longest
      integer :: n, i, next, first
      logical :: triangle

      first = model%elements%first(e)
      associate (nodes => model%elements%nodes, kind => model%elements%kind(e))
         if (.not. is_solid_kind(kind)) then
            length = norm2(model%nodes%x(:, nodes(first + 1)) - model%nodes%x(:, nodes(first)))
            return
         end if
         triangle = solid_topology(kind) == tri3 .or. solid_topology(kind) == tri6
         n = merge(3, 4, triangle)
         x(:, :n) = model%nodes%x(:2, nodes(first:first + n - 1))
      end associate
      area = 0.0_wp
      longest = 0.0_wp
      do i = 1, n
         next = modulo(i, n) + 1
         area = area + 0.5_wp*(x(1, i)*x(2, next) - x(1, next)*x(2, i))
         longest = max(longest, norm2(x(:, next) - x(:, i)))
      end do
      length = merge(2.0_wp, 1.0_wp, triangle)*abs(area)/longest
   end function element_length

end module wave_speeds
