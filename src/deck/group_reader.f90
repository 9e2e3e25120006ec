!> `*ELEMENT GROUP`: how elements are integrated in time.
module group_reader
   use errors, only: error_type
   use places, only: fail_at, line_text
   use properties, only: name_length
   use mesh, only: scheme_implicit, scheme_explicit, scheme_automatic
   use mesh, only: mass_lumped, mass_consistent
   use model, only: model_type
   use cards, only: deck_type, card_type, count_cards, get_word, get_name_parameter
   use cards, only: parameter_place
   use set_reader, only: find_element_set
   use words, only: word_length
   use text, only: to_text
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: read_groups

contains

   subroutine read_groups(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: group_of(:)   !! (elements) index of the group, 0 for none
      integer :: i, n, status

      allocate (model%groups(count_cards(deck, 'ELEMENTGROUP')), stat=status)
      call check_allocation(status)
      allocate (group_of(model%elements%n), source=0, stat=status)
      call check_allocation(status)
      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword /= 'ELEMENTGROUP') cycle
         n = n + 1
         call read_group(model, n, deck%cards(i), error)
         if (allocated(error)) return
         call check_overlap(model, n, deck%cards(i), group_of, error)
         if (allocated(error)) return
      end do
   end subroutine read_groups

   subroutine read_group(model, n, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: schemes(*) = [character(len=word_length) :: &
            'IMPLICIT', 'EXPLICIT', 'AUTO']
      character(len=word_length), parameter :: masses(*) = [character(len=word_length) :: &
            'LUMPED', 'CONSISTENT']
      integer, parameter :: scheme_values(*) = [scheme_implicit, scheme_explicit, &
            scheme_automatic]
      integer, parameter :: mass_values(0:2) = [0, mass_lumped, mass_consistent]
      character(len=name_length) :: name
      integer :: choice, set

      call get_name_parameter(card, 'ELSET', name, model%source, error)
      if (allocated(error)) return
      call find_element_set(model, name, parameter_place(card, 'ELSET'), set, error)
      if (allocated(error)) return
      model%groups(n)%set = set
      model%groups(n)%place = card%place
      call get_word(card, 'SCHEME', schemes, choice, model%source, error)
      if (allocated(error)) return
      model%groups(n)%scheme = scheme_values(choice)
      call get_word(card, 'MASS', masses, choice, model%source, error)
      if (allocated(error)) return
      model%groups(n)%mass = mass_values(choice)
      if (model%groups(n)%scheme /= scheme_implicit .and. &
            model%groups(n)%mass == mass_consistent) then
         call fail_at(error, model%source, parameter_place(card, 'MASS'), &
               'explicit elements cannot have a consistent mass, nor can those of SCHEME=AUTO', &
               cure='write MASS=LUMPED')
      end if
   end subroutine read_group

   subroutine check_overlap(model, n, card, group_of, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: n
      type(card_type), intent(in) :: card
      integer, intent(inout) :: group_of(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: i, e

      do i = 1, size(model%element_sets(model%groups(n)%set)%members)
         e = model%element_sets(model%groups(n)%set)%members(i)
         if (group_of(e) > 0) then
            call fail_at(error, model%source, parameter_place(card, 'ELSET'), 'element '// &
                  to_text(model%elements%id(e))//' is in two element groups, the first at '// &
                  line_text(model%source, model%groups(group_of(e))%place), &
                  cure='let the sets of the groups have no element in common')
            return
         end if
         group_of(e) = n
      end do
   end subroutine check_overlap

end module group_reader
