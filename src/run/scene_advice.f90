!> Where a scene is dearer than it needs to be, with the cure: only what the program's own numbers
!> make certain.
module scene_advice
   use kinds, only: wp
   use text, only: to_text, plural
   use memory_shortage, only: check_allocation
   use mesh, only: scheme_implicit, scheme_explicit
   use steps, only: step_type, procedure_dynamic
   use critical_step, only: find_own_limits
   use prescribed_motion, only: are_at_rest
   use scene_setup, only: simulation_type
   use scene_features, only: feature_list_type, kind_solution, kind_energies
   use column_table, only: column_bytes
   use output_cost, only: bytes_text
   implicit none
   private

   public :: advice_list_type, advise_step, advise_pairs, advise_end

   !> Lines of advice.
   type :: advice_list_type
      integer :: n = 0
      character(len=400) :: lines(32)
   contains
      procedure :: add
   end type advice_list_type

   !> Explicit elements keep this part of their critical step, as with SCHEME=AUTO.
   real(wp), parameter :: margin = 0.95_wp
   !> Parts of the time that are worth a word.
   real(wp), parameter :: worth_solving = 0.3_wp, worth_energies = 0.25_wp
   integer, parameter :: few_equations = 200
   !> So many times longer a step must be without a few elements, and how few these are.
   real(wp), parameter :: worth_mixing = 3.0_wp, few_elements = 0.05_wp
   integer, parameter :: least_elements = 20
   !> Bytes of frames and of histories that are too many; frames worth having.
   real(wp), parameter :: many_bytes = 1.0e9_wp, some_bytes = 2.0e8_wp
   real(wp), parameter :: many_frames = 2000.0_wp, good_frames = 200.0_wp

