!> The result file of a run: grid, histories, energies, events, and the model beside them.
module result_file
   use kinds, only: wp, int64
   use errors, only: error_type
   use part_file, only: part_file_type
   use state_archive, only: archive_type
   use model, only: model_type
   use steps, only: request_type, request_node_print, request_element_print, &
         request_contact_print, request_energy_print, request_node_file, request_element_file, &
         request_contact_file, quantity_cf, quantity_cdis, quantity_cpress, &
         quantity_cstate
   use contact_pairs, only: contact_pair_list_type
   use impact_scene, only: scene_type, contact_motion_type, event_impact, event_capture, &
         event_release, event_contact
   use hdf5_file, only: hdf5_file_type
   use column_table, only: column_table_type, text_length
   use output_plan, only: plan_type, new_plan, is_due
   use equation_of_motion, only: rigid_mass
   use snapshot, only: snapshot_type, take_snapshot, on_nodes, state_stuck
   use history_recorder, only: history_type, new_history, record_history
   use cost_account, only: enter, leave, stop_clock, phase_output
   use cost_recorder, only: write_cost
   use energy_recorder, only: new_energies, record_energies
   use grid_recorder, only: grid_type, new_grid, record_frame
   use model_recorder, only: write_model
   use restart_group, only: restart_group_type
   use gap_probe, only: gap_probe_type, new_gap_probe, probe_gaps
   use contact_faces, only: contact_face_type, new_contact_faces, find_pressures, find_row_forces, &
         share_contact
   implicit none
   private

   public :: result_file_type, open_results, record_increment, close_results, event_name
   public :: write_system, make_parts, flush_results, publish_results

   !> Everything open.
   type :: result_file_type
      type(hdf5_file_type) :: file
      type(plan_type) :: plan
      type(grid_type) :: grid
      type(history_type) :: history
      type(column_table_type) :: energy
      type(column_table_type) :: events
      type(gap_probe_type) :: gaps
      type(contact_face_type), allocatable :: faces(:)
      type(restart_group_type) :: restart
      integer :: n_elements = 0
      logical :: has_records = .false.           !! something worth a file of results
      real(wp), allocatable :: impulse(:)        !! (n_rows) since the last row of the history
   contains
      procedure :: pass_state
   end type result_file_type

