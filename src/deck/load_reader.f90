!> `*DLOAD` and `*BASE MOTION`.
module load_reader
   use kinds, only: wp
   use errors, only: error_type
   use places, only: fail_at
   use properties, only: name_length
   use histories, only: gravity_type, base_motion_type
   use model, only: model_type
   use cards, only: deck_type, card_type, get_integer_parameter, parameter_place
   use fields, only: fields_type, split_line, check_count, only_line, field_place, field_text
   use fields, only: is_given, get_reals, get_name
   use amplitude_reader, only: find_amplitude
   use numbers, only: unit_vector
   use set_reader, only: find_element_set
   use words, only: word_length, squeezed, advice
   implicit none
   private

   public :: read_gravity, read_base_motions

contains

   !> The GRAV lines of all *DLOAD cards of a step.
   subroutine read_gravity(list, model, deck, step, error)
      type(gravity_type), allocatable, intent(out) :: list(:)
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer :: i, n, line, amplitude

      allocate (list(count_lines(deck, 'DLOAD', step)))
      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword /= 'DLOAD' .or. deck%cards(i)%step /= step) cycle
         call find_amplitude(model, deck%cards(i), amplitude, error)
         if (allocated(error)) return
         do line = deck%cards(i)%first, deck%cards(i)%last
            call split_line(fields, deck, deck%cards(i), line, model%source, error)
            if (allocated(error)) return
            n = n + 1
            list(n)%amplitude = amplitude
            list(n)%place = fields%place
            call read_gravity_line(list(n), model, fields, error)
            if (allocated(error)) return
         end do
      end do
   end subroutine read_gravity

   pure function count_lines(deck, keyword, step) result(n)
      type(deck_type), intent(in) :: deck
      character(len=*), intent(in) :: keyword
      integer, intent(in) :: step
      integer :: n
      integer :: i

      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword == keyword .and. deck%cards(i)%step == step) then
            n = n + deck%cards(i)%last - deck%cards(i)%first + 1
         end if
      end do
   end function count_lines

   !> Element set or nothing, GRAV, size, direction.
   subroutine read_gravity_line(gravity, model, fields, error)
      type(gravity_type), intent(inout) :: gravity
      type(model_type), intent(in) :: model
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: allowed(*) = [character(len=word_length) :: 'GRAV']
      character(len=name_length) :: name
      real(wp) :: values(4)

      select case (squeezed(field_text(fields, 2)))
      case ('GRAV')
         call check_count(fields, 6, model%source, error)
      case ('P1', 'P2', 'P3', 'P4')
         call fail_at(error, model%source, field_place(fields, 2), &
               squeezed(field_text(fields, 2))//' is known but does not work yet', &
               cure=advice('', allowed))
      case default
         call fail_at(error, model%source, field_place(fields, 2), &
               "unknown load '"//field_text(fields, 2)//"'", &
               cure=advice(field_text(fields, 2), allowed))
      end select
      if (allocated(error)) return
      if (is_given(fields, 1)) then
         call get_name(fields, 1, 'element set', name, model%source, error)
         if (allocated(error)) return
         call find_element_set(model, name, field_place(fields, 1), gravity%set, error)
         if (allocated(error)) return
      end if
      call get_reals(fields, 3, 3, 'size and direction', values, model%source, error)
      if (allocated(error)) return
      if (all(abs(values(2:)) <= 0.0_wp)) then
         call fail_at(error, model%source, field_place(fields, 4), &
               'this direction has no length', cure='write a vector of any length but zero')
         return
      end if
      gravity%acceleration = values(1)*unit_vector(values(2:))
   end subroutine read_gravity_line

   !> All *BASE MOTION cards of a step.
   subroutine read_base_motions(list, model, deck, step, error)
      type(base_motion_type), allocatable, intent(out) :: list(:)
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      integer :: i, n

      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword == 'BASEMOTION' .and. deck%cards(i)%step == step) n = n + 1
      end do
      allocate (list(n))
      n = 0
      do i = 1, deck%n_cards
         if (deck%cards(i)%keyword /= 'BASEMOTION' .or. deck%cards(i)%step /= step) cycle
         n = n + 1
         call read_base_motion(list(n), model, deck, deck%cards(i), error)
         if (allocated(error)) return
         if (all(list(:n - 1)%dof /= list(n)%dof)) cycle
         call fail_at(error, model%source, parameter_place(deck%cards(i), 'DOF'), &
               'this step has a base motion along this freedom already', cure='keep one of the two')
         return
      end do
   end subroutine read_base_motions

   subroutine read_base_motion(motion, model, deck, card, error)
      type(base_motion_type), intent(inout) :: motion
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      real(wp) :: values(1)

      motion%place = card%place
      call find_amplitude(model, card, motion%amplitude, error)
      if (allocated(error)) return
      call get_integer_parameter(card, 'DOF', 1, motion%dof, model%source, error)
      if (allocated(error)) return
      if (motion%dof > 3) then
         call fail_at(error, model%source, parameter_place(card, 'DOF'), &
               'no such freedom', cure='freedoms are 1, 2 and 3 for x, y and z')
         return
      end if
      if (card%last < card%first) return
      call only_line(fields, deck, card, 1, model%source, error)
      if (allocated(error)) return
      call get_reals(fields, 1, 1, 'scale', values, model%source, error)
      motion%scale = values(1)
   end subroutine read_base_motion

end module load_reader
