!> Small-strain von Mises plasticity with piecewise linear hardening, isotropic or kinematic: radial
!> return and its consistent tangent (Simo and Hughes, Computational Inelasticity, box 3.2).
!> Components are 11 22 33 12 with engineering shear strain.
module j2_plastic
   use kinds, only: wp
   use elastic, only: plane_stress, elastic_matrix, elastic_thickness => thickness_strain
   use point_law, only: point_law_type
   implicit none
   private

   public :: j2_type, new_j2
   public :: n_state, state_strain, state_back, state_peeq, state_work, state_stress

   !> What a point remembers, and where it stands: plastic strain (4), back stress (4), equivalent
   !> plastic strain, plastic work a volume, stress (4). All start at zero.
   integer, parameter :: state_strain = 1
   integer, parameter :: state_back = 5
   integer, parameter :: state_peeq = 9
   integer, parameter :: state_work = 10
   integer, parameter :: state_stress = 11
   integer, parameter :: n_state = 14

   !> The law. Isotropic: the table is the yield stress over equivalent plastic strain. Kinematic:
   !> the yield surface keeps the size of the table's first stress and its centre moves with the
   !> slope that the table has at the equivalent plastic strain.
   type, extends(point_law_type) :: j2_type
      real(wp) :: shear = 0.0_wp
      real(wp) :: bulk = 0.0_wp
      real(wp) :: poisson = 0.0_wp
      real(wp) :: elastic(4, 4) = 0.0_wp
      logical :: kinematic = .false.
      real(wp), allocatable :: x(:)             !! equivalent plastic strain, increasing
      real(wp), allocatable :: y(:)             !! yield stress; constant beyond the ends
   contains
      procedure :: update
      procedure :: stress_at
      procedure :: thickness_strain
      procedure :: stored_energy
      procedure :: dissipated
      procedure :: plastic_measure
   end type j2_type

