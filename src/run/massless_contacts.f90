!> Contact of nodes without mass: the tip of a spring, for instance. Such a node has no velocity to
!> jump and gives way to whatever it meets, so its rows are closed on displacements at the end of
!> the step as those of MASS=REDISTRIBUTED are. Only a penalty needs nothing of the kind.
module massless_contacts
   use errors, only: error_type
   use kinds, only: wp
   use text, only: to_text
   use places, only: fail_at
   use model, only: model_type
   use equation_of_motion, only: system_type
   use contact_pairs, only: contact_pair_list_type, contact_row_type, row_fixed
   use constraint_rows, only: rows_type
   use row_placement, only: row_law
   implicit none
   private

   public :: mark_massless_rows

contains

   !> Marks the rows between whose sides no impulse can act, and gives them their law; to be called
   !> when the step's equations are known. Error: a restitution there.
   subroutine mark_massless_rows(model, list, system, rows, error)
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(in) :: list
      type(system_type), intent(in) :: system
      type(rows_type), intent(inout) :: rows
      type(error_type), allocatable, intent(out) :: error
      logical :: light
      integer :: i, node

      do i = 1, rows%n
         associate (row => list%rows(i))
            rows%massless(i) = .false.
            if (row%model_pair > 0) rows%massless(i) = model%pairs(row%model_pair)%redistributed
            node = row%node
            light = is_light(system, row, node)
            if (row%other > 0 .and. .not. light) then
               node = row%other
               light = is_light(system, row, node)
            end if
            rows%massless(i) = rows%massless(i) .or. light
            rows%law(i) = row_law(model%interactions(row%interaction)%method, rows%massless(i))
            if (.not. light .or. .not. rows%restitution(i) > 0.0_wp) cycle
            call fail_at(error, model%source, row%place, 'node ' &
                  //to_text(model%nodes%id(node))//' has no mass and cannot rebound: a ' &
                  //'RESTITUTION means nothing there', &
                  'give the node a mass, or leave RESTITUTION away: it then gives way to what ' &
                  //'it meets, without a jump')
            return
         end associate
      end do
   end subroutine mark_massless_rows

   !> A node that can move along the row's normal, by equations that all are without mass.
   pure function is_light(system, row, node) result(light)
      type(system_type), intent(in) :: system
      type(contact_row_type), intent(in) :: row
      integer, intent(in) :: node
      logical :: light
      integer :: k, f

      light = .false.
      associate (map => system%structure%map)
         do k = 1, 3
            f = map%freedom(k, node)
            if (f == 0) cycle
            ! normals of other kinds of rows turn
            if (row%kind == row_fixed .and. .not. abs(row%normal(k)) > 0.0_wp) cycle
            associate (equations => map%equation(map%first(f):map%first(f + 1) - 1))
               light = size(equations) > 0
               if (light) light = all(system%massless(equations))
            end associate
            if (.not. light) return
         end do
      end associate
   end function is_light

end module massless_contacts
