!> Compliance of contact rows, along their normals and where there is friction along their tangents
!> too: on the effective matrix at hand by back-substitutions, or on the mass.
module row_compliance
   use kinds, only: wp
   use errors, only: error_type
   use equation_of_motion, only: solve_motion, prepare_mass, solve_mass
   use constraint_rows, only: row_accelerations, slip_products, row_vector, slip_vector
   use impact_scene, only: scene_type
   implicit none
   private

   public :: compliance_type, find_compliance, mass_compliance, row_motion, join_rates, split_forces

   !> Rows that take part. With friction on any of them, forces and motions have 2 n entries: those
   !> along the normals, then those along the tangents.
   type :: compliance_type
      integer :: n = 0
      integer, allocatable :: rows(:)            !! (n)
      logical, allocatable :: rough(:)           !! (n) with friction; of no size if none is
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
      integer :: j, n, n_freedoms

      n = size(rows)
      n_freedoms = scene%system%structure%map%n_freedoms
      compliance%n = n
      compliance%rows = rows
      compliance%rough = pack(rough, spread(any(rough), 1, n))
      associate (m => n + size(compliance%rough))
         allocate (compliance%x(n_freedoms, m), compliance%w(m, m))
      end associate
      compliance%x = 0.0_wp
      compliance%w = 0.0_wp
      do j = 1, n
         call add_column(row_vector(scene%rows, rows(j), n_freedoms), j)
         ! a row that slides off its surface in this step asks for nothing
         if (.not. scene%rows%facing(rows(j))) compliance%w(j, j) = 1.0_wp
      end do
      do j = 1, size(compliance%rough)
         if (compliance%rough(j) .and. scene%rows%facing(rows(j))) then
            call add_column(slip_vector(scene%rows, rows(j), n_freedoms), n + j)
         else
            ! no force there: any motion will do
            compliance%w(n + j, n + j) = compliance%w(j, j)
         end if
      end do
      compliance%w = (compliance%w + transpose(compliance%w))/2.0_wp

   contains

      subroutine add_column(force, k)
         real(wp), intent(in) :: force(:)
         integer, intent(in) :: k

         if (on_mass) then
            compliance%x(:, k) = solve_mass(scene%system, force)
         else
            compliance%x(:, k) = solve_motion(scene%system, force)
         end if
         compliance%w(:, k) = row_motion(scene, compliance, compliance%x(:, k))
      end subroutine add_column

   end subroutine build

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
