!> `*EQUATION`: linear constraints, the first freedom of each eliminated.
module equation_reader
   use kinds, only: wp
   use errors, only: error_type
   use places, only: fail_at, line_text
   use histories, only: equation_type, boundary_type
   use model, only: model_type
   use integer_map, only: integer_map_type
   use cards, only: deck_type, card_type
   use fields, only: fields_type, split_line, check_count, field_place
   use fields, only: get_integer, get_real
   use spring_reader, only: get_dof
   use text, only: to_text
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: read_equations, check_equations

contains

   !> All equations; a card may hold several.
   subroutine read_equations(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      type(equation_type), allocatable :: equations(:)
      integer :: i, n, line, status

      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword /= 'EQUATION') cycle
         n = n + deck%cards(i)%last - deck%cards(i)%first + 1
      end do
      allocate (equations(n), stat=status)
      call check_allocation(status)
      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword /= 'EQUATION') cycle
         line = deck%cards(i)%first
         do while (line <= deck%cards(i)%last)
            n = n + 1
            call read_equation(equations(n), model, deck, deck%cards(i), line, error)
            if (allocated(error)) return
         end do
      end do
      model%equations = equations(:n)
   end subroutine read_equations

   !> The number of terms, then the terms over as many lines as they take.
   subroutine read_equation(equation, model, deck, card, line, error)
      type(equation_type), intent(out) :: equation
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      integer, intent(inout) :: line   !! that of the number in, the one behind the last term out
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer :: n_terms, n_read, status

      call split_line(fields, deck, card, line, model%source, error)
      if (allocated(error)) return
      call check_count(fields, 1, model%source, error)
      if (allocated(error)) return
      call get_integer(fields, 1, 'number of terms', n_terms, model%source, error)
      if (allocated(error)) return
      equation%place = fields%place
      if (n_terms < 2 .or. n_terms > 4*(card%last - line)) then
         call fail_at(error, model%source, field_place(fields, 1), &
               'the number of terms does not fit the lines that follow', &
               cure='write the number, 2 or more, then as many triples node, dof, coefficient')
         return
      end if
      allocate (equation%node(n_terms), equation%dof(n_terms), equation%coefficient(n_terms), &
            stat=status)
      call check_allocation(status)
      n_read = 0
      line = line + 1
      do while (n_read < n_terms)
         if (line > card%last) then
            call fail_at(error, model%source, equation%place, 'the equation has '// &
                  to_text(n_terms)//' terms but only '//to_text(n_read)//' follow', &
                  cure='write as many triples of node, dof, coefficient as the number says')
            return
         end if
         call read_terms(equation, n_read, model, deck, card, line, error)
         if (allocated(error)) return
         line = line + 1
      end do
   end subroutine read_equation

   !> The triples of one line.
   subroutine read_terms(equation, n_read, model, deck, card, line, error)
      type(equation_type), intent(inout) :: equation
      integer, intent(inout) :: n_read
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      integer, intent(in) :: line
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer :: i, id

      call split_line(fields, deck, card, line, model%source, error)
      if (allocated(error)) return
      call check_count(fields, 3*min(4, size(equation%node) - n_read), model%source, error)
      if (allocated(error)) return
      do i = 1, fields%n, 3
         call get_integer(fields, i, 'node id', id, model%source, error)
         if (allocated(error)) return
         n_read = n_read + 1
         equation%node(n_read) = model%nodes%index_of%find(id)
         if (equation%node(n_read) == 0) then
            call fail_at(error, model%source, field_place(fields, i), &
                  'no such node: '//to_text(id), cure='define it with *NODE')
            return
         end if
         call get_dof(fields, i + 1, equation%dof(n_read), model%source, error)
         if (allocated(error)) return
         call get_real(fields, i + 2, 'coefficient', equation%coefficient(n_read), &
               model%source, error)
         if (allocated(error)) return
         if (n_read > 1 .or. abs(equation%coefficient(1)) > 0.0_wp) cycle
         call fail_at(error, model%source, field_place(fields, 3), &
               'the first coefficient is zero', &
               cure='the first freedom is eliminated: it must take part')
         return
      end do
   end subroutine read_terms

   !> A freedom may be eliminated once, and then neither be used elsewhere nor be prescribed.
   subroutine check_equations(model, error)
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      type(integer_map_type) :: eliminated   !! freedom to index of its equation
      integer :: i, twin, key

      do i = 1, size(model%equations)
         key = freedom_key(model%equations(i)%node(1), model%equations(i)%dof(1))
         twin = eliminated%find(key)
         if (twin > 0) then
            call report(model, i, 1, 'is eliminated twice, first at '// &
                  line_text(model%source, model%equations(twin)%place), error)
            return
         end if
         call eliminated%insert(key, i)
      end do
      do i = 1, size(model%equations)
         call check_terms(model, i, eliminated, error)
         if (allocated(error)) return
      end do
      call check_boundaries(model, model%boundaries, eliminated, error)
      if (allocated(error)) return
      do i = 1, size(model%steps)
         call check_boundaries(model, model%steps(i)%boundaries, eliminated, error)
         if (allocated(error)) return
      end do
   end subroutine check_equations

   subroutine check_terms(model, i, eliminated, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      type(integer_map_type), intent(in) :: eliminated
      type(error_type), allocatable, intent(out) :: error
      type(integer_map_type) :: seen
      integer :: k, key, other

      do k = 1, size(model%equations(i)%node)
         key = freedom_key(model%equations(i)%node(k), model%equations(i)%dof(k))
         other = eliminated%find(key)
         if (seen%find(key) > 0) then
            call report(model, i, k, 'stands twice in one equation', error)
            return
         else if (k > 1 .and. other > 0) then
            call report(model, i, k, 'is used here but eliminated at '// &
                  line_text(model%source, model%equations(other)%place), error)
            return
         end if
         call seen%insert(key, k)
      end do
   end subroutine check_terms

   subroutine report(model, i, k, trouble, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i, k   !! equation and term
      character(len=*), intent(in) :: trouble
      type(error_type), allocatable, intent(out) :: error

      call fail_at(error, model%source, model%equations(i)%place, 'freedom '// &
            to_text(model%equations(i)%dof(k))//' of node '// &
            to_text(model%nodes%id(model%equations(i)%node(k)))//' '//trouble, &
            cure='the first freedom of an equation is eliminated: let each be first once, '// &
            'and stand nowhere else')
   end subroutine report

   subroutine check_boundaries(model, boundaries, eliminated, error)
      type(model_type), intent(in) :: model
      type(boundary_type), intent(in) :: boundaries(:)
      type(integer_map_type), intent(in) :: eliminated
      type(error_type), allocatable, intent(out) :: error
      integer :: i, other

      do i = 1, size(boundaries)
         other = eliminated%find(freedom_key(boundaries(i)%node, boundaries(i)%dof))
         if (other == 0) cycle
         call fail_at(error, model%source, boundaries(i)%place, 'freedom '// &
               to_text(boundaries(i)%dof)//' of node '// &
               to_text(model%nodes%id(boundaries(i)%node))// &
               ' is prescribed here but eliminated by the equation at '// &
               line_text(model%source, model%equations(other)%place), &
               cure='prescribe another freedom of the equation, or write that freedom first')
         return
      end do
   end subroutine check_boundaries

   pure function freedom_key(node, dof) result(key)
      integer, intent(in) :: node, dof
      integer :: key

      key = 3*node + dof
   end function freedom_key

end module equation_reader
