!> What memory a run will need: the model as it has been built to check it, which is measured, and
!> what the increments add, item by item. All in bytes.
module memory_estimate
   use kinds, only: wp
   use text, only: to_text
   use memory_use, only: resident_memory
   use skyline_matrix, only: profile_type, profile_entries
   use panel_layout, only: panel_layout_type, new_panel_layout
   use steps, only: step_type, procedure_static, procedure_dynamic, &
         procedure_frequency, solver_mumps
   use surfaces, only: method_transformation, method_penalty
   use effective_system, only: most_kept
   use compliance_store, only: most_entries
   use eigen_solver, only: condensed_below => small
   use output_plan, only: plan_type, new_plan
   use scene_setup, only: simulation_type
   implicit none
   private

   public :: memory_type, item_length, state_bytes, estimate_memory, add_step_memory
   public :: memory_text, megabytes
   public :: item_model, item_matrices, item_state, item_frames, item_rows, item_contact

   integer, parameter :: item_length = 24
   integer, parameter :: n_items = 6
   integer, parameter :: item_model = 1, item_matrices = 2, item_state = 3, item_frames = 4, &
         item_rows = 5, item_contact = 6
   character(len=item_length), parameter :: names(n_items) = [character(len=item_length) :: &
         'model', 'matrices', 'states', 'frames', 'rows', 'contact']
   real(wp), parameter :: real_bytes = 8.0_wp
   !> What HDF5 takes for itself while a file is open.
   real(wp), parameter :: library_bytes = 5.0e6_wp
   !> Values of an element or a node from which frames of stress are made.
   real(wp), parameter :: n_recovered = 14.0_wp
   !> What a column of the history takes beside its values: its path, and HDF5 while it is open.
   real(wp), parameter :: column_bytes = 2200.0_wp

   !> What is held while increments are taken, and the most that building the model took.
   type :: memory_type
      real(wp) :: items(n_items) = 0.0_wp
      real(wp) :: start_up = 0.0_wp
   contains
      procedure :: total
   end type memory_type

   !> States that automatic increments of a motion keep: that of the coarse motion, those to be put
   !> back, that at the start of the step.
   real(wp), parameter :: n_states_kept = 6.0_wp

