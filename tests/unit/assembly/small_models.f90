!> Small models put together by hand, as the deck reader would leave them.
module small_models
   use kinds, only: wp
   use histories, only: boundary_type, nodal_value_type, gravity_type, base_motion_type, &
         equation_type, amplitude_type, time_step, motion_displacement
   use mesh, only: set_type, element_group_type, element_mass, element_spring1, element_spring2, &
         element_springa, element_dashpot1, element_dashpot2, element_dashpota, element_truss
   use model, only: model_type
   use properties, only: section_type, material_type, section_solid, section_spring, &
         section_dashpot, section_mass
   use steps, only: step_type, procedure_dynamic
   implicit none
   private

   public :: start_model, add_node, add_mass, add_spring1, add_spring2, add_springa, add_nonlinear
   public :: add_dashpot1, add_dashpot2, add_dashpota, add_truss, add_group, add_equation
   public :: add_boundary, add_amplitude, add_step, add_load, add_motion, add_gravity
   public :: add_base_motion, add_element_set

contains

   !> Nothing at all.
   subroutine start_model(model)
      type(model_type), intent(out) :: model

      allocate (model%nodes%id(0), model%nodes%x(3, 0), model%nodes%place(0))
      allocate (model%elements%id(0), model%elements%kind(0), model%elements%nodes(0))
      allocate (model%elements%section(0), model%elements%place(0))
      model%elements%first = [1]
      allocate (model%node_sets(0), model%element_sets(0), model%materials(0), model%sections(0))
      allocate (model%groups(0), model%amplitudes(0), model%surfaces(0), model%rigid_surfaces(0))
      allocate (model%interactions(0), model%pairs(0), model%equations(0), model%boundaries(0))
      allocate (model%initial_displacements(0), model%initial_velocities(0), model%steps(0))
      allocate (model%notes(0), model%source%files(0))
   end subroutine start_model

   !> The next node; its id is ten times its index.
   subroutine add_node(model, x)
      type(model_type), intent(inout) :: model
      real(wp), intent(in) :: x(3)
      integer :: n

      n = model%nodes%n + 1
      model%nodes%n = n
      model%nodes%id = [model%nodes%id, 10*n]
      model%nodes%x = reshape([model%nodes%x, x], [3, n])
      deallocate (model%nodes%place)
      allocate (model%nodes%place(n))
   end subroutine add_node

   !> MASS at a node.
   subroutine add_mass(model, node, m)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node
      real(wp), intent(in) :: m
      type(section_type) :: section

      section%kind = section_mass
      section%coefficient = m
      call add_element(model, element_mass, [node], section)
   end subroutine add_mass

   !> SPRING1 along direction dof of a node.
   subroutine add_spring1(model, node, dof, k)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node, dof
      real(wp), intent(in) :: k
      type(section_type) :: section

      section%kind = section_spring
      section%coefficient = k
      section%dof = dof
      call add_element(model, element_spring1, [node], section)
   end subroutine add_spring1

   !> SPRING2 between direction dof of two nodes.
   subroutine add_spring2(model, nodes, dof, k)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: nodes(2), dof
      real(wp), intent(in) :: k
      type(section_type) :: section

      section%kind = section_spring
      section%coefficient = k
      section%dof = dof
      call add_element(model, element_spring2, nodes, section)
   end subroutine add_spring2

   !> SPRINGA along the line of two nodes.
   subroutine add_springa(model, nodes, k)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: nodes(2)
      real(wp), intent(in) :: k
      type(section_type) :: section

      section%kind = section_spring
      section%coefficient = k
      call add_element(model, element_springa, nodes, section)
   end subroutine add_springa

   !> Nonlinear SPRING1 along direction dof of a node.
   subroutine add_nonlinear(model, node, dof, u, f)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node, dof
      real(wp), intent(in) :: u(:), f(:)
      type(section_type) :: section

      section%kind = section_spring
      section%nonlinear = .true.
      section%force%n = size(u)
      section%force%x = u
      section%force%y = f
      section%dof = dof
      call add_element(model, element_spring1, [node], section)
   end subroutine add_nonlinear

   !> DASHPOT1 along direction dof of a node.
   subroutine add_dashpot1(model, node, dof, c)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node, dof
      real(wp), intent(in) :: c
      type(section_type) :: section

      section%kind = section_dashpot
      section%coefficient = c
      section%dof = dof
      call add_element(model, element_dashpot1, [node], section)
   end subroutine add_dashpot1

   !> DASHPOT2 between direction dof of two nodes.
   subroutine add_dashpot2(model, nodes, dof, c)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: nodes(2), dof
      real(wp), intent(in) :: c
      type(section_type) :: section

      section%kind = section_dashpot
      section%coefficient = c
      section%dof = dof
      call add_element(model, element_dashpot2, nodes, section)
   end subroutine add_dashpot2

   !> DASHPOTA along the line of two nodes.
   subroutine add_dashpota(model, nodes, c)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: nodes(2)
      real(wp), intent(in) :: c
      type(section_type) :: section

      section%kind = section_dashpot
      section%coefficient = c
      call add_element(model, element_dashpota, nodes, section)
   end subroutine add_dashpota

   !> A truss of a material of its own: E, rho, Rayleigh's alpha and beta.
   subroutine add_truss(model, nodes, area, material)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: nodes(2)
      real(wp), intent(in) :: area
      real(wp), intent(in) :: material(4)
      type(section_type) :: section
      type(material_type), allocatable :: longer(:)
      integer :: n

      n = size(model%materials)
      allocate (longer(n + 1))
      longer(:n) = model%materials
      longer(n + 1)%young = material(1)
      longer(n + 1)%density = material(2)
      longer(n + 1)%damping_alpha = material(3)
      longer(n + 1)%damping_beta = material(4)
      call move_alloc(longer, model%materials)
      section%kind = section_solid
      section%area = area
      section%material = n + 1
      call add_element(model, element_truss, nodes, section)
   end subroutine add_truss

   !> The next element with a section of its own; its id is a hundred times its index.
   subroutine add_element(model, kind, nodes, section)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: kind, nodes(:)
      type(section_type), intent(in) :: section
      type(section_type), allocatable :: longer(:)
      integer :: n

      n = model%elements%n + 1
      model%elements%n = n
      model%elements%id = [model%elements%id, 100*n]
      model%elements%kind = [model%elements%kind, kind]
      model%elements%nodes = [model%elements%nodes, nodes]
      model%elements%first = [model%elements%first, size(model%elements%nodes) + 1]
      deallocate (model%elements%place)
      allocate (model%elements%place(n))
      n = size(model%sections)
      allocate (longer(n + 1))
      longer(:n) = model%sections
      longer(n + 1) = section
      call move_alloc(longer, model%sections)
      model%elements%section = [model%elements%section, n + 1]
   end subroutine add_element

   !> A set of elements.
   subroutine add_element_set(model, members)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: members(:)
      type(set_type), allocatable :: longer(:)
      integer :: n

      n = size(model%element_sets)
      allocate (longer(n + 1))
      longer(:n) = model%element_sets
      longer(n + 1)%members = members
      call move_alloc(longer, model%element_sets)
   end subroutine add_element_set

   !> `*ELEMENT GROUP` for some elements; mass 0 leaves it to the scheme.
   subroutine add_group(model, members, scheme, mass)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: members(:), scheme, mass
      type(element_group_type) :: group

      call add_element_set(model, members)
      group%set = size(model%element_sets)
      group%scheme = scheme
      group%mass = mass
      model%groups = [model%groups, group]
   end subroutine add_group

   !> `*EQUATION`: sum of coefficients times freedoms is zero.
   subroutine add_equation(model, node, dof, coefficient)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node(:), dof(:)
      real(wp), intent(in) :: coefficient(:)
      type(equation_type), allocatable :: longer(:)
      integer :: n

      n = size(model%equations)
      allocate (longer(n + 1))
      longer(:n) = model%equations
      longer(n + 1)%node = node
      longer(n + 1)%dof = dof
      longer(n + 1)%coefficient = coefficient
      call move_alloc(longer, model%equations)
   end subroutine add_equation

   !> A freedom fixed before the first step.
   subroutine add_boundary(model, node, dof)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node, dof
      type(boundary_type) :: boundary

      boundary%node = node
      boundary%dof = dof
      model%boundaries = [model%boundaries, boundary]
   end subroutine add_boundary

   !> `*AMPLITUDE` on step time, or as said.
   subroutine add_amplitude(model, t, a, time)
      type(model_type), intent(inout) :: model
      real(wp), intent(in) :: t(:), a(:)
      integer, intent(in), optional :: time
      type(amplitude_type), allocatable :: longer(:)
      integer :: n

      n = size(model%amplitudes)
      allocate (longer(n + 1))
      longer(:n) = model%amplitudes
      longer(n + 1)%t = t
      longer(n + 1)%a = a
      longer(n + 1)%time = time_step
      if (present(time)) longer(n + 1)%time = time
      call move_alloc(longer, model%amplitudes)
   end subroutine add_amplitude

   !> A step without loads or conditions, dynamic or as said.
   subroutine add_step(model, duration, procedure)
      type(model_type), intent(inout) :: model
      real(wp), intent(in) :: duration
      integer, intent(in), optional :: procedure
      type(step_type), allocatable :: longer(:)
      integer :: n

      n = size(model%steps) + 1
      allocate (longer(n))
      longer(:n - 1) = model%steps
      longer(n)%procedure = procedure_dynamic
      if (present(procedure)) longer(n)%procedure = procedure
      longer(n)%duration = duration
      allocate (longer(n)%boundaries(0), longer(n)%loads(0), longer(n)%gravity(0), &
            longer(n)%distributed(0))
      allocate (longer(n)%base_motions(0), longer(n)%initial_displacements(0))
      allocate (longer(n)%initial_velocities(0), longer(n)%requests(0))
      call move_alloc(longer, model%steps)
   end subroutine add_step

   !> `*CLOAD` in the last step.
   subroutine add_load(model, node, dof, value, amplitude)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node, dof
      real(wp), intent(in) :: value
      integer, intent(in), optional :: amplitude
      type(nodal_value_type) :: load
      integer :: n

      load%node = node
      load%dof = dof
      load%value = value
      if (present(amplitude)) load%amplitude = amplitude
      n = size(model%steps)
      model%steps(n)%loads = [model%steps(n)%loads, load]
   end subroutine add_load

   !> `*BOUNDARY` in the last step, of displacement or as said.
   subroutine add_motion(model, node, dof, value, amplitude, motion)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node, dof
      real(wp), intent(in) :: value
      integer, intent(in), optional :: amplitude, motion
      type(boundary_type) :: boundary
      integer :: n

      boundary%node = node
      boundary%dof = dof
      boundary%value = value
      boundary%motion = motion_displacement
      if (present(amplitude)) boundary%amplitude = amplitude
      if (present(motion)) boundary%motion = motion
      n = size(model%steps)
      model%steps(n)%boundaries = [model%steps(n)%boundaries, boundary]
   end subroutine add_motion

   !> `*DLOAD` with GRAV in the last step, on an element set (0: all).
   subroutine add_gravity(model, set, acceleration, amplitude)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: set
      real(wp), intent(in) :: acceleration(3)
      integer, intent(in), optional :: amplitude
      type(gravity_type) :: gravity
      integer :: n

      gravity%set = set
      gravity%acceleration = acceleration
      if (present(amplitude)) gravity%amplitude = amplitude
      n = size(model%steps)
      model%steps(n)%gravity = [model%steps(n)%gravity, gravity]
   end subroutine add_gravity

   !> `*BASE MOTION` in the last step.
   subroutine add_base_motion(model, dof, scale, amplitude)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: dof, amplitude
      real(wp), intent(in) :: scale
      type(base_motion_type) :: motion
      integer :: n

      motion%dof = dof
      motion%scale = scale
      motion%amplitude = amplitude
      n = size(model%steps)
      model%steps(n)%base_motions = [model%steps(n)%base_motions, motion]
   end subroutine add_base_motion

end module small_models
