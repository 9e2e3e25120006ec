!> `*DLOAD` and `*BASE MOTION`.
module load_reader
   use kinds, only: wp
   use errors, only: error_type
   use places, only: fail_at
   use properties, only: name_length
   use mesh, only: set_type, is_solid_kind, solid_plane, solid_topology, axisymmetric, tri3, tri6
   use histories, only: gravity_type, distributed_load_type, base_motion_type
   use histories, only: load_pressure, load_body, load_centrifugal
   use integer_map, only: integer_map_type
   use model, only: model_type
   use cards, only: deck_type, card_type, get_integer_parameter, parameter_place
   use fields, only: fields_type, split_line, check_count, only_line, field_place, field_text
   use fields, only: is_given, is_integer, get_integer, get_real, get_reals, get_name
   use amplitude_reader, only: find_amplitude
   use numbers, only: unit_vector
   use set_reader, only: find_element_set
   use element_types, only: kind_name
   use words, only: word_length, find_word, advice
   use text, only: to_text
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: read_distributed, read_base_motions

   character(len=word_length), parameter :: load_words(*) = [character(len=word_length) :: &
         'P1', 'P2', 'P3', 'P4', 'BX', 'BY', 'CENTRIF', 'GRAV']
   !> The sets of a model while loads are read: those in use, and which element has its own.
   type :: own_sets_type
      integer :: n = 0                !! sets in use; the list has room for more
      type(integer_map_type) :: of    !! element index to the set of it alone
   end type own_sets_type

   integer, parameter :: word_bx = 5, word_by = 6, word_centrif = 7, word_grav = 8