contains

   !> All but the matrices, which depend on the step.
   subroutine estimate_memory(self, simulation)
      type(memory_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      real(wp) :: n_freedoms, n_history

      call resident_memory(self%items(item_model), self%start_up)
      associate (structure => simulation%scene%system%structure)
         n_freedoms = real(structure%map%n_freedoms, wp)
         n_history = real(structure%n_history, wp)
      end associate
      ! d, v, a, the forces beside them, of two states and the work between them
      self%items(item_state) = real_bytes*((10.0_wp + n_beside(simulation))*n_freedoms &
            + 3.0_wp*n_history)
      associate (steps => simulation%model%steps)
         if (any(steps%procedure == procedure_dynamic .and. .not. steps%direct)) then
            self%items(item_state) = self%items(item_state) &
                  + real_bytes*n_states_kept*(4.0_wp*n_freedoms + n_history)
         end if
      end associate
      ! one is gathered before it is written
      if (any(simulation%model%steps%restart_frequency > 0)) self%items(item_state) = &
            self%items(item_state) + state_bytes(simulation)
      self%items(item_contact) = real_bytes*contact_entries(simulation)
      call add_output(self, simulation)
   end subroutine estimate_memory

   !> What a state for a restart holds: d, v, a and the forces beside them, the history; twice where
   !> the motion is computed twice.
   pure real(wp) function state_bytes(simulation)
      type(simulation_type), intent(in) :: simulation
      real(wp), parameter :: n_arrays = 6.0_wp

      associate (structure => simulation%scene%system%structure, steps => simulation%model%steps)
         state_bytes = real_bytes*(n_arrays*real(structure%map%n_freedoms, wp) &
               + real(structure%n_history, wp) + n_arrays*real(simulation%scene%rows%n, wp))
         if (any(steps%procedure == procedure_dynamic .and. .not. steps%direct)) state_bytes = &
               2.0_wp*state_bytes
      end associate
   end function state_bytes

   !> Arrays of the states with contact that stand beside the first: where an impact is sought they
   !> are those at the end of a part of the step, at the impact and on trial.
   pure function n_beside(simulation) result(n)
      type(simulation_type), intent(in) :: simulation
      real(wp) :: n
      real(wp), parameter :: n_arrays = 7.0_wp

      associate (scene => simulation%scene)
         n = 0.0_wp
         if (scene%rows%n == 0) return
         n = n_arrays
         if (scene%settings%method /= method_transformation .or. scene%settings%anchored) return
         n = 3.0_wp*n_arrays
      end associate
   end function n_beside

   !> Motions by unit forces in contact rows: work space, and those kept for rows that stay.
   pure function contact_entries(simulation) result(entries)
      type(simulation_type), intent(in) :: simulation
      real(wp) :: entries
      real(wp), parameter :: n_shelves = 4.0_wp, n_working = 3.0_wp
      real(wp) :: n_columns

      associate (scene => simulation%scene, pairs => simulation%model%pairs)
         entries = 0.0_wp
         if (scene%rows%n == 0 .or. scene%settings%method == method_penalty) return
         n_columns = real(scene%rows%n + count(scene%rows%friction > 0.0_wp), wp)
         entries = n_columns*(real(scene%system%structure%map%n_freedoms, wp) &
               + 2.0_wp*real(scene%rows%n, wp))
         if (scene%system%structure%is_linear .and. all(pairs%target == 0)) then
            entries = n_shelves*min(entries, real(most_entries, wp)) + n_working*entries
         else
            entries = n_working*entries
         end if
      end associate
   end function contact_entries

   !> Frames with the snapshot and the sums they are made from, and rows of the history.
   subroutine add_output(self, simulation)
      type(memory_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(plan_type) :: plan
      real(wp) :: n_nodes, n_cells, n_values, n_sums, n_columns, n_frames

      call new_plan(plan, simulation%model)
      associate (model => simulation%model)
         n_nodes = real(model%nodes%n, wp)
         n_cells = real(model%elements%n, wp)
         n_values = 3.0_wp*n_nodes*real(1 + count(plan%file(2:4)), wp)
         n_sums = 0.0_wp
         if (any(plan%file(5:7))) then
            n_values = n_values + 7.0_wp*(n_nodes + n_cells)
            n_sums = n_recovered*(n_nodes + n_cells)
         end if
         n_frames = max(1.0_wp, min(256.0_wp, 65536.0_wp/max(1.0_wp, n_nodes, n_cells)))
      end associate
      self%items(item_frames) = library_bytes + real_bytes*(n_values*n_frames + n_sums &
            + 6.0_wp*real(simulation%scene%system%structure%map%n_freedoms, wp))
      n_columns = node_columns(plan, simulation%scene%system%structure%map%freedom) &
            + 6.0_wp*real(count(plan%element_print), wp)
      self%items(item_rows) = real_bytes*min(4096.0_wp*n_columns, max(2.0_wp**21, &
            64.0_wp*n_columns)) + column_bytes*n_columns
   end subroutine add_output

   !> Columns of the history that nodes have: one a freedom.
   pure real(wp) function node_columns(plan, freedom)
      type(plan_type), intent(in) :: plan
      integer, intent(in) :: freedom(:, :)       !! (3, n_nodes)
      integer :: node

      node_columns = 0.0_wp
      do node = 1, size(freedom, 2)
         node_columns = node_columns + real(count(plan%node_print(:, node)) &
               *count(freedom(:, node) > 0), wp)
      end do
   end function node_columns

   !> The matrices of the step at hand; what a step needs is kept for the next, so the most counts.
   subroutine add_step_memory(self, simulation, step)
      type(memory_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(step_type), intent(in) :: step
      real(wp) :: entries, n

      associate (system => simulation%scene%system)
         n = real(n_matrices(simulation, step), wp)
         if (step%order == 4) then
            ! complex factors of so many step lengths, M, C and K, and the factors of M
            n = merge(2.0_wp, 8.0_wp, simulation%scene%rows%n == 0) + 4.0_wp
            self%items(item_matrices) = max(self%items(item_matrices), real_bytes*n &
                  *real(profile_entries(system%profile), wp))
            return
         end if
         if (system%matrices%choice%taken == solver_mumps) then
            entries = sparse_entries(system%profile%n)
         else
            entries = skyline_entries(system%profile)
            if (step%procedure == procedure_frequency) then
               entries = mode_entries(simulation, step, entries)
               n = 1.0_wp
            else if (system%structure%is_linear .and. profile_entries(system%profile) <= most_kept &
                  .and. entries > real(system%profile%n, wp)) then
               n = n + 3.0_wp
            end if
         end if
      end associate
      self%items(item_matrices) = max(self%items(item_matrices), real_bytes*n*entries)
   end subroutine add_step_memory

   !> The most that free vibrations hold (linalg/eigen_solver): K, M and the factors with Lanczos'
   !> basis or with the condensed matrices, or the matrices of the residuals with the modes.
   function mode_entries(simulation, step, of_matrix) result(entries)
      type(simulation_type), intent(in) :: simulation
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: of_matrix          !! entries
      real(wp) :: entries, n, n_massive, n_wanted, n_basis

      associate (system => simulation%scene%system)
         n = real(system%structure%map%n_freedoms, wp)
         n_massive = real(count(.not. system%massless), wp)
      end associate
      n_wanted = min(real(step%n_modes, wp), n_massive)
      if (2.0_wp*n_wanted <= n_massive .and. n_massive > real(condensed_below, wp)) then
         n_basis = min(n_massive, max(2.0_wp*n_wanted + 5.0_wp, n_wanted + 22.0_wp))
         entries = n*(n_basis + n_wanted) + n_basis**2
      else
         entries = 3.0_wp*n_massive**2
      end if
      entries = max(3.0_wp*of_matrix + entries, 5.0_wp*of_matrix + 2.0_wp*n*n_wanted)
   end function mode_entries

   !> What is stored of a skyline, blocks filled up with zeros.
   function skyline_entries(profile) result(entries)
      type(profile_type), intent(in) :: profile
      real(wp) :: entries
      type(panel_layout_type) :: layout

      call new_panel_layout(layout, profile%first_row, profile%coupled)
      entries = real(layout%n_entries, wp)
   end function skyline_entries

   !> Factor of a plane mesh with two freedoms a node by nested dissection, with its work space: as
   !> in theory proportional to n log2 n for n nodes, the factor measured.
   pure function sparse_entries(n_equations) result(entries)
      integer, intent(in) :: n_equations
      real(wp) :: entries
      real(wp) :: n_nodes

      n_nodes = max(2.0_wp, real(n_equations, wp)/2.0_wp)
      entries = 24.0_wp*n_nodes*log(n_nodes)/log(2.0_wp)
   end function sparse_entries

   !> How many effective matrices a step has in use: one at rest; in motion that of the acceleration
   !> too; those of steps cut short by impacts, or chosen by the program, besides.
   pure function n_matrices(simulation, step) result(n)
      type(simulation_type), intent(in) :: simulation
      type(step_type), intent(in) :: step
      integer :: n

      n = 2
      if (step%procedure == procedure_static) n = 1
      if (.not. step%direct) n = 4
      if (step%procedure == procedure_static) return
      if (simulation%scene%rows%n > 0 .and. &
            simulation%scene%settings%method == method_transformation) n = 4
   end function n_matrices

   !> The most that is held at once.
   pure real(wp) function total(self)
      class(memory_type), intent(in) :: self

      total = max(self%start_up, sum(self%items))
   end function total

   !> "120 MB (model 80, matrices 30, ...)".
   pure function memory_text(self) result(line)
      type(memory_type), intent(in) :: self
      character(len=:), allocatable :: line
      integer :: i

      line = megabytes(self%total())//' MB ('
      do i = 1, n_items
         if (i > 1) line = line//', '
         line = line//trim(names(i))//' '//megabytes(self%items(i))
      end do
      line = line//'; at most '//megabytes(self%start_up)//' at the start)'
   end function memory_text

   !> A number of bytes for the eye.
   pure function megabytes(bytes) result(text)
      real(wp), intent(in) :: bytes
      character(len=:), allocatable :: text

      if (bytes < 1.0e9_wp) then
         text = to_text(1.0e-6_wp*bytes, 3)
      else
         text = to_text(nint(min(1.0e-6_wp*bytes, 1.0e9_wp)))
      end if
   end function megabytes

end module memory_estimate
