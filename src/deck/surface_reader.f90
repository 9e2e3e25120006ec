!> `*SURFACE` and `*RIGID SURFACE`: what may touch.
module surface_reader
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use places, only: fail_at
   use properties, only: name_length
   use element_sides, only: side_finder_type
   use model, only: model_type
   use model_building, only: append, fit, sort_unique
   use cards, only: deck_type, card_type, count_cards, get_word, get_name_parameter
   use cards, only: parameter_place
   use fields, only: fields_type, split_line
   use edge_surface_reader, only: read_edges
   use rigid_surface_reader, only: read_rigid_surface
   use set_reader, only: find_nodes
   use words, only: word_length
   implicit none
   private

   public :: read_surfaces

contains

   !> Surfaces of edges or nodes, and rigid surfaces; they share one set of names.
   subroutine read_surfaces(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      type(side_finder_type) :: finder
      character(len=name_length) :: name
      integer :: i, n, n_rigid, status

      allocate (model%surfaces(count_cards(deck, 'SURFACE')), stat=status)
      call check_allocation(status)
      allocate (model%rigid_surfaces(count_cards(deck, 'RIGIDSURFACE')), stat=status)
      call check_allocation(status)
      n = 0
      n_rigid = 0
      do i = 1, deck%n_cards
         select case (deck%cards(i)%keyword)
         case ('SURFACE')
            n = n + 1
            call read_surface(model, n, finder, deck, deck%cards(i), error)
         case ('RIGIDSURFACE')
            n_rigid = n_rigid + 1
            call get_new_name(model, deck%cards(i), name, error)
            if (allocated(error)) return
            model%rigid_surfaces(n_rigid)%name = name
            call model%rigid_surface_of%insert(name, n_rigid)
            model%rigid_surfaces(n_rigid)%place = deck%cards(i)%place
            call read_rigid_surface(model, n_rigid, deck, deck%cards(i), error)
         case default
            cycle
         end select
         if (allocated(error)) return
      end do
   end subroutine read_surfaces

   !> The name of a surface, not used before.
   subroutine get_new_name(model, card, name, error)
      type(model_type), intent(in) :: model
      type(card_type), intent(in) :: card
      character(len=name_length), intent(out) :: name
      type(error_type), allocatable, intent(out) :: error

      call get_name_parameter(card, 'NAME', name, model%source, error)
      if (allocated(error)) return
      if (index(name, '/') > 0) then
         call fail_at(error, model%source, parameter_place(card, 'NAME'), &
               "'"//trim(name)//"' is no name for a surface: it names a group of the results", &
               cure="leave out the '/'")
         return
      end if
      if (model%surface_of%find(name) + model%rigid_surface_of%find(name) == 0) return
      call fail_at(error, model%source, parameter_place(card, 'NAME'), &
            "surface '"//trim(name)//"' is defined twice", cure='give every surface its own name')
   end subroutine get_new_name

   subroutine read_surface(model, n, finder, deck, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n
      type(side_finder_type), intent(inout) :: finder
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: types(*) = [character(len=word_length) :: &
            'ELEMENT', 'NODE']
      character(len=name_length) :: name
      integer :: choice

      call get_new_name(model, card, name, error)
      if (allocated(error)) return
      call get_word(card, 'TYPE', types, choice, model%source, error)
      if (allocated(error)) return
      model%surfaces(n)%name = name
      call model%surface_of%insert(name, n)
      model%surfaces(n)%place = card%place
      if (choice == 2) then
         call read_surface_nodes(model, n, deck, card, error)
      else
         call read_edges(model, n, finder, deck, card, error)
      end if
   end subroutine read_surface

   !> TYPE=NODE.
   subroutine read_surface_nodes(model, n, deck, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer, allocatable :: nodes(:), more(:)
      integer :: line, k, i, n_nodes, status

      n_nodes = 0
      do line = card%first, card%last
         call split_line(fields, deck, card, line, model%source, error)
         if (allocated(error)) return
         do k = 1, fields%n
            call find_nodes(model, fields, k, more, error)
            if (allocated(error)) return
            do i = 1, size(more)
               call append(nodes, n_nodes, more(i))
            end do
         end do
      end do
      call fit(nodes, n_nodes)
      call sort_unique(nodes)
      call move_alloc(nodes, model%surfaces(n)%nodes)
      allocate (model%surfaces(n)%edges(3, 0), model%surfaces(n)%edge_element(0), stat=status)
      call check_allocation(status)
   end subroutine read_surface_nodes

end module surface_reader
