!> Writes /history: one column a printed component, one row an increment.
module history_recorder
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use kinds, only: wp
   use errors, only: error_type
   use text, only: to_text
   use memory_shortage, only: check_allocation
   use model, only: model_type
   use steps, only: quantity_u, quantity_v, quantity_a, quantity_rf, quantity_s, quantity_e, &
         quantity_ener, quantity_cf, quantity_cdis, quantity_peeq, quantity_cpress, &
         quantity_cslip, quantity_cstate, quantity_names, n_quantities
   use element_interface, only: n_recovered, recovered_stress, recovered_strain, recovered_peeq, &
         recovered_energy
   use contact_pairs, only: contact_pair_list_type
   use impact_scene, only: scene_type
   use hdf5_file, only: hdf5_file_type
   use column_table, only: column_table_type
   use output_plan, only: plan_type
   use snapshot, only: snapshot_type, element_values, state_open
   use gap_probe, only: not_a_number
   implicit none
   private

   public :: history_type, new_history, record_history

   !> Where the value of a column comes from.
   type :: column_type
      integer :: quantity = 0                    !! quantity_ parameter; impulse_column
      integer :: item = 0                        !! freedom, element of a group, or pair
      integer :: group = 0
      integer :: component = 0
   end type column_type

   integer, parameter :: impulse_column = n_quantities + 1

   !> The columns and their table.
   type :: history_type
      type(column_table_type) :: table
      type(column_type), allocatable :: columns(:)
      integer :: n = 0
      logical :: needs_reactions = .false.
   end type history_type

   character(len=12), parameter :: meanings(4) = &
         ['displacement', 'velocity    ', 'acceleration', 'reaction    ']

   !> What is said of a whole pair, beside its force and impulse.
   integer, parameter :: pair_quantities(4) = [quantity_cdis, quantity_cslip, quantity_cstate, &
         quantity_cpress]
   character(len=6), parameter :: pair_columns(4) = ['CDIS  ', 'CSLIP ', 'CNUM  ', 'CPRESS']
   character(len=72), parameter :: pair_meanings(4) = [character(len=72) :: &
         'smallest gap of the pair, negative in overlap; NaN where nothing is near', &
         'longest path that a node of the pair has slid along its partner', &
         'number of nodes in contact', 'largest contact pressure of the pair']

