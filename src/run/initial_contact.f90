!> Contact at the start of a run: rows for the geometry of the deck, and ADJUST.
module initial_contact
   use kinds, only: wp
   use errors, only: error_type
   use text, only: to_text, plural
   use places, only: note_at, fail_at
   use model, only: model_type
   use element_sides, only: count_sides, side_nodes
   use contact_pairs, only: contact_pair_list_type, find_contact_rows
   use contact_geometry, only: new_contact_geometry, allow_gaps
   use motion_state, only: state_type
   use constraint_rows, only: row_gaps
   use row_placement, only: new_rows, place_rows, nodal_displacements
   use impact_scene, only: scene_type
   use wall_side, only: lies_behind, wall_cure
   implicit none
   private

   public :: adjustment_type, build_rows, adjust_pairs, adjustment_remark
   public :: gaps_at_start, start_size

   !> What ADJUST did to one pair.
   type :: adjustment_type
      integer :: pair = 0                        !! index of the model's pair
      integer :: n_moved = 0                     !! nodes brought onto the master
      real(wp) :: largest_move = 0.0_wp
      integer :: n_allowed = 0                   !! rows whose gap at the start counts as zero
      real(wp) :: largest_allowance = 0.0_wp
   end type adjustment_type

   !> Gaps of moved nodes are closed to this part of the geometry's size.
   real(wp), parameter, public :: closed_tolerance = 1.0e-14_wp
   !> Moved nodes may have other partners: so many rounds at most.
   integer, parameter :: max_rounds = 10
   integer, parameter :: max_sweeps = 500

