!> `*MATERIAL` and the cards that belong to it.
module material_reader
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use places, only: source_type, fail_at
   use properties, only: material_type, table_type
   use model, only: model_type
   use cards, only: deck_type, card_type, count_cards, get_word, get_real_parameter
   use cards, only: get_name_parameter, parameter_place
   use words, only: word_length
   use fields, only: fields_type, only_line, split_line, check_count, field_place
   use fields, only: get_reals
   implicit none
   private

   public :: read_materials

contains

   !> Materials in the order of the deck; each sub-card belongs to the *MATERIAL before it.
   subroutine read_materials(model, deck, error)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      integer :: i, n, status

      allocate (model%materials(count_cards(deck, 'MATERIAL')), stat=status)
      call check_allocation(status)
      n = 0
      do i = 1, deck%n_cards
         select case (deck%cards(i)%keyword)
         case ('MATERIAL')
            n = n + 1
            call open_material(model, n, deck%cards(i), error)
         case ('ELASTIC', 'DENSITY', 'DAMPING', 'PLASTIC')
            call read_property(model, n, deck, deck%cards(i), error)
         case default
            cycle
         end select
         if (allocated(error)) return
      end do
      call check_plastic(model, error)
   end subroutine read_materials

   !> Plasticity is told by its stresses: without elasticity it says nothing.
   subroutine check_plastic(model, error)
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(model%materials)
         if (.not. model%materials(i)%has_plastic .or. model%materials(i)%has_elastic) cycle
         call fail_at(error, model%source, model%materials(i)%place, "material '"// &
               trim(model%materials(i)%name)//"' has *PLASTIC but no *ELASTIC", &
               cure='give it E and nu')
         return
      end do
   end subroutine check_plastic

   subroutine open_material(model, n, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error

      call get_name_parameter(card, 'NAME', model%materials(n)%name, model%source, error)
      if (allocated(error)) return
      model%materials(n)%place = card%place
      if (model%material_of%find(model%materials(n)%name) == 0) then
         call model%material_of%insert(model%materials(n)%name, n)
         return
      end if
      call fail_at(error, model%source, parameter_place(card, 'NAME'), &
            "material '"//trim(model%materials(n)%name)//"' is defined twice", &
            cure='give every material its own name')
   end subroutine open_material

   subroutine read_property(model, n, deck, card, error)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error

      if (n == 0) then
         call fail_at(error, model%source, card%place, &
               '*'//card%keyword//' belongs to a material', &
               cure='put *MATERIAL, NAME=name before it')
         return
      end if
      select case (card%keyword)
      case ('ELASTIC')
         call read_elastic(model%materials(n), deck, card, model%source, error)
      case ('DENSITY')
         call read_density(model%materials(n), deck, card, model%source, error)
      case ('PLASTIC')
         call read_plastic(model%materials(n), deck, card, model%source, error)
      case default
         call read_damping(model%materials(n), card, model%source, error)
      end select
   end subroutine read_property

   subroutine read_elastic(material, deck, card, source, error)
      type(material_type), intent(inout) :: material
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: types(*) = [character(len=word_length) :: &
            'ISO', 'ISOTROPIC']
      type(fields_type) :: fields
      real(wp) :: values(2)
      integer :: choice

      call get_word(card, 'TYPE', types, choice, source, error)
      if (allocated(error)) return
      call only_line(fields, deck, card, 2, source, error)
      if (allocated(error)) return
      call get_reals(fields, 1, 1, 'E, nu', values, source, error)
      if (allocated(error)) return
      if (material%has_elastic) then
         call fail_at(error, source, card%place, 'this material has *ELASTIC already', &
               cure='keep one of the two')
      else if (values(1) <= 0.0_wp) then
         call fail_at(error, source, field_place(fields, 1), &
               "Young's modulus must be positive", cure='a line is: E, nu with E > 0')
      else if (values(2) <= -1.0_wp .or. values(2) >= 0.5_wp) then
         call fail_at(error, source, field_place(fields, 2), &
               "Poisson's ratio is out of range", &
               cure='write nu between -1 and 0.5, neither included')
      end if
      material%has_elastic = .true.
      material%young = values(1)
      material%poisson = values(2)
   end subroutine read_elastic

   !> Lines of yield stress, plastic strain: where they end the stress stays.
   subroutine read_plastic(material, deck, card, source, error)
      type(material_type), intent(inout) :: material
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), parameter :: laws(*) = [character(len=word_length) :: &
            'ISOTROPIC', 'KINEMATIC', '~COMBINED']
      type(fields_type) :: fields
      real(wp) :: values(2)
      integer :: choice, line, n, status

      if (material%has_plastic) then
         call fail_at(error, source, card%place, 'this material has *PLASTIC already', &
               cure='keep one of the two')
         return
      end if
      call get_word(card, 'HARDENING', laws, choice, source, error)
      if (allocated(error)) return
      material%has_plastic = .true.
      material%kinematic = choice == 2
      n = card%last - card%first + 1
      material%hardening%n = n
      allocate (material%hardening%x(n), material%hardening%y(n), stat=status)
      call check_allocation(status)
      do line = card%first, card%last
         call split_line(fields, deck, card, line, source, error)
         if (allocated(error)) return
         call check_count(fields, 2, source, error)
         if (allocated(error)) return
         call get_reals(fields, 1, 2, 'yield stress, plastic strain', values, source, error)
         if (allocated(error)) return
         n = line - card%first + 1
         material%hardening%y(n) = values(1)
         material%hardening%x(n) = values(2)
         call check_yield(material%hardening, n, fields, source, error)
         if (allocated(error)) return
      end do
   end subroutine read_plastic

   !> Point n of a hardening curve, against the one before.
   subroutine check_yield(curve, n, fields, source, error)
      type(table_type), intent(in) :: curve
      integer, intent(in) :: n
      type(fields_type), intent(in) :: fields
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      if (curve%y(n) <= 0.0_wp) then
         call fail_at(error, source, field_place(fields, 1), 'the yield stress must be positive', &
               cure='a line is: yield stress, plastic strain')
      else if (n == 1) then
         if (abs(curve%x(1)) > 0.0_wp) call fail_at(error, source, field_place(fields, 2), &
               'the first plastic strain must be 0', &
               cure='begin with the stress at which yielding begins, and 0')
      else if (curve%x(n) <= curve%x(n - 1)) then
         call fail_at(error, source, field_place(fields, 2), 'the plastic strains must increase', &
               cure='order the lines of yield stress, plastic strain by strain')
      else if (curve%y(n) < curve%y(n - 1)) then
         call fail_at(error, source, field_place(fields, 1), &
               'softening: the yield stress falls', &
               cure='write yield stresses that grow or stay; softening has no unique solution')
      end if
   end subroutine check_yield

   subroutine read_density(material, deck, card, source, error)
      type(material_type), intent(inout) :: material
      type(deck_type), intent(in) :: deck
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      real(wp) :: values(1)

      call only_line(fields, deck, card, 1, source, error)
      if (allocated(error)) return
      call get_reals(fields, 1, 1, 'density', values, source, error)
      if (allocated(error)) return
      if (material%has_density) then
         call fail_at(error, source, card%place, 'this material has *DENSITY already', &
               cure='keep one of the two')
      else if (values(1) <= 0.0_wp) then
         call fail_at(error, source, field_place(fields, 1), 'the density must be positive', &
               cure='write rho > 0')
      end if
      material%has_density = .true.
      material%density = values(1)
   end subroutine read_density

   subroutine read_damping(material, card, source, error)
      type(material_type), intent(inout) :: material
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error

      if (size(card%parameters) == 0) then
         call fail_at(error, source, card%place, '*DAMPING without ALPHA or BETA says nothing', &
               cure='write *DAMPING, ALPHA=value, BETA=value')
         return
      end if
      if (material%has_damping) then
         call fail_at(error, source, card%place, 'this material has *DAMPING already', &
               cure='keep one of the two')
         return
      end if
      material%has_damping = .true.
      call get_real_parameter(card, 'ALPHA', material%damping_alpha, source, error)
      if (allocated(error)) return
      call get_real_parameter(card, 'BETA', material%damping_beta, source, error)
      if (allocated(error)) return
      if (material%damping_alpha < 0.0_wp) then
         call fail_at(error, source, parameter_place(card, 'ALPHA'), &
               'ALPHA must not be negative', cure='write ALPHA >= 0')
      else if (material%damping_beta < 0.0_wp) then
         call fail_at(error, source, parameter_place(card, 'BETA'), &
               'BETA must not be negative', cure='write BETA >= 0')
      end if
   end subroutine read_damping

end module material_reader
