!> Sections: what the elements of a set are made of; every element needs exactly one.
module section_reader
   use kinds, only: wp
   use errors, only: error_type
   use places, only: source_type, fail_at, line_text
   use properties, only: name_length, section_type, section_solid, section_spring
   use properties, only: section_dashpot, section_mass, section_gap
   use mesh, only: element_mass, element_spring1, element_spring2, element_springa
   use mesh, only: element_dashpot1, element_dashpot2, element_dashpota, element_truss, element_gap
   use mesh, only: element_line
   use model, only: model_type
   use cards, only: deck_type, card_type, get_name_parameter, parameter_place
   use fields, only: fields_type, only_line, field_place, get_reals
   use spring_reader, only: read_spring
   use numbers, only: unit_vector
   use set_reader, only: find_element_set
   use element_types, only: kind_name
   use solid_reader, only: read_solid, retype
   use source_reader, only: add_note
   use words, only: advice
   use text, only: to_text
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: read_sections

contains

   !> Reads all sections, then sees that every element has one.
   subroutine read_sections(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      type(section_type) :: section
      integer :: i, n, status

      allocate (model%sections(count_sections(deck)), stat=status)
      call check_allocation(status)
      n = 0
      do i = 1, deck%n_cards
         if (section_kind(deck%cards(i)%keyword) == 0) cycle
         n = n + 1
         call read_section(section, model, deck, deck%cards(i), error)
         if (allocated(error)) return
         model%sections(n) = section
         call assign_section(model, n, deck%cards(i), error)
         if (allocated(error)) return
      end do
      call find_lines(model)
      call check_complete(model, error)
   end subroutine read_sections

   pure function count_sections(deck) result(n)
      type(deck_type), intent(in) :: deck
      integer :: n
      integer :: i

      n = 0
      do i = 1, deck%n_cards
         if (section_kind(deck%cards(i)%keyword) > 0) n = n + 1
      end do
   end function count_sections

   !> The kind of section a keyword makes, 0 if it makes none.
   pure function section_kind(keyword) result(kind)
      character(len=*), intent(in) :: keyword
      integer :: kind

      select case (keyword)
      case ('SOLIDSECTION')
         kind = section_solid
      case ('SPRING')
         kind = section_spring
      case ('DASHPOT')
         kind = section_dashpot
      case ('MASS')
         kind = section_mass
      case ('GAP')
         kind = section_gap
      case default
         kind = 0
      end select
   end function section_kind

   !> The card that gives an element of this kind its section.
   pure function section_card(kind) result(card)
      integer, intent(in) :: kind   !! element_ parameter
      character(len=:), allocatable :: card

      select case (kind_of_section(kind))
      case (section_solid)
         card = '*SOLID SECTION'
      case (section_spring)
         card = '*SPRING'
      case (section_dashpot)
         card = '*DASHPOT'
      case (section_mass)
         card = '*MASS'
      case (section_gap)
         card = '*GAP'
      case default
         card = 'no section: it marks a boundary'
      end select
   end function section_card

   !> The kind of section that an element kind needs.
   elemental function kind_of_section(element_kind) result(kind)
      integer, intent(in) :: element_kind
      integer :: kind

      select case (element_kind)
      case (element_mass)
         kind = section_mass
      case (element_spring1, element_spring2, element_springa)
         kind = section_spring
      case (element_dashpot1, element_dashpot2, element_dashpota)
         kind = section_dashpot
      case (element_gap)
         kind = section_gap
      case (element_line)
         kind = 0
      case default
         kind = section_solid
      end select
   end function kind_of_section

   subroutine read_section(section, model, deck, card, error)
      type(section_type), intent(out) :: section
      type(model_type), intent(inout) :: model   !! solids are re-typed
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=name_length) :: name

      section%kind = section_kind(card%keyword)
      section%place = card%place
      call get_name_parameter(card, 'ELSET', name, model%source, error)
      if (allocated(error)) return
      call find_element_set(model, name, parameter_place(card, 'ELSET'), section%set, error)
      if (allocated(error)) return
      call check_kinds(section, model, card, error)
      if (allocated(error)) return
      select case (section%kind)
      case (section_solid)
         call retype(model%elements%kind, model%element_sets(section%set)%members, card, &
               model%source, error)
         if (allocated(error)) return
         call read_solid(section, model, deck, card, error)
      case (section_spring, section_dashpot)
         call read_spring(section, deck, card, &
               model%elements%kind(model%element_sets(section%set)%members), model%source, error)
      case (section_mass)
         call read_mass(section, deck, card, model%source, error)
      case default
         call read_gap(section, model, deck, card, error)
      end select
   end subroutine read_section

   !> All elements of the set must be of the kind that the card is for.
   subroutine check_kinds(section, model, card, error)
      type(section_type), intent(in) :: section
      type(model_type), intent(in) :: model
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      integer :: i, e

      do i = 1, size(model%element_sets(section%set)%members)
         e = model%element_sets(section%set)%members(i)
         if (kind_of_section(model%elements%kind(e)) == section%kind) cycle
         call fail_at(error, model%source, parameter_place(card, 'ELSET'), &
               'wrong element type: element '//to_text(model%elements%id(e))//' is '// &
               kind_name(model%elements%kind(e))//', which takes '// &
               section_card(model%elements%kind(e)), cure='give each type a set of its own')
         return
      end do
   end subroutine check_kinds

   subroutine read_mass(section, deck, card, source, error)
      type(section_type), intent(inout) :: section
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      real(wp) :: values(1)

      call only_line(fields, deck, card, 1, source, error)
      if (allocated(error)) return
      call get_reals(fields, 1, 1, 'mass', values, source, error)
      if (allocated(error)) return
      section%coefficient = values(1)
      if (values(1) <= 0.0_wp) call fail_at(error, source, field_place(fields, 1), &
            'the mass must be positive', cure='write m > 0')
   end subroutine read_mass

   subroutine read_gap(section, model, deck, card, error)
      type(section_type), intent(inout) :: section
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      character(len=name_length) :: name
      real(wp) :: values(4)

      if (index(model%element_sets(section%set)%name, '/') > 0) then
         call fail_at(error, model%source, parameter_place(card, 'ELSET'), &
               'a set of gaps names a group of the results', &
               cure="give them a set without '/' in its name")
         return
      end if
      call get_name_parameter(card, 'INTERACTION', name, model%source, error)
      if (allocated(error)) return
      section%interaction = model%interaction_of%find(name)
      if (section%interaction == 0) then
         call fail_at(error, model%source, parameter_place(card, 'INTERACTION'), &
               'no such surface interaction: '//trim(name), &
               cure='define it with *SURFACE INTERACTION; '// &
               advice(name, [model%interactions%name]))
         return
      else if (model%interactions(section%interaction)%friction > 0.0_wp) then
         call fail_at(error, model%source, parameter_place(card, 'INTERACTION'), &
               'gap elements have no friction, this interaction has', &
               cure='give them an interaction without *FRICTION, or use a *CONTACT PAIR')
         return
      end if
      call only_line(fields, deck, card, 4, model%source, error)
      if (allocated(error)) return
      call get_reals(fields, 1, 1, 'clearance and normal', values, model%source, error)
      if (allocated(error)) return
      section%clearance = values(1)
      if (fields%n == 1) return
      if (all(abs(values(2:)) <= 0.0_wp)) then
         call fail_at(error, model%source, field_place(fields, 2), 'the normal has no length', &
               cure='write nx, ny, nz, or leave them out')
         return
      end if
      section%normal = unit_vector(values(2:))
   end subroutine read_gap

   !> Gives the elements of the section's set their section; a second one is an error.
   subroutine assign_section(model, n, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      integer :: i, e, other

      do i = 1, size(model%element_sets(model%sections(n)%set)%members)
         e = model%element_sets(model%sections(n)%set)%members(i)
         other = model%elements%section(e)
         if (other > 0) then
            call fail_at(error, model%source, parameter_place(card, 'ELSET'), 'element '// &
                  to_text(model%elements%id(e))//' has two sections, the first at '// &
                  line_text(model%source, model%sections(other)%place), &
                  cure='let the sets of the two have no element in common')
            return
         end if
         model%elements%section(e) = n
      end do
   end subroutine assign_section

   !> Trusses without a section are lines that mark a boundary, as gmsh writes them.
   subroutine find_lines(model)
      type(model_type), intent(inout) :: model
      integer :: e, n

      do e = 1, model%elements%n
         if (model%elements%kind(e) /= element_truss .or. model%elements%section(e) > 0) cycle
         model%elements%kind(e) = element_line
      end do
      n = count(model%elements%kind == element_line)
      if (n > 0) call add_note(model%notes, to_text(n)//' line elements without a section '// &
            'mark boundaries and carry nothing')
   end subroutine find_lines

   subroutine check_complete(model, error)
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer :: e

      do e = 1, model%elements%n
         if (model%elements%section(e) > 0 .or. model%elements%kind(e) == element_line) cycle
         call fail_at(error, model%source, model%elements%place(e), 'element '// &
               to_text(model%elements%id(e))//' ('//kind_name(model%elements%kind(e))// &
               ') has no section', &
               cure='put it into a set that a '//section_card(model%elements%kind(e))// &
               ' card names')
         return
      end do
   end subroutine check_complete

end module section_reader
