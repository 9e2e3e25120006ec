!> What a deck would do, found by building every step of it without time passing.
module deck_check
   use kinds, only: wp
   use errors, only: error_type
   use text, only: to_text
   use threads, only: claim_work_space
   use model, only: model_type
   use deck_reader, only: read_deck
   use memory_limit, only: memory_limit_type, find_limit
   use memory_shortage, only: check_allocation
   use command_line, only: command_type
   use scene_setup, only: simulation_type, build_scene, begin_step, meet_conditions
   use memory_estimate, only: memory_type, estimate_memory, add_step_memory, memory_text
   use memory_refusal, only: check_reading, check_building, check_need, limit_text
   use output_plan, only: plan_type, new_plan
   use scene_features, only: feature_list_type, list_features, share_memory
   use scene_advice, only: advice_list_type, advise_step, advise_pairs
   use feature_report, only: report_features, report_advice
   use run_report, only: report_model, report_step, report_notes
   use run_log, only: log_type, say, remark
   use json_text, only: json_type
   use check_json, only: step_facts_type, facts_of, describe_check, put_lines
   use continuum_bodies, only: body_list_type, find_bodies, forget_bodies
   use notices, only: is_warning
   use deck_doubts, only: doubt_deck
   use step_doubts, only: doubt_step, may_be_too_long
   use longest_period, only: find_longest_period
   use explanation, only: explain_start
   use explanation_lines, only: lines_type
   implicit none
   private

   public :: preview_type, read_model, check_deck, prepare, report_preview

   !> Elements up to which a run, and a check, look at each for advice.
   integer, parameter :: most_elements(2) = [5000, 200000]

   !> Seconds that the longest period may take to find in a check; in a run, and as a part of it.
   real(wp), parameter :: patience = 0.3_wp, least_patience = 5.0e-4_wp, share = 0.01_wp
   real(wp), parameter :: long_patience = 5.0_wp   !! of an explanation

   !> What is known of a run before it begins.
   type :: preview_type
      type(memory_type) :: memory
      type(memory_limit_type) :: limit
      type(feature_list_type) :: features        !! of the dearest step
      type(advice_list_type) :: advice
      logical, allocatable :: may_meet(:)        !! by contact pairs
      type(step_facts_type), allocatable :: steps(:)
      type(lines_type) :: explanation
   end type preview_type

