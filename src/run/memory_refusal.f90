!> More memory than there is, refused before it is taken: to read a deck, to build its model, to
!> take the increments.
module memory_refusal
   use kinds, only: wp, int64
   use errors, only: error_type, new_error, status_memory
   use text, only: plural
   use memory_use, only: resident_memory
   use memory_limit, only: memory_limit_type
   use mumps_solver, only: mumps_available
   use steps, only: solver_mumps
   use model, only: model_type
   use scene_setup, only: simulation_type
   use memory_estimate, only: memory_type, memory_text, megabytes, item_matrices, item_state, &
         item_frames, item_rows, item_contact
   implicit none
   private

   public :: check_reading, check_building, check_need, limit_text

   !> Measured: a byte of a deck takes so many while it is read, with its lines and its tables. The
   !> least over meshes of one element type each.
   real(wp), parameter :: a_byte_read = 5.0_wp
   !> Measured: bytes of a node when the structure is built, the least over meshes of one element
   !> type each, all explicit and implicit.
   real(wp), parameter :: a_node_built = 500.0_wp

contains

   !> Error: reading a deck takes more than the limit. Of included files nothing is known yet.
   subroutine check_reading(limit, deck, error)
      type(memory_limit_type), intent(in) :: limit
      character(len=*), intent(in) :: deck       !! path
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: length
      real(wp) :: now, most

      inquire (file=deck, size=length)
      if (length <= 0) return
      call resident_memory(now, most)
      call refuse(limit, now + a_byte_read*real(length, wp), 'to read '//deck//' takes', &
            'fewer elements', error)
   end subroutine check_reading

   !> Error: the structure of the model takes more than the limit, without matrices and states.
   subroutine check_building(limit, model, error)
      type(memory_limit_type), intent(in) :: limit
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: now, most

      call resident_memory(now, most)
      call refuse(limit, now + a_node_built*real(model%nodes%n, wp), 'to build a model of ' &
            //plural(model%nodes%n, 'node')//' takes at least', 'fewer elements', error)
   end subroutine check_building

   !> Error: the increments take more than the limit.
   subroutine check_need(limit, memory, simulation, error)
      type(memory_limit_type), intent(in) :: limit
      type(memory_type), intent(in) :: memory
      type(simulation_type), intent(in) :: simulation
      type(error_type), allocatable, intent(out) :: error

      call refuse(limit, memory%total(), 'the run takes', cure_of(memory, simulation), error)
      if (.not. allocated(error)) return
      error%message = 'the run takes '//memory_text(memory)//error%message(index(error%message, &
            ', more than'):)
   end subroutine check_need

   subroutine refuse(limit, bytes, what, cure, error)
      type(memory_limit_type), intent(in) :: limit
      real(wp), intent(in) :: bytes
      character(len=*), intent(in) :: what, cure
      type(error_type), allocatable, intent(out) :: error

      if (bytes <= limit%bytes) return
      call new_error(error, status_memory, what//' '//megabytes(bytes)//' MB, more than the ' &
            //'limit of '//limit_text(limit)//new_line('a')//'  cure: '//cure//', or '//limit%cure)
   end subroutine refuse

   !> What helps most where the largest part is what it is.
   function cure_of(memory, simulation) result(cure)
      type(memory_type), intent(in) :: memory
      type(simulation_type), intent(in) :: simulation
      character(len=:), allocatable :: cure

      select case (maxloc(memory%items, 1))
      case (item_matrices)
         cure = 'fewer elements, explicit ones (they have no matrix)'
         if (simulation%scene%system%matrices%choice%taken /= solver_mumps &
               .and. mumps_available()) cure = cure//', SOLVER=MUMPS'
      case (item_state)
         cure = 'fewer elements'
         if (.not. all(simulation%model%steps%direct)) cure = cure//', increments by DIRECT'
      case (item_frames)
         cure = 'fewer elements, fewer fields in *NODE FILE and *EL FILE'
      case (item_rows)
         cure = 'fewer nodes and elements in *NODE PRINT and *EL PRINT'
      case (item_contact)
         cure = 'fewer nodes in contact pairs, METHOD=PENALTY'
      case default
         cure = 'fewer elements'
      end select
   end function cure_of

   !> "3200 MB (--memory)".
   function limit_text(limit) result(text)
      type(memory_limit_type), intent(in) :: limit
      character(len=:), allocatable :: text

      text = megabytes(limit%bytes)//' MB ('//limit%source//')'
   end function limit_text

end module memory_refusal