contains

   pure subroutine new_j2(self, elasticity, plane, kinematic, x, y)
      type(j2_type), intent(out) :: self
      real(wp), intent(in) :: elasticity(2)     !! Young's modulus, Poisson's ratio
      integer, intent(in) :: plane              !! plane_strain, plane_stress or axisymmetric
      logical, intent(in) :: kinematic
      real(wp), intent(in) :: x(:), y(:)

      self%n_state = n_state
      self%poisson = elasticity(2)
      self%shear = elasticity(1)/(2.0_wp*(1.0_wp + elasticity(2)))
      self%bulk = elasticity(1)/(3.0_wp*(1.0_wp - 2.0_wp*elasticity(2)))
      self%elastic = elastic_matrix(elasticity(1), elasticity(2), plane)
      self%plane = plane
      self%kinematic = kinematic
      self%x = x
      self%y = y
   end subroutine new_j2

   !> Stress, state and, if asked for, tangent after going from a state to a strain. In plane stress
   !> strain 33 is not looked at. The work is the trapezoid (old stress + new stress)/2 : plastic
   !> strain made, so that with the elastic energy it adds up to the trapezoid of stress : strain
   !> exactly.
   pure subroutine update(self, strain, state, stress, updated, tangent)
      class(j2_type), intent(in) :: self
      real(wp), intent(in) :: strain(4)
      real(wp), intent(in) :: state(self%n_state)
      real(wp), intent(out) :: stress(4)
      real(wp), intent(out) :: updated(self%n_state)
      real(wp), intent(out), optional :: tangent(4, 4)
      real(wp) :: total(4), made(4), unused(4, 4)
      logical :: elastic

      if (self%plane == plane_stress) then
         total(1:2) = strain(1:2)
         total(3) = state(3) + elastic_thickness(self%poisson, strain - state(1:4))
         total(4) = strain(4)
         call try_elastic(self, total, state, stress, elastic)
         if (elastic) stress(3) = 0.0_wp
      else
         call try_elastic(self, strain, state, stress, elastic)
      end if
      updated(:state_work) = state(:state_work)
      if (elastic) then
         updated(state_stress:) = stress
         if (present(tangent)) tangent = self%elastic
         return
      end if
      if (self%plane /= plane_stress) then
         call return_radially(self, strain, state, stress, updated, tangent)
      else if (present(tangent)) then
         call return_plane(self, total, state, stress, updated, tangent)
      else
         call return_plane(self, total, state, stress, updated, unused)
      end if
      made = updated(1:4) - state(1:4)
      updated(state_work) = state(state_work) &
            + dot_product(state(state_stress:) + stress, made)/2.0_wp
      updated(state_stress:) = stress
   end subroutine update

   !> D : elastic strain.
   pure function stress_at(self, strain, state) result(stress)
      class(j2_type), intent(in) :: self
      real(wp), intent(in) :: strain(4)
      real(wp), intent(in) :: state(self%n_state)
      real(wp) :: stress(4)

      stress = matmul(self%elastic, strain - state(1:4))
   end function stress_at

   pure function thickness_strain(self, strain, state) result(number)
      class(j2_type), intent(in) :: self
      real(wp), intent(in) :: strain(4)
      real(wp), intent(in) :: state(self%n_state)
      real(wp) :: number

      number = state(3) + elastic_thickness(self%poisson, strain - state(1:4))
   end function thickness_strain

   !> Half of stress : elastic strain.
   pure function stored_energy(self, strain, state, stress) result(energy)
      class(j2_type), intent(in) :: self
      real(wp), intent(in) :: strain(4)
      real(wp), intent(in) :: state(self%n_state)
      real(wp), intent(in) :: stress(4)
      real(wp) :: energy

      energy = dot_product(stress, strain - state(1:4))/2.0_wp
   end function stored_energy

   pure function dissipated(self, state) result(energy)
      class(j2_type), intent(in) :: self
      real(wp), intent(in) :: state(self%n_state)
      real(wp) :: energy

      energy = state(state_work)
   end function dissipated

   pure function plastic_measure(self, state) result(peeq)
      class(j2_type), intent(in) :: self
      real(wp), intent(in) :: state(self%n_state)
      real(wp) :: peeq

      peeq = state(state_peeq)
   end function plastic_measure

   !> The elastic stress at a strain, and whether it is within the yield surface. In scalars: most
   !> points of most steps need no more than this.
   pure subroutine try_elastic(self, strain, state, stress, elastic)
      type(j2_type), intent(in) :: self
      real(wp), intent(in) :: strain(4), state(n_state)
      real(wp), intent(out) :: stress(4)
      logical, intent(out) :: elastic
      real(wp) :: e1, e2, e3, sum_e, s1, s2, s3, s4, size, squared

      e1 = strain(1) - state(1)
      e2 = strain(2) - state(2)
      e3 = strain(3) - state(3)
      sum_e = e1 + e2 + e3
      s1 = 2.0_wp*self%shear*(e1 - sum_e/3.0_wp)
      s2 = 2.0_wp*self%shear*(e2 - sum_e/3.0_wp)
      s3 = 2.0_wp*self%shear*(e3 - sum_e/3.0_wp)
      s4 = self%shear*(strain(4) - state(4))
      squared = (s1 - state(state_back))**2 + (s2 - state(state_back + 1))**2 &
            + (s3 - state(state_back + 2))**2 + 2.0_wp*(s4 - state(state_back + 3))**2
      size = surface_size(self, state(state_peeq))*(1.0_wp + 1.0e-13_wp)
      elastic = 1.5_wp*squared <= size**2
      stress(1) = s1 + self%bulk*sum_e
      stress(2) = s2 + self%bulk*sum_e
      stress(3) = s3 + self%bulk*sum_e
      stress(4) = s4
   end subroutine try_elastic

   !> Deviator of the elastic stress at a strain, less the back stress.
   pure function relative_deviator(self, strain, state) result(xi)
      type(j2_type), intent(in) :: self
      real(wp), intent(in) :: strain(4), state(n_state)
      real(wp) :: xi(4)
      real(wp) :: e(3), third

      e = strain(1:3) - state(1:3)
      third = (e(1) + e(2) + e(3))/3.0_wp
      xi(1) = 2.0_wp*self%shear*(e(1) - third) - state(state_back)
      xi(2) = 2.0_wp*self%shear*(e(2) - third) - state(state_back + 1)
      xi(3) = 2.0_wp*self%shear*(e(3) - third) - state(state_back + 2)
      xi(4) = self%shear*(strain(4) - state(4)) - state(state_back + 3)
   end function relative_deviator

   !> von Mises stress of a deviator.
   pure function trial_size(xi) result(q)
      real(wp), intent(in) :: xi(4)
      real(wp) :: q

      q = sqrt(1.5_wp*(sum(xi(1:3)**2) + 2.0_wp*xi(4)**2))
   end function trial_size

   !> von Mises stress on the yield surface.
   pure function surface_size(self, peeq) result(size)
      type(j2_type), intent(in) :: self
      real(wp), intent(in) :: peeq
      real(wp) :: size
      integer :: i

      size = self%y(1)
      if (self%kinematic) return
      i = segment(self, peeq)
      if (i > 0) size = self%y(i) + slope(self, i)*(peeq - self%x(i))
   end function surface_size

   !> The table's last point at or before an equivalent plastic strain, 0 before the first.
   pure function segment(self, peeq) result(i)
      type(j2_type), intent(in) :: self
      real(wp), intent(in) :: peeq
      integer :: i

      do i = size(self%x), 1, -1
         if (self%x(i) <= peeq) return
      end do
      i = 0
   end function segment

   !> Slope of the table after its point i.
   pure function slope(self, i) result(h)
      type(j2_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp) :: h

      h = 0.0_wp
      if (i == 0 .or. i == size(self%x)) return
      h = (self%y(i + 1) - self%y(i))/(self%x(i + 1) - self%x(i))
   end function slope

   !> Growth of the equivalent plastic strain that takes back an excess of von Mises stress, walking
   !> along the table; the hardening gained on the way and the slope where it ends.
   pure subroutine grow(self, excess, peeq, growth, hardening, h)
      type(j2_type), intent(in) :: self
      real(wp), intent(in) :: excess, peeq
      real(wp), intent(out) :: growth, hardening, h
      real(wp) :: left, part
      integer :: i

      left = excess
      growth = 0.0_wp
      hardening = 0.0_wp
      do i = segment(self, peeq), size(self%x)
         h = slope(self, i)
         part = left/(3.0_wp*self%shear + h)
         if (i < size(self%x)) part = min(part, max(0.0_wp, self%x(i + 1) - peeq - growth))
         growth = growth + part
         hardening = hardening + h*part
         if (i == size(self%x)) return
         if (part < self%x(i + 1) - peeq - growth + part) return
         left = left - part*(3.0_wp*self%shear + h)
      end do
   end subroutine grow

   !> Radial return with strain 33 given; the strain is known to yield.
   pure subroutine return_radially(self, strain, state, stress, updated, tangent)
      type(j2_type), intent(in) :: self
      real(wp), intent(in) :: strain(4), state(n_state)
      real(wp), intent(out) :: stress(4)
      real(wp), intent(inout) :: updated(n_state)
      real(wp), intent(out), optional :: tangent(4, 4)
      real(wp) :: xi(4), q, normal(4), growth, hardening, h
      real(wp), parameter :: root = sqrt(1.5_wp)

      xi = relative_deviator(self, strain, state)
      q = trial_size(xi)
      normal = root*xi/q
      call grow(self, q - surface_size(self, state(state_peeq)), state(state_peeq), growth, &
            hardening, h)
      updated(1:3) = state(1:3) + root*growth*normal(1:3)
      updated(4) = state(4) + 2.0_wp*root*growth*normal(4)
      updated(state_back:state_back + 3) = state(state_back:state_back + 3)
      if (self%kinematic) updated(state_back:state_back + 3) = &
            updated(state_back:state_back + 3) + hardening/root*normal
      updated(state_peeq) = state(state_peeq) + growth
      stress = xi + state(state_back:state_back + 3) - 2.0_wp*self%shear*root*growth*normal
      stress(1:3) = stress(1:3) + self%bulk*sum(strain(1:3) - state(1:3))
      if (present(tangent)) tangent = consistent_tangent(self, normal, &
            3.0_wp*self%shear*growth/q, h)
   end subroutine return_radially

   !> K 1 1t + 2 G theta I_dev - 2 G (1/(1 + h/3G) - 1 + theta) n nt, theta = 1 - ratio.
   pure function consistent_tangent(self, normal, ratio, h) result(tangent)
      type(j2_type), intent(in) :: self
      real(wp), intent(in) :: normal(4)         !! unit tensor along the deviator
      real(wp), intent(in) :: ratio             !! 3 G growth/trial size
      real(wp), intent(in) :: h                 !! slope of the hardening
      real(wp) :: tangent(4, 4)
      real(wp) :: along
      integer :: i

      along = 2.0_wp*self%shear*(3.0_wp*self%shear/(3.0_wp*self%shear + h) - ratio)
      do i = 1, 4
         tangent(:, i) = -along*normal*normal(i)
      end do
      tangent(1:3, 1:3) = tangent(1:3, 1:3) + self%bulk &
            - 2.0_wp/3.0_wp*self%shear*(1.0_wp - ratio)
      do i = 1, 3
         tangent(i, i) = tangent(i, i) + 2.0_wp*self%shear*(1.0_wp - ratio)
      end do
      tangent(4, 4) = tangent(4, 4) + self%shear*(1.0_wp - ratio)
   end function consistent_tangent

   !> Plane stress: Newton's iteration for the strain 33 that leaves no stress 33, kept within the
   !> bounds found so far; the tangent is condensed.
   pure subroutine return_plane(self, start, state, stress, updated, tangent)
      type(j2_type), intent(in) :: self
      real(wp), intent(in) :: start(4), state(n_state)
      real(wp), intent(out) :: stress(4)
      real(wp), intent(inout) :: updated(n_state)
      real(wp), intent(out) :: tangent(4, 4)
      real(wp) :: strain(4), low, high, tolerance
      integer :: i
      integer, parameter :: most = 100

      strain = start
      low = -huge(low)
      high = huge(high)
      tolerance = 1.0e-13_wp*surface_size(self, state(state_peeq))
      do i = 1, most
         call return_full(self, strain, state, stress, updated, tangent)
         if (abs(stress(3)) <= tolerance) exit
         if (stress(3) > 0.0_wp) high = strain(3)
         if (stress(3) < 0.0_wp) low = strain(3)
         strain(3) = strain(3) - stress(3)/tangent(3, 3)
         if (strain(3) <= low .or. strain(3) >= high) strain(3) = low + (high - low)/2.0_wp
         if (strain(3) <= low .or. strain(3) >= high) exit
      end do
      stress(3) = 0.0_wp
      do i = 1, 4
         if (i /= 3) tangent(:, i) = tangent(:, i) - tangent(:, 3)*(tangent(3, i)/tangent(3, 3))
      end do
      tangent(:, 3) = 0.0_wp
      tangent(3, :) = 0.0_wp
   end subroutine return_plane

   !> Radial return with strain 33 given, or the elastic answer inside of the surface.
   pure subroutine return_full(self, strain, state, stress, updated, tangent)
      type(j2_type), intent(in) :: self
      real(wp), intent(in) :: strain(4), state(n_state)
      real(wp), intent(out) :: stress(4)
      real(wp), intent(inout) :: updated(n_state)
      real(wp), intent(out) :: tangent(4, 4)
      logical :: elastic

      call try_elastic(self, strain, state, stress, elastic)
      if (.not. elastic) then
         call return_radially(self, strain, state, stress, updated, tangent)
         return
      end if
      updated = state
      tangent = consistent_tangent(self, [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], 0.0_wp, 0.0_wp)
   end subroutine return_full

end module j2_plastic