contains

   !> Reads the deck, builds every step once without running, and says what a run would do.
   subroutine check_deck(command, report, error)
      type(command_type), intent(in) :: command
      type(json_type), intent(inout) :: report   !! open; gets what is known of the deck
      type(error_type), allocatable, intent(out) :: error
      type(simulation_type) :: simulation
      type(preview_type) :: preview
      type(log_type) :: log

      call read_model(simulation%model, command, preview, error)
      if (allocated(error)) return
      preview%explanation%wanted = command%explain
      log%terminal = .not. (command%explain .or. command%json)
      call prepare(simulation, log, .true., preview, error)
      if (allocated(error)) return
      if (command%explain .and. .not. command%json) call report_explanation(preview, simulation)
      call say(log, 'memory: '//memory_text(preview%memory))
      call report_limit(preview, simulation, log, error)
      if (allocated(error)) return
      call report_preview(preview, simulation, .true., log)
      call report_notes(simulation, log)
      call say(log, 'the deck is sound; --explain says what it means')
      if (command%json) call describe_check(report, simulation, preview%steps, preview%memory, &
            preview%limit%bytes, preview%features, preview%advice, log%notices)
      if (command%json .and. command%explain) call put_lines(report, preview%explanation)
      call simulation%scene%system%matrices%release()
   end subroutine check_deck

   !> The model of the deck, unless to read it takes more memory than there is.
   subroutine read_model(model, command, preview, error)
      type(model_type), intent(inout) :: model
      type(command_type), intent(in) :: command
      type(preview_type), intent(inout) :: preview   !! gets its limit
      type(error_type), allocatable, intent(out) :: error

      call find_limit(preview%limit, command%memory)
      call check_reading(preview%limit, command%deck, error)
      if (allocated(error)) return
      if (preview%limit%of_addresses) call claim_work_space()
      call read_deck(model, command%deck, command%definitions, error)
   end subroutine read_model

   !> A check fails where a run would for the limit that the user has set; that of the machine may
   !> not be the one of the run.
   subroutine report_limit(preview, simulation, log, error)
      type(preview_type), intent(in) :: preview
      type(simulation_type), intent(in) :: simulation
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: refusal

      if (preview%limit%bytes < huge(1.0_wp)) call say(log, 'memory limit: ' &
            //limit_text(preview%limit))
      call check_need(preview%limit, preview%memory, simulation, refusal)
      if (.not. allocated(refusal)) return
      if (preview%limit%by_user) then
         call move_alloc(refusal, error)
      else
         call remark(log, 'warning: it would be refused here: '//refusal%message)
      end if
   end subroutine report_limit

   !> The explanation, and what is doubtful in the deck.
   subroutine report_explanation(preview, simulation)
      type(preview_type), intent(in) :: preview
      type(simulation_type), intent(in) :: simulation
      type(log_type) :: log
      integer :: i

      do i = 1, preview%explanation%n
         call say(log, trim(preview%explanation%lines(i)))
      end do
      do i = 1, size(simulation%remarks)
         if (is_warning(simulation%remarks(i)%text)) call say(log, simulation%remarks(i)%text)
      end do
   end subroutine report_explanation

   !> Builds the scene and goes through all steps without time passing, for their errors.
   subroutine prepare(simulation, log, aloud, preview, error)
      type(simulation_type), intent(inout) :: simulation
      type(log_type), intent(in) :: log
      logical, intent(in) :: aloud
      type(preview_type), intent(inout) :: preview   !! with its limit
      type(error_type), allocatable, intent(out) :: error
      type(body_list_type) :: bodies
      integer :: status

      call check_building(preview%limit, simulation%model, error)
      if (allocated(error)) return
      call build_scene(simulation, error)
      if (allocated(error)) return
      allocate (preview%may_meet(size(simulation%contact%names)), source=.false., stat=status)
      call check_allocation(status)
      call find_bodies(bodies, simulation%model)
      call doubt_deck(simulation, bodies)
      if (aloud) call report_model(simulation, log)
      call go_through_steps(simulation, bodies, log, aloud, preview, error)
      ! what is measured next shall not have them
      call forget_bodies(bodies)
      if (allocated(error)) then
         call simulation%scene%system%matrices%release()
         return
      end if
      call estimate_memory(preview%memory, simulation)
      call share_memory(preview%features, preview%memory)
      call name_idle_pairs(simulation, preview)
      if (.not. aloud) call check_need(preview%limit, preview%memory, simulation, error)
      if (allocated(error)) call simulation%scene%system%matrices%release()
   end subroutine prepare

   !> Brings every step into force once, looks at what it will take, and lets its time pass.
   subroutine go_through_steps(simulation, bodies, log, aloud, preview, error)
      type(simulation_type), intent(inout) :: simulation
      type(body_list_type), intent(in) :: bodies
      type(log_type), intent(in) :: log
      logical, intent(in) :: aloud
      type(preview_type), intent(inout) :: preview
      type(error_type), allocatable, intent(out) :: error
      type(plan_type) :: plan
      integer :: i, status

      call new_plan(plan, simulation%model)
      allocate (preview%steps(size(simulation%model%steps)), stat=status)
      call check_allocation(status)
      do i = 1, size(simulation%model%steps)
         call begin_step(simulation, i, error)
         if (.not. allocated(error) .and. i == 1) call meet_conditions(simulation, error)
         if (allocated(error)) return
         if (aloud) call report_step(simulation, i, log)
         call look_ahead(simulation, i, bodies, aloud, plan, preview)
         simulation%motion%motion%t = simulation%motion%motion%t &
               + simulation%model%steps(i)%duration
      end do
   end subroutine go_through_steps

   !> Memory, features and advice of a step in force.
   subroutine look_ahead(simulation, i_step, bodies, aloud, plan, preview)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(body_list_type), intent(in) :: bodies
      logical, intent(in) :: aloud               !! this is a check
      type(plan_type), intent(in) :: plan
      type(preview_type), intent(inout) :: preview
      type(feature_list_type) :: features

      preview%steps(i_step) = facts_of(simulation)
      call add_step_memory(preview%memory, simulation, simulation%model%steps(i_step))
      call list_features(features, simulation, i_step, plan)
      call advise_step(preview%advice, simulation, i_step, features, &
            simulation%model%elements%n <= most_elements(merge(2, 1, aloud)))
      call advise_pairs(simulation, preview%may_meet)
      call judge_step(simulation, i_step, bodies, merge(patience, max(least_patience, &
            share*features%total()), aloud), preview)
      if (i_step > 1 .and. features%total() <= preview%features%total()) return
      preview%features = features
   end subroutine look_ahead

   !> What the longest period says of a step in force.
   subroutine judge_step(simulation, i_step, bodies, seconds, preview)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_step
      type(body_list_type), intent(in) :: bodies
      real(wp), intent(in) :: seconds            !! that finding it may take
      type(preview_type), intent(inout) :: preview
      real(wp) :: period
      logical :: costly

      period = 0.0_wp
      costly = .true.
      if (preview%explanation%wanted) then
         call find_longest_period(simulation, bodies%n, long_patience, period, costly)
      else if (may_be_too_long(simulation, i_step)) then
         call find_longest_period(simulation, bodies%n, seconds, period, costly)
      end if
      call doubt_step(simulation, i_step, bodies, period)
      if (preview%explanation%wanted) call explain_start(preview%explanation, simulation, i_step, &
            bodies, period, costly)
   end subroutine judge_step

   !> Pairs that cannot meet in any step.
   subroutine name_idle_pairs(simulation, preview)
      type(simulation_type), intent(in) :: simulation
      type(preview_type), intent(inout) :: preview
      integer :: p

      do p = 1, size(preview%may_meet)
         if (preview%may_meet(p) .or. .not. any(simulation%contact%rows%pair == p)) cycle
         call preview%advice%add('contact '//trim(simulation%contact%names(p)) &
               //' can never meet: all its nodes are held along their normals, and its walls ' &
               //'are at rest; leave the pair out')
      end do
   end subroutine name_idle_pairs

   !> Features and advice; the features of small models in few words unless all is wanted.
   subroutine report_preview(preview, simulation, whole, log)
      type(preview_type), intent(in) :: preview
      type(simulation_type), intent(in) :: simulation
      logical, intent(in) :: whole
      type(log_type), intent(in) :: log

      call report_features(preview%features, simulation%scene%system%structure%map%n_freedoms, &
            whole, log)
      call report_advice(preview%advice, log)
   end subroutine report_preview

end module deck_check
