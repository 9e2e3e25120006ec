!> Going on from the results of an earlier run: its state and deck, and the files that go on.
module restart_start
   use kinds, only: wp
   use errors, only: error_type, new_error, status_deck, status_file
   use text, only: to_text
   use file_calls, only: file_facts_type, look_at, is_regular, is_same
   use part_file, only: part_file_type, fill_part, discard
   use state_archive, only: archive_type
   use memory_shortage, only: check_allocation
   use model, only: model_type
   use places, only: source_type, fail_at
   use effective_matrix, only: mark_implicit
   use deck_reader, only: definition_type
   use deck_changes, only: deck_text_type, cut_deck, find_change, records_differ
   use hdf5_reader, only: hdf5_reader_type
   use restart_group, only: read_state, new_restart_group, continue_group, write_deck_names
   use restart_deck, only: read_restart_deck, definition_length
   use result_file, only: open_results, record_increment, write_system
   use result_extents, only: extents_type, resume_results
   use command_line, only: command_type
   use program_version, only: version_text
   use output_files, only: claim_output, log_stem
   use run_log, only: open_log, continue_log, say
   use run_output, only: output_type
   use step_tally, only: start_tally
   use scene_setup, only: simulation_type
   use course, only: course_type
   implicit none
   private

   public :: restart_type, read_restart, is_finished, open_outputs, begin_again

   character(len=*), parameter :: nl = new_line('a')

   !> What a run goes on from, if it does.
   type :: restart_type
      logical :: wanted = .false.
      type(archive_type) :: archive
      character(len=:), allocatable :: path      !! of the earlier results
      logical :: same_file = .false.             !! which are gone on with
      logical :: resumed = .false.               !! rows go on behind those of the earlier run
      character(len=:), allocatable, private :: misfit   ! why they cannot
      type(file_facts_type), private :: facts    ! of them, when they were read
      type(definition_type), allocatable, private :: definitions(:)
      integer :: step = 0, increment = 0         !! reached
      real(wp) :: step_time = 0.0_wp
   end type restart_type

