!> What is kept of matrices and solutions to be used again: not the numbers but what they were made
!> from, so that they can be made again to the bit.
module kept_solutions
   use kinds, only: wp, int64
   use text, only: to_text
   use errors, only: error_type
   use state_archive, only: archive_type
   use memory_shortage, only: check_allocation
   use motion_state, only: state_type
   use gauss_matrices, only: kept_gauss_steps, drop_gauss
   use gauss_step, only: prepare_step
   use equation_of_motion, only: system_type, prepare_again
   use compliance_store, only: compliance_store_type, complex_columns_type, shelves_by_age, &
         kept_columns
   use impact_scene, only: scene_type
   use row_compliance, only: refill_shelf
   use fourth_order_step, only: find_columns
   implicit none
   private

   public :: kept_solutions_type, note_kept, drop_kept, make_again

   !> Columns of the compliance of rows on one matrix.
   type :: kept_shelf_type
      real(wp) :: factors(3) = 0.0_wp            !! c_m, c_c, c_k of the matrix
      integer, allocatable :: columns(:)         !! in the order they were found in
      integer, allocatable :: batch(:)           !! of each: those found together
   end type kept_shelf_type

   !> All in order of age, what was used last at the end.
   type :: kept_solutions_type
      real(wp), allocatable :: factors(:, :)     !! (3, n) of the matrices
      real(wp), allocatable :: gauss_dt(:)       !! steps of the complex matrices
      logical, allocatable :: gauss_whole(:)     !! in the place of whole steps
      integer :: n_shelves = 0
      type(kept_shelf_type), allocatable :: shelves(:)
      real(wp) :: held_dt = -1.0_wp              !! fourth order: step of the columns of held rows
      integer, allocatable :: held_rows(:)
   contains
      procedure :: pass_state
   end type kept_solutions_type

contains

   !> All of it.
   subroutine pass_state(self, archive)
      class(kept_solutions_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive
      integer :: i, status

      call archive%pass('factors', self%factors)
      call archive%pass('gauss_dt', self%gauss_dt)
      call archive%pass('gauss_whole', self%gauss_whole)
      call archive%pass('held_dt', self%held_dt)
      call archive%pass('held_rows', self%held_rows)
      call archive%pass('n_shelves', self%n_shelves)
      if (archive%reading) then
         allocate (self%shelves(self%n_shelves), stat=status)
         call check_allocation(status)
      end if
      do i = 1, self%n_shelves
         call archive%enter('shelf_'//to_text(i))
         call archive%pass_fixed('factors', self%shelves(i)%factors)
         call archive%pass('columns', self%shelves(i)%columns)
         call archive%pass('batch', self%shelves(i)%batch)
         call archive%leave()
      end do
   end subroutine pass_state

   !> Looks at what there is. A tangent of nonlinear elements is never used again.
   subroutine note_kept(self, scene)
      type(kept_solutions_type), intent(out) :: self
      type(scene_type), intent(in) :: scene
      integer, allocatable :: shelves(:)
      real(wp), allocatable :: factors(:, :)
      logical, allocatable :: stays(:)
      integer :: i, status

      associate (system => scene%system)
         call system%matrices%kept_factors(factors)
         stays = [(system%structure%is_linear .or. .not. any(factors(2:3, i) > 0.0_wp), &
               i=1, size(factors, 2))]
         self%factors = factors(:, pack([(i, i=1, size(stays))], stays))
         call kept_gauss_steps(system%gauss, system%matrices, self%gauss_dt, self%gauss_whole)
         shelves = shelves_by_age(scene%compliances, system%matrices%generation)
         self%n_shelves = size(shelves)
         allocate (self%shelves(self%n_shelves), stat=status)
         call check_allocation(status)
         do i = 1, self%n_shelves
            associate (shelf => scene%compliances%shelves(shelves(i)))
               self%shelves(i)%factors = shelf%factors
               self%shelves(i)%columns = kept_columns(shelf)
               self%shelves(i)%batch = shelf%batch(:shelf%n)
            end associate
         end do
         if (scene%held%generation /= system%matrices%generation) return
         self%held_dt = scene%held%dt
         self%held_rows = scene%held%rows
      end associate
   end subroutine note_kept

   !> Empties the stores.
   subroutine drop_kept(scene)
      type(scene_type), intent(inout) :: scene
      type(compliance_store_type) :: no_columns
      type(complex_columns_type) :: none_held

      call drop_matrices(scene%system)
      scene%compliances = no_columns
      scene%held = none_held
   end subroutine drop_kept

   !> The matrices alone: their number tells the columns that belong to them.
   subroutine drop_matrices(system)
      type(system_type), intent(inout) :: system
      integer(int64) :: generation

      generation = system%matrices%generation
      call system%matrices%forget()
      system%matrices%generation = generation
      call drop_gauss(system%gauss)
   end subroutine drop_matrices

   !> Makes all again, in a scene whose step has begun and that has none of it yet.
   subroutine make_again(self, scene, state, error)
      type(kept_solutions_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(state_type), intent(in) :: state
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, self%n_shelves
         call prepare_again(scene%system, self%shelves(i)%factors, state, error)
         if (allocated(error)) return
         call refill_shelf(scene, self%shelves(i)%columns, self%shelves(i)%batch)
      end do
      if (allocated(self%held_rows)) then
         call prepare_step(scene%system, self%held_dt, .false., error)
         if (allocated(error)) return
         call find_columns(scene, self%held_rows, self%held_dt)
      end if
      ! matrices made for the columns alone have to go: they would be found in the store
      call drop_matrices(scene%system)
      do i = 1, size(self%factors, 2)
         call prepare_again(scene%system, self%factors(:, i), state, error)
         if (allocated(error)) return
      end do
      do i = 1, size(self%gauss_dt)
         call prepare_step(scene%system, self%gauss_dt(i), self%gauss_whole(i), error)
         if (allocated(error)) return
      end do
   end subroutine make_again

end module kept_solutions
