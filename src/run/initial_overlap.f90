!> The errors of nodes that overlap at the start of a run, or that prescribed displacements put
!> inside another body.
module initial_overlap
   use kinds, only: wp
   use errors, only: error_type
   use text, only: to_text
   use places, only: fail_at
   use model, only: model_type
   use contact_pairs, only: contact_pair_list_type
   use motion_state, only: state_type
   use constraint_rows, only: law_penalty, law_overlap, gap_size
   use row_placement, only: nodal_displacements
   use deep_overlap, only: find_deep_nodes
   use impact_scene, only: scene_type, merge_gap_tolerance
   use wall_side, only: lies_behind, wall_cure
   use initial_contact, only: gaps_at_start, start_size, closed_tolerance
   implicit none
   private

   public :: check_overlaps, check_jump

   !> The mean gap over the sides around a node is negative where round bodies just touch: the
   !> functions of a curved side's ends are so on a part of it. That is no more than this part of
   !> the length which the node stands for.
   real(wp), parameter :: weighted_share = 0.05_wp
   !> The error of overlapping nodes names so many.
   integer, parameter :: most_named = 5
   !> Prescribed displacements that change by no more than this part of the size go on smoothly.
   real(wp), parameter :: jump_tolerance = 1.0e-10_wp

contains

   !> Nodes that overlap at the start are an error, which names the worst of the worst pair.
   subroutine check_overlaps(model, list, scene, start, error, cure)
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(in) :: list
      type(scene_type), intent(inout) :: scene
      type(state_type), intent(in) :: start
      type(error_type), allocatable, intent(out) :: error
      character(len=*), intent(in), optional :: cure   !! instead of the usual one
      character(len=:), allocatable :: advice
      real(wp) :: gaps(scene%rows%n), limit
      integer :: worst

      if (scene%rows%n == 0) return
      call gaps_at_start(scene, start, gaps)
      limit = max(merge_gap_tolerance*gap_size(scene%rows, start, 0.0_wp), &
            merge_gap_tolerance*scene%geometry%size, closed_tolerance*start_size(model, scene))
      where (gaps >= -weighted_share*scene%rows%weight) gaps = max(0.0_wp, gaps)
      worst = minloc(gaps, dim=1)
      if (gaps(worst) >= -limit) then
         if (.not. present(cure)) call check_depths(model, list, scene, start, error)
         return
      end if
      advice = overlap_cure(model, list%rows(worst)%model_pair, model%nodes%x(:, &
            :model%nodes%n) + nodal_displacements(scene%system%structure%map, start%d))
      if (present(cure)) advice = cure
      call fail_at(error, model%source, list%rows(worst)%place, &
            overlap_text(list, scene, &
            merge(gaps, 0.0_wp, list%rows%pair == list%rows(worst)%pair), limit), advice)
   end subroutine check_overlaps

   !> So are nodes inside their partner's body that are far from all of its sides.
   subroutine check_depths(model, list, scene, start, error)
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(in) :: list
      type(scene_type), intent(in) :: scene
      type(state_type), intent(in) :: start
      type(error_type), allocatable, intent(out) :: error
      logical :: deep(scene%rows%n)
      integer :: row

      call find_deep_nodes(model, list%rows, model%nodes%x(:, :model%nodes%n) &
            + nodal_displacements(scene%system%structure%map, start%d), deep)
      if (.not. any(deep)) return
      row = findloc(deep, .true., dim=1)
      call fail_at(error, model%source, list%rows(row)%place, 'node ' &
            //to_text(scene%rows%node_id(row))//' of '//trim(list%names(list%rows(row)%pair)) &
            //' lies deep inside its contact partner at the start', &
            'move the body, or give it an initial displacement without overlap')
   end subroutine check_depths

   !> So are nodes that the prescribed displacements of a dynamic step, which act at once, put
   !> inside another body.
   subroutine check_jump(model, list, scene, before, start, error)
      type(model_type), intent(in) :: model
      type(contact_pair_list_type), intent(in) :: list
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: before(:)          !! (n_freedoms) displacements without them
      type(state_type), intent(in) :: start      !! with them
      type(error_type), allocatable, intent(out) :: error

      ! what earlier steps have left of overlap is no error where overlap makes the force
      if (start%t > 0.0_wp .and. any(scene%rows%law == law_penalty .or. &
            scene%rows%law == law_overlap)) return
      if (.not. any(abs(start%d - before) > jump_tolerance*scene%geometry%size)) return
      call check_overlaps(model, list, scene, start, error, 'a displacement that *BOUNDARY ' &
            //'prescribes in a dynamic step acts at once: let it grow by an *AMPLITUDE')
   end subroutine check_jump

   function overlap_text(list, scene, gaps, limit) result(cause)
      type(contact_pair_list_type), intent(in) :: list
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: gaps(:)            !! (n_rows) of one pair, the others zero
      real(wp), intent(in) :: limit
      character(len=:), allocatable :: cause
      logical :: left(size(gaps))
      integer :: i, row

      row = minloc(gaps, dim=1)
      left = gaps < -limit
      if (count(left) == 1) then
         cause = 'node '//to_text(scene%rows%node_id(row))//' overlaps its contact partner by ' &
               //to_text(-gaps(row))//' at the start'
         return
      end if
      cause = to_text(count(left))//' nodes of '//trim(list%names(list%rows(row)%pair)) &
            //' overlap at the start'
      if (count(left) > most_named) cause = cause//', the worst of them'
      cause = cause//': '
      do i = 1, min(most_named, count(left))
         row = minloc(gaps, dim=1, mask=left)
         left(row) = .false.
         if (i > 1) cause = cause//', '
         cause = cause//'node '//to_text(scene%rows%node_id(row))//' by '//to_text(-gaps(row))
      end do
   end function overlap_text

   function overlap_cure(model, pair, x) result(cure)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair                !! index of the model's pair, 0: a gap element
      real(wp), intent(in) :: x(:, :)            !! (3, n_nodes) at the start
      character(len=:), allocatable :: cure
      logical :: behind

      behind = .false.
      if (pair > 0) behind = lies_behind(model, pair, x, .true.)
      if (pair == 0) then
         cure = 'give the gap a larger clearance, or an initial displacement without overlap'
      else if (behind) then
         cure = wall_cure(model, pair)
      else if (model%pairs(pair)%adjust) then
         cure = 'ADJUST could not put them where they overlap nothing: look at the surfaces there'
      else if (model%pairs(pair)%target == model%pairs(pair)%contactor) then
         cure = 'move the nodes apart, or give an initial displacement without overlap'
      else
         cure = 'move the body, give it an initial displacement without overlap, or write ADJUST ' &
               //'on *CONTACT PAIR: it brings these nodes onto the master'
      end if
   end function overlap_cure

end module initial_overlap
