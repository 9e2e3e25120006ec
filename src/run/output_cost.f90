!> What the records of a step take: columns of the history, frames, their size and their time.
module output_cost
   use kinds, only: wp
   use text, only: to_text
   use steps, only: step_type, request_node_print, request_element_print, request_contact_print, &
         request_node_file, request_element_file, request_contact_file, request_energy_print, &
         quantity_u, quantity_v, quantity_a, quantity_rf, quantity_s, quantity_e, quantity_ener, &
         quantity_peeq, quantity_cf, quantity_cdis, quantity_cpress, quantity_cslip, &
         quantity_cstate, quantity_names, n_quantities
   use output_plan, only: plan_type
   use scene_setup, only: simulation_type
   implicit none
   private

   public :: output_cost_type, new_output_cost, bytes_text

   real(wp), parameter :: real_bytes = 8.0_wp
   !> Seconds: a byte of a frame, a value of a row, a freedom of the state it is taken from, a point
   !> where stresses are found.
   real(wp), parameter :: frame_byte = 2.0e-9_wp, row_value = 10.0e-9_wp, &
         state_freedom = 5.0e-9_wp, stress_point = 0.3e-6_wp

   integer, parameter :: vectors(5) = [quantity_u, quantity_v, quantity_a, quantity_rf, quantity_cf]
   integer, parameter :: of_elements(4) = [quantity_s, quantity_e, quantity_ener, quantity_peeq]
   integer, parameter :: of_contact(4) = [quantity_cdis, quantity_cpress, quantity_cslip, &
         quantity_cstate]

   !> Records of one step.
   type :: output_cost_type
      integer :: n_columns = 0                   !! of the history
      real(wp) :: print_every = 1.0_wp           !! increments between rows
      real(wp) :: row_seconds = 0.0_wp
      character(len=:), allocatable :: fields    !! of frames: 'U V S'
      logical :: asked_frames = .false.          !! by a FILE card of the step
      real(wp) :: n_frames = 0.0_wp
      real(wp) :: frame_bytes = 0.0_wp           !! of one frame
      real(wp) :: frame_seconds = 0.0_wp
      logical :: energies = .false.              !! by an ENERGY PRINT card of the step
      real(wp) :: energy_every = 1.0_wp
   end type output_cost_type

contains

   !> By the requests of a step that takes so many increments.
   subroutine new_output_cost(self, simulation, step, increments, plan)
      type(output_cost_type), intent(out) :: self
      type(simulation_type), intent(in) :: simulation
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: increments         !! 0: modes
      type(plan_type), intent(in) :: plan
      real(wp) :: file_every

      self%print_every = least_frequency(step, [request_node_print, request_element_print, &
            request_contact_print])
      if (self%print_every > 0.0_wp) call measure_rows(self, simulation, plan)
      self%print_every = max(1.0_wp, self%print_every)
      call measure_frame(self, simulation, plan)
      file_every = least_frequency(step, [request_node_file, request_element_file, &
            request_contact_file])
      self%asked_frames = file_every > 0.0_wp
      self%n_frames = 2.0_wp
      if (self%asked_frames) self%n_frames = 1.0_wp + real(ceiling(increments/file_every), wp)
      if (step%n_modes > 0) self%n_frames = real(step%n_modes, wp)
      self%energy_every = least_frequency(step, [request_energy_print])
      self%energies = self%energy_every > 0.0_wp
      self%energy_every = max(1.0_wp, self%energy_every)
   end subroutine new_output_cost

   !> The smallest FREQUENCY of requests of some kinds, 0 without any.
   pure real(wp) function least_frequency(step, kinds)
      type(step_type), intent(in) :: step
      integer, intent(in) :: kinds(:)            !! request_ parameters
      integer :: i

      least_frequency = 0.0_wp
      do i = 1, size(step%requests)
         associate (request => step%requests(i))
            if (.not. any(kinds == request%kind)) cycle
            if (least_frequency > 0.0_wp .and. real(request%frequency, wp) > least_frequency) cycle
            least_frequency = real(request%frequency, wp)
         end associate
      end do
   end function least_frequency

   !> Columns of nodes, elements and pairs.
   subroutine measure_rows(self, simulation, plan)
      type(output_cost_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(plan_type), intent(in) :: plan
      integer :: node, g, e, n_points

      n_points = 0
      associate (structure => simulation%scene%system%structure)
         do node = 1, size(plan%node_print, 2)
            self%n_columns = self%n_columns + count(plan%node_print(vectors(:4), node)) &
                  *count(structure%map%freedom(:, node) > 0)
         end do
         do g = 1, size(structure%groups)
            associate (group => structure%groups(g))
               if (group%element%n_points == 0) cycle
               do e = 1, size(group%member)
                  associate (wanted => plan%element_print(:, group%member(e)))
                     if (.not. any(wanted)) cycle
                     n_points = n_points + group%element%n_points
                     self%n_columns = self%n_columns + group%element%n_stresses &
                           *count(wanted(of_elements(:2))) + count(wanted(of_elements(3:)))
                  end associate
               end do
            end associate
         end do
         if (allocated(simulation%contact%names)) self%n_columns = self%n_columns &
               + size(simulation%contact%names)*(merge(4, 0, plan%contact_print(quantity_cf)) &
               + count(plan%contact_print(of_contact)))
         self%row_seconds = row_value*real(self%n_columns, wp) &
               + state_freedom*real(structure%map%n_freedoms, wp) + stress_point*real(n_points, wp)
      end associate
   end subroutine measure_rows

   !> Fields of a frame: displacements always; stresses with MISES at nodes and in elements.
   subroutine measure_frame(self, simulation, plan)
      type(output_cost_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(plan_type), intent(in) :: plan
      real(wp) :: n_nodes, n_cells, n_points
      integer :: q, g
      logical :: wanted(n_quantities)

      wanted = plan%file
      wanted(quantity_u) = .true.
      self%fields = ''
      do q = 1, n_quantities
         if (wanted(q)) self%fields = self%fields//' '//trim(quantity_names(q))
      end do
      self%fields = self%fields(2:)
      n_nodes = real(simulation%model%nodes%n, wp)
      n_cells = real(simulation%model%elements%n, wp)
      self%frame_bytes = real_bytes*(n_nodes*real(3*count(wanted(vectors)) &
            + count(wanted(of_contact)), wp) + (n_nodes + n_cells)*sum(merge([7.0_wp, 6.0_wp, &
            1.0_wp, 1.0_wp], 0.0_wp, wanted(of_elements))))
      n_points = 0.0_wp
      do g = 1, size(simulation%scene%system%structure%groups)
         associate (group => simulation%scene%system%structure%groups(g))
            n_points = n_points + real(group%element%n_points, wp)*real(size(group%member), wp)
         end associate
      end do
      if (.not. any(wanted(of_elements))) n_points = 0.0_wp
      self%frame_seconds = frame_byte*self%frame_bytes + stress_point*n_points
   end subroutine measure_frame

   !> "24 B", "1.3 MB".
   pure function bytes_text(bytes) result(text)
      real(wp), intent(in) :: bytes
      character(len=:), allocatable :: text

      if (bytes < 1.0e3_wp) then
         text = to_text(bytes, 3)//' B'
      else if (bytes < 1.0e6_wp) then
         text = to_text(1.0e-3_wp*bytes, 3)//' kB'
      else if (bytes < 1.0e9_wp) then
         text = to_text(1.0e-6_wp*bytes, 3)//' MB'
      else
         text = to_text(1.0e-9_wp*bytes, 3)//' GB'
      end if
   end function bytes_text

end module output_cost