contains

   !> All *DLOAD cards of a step: gravity, and what acts on edges and volumes.
   subroutine read_distributed(gravity, distributed, model, deck, step, error)
      type(gravity_type), allocatable, intent(out) :: gravity(:)
      type(distributed_load_type), allocatable, intent(out) :: distributed(:)
      type(model_type), intent(inout) :: model   !! gets a set for every element that is named
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      type(own_sets_type) :: own
      integer :: i, n, n_gravity, line, amplitude, status

      n = count_lines(deck, 'DLOAD', step)
      allocate (gravity(n), distributed(n), stat=status)
      call check_allocation(status)
      call find_own_sets(own, model%element_sets)
      call reserve_sets(model%element_sets, n)
      n = 0
      n_gravity = 0
      do i = deck%first_card(step), deck%last_card(step)
         if (deck%cards(i)%keyword /= 'DLOAD' .or. deck%cards(i)%step /= step) cycle
         call find_amplitude(model, deck%cards(i), amplitude, error)
         if (allocated(error)) return
         do line = deck%cards(i)%first, deck%cards(i)%last
            call split_line(fields, deck, deck%cards(i), line, model%source, error)
            if (allocated(error)) return
            if (find_word(field_text(fields, 2), load_words) == word_grav) then
               n_gravity = n_gravity + 1
               gravity(n_gravity)%amplitude = amplitude
               gravity(n_gravity)%place = fields%place
               call read_gravity(gravity(n_gravity), model, own, fields, error)
            else
               n = n + 1
               distributed(n)%amplitude = amplitude
               distributed(n)%place = fields%place
               call read_load(distributed(n), model, own, fields, error)
            end if
            if (allocated(error)) return
         end do
      end do
      gravity = gravity(:n_gravity)
      distributed = distributed(:n)
      call reserve_sets(model%element_sets, own%n - size(model%element_sets))
   end subroutine read_distributed

   !> The sets that loads of earlier steps made for single elements.
   subroutine find_own_sets(own, sets)
      type(own_sets_type), intent(inout) :: own
      type(set_type), intent(in) :: sets(:)
      integer :: i

      own%n = size(sets)
      do i = 1, size(sets)
         if (sets(i)%name(1:8) == 'element ') call own%of%insert(sets(i)%members(1), i)
      end do
   end subroutine find_own_sets

   !> Lengthens (or, by a negative number, shortens) the list of sets; the new ones are empty.
   subroutine reserve_sets(sets, n_more)
      type(set_type), allocatable, intent(inout) :: sets(:)
      integer, intent(in) :: n_more
      type(set_type), allocatable :: longer(:)
      integer :: i, status

      if (n_more == 0) return
      allocate (longer(size(sets) + n_more), stat=status)
      call check_allocation(status)
      do i = 1, size(longer)
         if (i > size(sets)) then
            longer(i)%name = 'element'
            allocate (longer(i)%members(0), stat=status)
            call check_allocation(status)
         else
            longer(i)%name = sets(i)%name
            longer(i)%place = sets(i)%place
            call move_alloc(sets(i)%members, longer(i)%members)
         end if
      end do
      call move_alloc(longer, sets)
   end subroutine reserve_sets

   !> The set that field 1 names; an element's id gets a set of its own, named in lower case.
   subroutine find_elements(model, own, fields, set, error)
      type(model_type), intent(inout) :: model
      type(own_sets_type), intent(inout) :: own
      type(fields_type), intent(in) :: fields
      integer, intent(out) :: set
      type(error_type), allocatable, intent(out) :: error
      character(len=name_length) :: name
      integer :: id, e

      set = 0
      if (.not. is_integer(fields, 1)) then
         call get_name(fields, 1, 'element id or set', name, model%source, error)
         if (allocated(error)) return
         call find_element_set(model, name, field_place(fields, 1), set, error)
         return
      end if
      call get_integer(fields, 1, 'element id', id, model%source, error)
      if (allocated(error)) return
      e = model%elements%index_of%find(id)
      if (e == 0) then
         call fail_at(error, model%source, field_place(fields, 1), &
               'no such element: '//to_text(id), cure='define it with *ELEMENT')
         return
      end if
      set = own%of%find(e)
      if (set > 0) return
      own%n = own%n + 1
      set = own%n
      call own%of%insert(e, set)
      model%element_sets(set)%name = 'element '//to_text(id)
      model%element_sets(set)%members = [e]
      model%element_sets(set)%place = fields%place
   end subroutine find_elements

   !> Element or set, P1 to P4, BX, BY or CENTRIF, numbers.
   subroutine read_load(load, model, own, fields, error)
      type(distributed_load_type), intent(inout) :: load
      type(model_type), intent(inout) :: model
      type(own_sets_type), intent(inout) :: own
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      integer :: word

      word = find_word(field_text(fields, 2), load_words)
      if (word == 0) then
         call fail_at(error, model%source, field_place(fields, 2), &
               "unknown load '"//field_text(fields, 2)//"'", &
               cure=advice(field_text(fields, 2), load_words))
         return
      end if
      call find_elements(model, own, fields, load%set, error)
      if (allocated(error)) return
      call check_loaded(load, word, model, fields, error)
      if (allocated(error)) return
      if (word == word_centrif) then
         load%kind = load_centrifugal
         call read_centrifugal(load, model, fields, error)
         return
      end if
      call check_count(fields, 3, model%source, error)
      if (allocated(error)) return
      call get_real(fields, 3, 'value', load%value, model%source, error)
      if (allocated(error)) return
      if (word >= word_bx) then
         load%kind = load_body
         load%body(word - word_bx + 1) = load%value
      else
         load%kind = load_pressure
         load%edge = word
      end if
   end subroutine read_load

   !> Such loads act on solids, P4 on those with four edges.
   subroutine check_loaded(load, word, model, fields, error)
      type(distributed_load_type), intent(in) :: load
      integer, intent(in) :: word   !! index into the load words
      type(model_type), intent(in) :: model
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      integer :: i, e

      do i = 1, size(model%element_sets(load%set)%members)
         e = model%element_sets(load%set)%members(i)
         associate (kind => model%elements%kind(e))
            if (.not. is_solid_kind(kind)) then
               call fail_at(error, model%source, field_place(fields, 1), 'element '// &
                     to_text(model%elements%id(e))//' is '//kind_name(kind)//', '// &
                     trim(load_words(word))//' acts on plane and axisymmetric elements only', &
                     cure='name a set of such elements')
            else if (word == 4 .and. any(solid_topology(kind) == [tri3, tri6])) then
               call fail_at(error, model%source, field_place(fields, 2), 'element '// &
                     to_text(model%elements%id(e))//' is '//kind_name(kind)//', it has no edge 4', &
                     cure='edges 1, 2, 3 of a triangle are P1, P2, P3')
            end if
         end associate
         if (allocated(error)) return
      end do
   end subroutine check_loaded

   !> omega squared, a point of the axis, its direction.
   subroutine read_centrifugal(load, model, fields, error)
      type(distributed_load_type), intent(inout) :: load
      type(model_type), intent(in) :: model
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: values(7)

      call check_count(fields, 9, model%source, error)
      if (allocated(error)) return
      call get_reals(fields, 3, 7, 'omega squared, point, direction', values, model%source, error)
      if (allocated(error)) return
      if (values(1) < 0.0_wp) then
         call fail_at(error, model%source, field_place(fields, 3), &
               'the square of the angular velocity must not be negative', &
               cure='write omega squared, not omega')
         return
      else if (all(abs(values(5:)) <= 0.0_wp)) then
         call fail_at(error, model%source, field_place(fields, 7), &
               'this direction has no length', cure='write a vector of any length but zero')
         return
      end if
      load%value = values(1)
      load%point = values(2:4)
      load%axis = unit_vector(values(5:))
      call check_axis(load, model, fields, error)
   end subroutine read_centrifugal

   !> A plane body turns about an axis along z, an axisymmetric one about its own, y.
   subroutine check_axis(load, model, fields, error)
      type(distributed_load_type), intent(in) :: load
      type(model_type), intent(in) :: model
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      real(wp), parameter :: slack = 1.0e-9_wp
      integer, allocatable :: planes(:)
      logical :: along_z, along_y

      planes = solid_plane(model%elements%kind(model%element_sets(load%set)%members))
      along_z = all(abs(load%axis(1:2)) <= slack)
      along_y = abs(load%axis(1)) + abs(load%axis(3)) <= slack
      if (any(planes /= axisymmetric) .and. .not. along_z) then
         call fail_at(error, model%source, field_place(fields, 7), &
               'a plane body turns about an axis along z', cure='write the direction 0, 0, 1')
      else if (any(planes == axisymmetric) .and. .not. along_y) then
         call fail_at(error, model%source, field_place(fields, 7), &
               'an axisymmetric body turns about its axis y', cure='write the direction 0, 1, 0')
      else if (any(planes == axisymmetric) .and. &
            abs(load%point(1)) + abs(load%point(3)) > 0.0_wp) then
         call fail_at(error, model%source, field_place(fields, 4), &
               'an axisymmetric body turns about its axis, x = z = 0', &
               cure='write the point 0, 0, 0')
      end if
   end subroutine check_axis

   pure function count_lines(deck, keyword, step) result(n)
      type(deck_type), intent(in) :: deck
      character(len=*), intent(in) :: keyword
      integer, intent(in) :: step
      integer :: n
      integer :: i

      n = 0
      do i = deck%first_card(step), deck%last_card(step)
         if (deck%cards(i)%keyword == keyword .and. deck%cards(i)%step == step) then
            n = n + deck%cards(i)%last - deck%cards(i)%first + 1
         end if
      end do
   end function count_lines

   !> Element, set or nothing (everything), GRAV, size, direction.
   subroutine read_gravity(gravity, model, own, fields, error)
      type(gravity_type), intent(inout) :: gravity
      type(model_type), intent(inout) :: model
      type(own_sets_type), intent(inout) :: own
      type(fields_type), intent(in) :: fields
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: values(4)

      call check_count(fields, 6, model%source, error)
      if (allocated(error)) return
      if (is_given(fields, 1)) then
         call find_elements(model, own, fields, gravity%set, error)
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
   end subroutine read_gravity

   !> All *BASE MOTION cards of a step.
   subroutine read_base_motions(list, model, deck, step, error)
      type(base_motion_type), allocatable, intent(out) :: list(:)
      type(model_type), intent(in) :: model
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      integer :: i, n, status

      n = 0
      do i = deck%first_card(step), deck%last_card(step)
         if (deck%cards(i)%keyword == 'BASEMOTION' .and. deck%cards(i)%step == step) n = n + 1
      end do
      allocate (list(n), stat=status)
      call check_allocation(status)
      n = 0
      do i = deck%first_card(step), deck%last_card(step)
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