contains

   !> Makes the group and its columns: those of existing freedoms, of elements with stress, of
   !> pairs.
   subroutine new_history(self, file, model, scene, list, plan, error)
      type(history_type), intent(out) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      type(contact_pair_list_type), intent(in) :: list
      type(plan_type), intent(in) :: plan
      type(error_type), allocatable, intent(out) :: error
      integer :: status

      allocate (self%columns(64), stat=status)
      call check_allocation(status)
      call self%table%create(file, '/history', &
            'what the deck asks to print, a row an increment', error)
      if (allocated(error)) return
      call self%table%add_column(file, 'time', 'total time', error)
      if (allocated(error)) return
      call add_nodes(self, file, model, scene, plan, error)
      if (allocated(error)) return
      call add_elements(self, file, model, scene, plan, error)
      if (allocated(error)) return
      call add_pairs(self, file, list, plan, error)
   end subroutine new_history

   subroutine add_nodes(self, file, model, scene, plan, error)
      type(history_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      type(plan_type), intent(in) :: plan
      type(error_type), allocatable, intent(out) :: error
      integer :: node, q, i, f
      character(len=:), allocatable :: id

      do node = 1, model%nodes%n
         do q = quantity_u, quantity_rf
            if (.not. plan%node_print(q, node)) cycle
            self%needs_reactions = self%needs_reactions .or. q == quantity_rf
            id = to_text(model%nodes%id(node))
            do i = 1, 3
               f = scene%system%structure%map%freedom(i, node)
               if (f == 0) cycle
               call add(self, file, column_type(q, f, 0, i), 'node_'//id//'/' &
                     //trim(quantity_names(q))//to_text(i), trim(meanings(q))//' of node ' &
                     //id//' in direction '//to_text(i), error)
               if (allocated(error)) return
            end do
         end do
      end do
   end subroutine add_nodes

   subroutine add_elements(self, file, model, scene, plan, error)
      type(history_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      type(plan_type), intent(in) :: plan
      type(error_type), allocatable, intent(out) :: error
      integer :: g, e, q

      do g = 1, size(scene%system%structure%groups)
         associate (group => scene%system%structure%groups(g))
            if (group%element%n_points == 0) cycle
            do e = 1, size(group%member)
               do q = 1, n_quantities
                  if (.not. plan%element_print(q, group%member(e))) cycle
                  call add_element(self, file, column_type(q, e, g, 0), &
                        to_text(model%elements%id(group%member(e))), &
                        group%element%n_stresses, error)
                  if (allocated(error)) return
               end do
            end do
         end associate
      end do
   end subroutine add_elements

   !> The columns of one quantity of one element: rows of what `recover` gives, averaged.
   subroutine add_element(self, file, column, id, n_stresses, error)
      type(history_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(column_type), intent(in) :: column    !! without its component
      character(len=*), intent(in) :: id
      integer, intent(in) :: n_stresses
      type(error_type), allocatable, intent(out) :: error
      type(column_type) :: one
      character(len=2), parameter :: direction(6) = ['11', '22', '33', '12', '13', '23']
      character(len=6) :: word
      integer :: i, first

      one = column
      select case (column%quantity)
      case (quantity_s, quantity_e)
         first = merge(recovered_stress, recovered_strain, column%quantity == quantity_s)
         word = merge('stress', 'strain', column%quantity == quantity_s)
         do i = 1, n_stresses
            one%component = first + i - 1
            call add(self, file, one, 'element_'//id//'/'//merge('S', 'E', word == 'stress') &
                  //direction(i), word//' '//direction(i)//' of element '//id &
                  //', mean over its points', &
                  error)
            if (allocated(error)) return
         end do
      case (quantity_peeq)
         one%component = recovered_peeq
         call add(self, file, one, 'element_'//id//'/PEEQ', &
               'equivalent plastic strain of element ' &
               //id//', mean over its points', error)
      case default
         one%component = recovered_energy
         call add(self, file, one, 'element_'//id//'/ENER', 'strain energy density of element ' &
               //id//', mean over its points', error)
      end select
   end subroutine add_element

   subroutine add_pairs(self, file, list, plan, error)
      type(history_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(contact_pair_list_type), intent(in) :: list
      type(plan_type), intent(in) :: plan
      type(error_type), allocatable, intent(out) :: error
      integer :: p, i
      character(len=:), allocatable :: group

      do p = 1, size(list%names)
         group = 'contact_'//trim(list%names(p))//'/'
         if (plan%contact_print(quantity_cf)) then
            do i = 1, 3
               call add(self, file, column_type(quantity_cf, p, 0, i), group//'CF'//to_text(i), &
                     'total contact force with friction on the slave in direction ' &
                     //to_text(i), error)
               if (allocated(error)) return
            end do
            call add(self, file, column_type(impulse_column, p, 0, 0), group//'impulse', &
                  'normal contact impulse since the row before, impacts included', error)
            if (allocated(error)) return
         end if
         do i = 1, size(pair_quantities)
            if (.not. plan%contact_print(pair_quantities(i))) cycle
            call add(self, file, column_type(pair_quantities(i), p, 0, 0), &
                  group//trim(pair_columns(i)), trim(pair_meanings(i)), error)
            if (allocated(error)) return
         end do
      end do
   end subroutine add_pairs

   subroutine add(self, file, column, path, description, error)
      type(history_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(column_type), intent(in) :: column
      character(len=*), intent(in) :: path, description
      type(error_type), allocatable, intent(out) :: error
      type(column_type), allocatable :: longer(:)
      integer :: status

      call self%table%add_column(file, path, description, error, &
            partial=column%quantity == quantity_cdis)
      if (allocated(error)) return
      if (self%n == size(self%columns)) then
         allocate (longer(2*self%n), stat=status)
         call check_allocation(status)
         longer(:self%n) = self%columns
         call move_alloc(longer, self%columns)
      end if
      self%n = self%n + 1
      self%columns(self%n) = column
   end subroutine add

   !> Appends a row.
   subroutine record_history(self, file, scene, list, snapshot, error)
      type(history_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(scene_type), intent(inout) :: scene
      type(contact_pair_list_type), intent(in) :: list
      type(snapshot_type), intent(in) :: snapshot
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: row(self%n + 1), recovered(n_recovered)
      integer :: i, found(2)

      row(1) = snapshot%time
      found = 0
      do i = 1, self%n
         associate (column => self%columns(i))
            select case (column%quantity)
            case (quantity_s, quantity_e, quantity_ener, quantity_peeq)
               ! columns of one element follow each other
               if (any([column%group, column%item] /= found)) recovered = element_values(scene, &
                     column%group, column%item, snapshot)
               found = [column%group, column%item]
               row(i + 1) = recovered(column%component)
            case default
               row(i + 1) = value_of(column, list, snapshot)
            end select
         end associate
      end do
      call self%table%append_row(file, row, error)
   end subroutine record_history

   !> A value of a node or a pair.
   function value_of(column, list, snapshot) result(value)
      type(column_type), intent(in) :: column
      type(contact_pair_list_type), intent(in) :: list
      type(snapshot_type), intent(in) :: snapshot
      real(wp) :: value

      select case (column%quantity)
      case (quantity_u)
         value = snapshot%u(column%item)
      case (quantity_v)
         value = snapshot%v(column%item)
      case (quantity_a)
         value = snapshot%a(column%item)
      case (quantity_rf)
         value = snapshot%rf(column%item)
      case default
         value = value_of_pair(column, list, snapshot)
      end select
   end function value_of

   !> A value over all rows of a pair.
   function value_of_pair(column, list, snapshot) result(value)
      type(column_type), intent(in) :: column
      type(contact_pair_list_type), intent(in) :: list
      type(snapshot_type), intent(in) :: snapshot
      real(wp) :: value
      logical :: own(size(list%rows))

      own = list%rows%pair == column%item
      select case (column%quantity)
      case (quantity_cf)
         value = sum(snapshot%force(column%component, :), mask=own)
      case (impulse_column)
         value = sum(snapshot%impulse, mask=own)
      case (quantity_cslip)
         value = maxval(snapshot%slip, mask=own)
      case (quantity_cstate)
         value = real(count(own .and. snapshot%state > state_open), wp)
      case (quantity_cpress)
         value = maxval(snapshot%pressure, mask=own)
      case default
         own = own .and. .not. ieee_is_nan(snapshot%gap)
         value = not_a_number()
         if (any(own)) value = minval(snapshot%gap, mask=own)
      end select
   end function value_of_pair

end module history_recorder