contains

   !> Creates the file with all its groups. The model is known to be sound by now.
   subroutine open_results(self, place, path, model, scene, list, error)
      type(result_file_type), intent(out) :: self
      type(part_file_type), intent(in) :: place  !! taken over
      character(len=*), intent(in) :: path       !! for messages
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      type(contact_pair_list_type), intent(in) :: list
      type(error_type), allocatable, intent(out) :: error

      call self%file%create_claimed(place, path, error)
      if (.not. allocated(error)) call make_parts(self, model, scene, list, error)
   end subroutine open_results

   !> All groups of the file, which is open.
   subroutine make_parts(self, model, scene, list, error)
      type(result_file_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      type(contact_pair_list_type), intent(in) :: list
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      self%n_elements = model%elements%n
      call new_plan(self%plan, model)
      call self%file%compress(model%compression)
      call new_grid(self%grid, self%file, model, self%plan, any([(scene%system%structure%groups(i) &
            %element%is_solid, i=1, size(scene%system%structure%groups))]), error)
      if (allocated(error)) return
      call new_history(self%history, self%file, model, scene, list, self%plan, error)
      if (allocated(error)) return
      ! the history has its columns; by node and element they would take much
      deallocate (self%plan%node_print, self%plan%element_print)
      if (self%plan%energy) call new_energies(self%energy, self%file, scene, error)
      if (allocated(error)) return
      call new_events(self, list, error)
      if (allocated(error)) return
      call new_gap_probe(self%gaps, scene)
      self%impulse = 0.0_wp*scene%impulse
      call new_contact_faces(self%faces, model, list)
      call write_model(self%file, model, error)
   end subroutine make_parts

   !> What the records to come depend on.
   subroutine pass_state(self, archive)
      class(result_file_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive

      call self%gaps%pass_state(archive)
      call archive%pass('impulse_since_the_last_row', self%impulse)
   end subroutine pass_state

   !> The table of events; its texts are as long as the longest.
   subroutine new_events(self, list, error)
      type(result_file_type), intent(inout) :: self
      type(contact_pair_list_type), intent(in) :: list
      type(error_type), allocatable, intent(out) :: error
      character(len=15), parameter :: names(5) = ['time           ', 'gap_rate_before', &
            'gap_rate_after ', 'impulse        ', 'beta           ']
      character(len=50), parameter :: meanings(5) = [ &
            'total time                                        ', &
            'gap rate before the event, negative when closing  ', &
            'gap rate after the event                          ', &
            'impulse along the normal                          ', &
            'Newmark beta of the step with the event           ']
      integer :: i, longest

      longest = max(1, maxval([0, len_trim(list%names)]))
      call self%events%create(self%file, '/events', 'impacts, captures and releases', error)
      do i = 1, size(names)
         if (allocated(error)) return
         call self%events%add_column(self%file, trim(names(i)), trim(meanings(i)), error)
      end do
      if (allocated(error)) return
      call self%events%add_integer_column(self%file, 'node', 'id of the slave node', error)
      if (allocated(error)) return
      call self%events%add_integer_column(self%file, 'solves', &
            'back-substitutions of the run up to then', error)
      if (allocated(error)) return
      call self%events%add_integer_column(self%file, 'factorizations', &
            'factorizations of the run up to then', error)
      if (allocated(error)) return
      call self%events%add_text_column(self%file, 'kind', len(event_name(event_impact)), &
            'impact, capture, release, contact (first overlap) or limit (of events)', error)
      if (allocated(error)) return
      call self%events%add_text_column(self%file, 'pair', longest, &
            'name of the contact pair', error)
   end subroutine new_events

   !> The equations of the first step: column heights of K*, columns of implicit elements; settings.
   subroutine write_system(self, scene, version, implicit_equation, error)
      type(result_file_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      character(len=*), intent(in) :: version
      logical, intent(in) :: implicit_equation(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: heights(size(implicit_equation)), i

      heights = [(i - scene%system%profile%first_row(i) + 1, i=1, size(heights))]
      call self%file%set_attribute('/model', 'version', version, error)
      if (allocated(error)) return
      call self%file%set_attribute('/model', 'n_eq', size(heights), error)
      if (allocated(error)) return
      call self%file%set_attribute('/model', 'gamma', scene%system%newmark%gamma, error)
      if (allocated(error)) return
      call self%file%set_attribute('/model', 'beta', scene%system%newmark%beta, error)
      if (allocated(error)) return
      call self%file%set_attribute('/model', 'alpha', scene%system%newmark%alpha, error)
      if (allocated(error)) return
      call self%file%set_attribute('/model', 'order', merge(4, 2, scene%settings%fourth_order), &
            error)
      if (allocated(error)) return
      call self%file%write_dataset('/model/profile', heights, &
            'column heights of the effective stiffness, diagonal included', error)
      if (allocated(error)) return
      call self%file%write_dataset('/model/implicit', merge(1, 0, implicit_equation), &
            '1 for equations that an implicit element touches', error)
      if (allocated(error)) return
      call write_schemes(self, scene, error)
      if (allocated(error)) return
      call write_fixed(self, scene, error)
      if (allocated(error)) return
      call self%file%write_dataset('/model/mass', on_nodes(scene%system%structure%map%freedom, &
            rigid_mass(scene%system)), &
            'mass of each point in directions 1, 2, 3; with V it gives the linear momentum', error)
   end subroutine write_system

   !> How each element goes through time.
   subroutine write_schemes(self, scene, error)
      type(result_file_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(error_type), allocatable, intent(out) :: error
      integer :: scheme(self%n_elements), g

      scheme = 0
      do g = 1, size(scene%system%structure%groups)
         associate (group => scene%system%structure%groups(g))
            scheme(group%member) = group%scheme
         end associate
      end do
      call self%file%write_dataset('/model/element_scheme', scheme, &
            '1 implicit, 2 explicit, 0 neither (gaps, lines), in the order of the cells', error)
   end subroutine write_schemes

   !> The freedoms that supports hold or move in the first step.
   subroutine write_fixed(self, scene, error)
      type(result_file_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(error_type), allocatable, intent(out) :: error

      associate (map => scene%system%structure%map)
         call self%file%write_dataset('/model/fixed_point', pack(map%node - 1, map%prescribed), &
               'points (counted from 0) with a freedom that *BOUNDARY holds or moves', error)
         if (allocated(error)) return
         call self%file%write_dataset('/model/fixed_dof', pack(map%dof, map%prescribed), &
               'that freedom: 1, 2, 3 for x, y, z, one for each of fixed_point', error)
      end associate
   end subroutine write_fixed

   !> Records what is due at the end of an increment (0: the initial state), and all its events.
   subroutine record_increment(self, scene, list, motion, requests, increment, last, error)
      type(result_file_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_pair_list_type), intent(in) :: list
      type(contact_motion_type), intent(in) :: motion
      type(request_type), intent(in) :: requests(:)
      integer, intent(in) :: increment
      logical, intent(in) :: last                !! of the step
      type(error_type), allocatable, intent(out) :: error
      logical :: print_due, frame_due, energy_due
      integer :: outer

      call record_events(self, scene, list, error)
      if (allocated(error)) return
      self%impulse = self%impulse + scene%impulse
      print_due = is_due(requests, [request_node_print, request_element_print, &
            request_contact_print], increment, last)
      energy_due = is_due(requests, [request_energy_print], increment, last)
      frame_due = is_due(requests, [request_node_file, request_element_file, &
            request_contact_file], increment, last) .or. increment == 0 .or. last
      frame_due = frame_due .and. .not. self%plan%modes_only
      if (.not. (energy_due .or. print_due .or. frame_due)) return
      if (frame_due) then
         call enter(scene%system%cost, phase_output, outer, .true.)
      else
         call enter(scene%system%cost, phase_output, outer)
      end if
      if (energy_due) call record_energies(self%energy, self%file, scene, motion, error)
      if (.not. allocated(error) .and. (print_due .or. frame_due)) call record_state(self, scene, &
            list, motion, [print_due, frame_due], error)
      call leave(scene%system%cost, outer)
      self%has_records = self%has_records .or. .not. allocated(error)
   end subroutine record_increment

   !> A row of the histories, a frame, or both, of the same state.
   subroutine record_state(self, scene, list, motion, due, error)
      type(result_file_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_pair_list_type), intent(in) :: list
      type(contact_motion_type), intent(in) :: motion
      logical, intent(in) :: due(2)              !! row, frame
      type(error_type), allocatable, intent(out) :: error
      type(snapshot_type) :: snapshot

      call take_snapshot(snapshot, scene, motion, self%history%needs_reactions &
            .or. self%grid%needs_reactions)
      call measure_contact(self, scene, list, motion, snapshot)
      if (due(1)) then
         snapshot%impulse = self%impulse
         self%impulse = 0.0_wp
         call record_history(self%history, self%file, scene, list, snapshot, error)
         if (allocated(error)) return
      end if
      if (due(2)) call record_frame(self%grid, self%file, scene, list, snapshot, error)
   end subroutine record_state

   !> What of contact has to be computed for the records alone.
   subroutine measure_contact(self, scene, list, motion, snapshot)
      type(result_file_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(contact_pair_list_type), intent(in) :: list
      type(contact_motion_type), intent(in) :: motion
      type(snapshot_type), intent(inout) :: snapshot
      logical :: wanted(size(self%plan%file))

      if (scene%rows%n == 0) return
      wanted = self%plan%file .or. self%plan%contact_print
      if (wanted(quantity_cdis)) call probe_gaps(self%gaps, scene, motion, snapshot%gap)
      if (wanted(quantity_cpress) .or. wanted(quantity_cstate)) call find_pressures(self%faces, &
            scene, list, snapshot%lambda, snapshot%pressure)
      call share_contact(self%faces, scene, list, snapshot%lambda, snapshot%state, snapshot%slip)
      ! on the axis a pressure makes no force
      where (snapshot%pressure > 0.0_wp) snapshot%state = max(snapshot%state, state_stuck)
      if (wanted(quantity_cf)) call find_row_forces(self%faces, scene, list, snapshot%lambda, &
            snapshot%tau, snapshot%force)
   end subroutine measure_contact

   subroutine record_events(self, scene, list, error)
      type(result_file_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(contact_pair_list_type), intent(in) :: list
      type(error_type), allocatable, intent(out) :: error
      character(len=text_length) :: texts(2)
      integer :: i

      do i = 1, scene%n_events
         associate (event => scene%events(i))
            texts(1) = event_name(event%kind)
            texts(2) = list%names(list%rows(event%row)%pair)
            call self%events%append_row(self%file, [event%time, event%rate_before, &
                  event%rate_after, event%impulse, event%beta], &
                  [int(scene%rows%node_id(event%row), int64), event%n_solves, &
                  event%n_factorizations], texts, error)
         end associate
         if (allocated(error)) return
      end do
      scene%n_events = 0
   end subroutine record_events

   !> The word for a kind of event.
   pure function event_name(kind) result(name)
      integer, intent(in) :: kind
      character(len=8) :: name

      select case (kind)
      case (event_impact)
         name = 'impact'
      case (event_capture)
         name = 'capture'
      case (event_release)
         name = 'release'
      case (event_contact)
         name = 'contact'
      case default
         name = 'limit'
      end select
   end function event_name

   !> Brings all that is held in memory into the part file; where one table fails for want of space
   !> another may still fit.
   subroutine flush_results(self, error)
      type(result_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: other

      call self%grid%grid%flush(self%file, error)
      call self%history%table%flush(self%file, other)
      call keep_first(error, other)
      if (self%plan%energy) call self%energy%flush(self%file, other)
      call keep_first(error, other)
      call self%events%flush(self%file, other)
      call keep_first(error, other)
   end subroutine flush_results

   pure subroutine keep_first(error, other)
      type(error_type), allocatable, intent(inout) :: error, other

      if (allocated(other) .and. .not. allocated(error)) call move_alloc(other, error)
   end subroutine keep_first

   !> Lets others see all results so far.
   subroutine publish_results(self, error)
      type(result_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error

      call flush_results(self, error)
      if (.not. allocated(error)) call self%file%publish(error)
   end subroutine publish_results

   !> Flushes, writes what the run has cost, and closes; called also when a run stops early. What
   !> stops before its first record leaves no file, and one that was there as it was.
   subroutine close_results(self, scene, error)
      type(result_file_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene   !! its clock is stopped
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: close_error
      integer :: outer

      call enter(scene%system%cost, phase_output, outer, .true.)
      if (self%file%is_open() .and. self%has_records) call flush_results(self, error)
      call leave(scene%system%cost, outer)
      call stop_clock(scene%system%cost)
      if (.not. self%has_records) then
         call self%file%drop()
         return
      end if
      ! what could not be written does not keep the rest from being closed
      if (.not. allocated(error)) call write_cost(self%file, scene, error)
      call self%file%close(close_error)
      call keep_first(error, close_error)
   end subroutine close_results

end module result_file
