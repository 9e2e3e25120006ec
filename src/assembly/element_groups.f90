!> The factory of element groups: gathers the model's elements by section and scheme, checks their
!> geometry, and makes the objects that compute.
module element_groups
   use kinds, only: wp
   use errors, only: error_type, new_error, status_internal
   use text, only: to_text
   use memory_shortage, only: check_allocation
   use places, only: fail_at
   use model, only: model_type
   use mesh, only: element_mass, element_spring1, element_spring2, element_springa, &
         element_dashpot1, element_dashpot2, element_dashpota, element_truss, element_gap, &
         element_line, is_solid_kind, scheme_implicit, scheme_explicit, &
         scheme_automatic, mass_consistent
   use properties, only: section_type, material_type
   use element_interface, only: element_type
   use element_chunks, only: chunks_type
   use axial_kinematics, only: one_freedom, two_freedoms, line_of_action
   use point_mass, only: point_mass_type, new_point_mass
   use solid_factory, only: make_solid
   use spring, only: spring_type, new_spring
   use dashpot, only: dashpot_type, new_dashpot
   use truss, only: truss_type, new_truss, truss_material_type
   implicit none
   private

   public :: group_type, build_groups, group_mass

   !> Elements of one kind, section, scheme and mass.
   type :: group_type
      class(element_type), allocatable :: element
      integer :: kind = 0                        !! one of the element_ parameters
      integer, allocatable :: member(:)          !! (n) element indices in the model
      integer, allocatable :: ien(:, :)          !! (n_nodes, n) node indices
      integer, allocatable :: lm(:, :)           !! (3 n_nodes, n) freedoms, 0: does not exist
      type(chunks_type) :: chunks                !! of elements that work in chunks
      integer :: history_start = 0               !! variables before this group's in the history
      integer :: scheme = scheme_implicit
      logical :: lumped = .true.
      logical :: resists = .false.               !! its elements have forces: not so point masses
      real(wp), allocatable :: damping(:, :, :)  !! (3 n_nodes, 3 n_nodes, n), empty without any
      !> Of redistributed mass (else not allocated): 0 at nodes that have lost theirs, 1 elsewhere;
      !> what was moved to them; by what the element's mass is multiplied after that.
      real(wp), allocatable :: mass_share(:, :)  !! (n_nodes, n)
      real(wp), allocatable :: moved_mass(:, :)  !! (n_nodes, n)
      real(wp), allocatable :: mass_factor(:)    !! (n)
   end type group_type

