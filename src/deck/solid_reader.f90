!> `*SOLID SECTION`: material and thickness of plane elements, area of trusses.
module solid_reader
   use kinds, only: wp
   use errors, only: error_type
   use places, only: source_type, fail_at, note_at
   use properties, only: name_length, section_type
   use mesh, only: element_truss, is_solid_kind, solid_plane, solid_topology, solid_reduced
   use mesh, only: plane_strain, plane_stress, axisymmetric, quad4
   use model, only: model_type
   use source_reader, only: add_note
   use cards, only: deck_type, card_type, count_cards, get_word, get_name_parameter
   use cards, only: get_real_parameter, parameter_place
   use fields, only: fields_type, only_line, field_place, get_reals, is_given
   use element_types, only: kind_name
   use words, only: word_length, advice
   use text, only: to_text
   implicit none
   private

   public :: retype, read_solid

contains

   !> ELEMENTS=CPE, CPS or CAX makes all solids of the set such; meshers know one plane type only.
   subroutine retype(kinds, members, card, source, error)
      integer, intent(inout) :: kinds(:)   !! of all elements
      integer, intent(in) :: members(:)    !! of the set
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: planes(*) = [character(len=word_length) :: &
            'CPE', 'CPS', 'CAX']
      integer, parameter :: plane_values(*) = [plane_strain, plane_stress, axisymmetric]
      integer :: i, choice

      call get_word(card, 'ELEMENTS', planes, choice, source, error)
      if (allocated(error) .or. choice == 0) return
      if (.not. any(is_solid_kind(kinds(members)))) then
         call fail_at(error, source, parameter_place(card, 'ELEMENTS'), &
               'the set has no plane or axisymmetric elements', cure='remove ELEMENTS')
         return
      end if
      do i = 1, size(members)
         associate (kind => kinds(members(i)))
            if (is_solid_kind(kind)) kind = 100*plane_values(choice) + modulo(kind, 100)
         end associate
      end do
   end subroutine retype

   !> The rest of a solid section, once its set is known and its elements have their type.
   subroutine read_solid(section, model, deck, card, error)
      type(section_type), intent(inout) :: section
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: kinds(:)
      real(wp) :: offset

      kinds = model%elements%kind(model%element_sets(section%set)%members)
      call check_mixture(kinds, card, model%source, error)
      if (allocated(error)) return
      call read_material(section, model, deck, card, error)
      if (allocated(error)) return
      call check_plasticity(section, kinds, model, card, error)
      if (allocated(error)) return
      offset = 0.0_wp
      call get_real_parameter(card, 'OFFSET', offset, model%source, error)
      if (allocated(error)) return
      if (abs(offset) > 0.0_wp) then
         call fail_at(error, model%source, parameter_place(card, 'OFFSET'), &
               'an offset of the section is not known here', cure='remove OFFSET')
         return
      end if
      call read_b_bar(section, kinds, card, model%source, error)
      if (allocated(error)) return
      call read_thickness(section, kinds, deck, card, model, error)
      if (allocated(error)) return
      call check_places(model, model%element_sets(section%set)%members, error)
   end subroutine read_solid

   subroutine check_mixture(kinds, card, source, error)
      integer, intent(in) :: kinds(:)
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      if (any(kinds == element_truss) .and. any(is_solid_kind(kinds))) then
         call fail_at(error, source, parameter_place(card, 'ELSET'), &
               'the set mixes trusses and solids', cure='give each type a set of its own')
      end if
   end subroutine check_mixture

   !> A solid needs elasticity, and density when anything moves.
   subroutine read_material(section, model, deck, card, error)
      type(section_type), intent(inout) :: section
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=name_length) :: name

      call get_name_parameter(card, 'MATERIAL', name, model%source, error)
      if (allocated(error)) return
      section%material = model%material_of%find(name)
      if (section%material == 0) then
         call fail_at(error, model%source, parameter_place(card, 'MATERIAL'), &
               'no such material: '//trim(name), &
               cure='define it with *MATERIAL; '//advice(name, [model%materials%name]))
         return
      end if
      associate (used => model%materials(section%material))
         if (.not. used%has_elastic) then
            call fail_at(error, model%source, parameter_place(card, 'MATERIAL'), &
                  "material '"//trim(used%name)//"' has no *ELASTIC", cure='give it E and nu')
         else if (.not. used%has_density .and. &
               count_cards(deck, 'DYNAMIC') + count_cards(deck, 'FREQUENCY') > 0) then
            call fail_at(error, model%source, parameter_place(card, 'MATERIAL'), &
                  "material '"//trim(used%name)//"' has no *DENSITY", &
                  cure='write *DENSITY and the density below *MATERIAL: every *DYNAMIC and ' &
                  //'*FREQUENCY step needs it (of steel 7850 in kg and m, 7.85e-9 in t and mm)')
         end if
      end associate
   end subroutine read_material

   subroutine check_plasticity(section, kinds, model, card, error)
      type(section_type), intent(in) :: section
      integer, intent(in) :: kinds(:)
      type(model_type), intent(in) :: model
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error

      if (.not. model%materials(section%material)%has_plastic) return
      if (all(kinds /= element_truss)) return
      call fail_at(error, model%source, parameter_place(card, 'MATERIAL'), &
            'plasticity of trusses is known but does not work yet', &
            cure='give trusses a material without *PLASTIC')
   end subroutine check_plasticity

   !> BBAR=YES averages the volumetric strain of an element; only CPE4 and CAX4 have a use for it.
   subroutine read_b_bar(section, kinds, card, source, error)
      type(section_type), intent(inout) :: section
      integer, intent(in) :: kinds(:)
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: answers(*) = [character(len=word_length) :: &
            'YES', 'NO']
      integer :: i, choice

      call get_word(card, 'BBAR', answers, choice, source, error)
      if (allocated(error)) return
      section%b_bar = choice == 1
      if (.not. section%b_bar) return
      do i = 1, size(kinds)
         if (takes_b_bar(kinds(i))) cycle
         call fail_at(error, source, parameter_place(card, 'BBAR'), &
               'BBAR is for CPE4 and CAX4, the set has '//kind_name(kinds(i)), &
               cure='remove BBAR, or give each type its set')
         return
      end do
   end subroutine read_b_bar

   pure function takes_b_bar(kind) result(takes)
      integer, intent(in) :: kind
      logical :: takes

      takes = is_solid_kind(kind) .and. solid_plane(kind) /= plane_stress .and. &
            solid_topology(kind) == quad4 .and. .not. solid_reduced(kind)
   end function takes_b_bar

   !> The data line: the area of trusses, the thickness of plane elements (1 without a line).
   subroutine read_thickness(section, kinds, deck, card, model, error)
      type(section_type), intent(inout) :: section
      integer, intent(in) :: kinds(:)
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(model_type), intent(inout) :: model
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      character(len=:), allocatable :: what
      real(wp) :: values(1)

      section%area = 1.0_wp
      what = 'thickness'
      if (any(kinds == element_truss)) what = 'area'
      if (card%last < card%first) then
         if (what == 'area') call fail_at(error, model%source, card%place, &
               '*SOLID SECTION of trusses has no data lines', cure='write the area of the truss')
         return
      end if
      call only_line(fields, deck, card, 1, model%source, error)
      if (allocated(error)) return
      if (what == 'thickness' .and. .not. is_given(fields, 1)) return
      call get_reals(fields, 1, 1, what, values, model%source, error)
      if (allocated(error)) return
      if (all(solid_plane(kinds) == axisymmetric)) then
         call add_note(model%notes, note_at(model%source, fields%place, 'the thickness of '// &
               'axisymmetric elements has no effect: forces are those of the whole ring'))
      else if (any(solid_plane(kinds) == axisymmetric)) then
         call fail_at(error, model%source, field_place(fields, 1), 'a thickness of a set that '// &
               'mixes plane and axisymmetric elements', cure='give each type a set of its own')
      else if (values(1) <= 0.0_wp) then
         call fail_at(error, model%source, field_place(fields, 1), &
               'the '//what//' must be positive', cure='write a number above 0')
      else
         section%area = values(1)
      end if
   end subroutine read_thickness

   !> Plane elements lie in a plane of one z, axisymmetric ones at radii x >= 0.
   subroutine check_places(model, members, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: members(:)
      type(error_type), allocatable, intent(out) :: error
      real(wp), parameter :: noise = 1.0e-6_wp
      integer :: i, e
      real(wp) :: length, lowest(3), highest(3)

      do i = 1, size(members)
         e = members(i)
         if (.not. is_solid_kind(model%elements%kind(e))) cycle
         associate (nodes => model%elements%nodes(model%elements%first(e): &
               model%elements%first(e + 1) - 1))
            lowest = minval(model%nodes%x(:, nodes), dim=2)
            highest = maxval(model%nodes%x(:, nodes), dim=2)
         end associate
         length = noise*maxval(highest(:2) - lowest(:2))
         if (highest(3) - lowest(3) > length) then
            call fail_at(error, model%source, model%elements%place(e), &
                  'the nodes of element '//to_text(model%elements%id(e))//' ('// &
                  kind_name(model%elements%kind(e))//') differ in z', &
                  cure='draw plane and axisymmetric elements in the x, y plane')
            return
         end if
         if (solid_plane(model%elements%kind(e)) == axisymmetric .and. lowest(1) < -length) then
            call fail_at(error, model%source, model%elements%place(e), &
                  'element '//to_text(model%elements%id(e))//' ('// &
                  kind_name(model%elements%kind(e))//') reaches beyond the axis x = 0', &
                  cure='x is the radius and not negative, y the axis')
            return
         end if
      end do
   end subroutine check_places

end module solid_reader
