!> Compliance of contact rows, along their normals and where there is friction along their tangents
!> too: on the effective matrix at hand by back-substitutions, or on the mass. What stays the same
!> is kept.
module row_compliance
   use kinds, only: wp, int64
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use equation_of_motion, only: prepare_mass, solve_together
   use compliance_store, only: choose_shelf, missing_columns, begin_batch, keep_column, &
         add_columns, most_entries
   use constraint_rows, only: row_accelerations, slip_products, row_vector, slip_vector
   use impact_scene, only: scene_type
   implicit none
   private

   public :: compliance_type, find_compliance, mass_compliance, row_motion, pushed, unit_motions
   public :: join_rates, split_forces, refill_shelf

   !> Rows that take part. With friction on any of them, forces and motions have 2 n entries: those
   !> along the normals, then those along the tangents.
   type :: compliance_type
      integer :: n = 0
      integer, allocatable :: rows(:)            !! (n)
      logical, allocatable :: rough(:)           !! (n) with friction; of no size if none is
      integer :: shelf = 0                       !! where the columns are kept, 0: in `x`
      integer, allocatable :: place(:)           !! (n or 2 n) on the shelf, 0: a column of zeros
      real(wp), allocatable :: x(:, :)           !! (n_freedoms, n or 2 n) motion by unit forces
      real(wp), allocatable :: w(:, :)           !! (n or 2 n, the same) of the rows
   end type compliance_type