contains

   !> Reads the state that the command names; sees that the deck is the same as far as it must be.
   subroutine read_restart(self, command, model, error)
      type(restart_type), intent(out) :: self
      type(command_type), intent(in) :: command
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      type(hdf5_reader_type) :: reader
      type(deck_text_type) :: new, old

      self%wanted = allocated(command%restart)
      if (.not. self%wanted) return
      self%path = command%restart
      self%definitions = command%definitions
      self%facts = look_at(self%path)
      self%same_file = is_same(self%facts, look_at(command%output))
      if (self%facts%exists .and. .not. is_regular(self%facts)) call new_error(error, status_file, &
            'cannot read '''//self%path//''': it is a directory, pipe or device'//nl &
            //'  cure: name the result file of the run to go on with')
      if (.not. allocated(error)) call reader%open(self%path, error)
      if (allocated(error)) return
      call read_state(reader, self%path, self%archive, error)
      if (.not. allocated(error)) call read_old_deck(reader, self%path, old, error)
      call reader%close()
      if (allocated(error)) return
      call find_place(self)
      call cut_deck(new, model%source, command%definitions, error)
      if (allocated(error)) return
      call compare(self, new, old, error)
      if (allocated(error)) return
      call check_end(self, model, error)
   end subroutine read_restart

   subroutine read_old_deck(reader, path, old, error)
      type(hdf5_reader_type), intent(in) :: reader
      character(len=*), intent(in) :: path
      type(deck_text_type), intent(out) :: old
      type(error_type), allocatable, intent(out) :: error
      type(source_type) :: source
      character(len=definition_length), allocatable :: texts(:)
      type(definition_type), allocatable :: definitions(:)
      integer :: i, equals, status

      call read_restart_deck(reader, path, source, texts, error)
      if (allocated(error)) return
      allocate (definitions(size(texts)), stat=status)
      call check_allocation(status)
      do i = 1, size(texts)
         equals = index(texts(i), '=')
         definitions(i)%name = texts(i)(:equals - 1)
         definitions(i)%value = trim(texts(i)(equals + 1:))
      end do
      call cut_deck(old, source, definitions, error)
   end subroutine read_old_deck

   subroutine find_place(self)
      type(restart_type), intent(inout) :: self

      self%archive%reading = .true.
      call self%archive%pass('course/step', self%step)
      call self%archive%pass('course/increment', self%increment)
      call self%archive%pass('course/step_time', self%step_time)
   end subroutine find_place

   subroutine compare(self, new, old, error)
      type(restart_type), intent(inout) :: self
      type(deck_text_type), intent(in) :: new, old
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: what
      logical :: differ

      call find_change(new, old, self%step, error)
      if (allocated(error)) return
      call records_differ(new, old, self%step, differ, what)
      if (.not. differ) return
      self%misfit = 'the deck records something else than before: '//what
      if (self%same_file) call refuse(self, status_deck, error)
   end subroutine compare

   !> Other records cannot stand in one file.
   subroutine refuse(self, status, error)
      type(restart_type), intent(in) :: self
      integer, intent(in) :: status
      type(error_type), allocatable, intent(out) :: error

      call new_error(error, status, 'cannot go on in '''//self%path//''': '//self%misfit//nl &
            //'  cure: -o NEW.h5 begins a new file with the state of the restart; or ask for the ' &
            //'same records')
   end subroutine refuse

   !> The step must not end before what has been reached.
   subroutine check_end(self, model, error)
      type(restart_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      if (self%step < 1 .or. self%step > size(model%steps)) then
         call new_error(error, status_file, 'the state in '''//self%path//''' is in step ' &
               //to_text(self%step)//', which the deck does not have'//nl &
               //'  cure: keep all steps that the run has begun')
      else if (model%steps(self%step)%duration < self%step_time) then
         call fail_at(error, model%source, model%steps(self%step)%time_place, &
               'the step ends before '//to_text(self%step_time)//', the step time reached in ''' &
               //self%path//'''', cure='a T from there on; or run the deck from its start')
      end if
   end subroutine check_end

   !> Whether there is nothing left to do, the results standing where they are.
   pure function is_finished(self, model) result(finished)
      type(restart_type), intent(in) :: self
      type(model_type), intent(in) :: model
      logical :: finished

      finished = .false.
      if (.not. (self%wanted .and. self%same_file)) return
      finished = self%step == size(model%steps)
      if (finished) finished = .not. model%steps(self%step)%duration > self%step_time
   end function is_finished

   !> Takes and opens the results and the log: new ones, or those of the earlier run.
   subroutine open_outputs(self, command, simulation, output, error)
      type(restart_type), intent(inout) :: self
      type(command_type), intent(in) :: command
      type(simulation_type), intent(inout) :: simulation
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      type(part_file_type) :: place
      type(command_type) :: taking

      taking = command
      taking%overwrite = command%overwrite .or. self%same_file
      if (self%wanted .and. .not. allocated(self%misfit)) then
         call claim_output(place, taking, simulation%model%source, error)
         if (.not. allocated(error)) call resume(self, place, simulation, output, error)
         if (allocated(error)) return
      end if
      if (.not. self%resumed) then
         call claim_output(place, taking, simulation%model%source, error)
         if (allocated(error)) return
         call open_results(output%results, place, command%output, simulation%model, &
               simulation%scene, simulation%contact, error)
         call name_deck(command%definitions, simulation%model%source, output)
      end if
      call start_tally(output%tally, size(simulation%model%steps))
      if (self%wanted .and. .not. allocated(error)) call output%tally%pass_state(self%archive, &
            simulation)
      if (.not. allocated(error)) call open_lines(self, command, output, error)
      if (.not. allocated(error)) return
      output%results%has_records = .false.
      call output%results%file%drop()
   end subroutine open_outputs

   !> Copies the earlier results and goes on in the copy, if they are what the deck asks for.
   subroutine resume(self, place, simulation, output, error)
      type(restart_type), intent(inout) :: self
      type(part_file_type), intent(inout) :: place
      type(simulation_type), intent(in) :: simulation
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      type(extents_type) :: extents
      type(file_facts_type) :: facts

      call fill_part(place, self%path, error)
      facts = look_at(self%path)
      if (.not. (allocated(error) .or. is_same(self%facts, facts))) call new_error( &
            error, status_file, 'another run has written '''//self%path//''' just now' &
            //nl//'  cure: wait until it ends')
      if (allocated(error)) then
         call discard(place)
         return
      end if
      call extents%pass_state(self%archive)
      call resume_results(output%results, place, simulation%model, simulation%scene, &
            simulation%contact, extents, self%misfit, error)
      self%resumed = .not. (allocated(error) .or. allocated(self%misfit))
      if (self%resumed) then
         call output%results%pass_state(self%archive)
         call name_deck(self%definitions, simulation%model%source, output)
         call continue_group(output%results%restart, self%archive)
         call write_deck_names(output%results%restart, output%results%file, error)
      end if
      if (self%resumed .and. .not. allocated(error)) return
      output%results%has_records = .false.
      call output%results%file%drop()
      if (self%same_file .and. .not. allocated(error)) call refuse(self, status_file, error)
   end subroutine resume

   !> What the results say of the deck.
   subroutine name_deck(definitions, source, output)
      type(definition_type), intent(in) :: definitions(:)
      type(source_type), intent(in) :: source
      type(output_type), intent(inout) :: output
      character(len=definition_length) :: texts(size(definitions))
      integer :: i

      do i = 1, size(definitions)
         texts(i) = definitions(i)%name//'='//definitions(i)%value
      end do
      call new_restart_group(output%results%restart, source, texts)
   end subroutine name_deck

   subroutine open_lines(self, command, output, error)
      type(restart_type), intent(inout) :: self
      type(command_type), intent(in) :: command
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error

      if (self%wanted) then
         call continue_log(output%log, log_stem(command%output), log_stem(self%path), &
               command%quiet, self%archive, error)
      else
         call open_log(output%log, log_stem(command%output), command%quiet, error)
      end if
   end subroutine open_lines

   !> Says where the run goes on; a new file begins with that state.
   subroutine begin_again(self, simulation, course, output, error)
      type(restart_type), intent(in) :: self
      type(simulation_type), intent(inout) :: simulation
      type(course_type), intent(in) :: course
      type(output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: implicit_equation(:)

      call say(output%log, 'restarted from '''//self%path//''': step '//to_text(course%step) &
            //', increment '//to_text(course%increment)//', time ' &
            //to_text(simulation%motion%motion%t))
      if (self%resumed) return
      call say(output%log, '  its records were others: the first row here is that state')
      call mark_implicit(simulation%scene%system%structure, implicit_equation)
      call write_system(output%results, simulation%scene, version_text(), implicit_equation, error)
      if (.not. allocated(error)) call record_increment(output%results, simulation%scene, &
            simulation%contact, simulation%motion, simulation%model%steps(course%step)%requests, &
            0, .false., error)
   end subroutine begin_again

end module restart_start