contains

   !> Makes the groups of a model. A line element of no length is an error at its line.
   subroutine build_groups(groups, model, lumped_default, error, automatic)
      type(group_type), allocatable, intent(out) :: groups(:)
      type(model_type), intent(in) :: model
      logical, intent(in) :: lumped_default      !! mass of groups that do not say which
      type(error_type), allocatable, intent(out) :: error
      integer, intent(in), optional :: automatic(:)   !! (n_elements) scheme in place of AUTO
      integer, allocatable :: key(:)
      integer :: e, g, n_groups, scheme_of(model%elements%n)
      logical :: lumped_of(model%elements%n)
      integer :: status

      call resolve_schemes(model, lumped_default, scheme_of, lumped_of)
      if (present(automatic)) then
         where (scheme_of == scheme_automatic) scheme_of = automatic
      end if
      where (scheme_of == scheme_automatic) scheme_of = scheme_explicit
      call number_groups(model, scheme_of, lumped_of, key, n_groups)
      allocate (groups(n_groups), stat=status)
      call check_allocation(status)
      call list_members(groups, key)
      do g = 1, n_groups
         e = groups(g)%member(1)
         groups(g)%kind = model%elements%kind(e)
         groups(g)%scheme = scheme_of(e)
         groups(g)%lumped = lumped_of(e)
         call gather_nodes(groups(g), model)
         call make_element(groups(g), model, error)
         if (allocated(error)) return
         call store_damping(groups(g))
      end do
   end subroutine build_groups

   !> The elements of every group, in their order.
   subroutine list_members(groups, key)
      type(group_type), intent(inout) :: groups(:)
      integer, intent(in) :: key(:)              !! (n_elements) their group, 0 for none
      integer, allocatable :: n(:)
      integer :: e, g, status

      allocate (n(size(groups)), source=0, stat=status)
      call check_allocation(status)
      do e = 1, size(key)
         if (key(e) > 0) n(key(e)) = n(key(e)) + 1
      end do
      do g = 1, size(groups)
         allocate (groups(g)%member(n(g)), stat=status)
         call check_allocation(status)
      end do
      n = 0
      do e = 1, size(key)
         if (key(e) == 0) cycle
         n(key(e)) = n(key(e)) + 1
         groups(key(e))%member(n(key(e))) = e
      end do
   end subroutine list_members

   !> What `*ELEMENT GROUP` says of each element.
   subroutine resolve_schemes(model, lumped_default, scheme_of, lumped_of)
      type(model_type), intent(in) :: model
      logical, intent(in) :: lumped_default
      integer, intent(out) :: scheme_of(:)
      logical, intent(out) :: lumped_of(:)
      integer :: g
      logical :: lumped

      scheme_of = scheme_implicit
      lumped_of = lumped_default
      do g = 1, size(model%groups)
         lumped = lumped_default .or. model%groups(g)%scheme /= scheme_implicit
         if (model%groups(g)%mass /= 0) lumped = model%groups(g)%mass /= mass_consistent
         scheme_of(model%element_sets(model%groups(g)%set)%members) = model%groups(g)%scheme
         lumped_of(model%element_sets(model%groups(g)%set)%members) = lumped
      end do
      ! Nothing but trusses and solids has a mass matrix that is not diagonal
      where (model%elements%kind(:model%elements%n) /= element_truss .and. &
            .not. is_solid_kind(model%elements%kind(:model%elements%n))) lumped_of = .true.
   end subroutine resolve_schemes

   !> Gives elements of one kind, section, scheme and mass one number; gaps and lines get none.
   subroutine number_groups(model, scheme_of, lumped_of, key, n_groups)
      type(model_type), intent(in) :: model
      integer, intent(in) :: scheme_of(:)
      logical, intent(in) :: lumped_of(:)
      integer, allocatable, intent(out) :: key(:)
      integer, intent(out) :: n_groups
      integer :: e, variant, status
      integer, allocatable :: rank_of(:), number_of(:, :, :)

      call rank_kinds(model%elements%kind(:model%elements%n), rank_of)
      allocate (key(model%elements%n), stat=status)
      call check_allocation(status)
      allocate (number_of(6, maxval([rank_of, 1]), 0:size(model%sections)), stat=status)
      call check_allocation(status)
      number_of = 0
      key = 0
      n_groups = 0
      do e = 1, model%elements%n
         if (any(model%elements%kind(e) == [element_gap, element_line])) cycle
         variant = 2*scheme_of(e) - merge(1, 0, lumped_of(e))
         associate (number => number_of(variant, rank_of(model%elements%kind(e)), &
               model%elements%section(e)))
            if (number == 0) then
               n_groups = n_groups + 1
               number = n_groups
            end if
            key(e) = number
         end associate
      end do
   end subroutine number_groups

   !> Numbers the kinds that occur from 1; 0 for the others.
   pure subroutine rank_kinds(kind, rank_of)
      integer, intent(in) :: kind(:)
      integer, allocatable, intent(out) :: rank_of(:)   !! (largest kind)
      integer :: i, status

      allocate (rank_of(maxval([kind, 1])), stat=status)
      call check_allocation(status)
      rank_of = 0
      rank_of(kind) = 1
      do i = 2, size(rank_of)
         if (rank_of(i) > 0) rank_of(i) = maxval(rank_of(:i - 1)) + 1
      end do
   end subroutine rank_kinds

   subroutine gather_nodes(group, model)
      type(group_type), intent(inout) :: group
      type(model_type), intent(in) :: model
      integer :: i, e, n_nodes, status

      e = group%member(1)
      n_nodes = model%elements%first(e + 1) - model%elements%first(e)
      allocate (group%ien(n_nodes, size(group%member)), stat=status)
      call check_allocation(status)
      do i = 1, size(group%member)
         e = model%elements%first(group%member(i))
         group%ien(:, i) = model%elements%nodes(e:e + n_nodes - 1)
      end do
   end subroutine gather_nodes

   !> The one place that turns an element kind into its type.
   subroutine make_element(group, model, error)
      type(group_type), intent(inout) :: group
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      type(section_type) :: section
      real(wp), allocatable :: b(:, :), length(:)

      section = model%sections(model%elements%section(group%member(1)))
      if (group%kind == element_mass) then
         call make_mass(group, section)
         return
      else if (is_solid_kind(group%kind)) then
         call make_solid(group%element, model, group%member, group%ien, group%lumped, error)
         return
      end if
      call find_kinematics(group, model, section, b, length, error)
      if (allocated(error)) return
      select case (group%kind)
      case (element_spring1, element_spring2, element_springa)
         call make_spring(group, section, b)
      case (element_dashpot1, element_dashpot2, element_dashpota)
         call make_dashpot(group, section, b)
      case (element_truss)
         call make_truss(group, section, model%materials(section%material), b, length)
      case default
         call new_error(error, status_internal, &
               'element kind '//to_text(group%kind)//' has no type')
      end select
   end subroutine make_element

   subroutine make_mass(group, section)
      type(group_type), intent(inout) :: group
      type(section_type), intent(in) :: section
      type(point_mass_type), allocatable :: element
      integer :: i, status

      allocate (element, stat=status)
      call check_allocation(status)
      call new_point_mass(element, [(section%coefficient, i=1, size(group%member))])
      call move_alloc(element, group%element)
   end subroutine make_mass

   subroutine make_spring(group, section, b)
      type(group_type), intent(inout) :: group
      type(section_type), intent(in) :: section
      real(wp), intent(in) :: b(:, :)
      type(spring_type), allocatable :: element
      integer :: status

      allocate (element, stat=status)
      call check_allocation(status)
      if (section%nonlinear) then
         call new_spring(element, b, 0.0_wp, section%force%x, section%force%y)
      else
         call new_spring(element, b, section%coefficient)
      end if
      call move_alloc(element, group%element)
   end subroutine make_spring

   subroutine make_dashpot(group, section, b)
      type(group_type), intent(inout) :: group
      type(section_type), intent(in) :: section
      real(wp), intent(in) :: b(:, :)
      type(dashpot_type), allocatable :: element
      integer :: status

      allocate (element, stat=status)
      call check_allocation(status)
      call new_dashpot(element, b, section%coefficient)
      call move_alloc(element, group%element)
   end subroutine make_dashpot

   subroutine make_truss(group, section, material, b, length)
      type(group_type), intent(inout) :: group
      type(section_type), intent(in) :: section
      type(material_type), intent(in) :: material
      real(wp), intent(in) :: b(:, :), length(:)
      type(truss_type), allocatable :: element
      type(truss_material_type) :: shared
      integer :: status

      shared%young = material%young
      shared%density = material%density
      shared%area = section%area
      shared%damping_alpha = material%damping_alpha
      shared%damping_beta = material%damping_beta
      allocate (element, stat=status)
      call check_allocation(status)
      call new_truss(element, b, length, shared, group%lumped)
      call move_alloc(element, group%element)
   end subroutine make_truss

   !> b of every element, and the lengths of those that act along a line.
   subroutine find_kinematics(group, model, section, b, length, error)
      type(group_type), intent(in) :: group
      type(model_type), intent(in) :: model
      type(section_type), intent(in) :: section
      real(wp), allocatable, intent(out) :: b(:, :), length(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: i, e, status

      allocate (b(3*size(group%ien, 1), size(group%member)), length(size(group%member)), &
            stat=status)
      call check_allocation(status)
      length = 0.0_wp
      do i = 1, size(group%member)
         select case (group%kind)
         case (element_spring1, element_dashpot1)
            b(:, i) = one_freedom(section%dof(1))
         case (element_spring2, element_dashpot2)
            b(:, i) = two_freedoms(section%dof)
         case default
            call line_of_action(model%nodes%x(:, group%ien(:, i)), b(:, i), length(i))
            if (length(i) > 0.0_wp) cycle
            e = group%member(i)
            call fail_at(error, model%source, model%elements%place(e), 'element ' &
                  //to_text(model%elements%id(e))//' has zero length: its two nodes coincide', &
                  'give its nodes different coordinates, or use a SPRING2 or DASHPOT2')
            return
         end select
      end do
   end subroutine find_kinematics

   !> Mass of element e of a group, redistributed where contact asks for it: factor times
   !> (D M D + diag(moved)), D zero at contact nodes.
   pure subroutine group_mass(group, e, lumped, matrix, part)
      type(group_type), intent(in) :: group
      integer, intent(in) :: e
      logical, intent(in) :: lumped
      real(wp), intent(out) :: matrix(:, :)      !! (3 n_nodes, 3 n_nodes)
      real(wp), intent(in), optional :: part     !! of M, 1 without
      integer :: i, node
      logical :: has_mass

      call group%element%mass(e, lumped, matrix)
      if (present(part)) matrix = part*matrix
      if (.not. allocated(group%moved_mass)) return
      do i = 1, size(matrix, 1)
         node = (i + 2)/3
         has_mass = matrix(i, i) > 0.0_wp
         matrix(:, i) = group%mass_share(node, e)*matrix(:, i)
         matrix(i, :) = group%mass_share(node, e)*matrix(i, :)
         if (has_mass) matrix(i, i) = matrix(i, i) + group%moved_mass(node, e)
      end do
      matrix = group%mass_factor(e)*matrix
   end subroutine group_mass

   !> Keeps the damping matrices if there is any damping in the group.
   subroutine store_damping(group)
      type(group_type), intent(inout) :: group
      integer :: n, i, status
      real(wp), allocatable :: matrix(:, :)

      n = 3*group%element%n_nodes
      allocate (matrix(n, n), stat=status)
      call check_allocation(status)
      call group%element%damping(1, matrix)
      if (.not. any(abs(matrix) > 0.0_wp)) then
         allocate (group%damping(n, n, 0), stat=status)
         call check_allocation(status)
         return
      end if
      allocate (group%damping(n, n, group%element%n_elements), stat=status)
      call check_allocation(status)
      do i = 1, group%element%n_elements
         call group%element%damping(i, group%damping(:, :, i))
      end do
   end subroutine store_damping

end module element_groups