contains

   !> X = A^-1 [G; T]t and W = [G; T] X for some rows, with the matrix last prepared.
   subroutine find_compliance(scene, rows, compliance)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: rows(:)
      type(compliance_type), intent(out) :: compliance

      call build(scene, rows, .false., scene%rows%friction(rows) > 0.0_wp, compliance)
   end subroutine find_compliance

   !> The same on the mass: M^-1 [G; T]t; `smooth` leaves friction out.
   subroutine mass_compliance(scene, marked, compliance, error, smooth)
      type(scene_type), intent(inout) :: scene
      logical, intent(in) :: marked(:)           !! (n_rows)
      type(compliance_type), intent(out) :: compliance
      type(error_type), allocatable, intent(out) :: error
      logical, intent(in), optional :: smooth
      integer :: rows(count(marked)), i
      logical :: rough(count(marked))

      call prepare_mass(scene%system, error)
      if (allocated(error)) return
      rows = pack([(i, i=1, scene%rows%n)], marked)
      rough = scene%rows%friction(rows) > 0.0_wp
      if (present(smooth)) rough = rough .and. .not. smooth
      call build(scene, rows, .true., rough, compliance)
   end subroutine mass_compliance

   subroutine build(scene, rows, on_mass, rough, compliance)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: rows(:)
      logical, intent(in) :: on_mass, rough(:)
      type(compliance_type), intent(out) :: compliance
      integer :: columns(size(rows)*merge(2, 1, any(rough)))
      integer :: j, n

      n = size(rows)
      scene%system%cost%contact_rows = scene%system%cost%contact_rows + n
      compliance%n = n
      compliance%rows = rows
      compliance%rough = pack(rough, spread(any(rough), 1, n))
      columns(:n) = rows
      if (any(rough)) columns(n + 1:) = merge(scene%rows%n + rows, 0, &
            rough .and. scene%rows%facing(rows))
      if (stays(scene, size(columns))) then
         call take_from_shelf(scene, columns, on_mass, compliance)
      else
         call solve_for_columns(scene, columns, on_mass, compliance)
      end if
      do j = 1, n
         ! a row that slides off its surface in this step asks for nothing
         if (.not. scene%rows%facing(rows(j))) compliance%w(j, j) = 1.0_wp
      end do
      do j = 1, size(compliance%rough)
         ! no force there: any motion will do
         if (columns(n + j) == 0) compliance%w(n + j, n + j) = compliance%w(j, j)
      end do
      compliance%w = (compliance%w + transpose(compliance%w))/2.0_wp
   end subroutine build

   !> Whether columns are the same as long as the matrix is, and few enough to be kept.
   pure function stays(scene, n_columns) result(same)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: n_columns
      logical :: same

      same = scene%system%structure%is_linear .and. .not. scene%rows%moving .and. &
            int(scene%system%structure%map%n_freedoms, int64)*n_columns <= most_entries
   end function stays

   !> The columns of the matrix at hand, from the shelf where they are there already.
   subroutine take_from_shelf(scene, columns, on_mass, compliance)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: columns(:)
      logical, intent(in) :: on_mass
      type(compliance_type), intent(inout) :: compliance
      integer :: j, status

      associate (matrices => scene%system%matrices)
         call choose_shelf(scene%compliances, matrices%generation, matrices%current_factors(), &
               scene%rows%n, compliance%shelf)
      end associate
      associate (shelf => scene%compliances%shelves(compliance%shelf), n => scene%rows%n)
         call find_and_keep(scene, missing_columns(shelf, pack(columns, columns > 0)), on_mass, &
               compliance%shelf)
         allocate (compliance%place(size(columns)), stat=status)
         call check_allocation(status)
         allocate (compliance%w(size(columns), size(columns)), stat=status)
         call check_allocation(status)
         compliance%place = 0
         compliance%w = 0.0_wp
         do j = 1, size(columns)
            if (columns(j) == 0) cycle
            compliance%place(j) = shelf%place(columns(j))
            compliance%w(:, j) = join_rates(compliance, shelf%w(:n, compliance%place(j)), &
                  shelf%w(n + 1:, compliance%place(j)))
         end do
      end associate
   end subroutine take_from_shelf

   !> Columns of the matrix at hand are found together and put on its shelf.
   subroutine find_and_keep(scene, columns, on_mass, shelf)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: columns(:)
      logical, intent(in) :: on_mass
      integer, intent(in) :: shelf
      real(wp), allocatable :: x(:, :)
      integer :: j

      if (size(columns) == 0) return
      call column_motions(scene, columns, on_mass, x)
      call begin_batch(scene%compliances%shelves(shelf))
      do j = 1, size(columns)
         call keep_column(scene%compliances%shelves(shelf), columns(j), x(:, j), &
               [row_accelerations(scene%rows, x(:, j)), slip_products(scene%rows, x(:, j))])
      end do
   end subroutine find_and_keep

   !> Puts columns of the matrix last prepared on a shelf, those of one batch found together: to the
   !> bit what has been there before.
   subroutine refill_shelf(scene, columns, batch)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: columns(:)
      integer, intent(in) :: batch(:)            !! ascending from 1
      real(wp) :: factors(3)
      integer :: shelf, i

      factors = scene%system%matrices%current_factors()
      call choose_shelf(scene%compliances, scene%system%matrices%generation, factors, &
            scene%rows%n, shelf)
      do i = 1, maxval([0, batch])
         call find_and_keep(scene, pack(columns, batch == i), .not. any(factors(2:3) > 0.0_wp), &
               shelf)
      end do
   end subroutine refill_shelf

   !> The columns of the matrix at hand, for this once.
   subroutine solve_for_columns(scene, columns, on_mass, compliance)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: columns(:)
      logical, intent(in) :: on_mass
      type(compliance_type), intent(inout) :: compliance
      integer :: j, status

      call column_motions(scene, columns, on_mass, compliance%x)
      allocate (compliance%w(size(columns), size(columns)), stat=status)
      call check_allocation(status)
      compliance%w = 0.0_wp
      do j = 1, size(columns)
         if (columns(j) == 0) cycle
         compliance%w(:, j) = row_motion(scene, compliance, compliance%x(:, j))
      end do
   end subroutine solve_for_columns

   !> Motions by unit forces along the normals of rows, or behind all rows along their tangents;
   !> a column 0 is zero.
   subroutine column_motions(scene, columns, on_mass, x)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: columns(:)
      logical, intent(in) :: on_mass
      real(wp), allocatable, intent(out) :: x(:, :)   !! (n_freedoms, size(columns))
      integer :: j, n_freedoms, status

      n_freedoms = scene%system%structure%map%n_freedoms
      allocate (x(n_freedoms, size(columns)), stat=status)
      call check_allocation(status)
      if (size(columns) == 0) return
      do j = 1, size(columns)
         if (columns(j) == 0) then
            x(:, j) = 0.0_wp
         else if (columns(j) > scene%rows%n) then
            x(:, j) = slip_vector(scene%rows, columns(j) - scene%rows%n, n_freedoms)
         else
            x(:, j) = row_vector(scene%rows, columns(j), n_freedoms)
         end if
      end do
      call solve_together(scene%system, on_mass, x)
   end subroutine column_motions

   !> Motion by forces, or impulses, in the rows that take part.
   function pushed(scene, compliance, forces) result(motion)
      type(scene_type), intent(in) :: scene
      type(compliance_type), intent(in) :: compliance
      real(wp), intent(in) :: forces(:)          !! (n or 2 n)
      real(wp), dimension(scene%system%structure%map%n_freedoms) :: motion
      integer :: pushing(size(forces)), n, j

      if (compliance%shelf == 0) then
         motion = matmul(compliance%x, forces)
         return
      end if
      n = 0
      do j = 1, size(forces)
         if (compliance%place(j) == 0 .or. abs(forces(j)) <= 0.0_wp) cycle
         n = n + 1
         pushing(n) = j
      end do
      call add_columns(scene%compliances%shelves(compliance%shelf), compliance%place(pushing(:n)), &
            forces(pushing(:n)), motion)
   end function pushed

   !> The motions by unit forces in the rows that take part.
   function unit_motions(scene, compliance) result(x)
      type(scene_type), intent(in) :: scene
      type(compliance_type), intent(in) :: compliance
      real(wp) :: x(scene%system%structure%map%n_freedoms, size(compliance%w, 1))
      real(wp) :: unit(size(x, 2))
      integer :: j

      do j = 1, size(x, 2)
         unit = 0.0_wp
         unit(j) = 1.0_wp
         x(:, j) = pushed(scene, compliance, unit)
      end do
   end function unit_motions

   !> [G; T] u of the rows that take part; nothing along the tangent of rows without friction.
   pure function row_motion(scene, compliance, u) result(motion)
      type(scene_type), intent(in) :: scene
      type(compliance_type), intent(in) :: compliance
      real(wp), intent(in) :: u(:)               !! (n_freedoms)
      real(wp) :: motion(compliance%n + size(compliance%rough))

      motion = join_rates(compliance, row_accelerations(scene%rows, u), &
            slip_products(scene%rows, u))
   end function row_motion

   !> Values along the normals and tangents of all rows as those of the rows that take part.
   pure function join_rates(compliance, normal, tangential) result(joined)
      type(compliance_type), intent(in) :: compliance
      real(wp), intent(in) :: normal(:), tangential(:)   !! (n_rows)
      real(wp) :: joined(compliance%n + size(compliance%rough))

      joined(:compliance%n) = normal(compliance%rows)
      if (size(compliance%rough) == 0) return
      joined(compliance%n + 1:) = merge(tangential(compliance%rows), 0.0_wp, compliance%rough)
   end function join_rates

   !> Forces or impulses of the rows that take part as those of all rows, the others as they are.
   pure subroutine split_forces(compliance, joined, normal, tangential)
      type(compliance_type), intent(in) :: compliance
      real(wp), intent(in) :: joined(:)
      real(wp), intent(inout) :: normal(:), tangential(:)   !! (n_rows)

      normal(compliance%rows) = joined(:compliance%n)
      if (size(compliance%rough) == 0) return
      tangential(compliance%rows) = joined(compliance%n + 1:)
   end subroutine split_forces

end module row_compliance
