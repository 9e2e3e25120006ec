!> `*RIGID SURFACE`: planes and circles, at rest or moved by an amplitude.
module rigid_surface_reader
   use kinds, only: wp
   use errors, only: error_type
   use places, only: fail_at
   use surfaces, only: rigid_plane, rigid_circle
   use model, only: model_type
   use cards, only: deck_type, card_type, get_word
   use fields, only: fields_type, split_line, check_count, field_place, get_reals
   use amplitude_reader, only: find_amplitude
   use numbers, only: unit_vector
   use words, only: word_length
   use text, only: to_text
   implicit none
   private

   public :: read_rigid_surface

contains

   !> All but the name of rigid surface n.
   subroutine read_rigid_surface(model, n, deck, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: types(*) = [character(len=word_length) :: &
            'PLANE', 'CIRCLE']
      integer, parameter :: kinds(*) = [rigid_plane, rigid_circle]
      integer :: choice, n_lines
      real(wp) :: motion(4)

      call get_word(card, 'TYPE', types, choice, model%source, error)
      if (allocated(error)) return
      model%rigid_surfaces(n)%kind = kinds(choice)
      call find_amplitude(model, card, model%rigid_surfaces(n)%amplitude, error)
      if (allocated(error)) return
      n_lines = 2
      if (model%rigid_surfaces(n)%amplitude > 0) n_lines = 3
      if (card%last - card%first + 1 /= n_lines) then
         call fail_at(error, model%source, deck%data(min(card%last, card%first + n_lines)), &
               'this card takes '//to_text(n_lines)//' data lines', cure='point and normal, or '// &
               'centre and radius, and with AMPLITUDE direction and size of the motion')
         return
      end if
      call read_shape(model, n, deck, card, error)
      if (allocated(error) .or. n_lines == 2) return
      call read_vector(model, deck, card, 3, motion, error)
      if (allocated(error)) return
      model%rigid_surfaces(n)%motion = motion(4)*unit_vector(motion(:3))
   end subroutine read_rigid_surface

   !> A point and the normal of a plane, the centre and the radius of a circle.
   subroutine read_shape(model, n, deck, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: point(3), normal(3), radius

      call read_vector(model, deck, card, 1, point, error)
      if (allocated(error)) return
      model%rigid_surfaces(n)%point = point
      if (model%rigid_surfaces(n)%kind == rigid_circle) then
         call read_radius(model, deck, card, radius, error)
         if (allocated(error)) return
         model%rigid_surfaces(n)%radius = radius
      else
         call read_vector(model, deck, card, 2, normal, error)
         if (allocated(error)) return
         model%rigid_surfaces(n)%normal = unit_vector(normal)
      end if
   end subroutine read_shape

   !> Line 2 of a circle: its radius, negative when bodies are inside.
   subroutine read_radius(model, deck, card, radius, error)
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      real(wp), intent(out) :: radius
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      real(wp) :: values(1)

      radius = 0.0_wp
      call split_line(fields, deck, card, card%first + 1, model%source, error)
      if (allocated(error)) return
      if (fields%n > 1) then
         call fail_at(error, model%source, field_place(fields, 2), &
               'a circle has one radius', cure='line 1 is the centre, line 2 the radius')
         return
      end if
      call get_reals(fields, 1, 1, 'radius', values, model%source, error)
      if (allocated(error)) return
      radius = values(1)
      if (.not. abs(radius) > 0.0_wp) call fail_at(error, model%source, &
            field_place(fields, 1), 'the radius must not be zero', &
            cure='write a positive radius, or a negative one if bodies are inside the circle')
   end subroutine read_radius

   !> Line 1 of a rigid surface (a point), 2 (a direction) or 3 (a direction and a size).
   subroutine read_vector(model, deck, card, k, values, error)
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      integer, intent(in) :: k
      real(wp), intent(out) :: values(:)
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer :: n_needed

      values = 0.0_wp
      n_needed = 2
      if (size(values) == 4) n_needed = 4
      call split_line(fields, deck, card, card%first + k - 1, model%source, error)
      if (allocated(error)) return
      call check_count(fields, size(values), model%source, error)
      if (allocated(error)) return
      call get_reals(fields, 1, n_needed, 'component', values, model%source, error)
      if (allocated(error)) return
      if (k == 1) return
      if (all(abs(values(:3)) <= 0.0_wp)) call fail_at(error, model%source, &
            field_place(fields, 1), 'this direction has no length', &
            cure='write a vector of any length but zero')
   end subroutine read_vector

end module rigid_surface_reader
