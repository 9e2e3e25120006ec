!> `*SPRING` and `*DASHPOT`: directions, then a coefficient or a law.
module spring_reader
   use kinds, only: wp
   use errors, only: error_type
   use places, only: source_type, fail_at
   use properties, only: section_type, section_spring
   use mesh, only: element_spring1, element_springa, element_dashpot1, element_dashpota
   use cards, only: deck_type, card_type, has_parameter, parameter_place
   use fields, only: fields_type, split_line, check_count, field_place, is_given
   use fields, only: get_integer, get_reals
   use text, only: to_text
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: read_spring, get_dof

contains

   !> The rest of a spring's or dashpot's section, once its set is known.
   subroutine read_spring(section, deck, card, kinds, source, error)
      type(section_type), intent(inout) :: section
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      integer, intent(in) :: kinds(:)   !! of the elements of the set
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: axial(:)
      integer :: line, status

      allocate (axial(size(kinds)), stat=status)
      call check_allocation(status)
      axial = kinds == element_springa .or. kinds == element_dashpota
      if (any(axial) .and. .not. all(axial)) then
         call fail_at(error, source, parameter_place(card, 'ELSET'), &
               'the set mixes elements along their axis with elements along freedoms', &
               cure='give each type a set of its own')
         return
      end if
      line = card%first
      if (any(axial)) then
         call skip_empty(line, deck, card, source, error)
         if (allocated(error)) return
      else
         call read_directions(section, deck, card, kinds, source, error)
         if (allocated(error)) return
         line = line + 1
      end if
      section%nonlinear = has_parameter(card, 'NONLINEAR')
      if (section%nonlinear) then
         call read_law(section, deck, card, line, source, error)
      else
         call read_coefficient(section, deck, card, line, source, error)
      end if
   end subroutine read_spring

   !> A line of nothing but a comma may stand where other elements have their freedoms.
   subroutine skip_empty(line, deck, card, source, error)
      integer, intent(inout) :: line
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer :: k

      call split_line(fields, deck, card, line, source, error)
      if (allocated(error)) return
      if (.not. any([(is_given(fields, k), k=1, fields%n)])) line = line + 1
   end subroutine skip_empty

   !> The line with one or two freedoms; the second defaults to the first.
   subroutine read_directions(section, deck, card, kinds, source, error)
      type(section_type), intent(inout) :: section
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      integer, intent(in) :: kinds(:)
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer :: n_max

      n_max = 2
      if (any(kinds == element_spring1 .or. kinds == element_dashpot1)) n_max = 1
      call split_line(fields, deck, card, card%first, source, error)
      if (allocated(error)) return
      call check_count(fields, n_max, source, error)
      if (allocated(error)) return
      call get_dof(fields, 1, section%dof(1), source, error)
      if (allocated(error)) return
      section%dof(2) = section%dof(1)
      if (is_given(fields, 2)) call get_dof(fields, 2, section%dof(2), source, error)
   end subroutine read_directions

   !> A freedom: 1, 2 or 3.
   subroutine get_dof(fields, i, dof, source, error)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: i
      integer, intent(out) :: dof
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      call get_integer(fields, i, 'freedom', dof, source, error)
      if (allocated(error)) return
      if (dof < 1 .or. dof > 3) call fail_at(error, source, field_place(fields, i), &
            'no such freedom: '//to_text(dof), cure='freedoms are 1, 2 and 3 for x, y and z')
   end subroutine get_dof

   subroutine read_coefficient(section, deck, card, line, source, error)
      type(section_type), intent(inout) :: section
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      integer, intent(in) :: line
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      real(wp) :: values(1)
      character(len=:), allocatable :: what

      what = 'damping coefficient'
      if (section%kind == section_spring) what = 'stiffness'
      if (line > card%last) then
         call fail_at(error, source, deck%data(card%last), 'no line with the '//what, &
               cure='write the '//what//' on the line after')
         return
      else if (line < card%last) then
         call fail_at(error, source, deck%data(line + 1), 'one line too many', &
               cure='the '//what//' takes one line; without NONLINEAR it is one number')
         return
      end if
      call split_line(fields, deck, card, line, source, error)
      if (allocated(error)) return
      call check_count(fields, 1, source, error)
      if (allocated(error)) return
      call get_reals(fields, 1, 1, what, values, source, error)
      if (allocated(error)) return
      section%coefficient = values(1)
      if (values(1) < 0.0_wp) call fail_at(error, source, field_place(fields, 1), &
            'the '//what//' must not be negative', cure='write a number from 0 up')
   end subroutine read_coefficient

   !> Lines of force, elongation.
   subroutine read_law(section, deck, card, first, source, error)
      type(section_type), intent(inout) :: section
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      integer, intent(in) :: first   !! first line of the law
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      real(wp) :: values(2)
      integer :: line, n, status

      n = card%last - first + 1
      if (n < 2) then
         call fail_at(error, source, deck%data(card%last), &
               'a nonlinear spring needs two pairs at least', &
               cure='write lines of force, elongation')
         return
      end if
      allocate (section%force%x(n), section%force%y(n), stat=status)
      call check_allocation(status)
      section%force%n = n
      do line = first, card%last
         n = line - first + 1
         call split_line(fields, deck, card, line, source, error)
         if (allocated(error)) return
         call check_count(fields, 2, source, error)
         if (allocated(error)) return
         call get_reals(fields, 1, 2, 'force, elongation', values, source, error)
         if (allocated(error)) return
         section%force%y(n) = values(1)
         section%force%x(n) = values(2)
         if (n == 1) cycle
         if (values(2) > section%force%x(n - 1)) cycle
         call fail_at(error, source, field_place(fields, 2), 'the elongations must increase', &
               cure='order the lines of force, elongation by elongation')
         return
      end do
   end subroutine read_law

end module spring_reader