contains

   !> The contact rows of a model on the freedoms of the structure, in the undeformed geometry.
   subroutine build_rows(model, list, scene, error)
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(out) :: list
      type(scene_type), intent(inout) :: scene
      type(error_type), allocatable, intent(out) :: error

      call find_contact_rows(model, list, error)
      if (allocated(error)) return
      call new_contact_geometry(scene%geometry, model, list)
      call new_rows(scene%rows, scene%geometry, list, model, scene%system%structure, error)
   end subroutine build_rows

   !> ADJUST: slave nodes that overlap at the start, or are open by no more than the distance asked
   !> for, are moved onto the master without strain; middle nodes that are no slaves go with the
   !> ends of their sides. Rows weighted over sides and those of a second pass cannot be closed by
   !> nodal positions: what they overlap at the start counts as zero. The structure has to be built
   !> again if nodes have moved.
   subroutine adjust_pairs(model, list, scene, start, adjustments, error)
      type(model_type), intent(inout) :: model
      type(contact_pair_list_type), intent(inout) :: list
      type(scene_type), intent(inout) :: scene
      type(state_type), intent(in) :: start
      type(adjustment_type), allocatable, intent(out) :: adjustments(:)   !! of pairs with ADJUST
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: x(:, :)
      integer :: owner(model%nodes%n), round, i
      logical :: moved

      adjustments = [(adjustment_type(pair=i), i=1, size(model%pairs))]
      call check_walls(model, nodal_displacements(scene%system%structure%map, start%d), error)
      if (allocated(error)) return
      x = model%nodes%x
      owner = 0
      do round = 1, max_rounds
         call move_nodes(model, list, scene, start, owner, moved)
         if (.not. moved) exit
         call build_rows(model, list, scene, error)
         if (allocated(error)) return
      end do
      do i = 1, model%nodes%n
         if (owner(i) == 0) cycle
         associate (adjustment => adjustments(owner(i)))
            adjustment%n_moved = adjustment%n_moved + 1
            adjustment%largest_move = max(adjustment%largest_move, &
                  norm2(model%nodes%x(:, i) - x(:, i)))
         end associate
      end do
      call allow_remaining(model, list, scene, start, adjustments, error)
      adjustments = pack(adjustments, model%pairs%adjust)
   end subroutine adjust_pairs

   !> ADJUST would put a body that lies wholly behind a rigid surface flat on it: an error.
   subroutine check_walls(model, u, error)
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:, :)            !! (3, n_nodes) displacements at the start
      type(error_type), allocatable, intent(out) :: error
      integer :: p

      do p = 1, size(model%pairs)
         if (.not. model%pairs(p)%adjust .or. model%pairs(p)%rigid_target == 0) cycle
         if (.not. lies_behind(model, p, model%nodes%x(:, :model%nodes%n) + u, .false.)) cycle
         call fail_at(error, model%source, model%pairs(p)%place, 'ADJUST: ' &
               //trim(model%surfaces(model%pairs(p)%contactor)%name)//' is on the wrong side of ' &
               //trim(model%rigid_surfaces(model%pairs(p)%rigid_target)%name), &
               wall_cure(model, p))
         return
      end do
   end subroutine check_walls

   !> One round: every slave node onto the partners that it has now.
   subroutine move_nodes(model, list, scene, start, owner, moved)
      type(model_type), intent(inout) :: model
      type(contact_pair_list_type), intent(in) :: list
      type(scene_type), intent(inout) :: scene
      type(state_type), intent(in) :: start
      integer, intent(inout) :: owner(:)         !! (n_nodes) pair that moved a node, 0: none
      logical, intent(out) :: moved
      real(wp) :: gaps(scene%rows%n), move(3, model%nodes%n)
      logical :: wanted(scene%rows%n)
      integer :: i

      call gaps_at_start(scene, start, gaps)
      wanted = is_wanted(model, list, scene, gaps) .and. .not. by_allowance(model, list)
      moved = any(wanted)
      if (.not. moved) return
      do i = 1, size(gaps)
         if (wanted(i)) owner(list%rows(i)%node) = list%rows(i)%model_pair
      end do
      call find_moves(list, scene, gaps, merge(1, 0, wanted) &
            + merge(1, 0, has_adjust(model, list) .and. .not. by_allowance(model, list)), move)
      call move_middle_nodes(model, move)
      model%nodes%x(:, :model%nodes%n) = model%nodes%x(:, :model%nodes%n) + move
   end subroutine move_nodes

   !> The moves that open overlaps and close gaps, by one row after the other until all are content:
   !> a node may be in the corner of several partners, and must not be moved into another.
   pure subroutine find_moves(list, scene, gaps, role, move)
      type(contact_pair_list_type), intent(in) :: list
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: gaps(:)            !! (n_rows)
      integer, intent(in) :: role(:)             !! (n_rows) 0: none, 1: stays open, 2: is closed
      real(wp), intent(out) :: move(:, :)        !! (3, n_nodes)
      real(wp) :: left, largest
      integer :: i, sweep

      move = 0.0_wp
      do sweep = 1, max_sweeps
         largest = 0.0_wp
         do i = 1, size(gaps)
            if (role(i) == 0 .or. .not. scene%rows%facing(i)) cycle
            associate (normal => scene%rows%normal(:, i), own => move(:, list%rows(i)%node))
               left = gaps(i) + dot_product(normal, own)
               if (role(i) == 1 .or. gaps(i) < 0.0_wp) left = min(0.0_wp, left)
               own = own - left*normal
            end associate
            largest = max(largest, abs(left))
         end do
         if (largest <= closed_tolerance*maxval(abs(move))) return
      end do
   end subroutine find_moves

   !> Middle nodes of solids that are on no slave surface of ADJUST go half the way of both ends of
   !> their side: straight sides stay straight.
   subroutine move_middle_nodes(model, move)
      type(model_type), intent(in) :: model
      real(wp), intent(inout) :: move(:, :)      !! (3, n_nodes)
      logical :: slave(model%nodes%n)
      integer :: e, side, nodes(3)

      slave = .false.
      do e = 1, size(model%pairs)
         if (model%pairs(e)%adjust) slave(model%surfaces(model%pairs(e)%contactor)%nodes) = .true.
      end do
      do e = 1, model%elements%n
         do side = 1, count_sides(model%elements%kind(e))
            nodes = side_nodes(model%elements, e, side)
            if (nodes(3) == 0) exit
            if (slave(nodes(3))) cycle
            move(:, nodes(3)) = (move(:, nodes(1)) + move(:, nodes(2)))/2.0_wp
         end do
      end do
   end subroutine move_middle_nodes

   !> Takes the gaps that are left as zero where nodal positions cannot close them.
   subroutine allow_remaining(model, list, scene, start, adjustments, error)
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(in) :: list
      type(scene_type), intent(inout) :: scene
      type(state_type), intent(in) :: start
      type(adjustment_type), intent(inout) :: adjustments(:)   !! (n_pairs)
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: gaps(scene%rows%n)
      logical :: wanted(scene%rows%n)
      integer :: i

      call gaps_at_start(scene, start, gaps)
      wanted = is_wanted(model, list, scene, gaps) .and. by_allowance(model, list)
      if (.not. any(wanted)) return
      do i = 1, size(gaps)
         if (.not. wanted(i)) cycle
         associate (adjustment => adjustments(list%rows(i)%model_pair))
            adjustment%n_allowed = adjustment%n_allowed + 1
            adjustment%largest_allowance = max(adjustment%largest_allowance, abs(gaps(i)))
         end associate
      end do
      call allow_gaps(scene%geometry, merge(gaps, 0.0_wp, wanted))
      call new_rows(scene%rows, scene%geometry, list, model, scene%system%structure, error)
   end subroutine allow_remaining

   !> Rows of pairs with ADJUST whose gap at the start is to be closed.
   pure function is_wanted(model, list, scene, gaps) result(wanted)
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(in) :: list
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: gaps(:)            !! (n_rows)
      logical :: wanted(size(gaps))
      real(wp) :: limit
      integer :: i

      wanted = .false.
      limit = closed_tolerance*start_size(model, scene)
      do i = 1, size(gaps)
         if (list%rows(i)%model_pair == 0 .or. .not. scene%rows%facing(i)) cycle
         associate (pair => model%pairs(list%rows(i)%model_pair))
            wanted(i) = pair%adjust .and. gaps(i) <= pair%adjust_distance .and. &
                  abs(gaps(i)) > limit
         end associate
      end do
   end function is_wanted

   !> Rows of pairs with ADJUST.
   pure function has_adjust(model, list) result(has)
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(in) :: list
      logical :: has(size(list%rows))
      integer :: i

      has = .false.
      do i = 1, size(has)
         if (list%rows(i)%model_pair > 0) has(i) = model%pairs(list%rows(i)%model_pair)%adjust
      end do
   end function has_adjust

   !> Rows that ADJUST closes by an allowance.
   pure function by_allowance(model, list) result(by)
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(in) :: list
      logical :: by(size(list%rows))
      integer :: i

      by = list%rows%pass == 2
      do i = 1, size(by)
         if (list%rows(i)%model_pair == 0) cycle
         associate (pair => model%pairs(list%rows(i)%model_pair))
            by(i) = by(i) .or. (pair%weighted .and. pair%target > 0)
         end associate
      end do
   end function by_allowance

   !> What round-off of the geometry is relative to: its extent, or how far it is from the origin.
   pure function start_size(model, scene) result(length)
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      real(wp) :: length

      length = max(scene%geometry%size, maxval(abs(model%nodes%x(:, :model%nodes%n))))
   end function start_size

   subroutine gaps_at_start(scene, start, gaps)
      type(scene_type), intent(inout) :: scene
      type(state_type), intent(in) :: start
      real(wp), intent(out) :: gaps(:)           !! (n_rows)

      call place_rows(scene%rows, scene%geometry, scene%system%structure%map, start, start, &
            huge(1.0_wp))
      gaps = row_gaps(scene%rows, start)
   end subroutine gaps_at_start

   !> A line for the log on what ADJUST did.
   function adjustment_remark(model, list, adjustment) result(remark)
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(in) :: list
      type(adjustment_type), intent(in) :: adjustment
      character(len=:), allocatable :: remark
      integer :: row

      row = findloc(list%rows%model_pair, adjustment%pair, dim=1)
      remark = 'ADJUST of '//trim(list%names(list%rows(row)%pair))
      if (adjustment%n_moved > 0) then
         remark = remark//' moved '//plural(adjustment%n_moved, 'node')//', by at most ' &
               //to_text(adjustment%largest_move)
      else if (adjustment%n_allowed == 0) then
         remark = remark//' found nothing to move'
      end if
      if (adjustment%n_moved*adjustment%n_allowed > 0) remark = remark//','
      if (adjustment%n_allowed > 0) remark = remark//' took the gap of ' &
            //plural(adjustment%n_allowed, 'node')//' at the start as zero, at most ' &
            //to_text(adjustment%largest_allowance)
      remark = note_at(model%source, model%pairs(adjustment%pair)%place, remark)
   end function adjustment_remark

end module initial_contact