contains

   !> Advice on a step that is in force.
   subroutine advise_step(self, simulation, i_step, features, thorough)
      type(advice_list_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step
      type(feature_list_type), intent(in) :: features
      logical, intent(in) :: thorough            !! look at every element too

      associate (step => simulation%model%steps(i_step))
         if (step%procedure == procedure_dynamic) then
            call advise_explicit(self, simulation, step, features)
            if (thorough) call advise_mixed(self, simulation, step)
            call advise_energies(self, simulation, features)
         end if
         if (step%direct) call advise_output(self, features)
      end associate
   end subroutine advise_step

   !> A line that is not there yet.
   subroutine add(self, line)
      class(advice_list_type), intent(inout) :: self
      character(len=*), intent(in) :: line

      if (self%n == size(self%lines)) return
      if (any(self%lines(:self%n) == line)) return
      self%n = self%n + 1
      self%lines(self%n) = line
   end subroutine add

   !> The part that features of a kind have in the time.
   pure real(wp) function share_of(features, kind)
      type(feature_list_type), intent(in) :: features
      integer, intent(in) :: kind

      associate (items => features%items(:features%n))
         share_of = sum(items%seconds, mask=items%kind == kind)/sum(items%seconds)
      end associate
   end function share_of

   !> Implicit elements that could as well be explicit: lumped, the step below their critical one,
   !> and nothing in the step that wants implicit elements.
   subroutine advise_explicit(self, simulation, step, features)
      type(advice_list_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(step_type), intent(in) :: step
      type(feature_list_type), intent(in) :: features
      integer :: n

      associate (structure => simulation%scene%system%structure, &
            limit => simulation%critical(scheme_implicit), scene => simulation%scene)
         if (.not. step%direct .or. step%order /= 2 .or. abs(step%alpha) > 0.0_wp) return
         if (structure%has_consistent_mass .or. size(structure%map%dependent) > 0) return
         if (any(structure%groups%scheme == scheme_explicit)) return
         if (scene%settings%fictitious .or. scene%settings%anchored) return
         if (any(scene%system%massless) .or. limit%massless_freedom > 0) return
         if (step%dt > margin*limit%step .or. structure%map%n_eq < few_equations) return
         if (share_of(features, kind_solution) < worth_solving) return
         n = sum([0, pack([(size(structure%groups(n)%member), n=1, size(structure%groups))], &
               structure%groups%resists)])
         call self%add('all '//to_text(n)//' implicit elements could be explicit: their critical ' &
               //'step is '//to_text(limit%step, 3)//', the step '//to_text(step%dt, 3)//', and ' &
               //'their mass is lumped; *DYNAMIC, DIRECT, EXPLICIT saves the solutions, about ' &
               //to_text(nint(100.0_wp*share_of(features, kind_solution)))//' % of the time')
      end associate
   end subroutine advise_explicit

   !> Explicit elements of which a few keep the step small.
   subroutine advise_mixed(self, simulation, step)
      type(advice_list_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(step_type), intent(in) :: step
      real(wp), allocatable :: limits(:)
      logical, allocatable :: counted(:)
      real(wp) :: without
      integer :: g, n, n_short, status

      if (simulation%partition%n_elements > 0) return
      if (step%dt < 0.5_wp*simulation%critical(scheme_explicit)%step) return
      associate (structure => simulation%scene%system%structure)
         allocate (limits(simulation%model%elements%n), counted(simulation%model%elements%n), &
               stat=status)
         call check_allocation(status)
         counted = .false.
         do g = 1, size(structure%groups)
            associate (group => structure%groups(g))
               if (group%scheme == scheme_explicit .and. group%resists) then
                  counted(group%member) = .true.
               end if
            end associate
         end do
         n = count(counted)
         if (n < least_elements) return
         call find_own_limits(structure, limits)
      end associate
      where (.not. counted) limits = huge(1.0_wp)
      n_short = count(limits < worth_mixing*step%dt/margin)
      if (n_short == 0 .or. real(n_short, wp) > few_elements*real(n, wp)) return
      without = minval(limits, mask=limits >= worth_mixing*step%dt/margin)
      call self%add(to_text(n_short)//' of '//to_text(n)//' explicit elements, as element ' &
            //to_text(simulation%model%elements%id(minloc(limits, dim=1)))//', keep the step at ' &
            //to_text(step%dt, 3)//'; the others would bear '//to_text(margin*without, 3)//': ' &
            //'*ELEMENT GROUP, SCHEME=AUTO and such a step make these few implicit')
   end subroutine advise_mixed

   !> Energies of many groups.
   subroutine advise_energies(self, simulation, features)
      type(advice_list_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(feature_list_type), intent(in) :: features

      if (.not. features%output%energies .or. features%output%energy_every > 1.5_wp) return
      associate (structure => simulation%scene%system%structure)
         if (structure%map%n_eq < few_equations .or. size(structure%groups) < 2) return
         if (share_of(features, kind_energies) < worth_energies) return
         call self%add('energies of '//to_text(size(structure%groups))//' groups in every ' &
               //'increment take about '//to_text(nint(100.0_wp*share_of(features, &
               kind_energies)))//' % of the time: FREQUENCY=10 on *ENERGY PRINT leaves a tenth')
      end associate
   end subroutine advise_energies

   !> Frames and histories that fill the disk.
   subroutine advise_output(self, features)
      type(advice_list_type), intent(inout) :: self
      type(feature_list_type), intent(in) :: features
      real(wp) :: bytes, rows

      associate (output => features%output)
         bytes = output%n_frames*output%frame_bytes
         if (output%asked_frames .and. (bytes > many_bytes .or. (bytes > some_bytes .and. &
               output%n_frames > many_frames))) call self%add(to_text(output%n_frames, 6) &
               //' frames of '//bytes_text(output%frame_bytes)//' are '//bytes_text(bytes)//': ' &
               //fewer_frames(features))
         rows = features%increments/output%print_every
         bytes = column_bytes(rows)*real(output%n_columns, wp)
         if (bytes > many_bytes) call self%add(plural(output%n_columns, 'column') &
               //' of the history at '//to_text(rows, 6)//' times are '//bytes_text(bytes) &
               //': NSET= or ELSET= on the PRINT cards, or a larger FREQUENCY, leaves fewer')
      end associate
   end subroutine advise_output

   !> What makes frames take less: where there are no more than enough of them, less in each.
   pure function fewer_frames(features) result(advice)
      type(feature_list_type), intent(in) :: features
      character(len=:), allocatable :: advice

      if (features%output%n_frames > 2.0_wp*good_frames .and. features%increments > 0.0_wp) then
         advice = 'FREQUENCY='//to_text(ceiling(features%increments/good_frames)) &
               //' on the FILE cards leaves some '//to_text(nint(good_frames))
      else
         advice = 'fewer fields on the FILE cards, or *OUTPUT, COMPRESS, make them smaller'
      end if
   end function fewer_frames

   !> Marks the pairs that may meet in the step in force: a row whose freedoms along its normal are
   !> all held at rest, before a wall at rest, keeps its gap.
   subroutine advise_pairs(simulation, may_meet)
      type(simulation_type), intent(in) :: simulation
      logical, intent(inout) :: may_meet(:)      !! by pairs
      logical :: at_rest
      integer :: i

      associate (rows => simulation%scene%rows, system => simulation%scene%system, &
            state => simulation%motion%motion)
         at_rest = are_at_rest(system%motions, state%d, state%v, state%a)
         do i = 1, rows%n
            if (at_rest .and. .not. rows%moving .and. rows%amplitude(i) == 0) then
               associate (from => rows%along_normal%first(i), &
                     to => rows%along_normal%first(i + 1) - 1)
                  if (all(system%structure%map%prescribed( &
                        rows%along_normal%freedom(from:to)))) cycle
               end associate
            end if
            may_meet(rows%pair(i)) = .true.
         end do
      end associate
   end subroutine advise_pairs

   !> What a finished run has shown: pairs that never met, materials that never yielded.
   subroutine advise_end(self, simulation)
      type(advice_list_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      integer :: p

      associate (structure => simulation%scene%system%structure, ledger => simulation%scene%ledger)
         do p = 1, size(simulation%contact%names)
            if (.not. any(simulation%contact%rows%pair == p) .or. simulation%has_met(p)) cycle
            call self%add('contact '//trim(simulation%contact%names(p))//' has not met in this ' &
                  //'run: without it nothing changes but the time')
         end do
         if (structure%is_linear .or. abs(ledger%plastic) > 0.0_wp) return
         if (.not. all_plastic(simulation)) return
         call self%add('nothing has yielded: without *PLASTIC the model is linear, with the same ' &
               //'motion and for less')
      end associate
   end subroutine advise_end

   !> Whether all that is not linear is so by its material.
   pure logical function all_plastic(simulation)
      type(simulation_type), intent(in) :: simulation
      integer :: g

      all_plastic = .true.
      do g = 1, size(simulation%scene%system%structure%groups)
         associate (element => simulation%scene%system%structure%groups(g)%element)
            if (.not. element%linear .and. element%n_history == 0) all_plastic = .false.
         end associate
      end do
   end function all_plastic

end module scene_advice
