!> Which freedoms, schemes and masses a state belongs to: later steps of the deck, which may change,
!> have a say in them.
module state_structure
   use errors, only: error_type
   use text, only: to_text
   use memory_shortage, only: check_allocation
   use mesh, only: scheme_explicit
   use places, only: place_type, fail_at
   use state_archive, only: archive_type
   use scene_setup, only: simulation_type
   implicit none
   private

   public :: pass_structure

   character(len=*), parameter :: cure = &
         'leave this step out, or run the deck with it from its start'

contains

   !> Keeps what the state belongs to, or compares it with what the deck makes now. Error: the steps
   !> behind the one reached bring freedoms, or change how elements are computed.
   subroutine pass_structure(simulation, i_step, archive, error)
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step              !! reached
      type(archive_type), intent(inout) :: archive
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: freedom(:), before(:)

      associate (map => simulation%scene%system%structure%map)
         freedom = 4*map%node + map%dof
      end associate
      before = freedom
      call archive%pass('structure/freedom', before)
      call archive%demand('structure/freedom', allocated(before))
      if (allocated(archive%problem)) return
      if (archive%reading) call compare_freedoms(simulation, i_step, freedom, before, error)
      if (allocated(error)) return
      call find_schemes(simulation, freedom)
      before = freedom
      call archive%pass('structure/scheme', before)
      call archive%demand('structure/scheme', allocated(before))
      if (allocated(archive%problem)) return
      if (archive%reading) call compare_schemes(simulation, i_step, freedom, before, error)
   end subroutine pass_structure

   !> The scheme of each element as the deck has it, and whether its mass is lumped.
   subroutine find_schemes(simulation, scheme)
      type(simulation_type), intent(in) :: simulation
      integer, allocatable, intent(inout) :: scheme(:)   !! (n_elements) 2 scheme + (1: lumped)
      integer :: g, status

      deallocate (scheme)
      allocate (scheme(simulation%model%elements%n), source=0, stat=status)
      call check_allocation(status)
      associate (groups => simulation%scene%system%structure%groups)
         do g = 1, size(groups)
            scheme(groups(g)%member) = 2*simulation%deck_scheme(g) + merge(1, 0, groups(g)%lumped)
         end do
      end associate
   end subroutine find_schemes

   subroutine compare_freedoms(simulation, i_step, now, before, error)
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step
      integer, intent(in) :: now(:), before(:)   !! (n_freedoms) 4 node + direction
      type(error_type), allocatable, intent(out) :: error
      logical, dimension(4*simulation%model%nodes%n + 3) :: has, had
      integer :: f

      if (size(now) == size(before)) then
         if (all(now == before)) return
      end if
      has = .false.
      had = .false.
      has(now) = .true.
      do f = 1, size(before)
         if (before(f) > 3 .and. before(f) <= size(had)) had(before(f)) = .true.
      end do
      f = findloc(has .neqv. had, .true., dim=1)
      if (f == 0) then
         call order_differs(simulation, i_step, error)
         return
      end if
      associate (nodes => simulation%model%nodes)
         if (has(f)) then
            call fail_at(error, simulation%model%source, naming_place(simulation, i_step, f), &
                  'the state has no freedom '//to_text(modulo(f, 4))//' of node ' &
                  //to_text(nodes%id(f/4))//', which nothing named when the run was begun', cure)
         else
            call fail_at(error, simulation%model%source, later_place(simulation, i_step), &
                  'the state has a freedom '//to_text(modulo(f, 4))//' of node ' &
                  //to_text(nodes%id(f/4))//', which no later step names any more', &
                  'let a later step name it again, or run the deck from its start')
         end if
      end associate
   end subroutine compare_freedoms

   subroutine order_differs(simulation, i_step, error)
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step
      type(error_type), allocatable, intent(out) :: error

      call fail_at(error, simulation%model%source, later_place(simulation, i_step), &
            'the freedoms of the state stand in another order', cure)
   end subroutine order_differs

   subroutine compare_schemes(simulation, i_step, now, before, error)
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step
      integer, intent(in) :: now(:), before(:)   !! (n_elements)
      type(error_type), allocatable, intent(out) :: error
      integer :: e

      e = 0
      if (size(now) == size(before)) then
         e = findloc(now /= before, .true., dim=1)
         if (e == 0) return
      end if
      if (e == 0) then
         call order_differs(simulation, i_step, error)
         return
      end if
      call fail_at(error, simulation%model%source, later_place(simulation, i_step), &
            'with this step element '//to_text(simulation%model%elements%id(e))//' is ' &
            //described(now(e))//' throughout, in the state it is '//described(before(e)), cure)
   end subroutine compare_schemes

   pure function described(scheme) result(text)
      integer, intent(in) :: scheme
      character(len=:), allocatable :: text

      text = 'implicit'
      if (scheme/2 == scheme_explicit) text = 'explicit'
      if (modulo(scheme, 2) == 1) then
         text = text//' with lumped mass'
      else
         text = text//' with consistent mass'
      end if
   end function described

   !> Where a step behind the one reached names a freedom; else that step.
   pure function naming_place(simulation, i_step, freedom) result(place)
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step, freedom     !! 4 node + direction
      type(place_type) :: place
      integer :: s, i

      place = later_place(simulation, i_step)
      do s = i_step + 1, size(simulation%model%steps)
         associate (step => simulation%model%steps(s))
            i = findloc(4*step%boundaries%node + step%boundaries%dof, freedom, dim=1)
            if (i > 0) place = step%boundaries(i)%place
            if (i > 0) return
            i = findloc(4*step%loads%node + step%loads%dof, freedom, dim=1)
            if (i > 0) place = step%loads(i)%place
            if (i > 0) return
            associate (velocities => step%initial_velocities)
               i = findloc(4*velocities%node + velocities%dof, freedom, dim=1)
               if (i > 0) place = velocities(i)%place
               if (i > 0) return
            end associate
         end associate
      end do
   end function naming_place

   !> The step behind the one reached, if there is one.
   pure function later_place(simulation, i_step) result(place)
      type(simulation_type), intent(in) :: simulation
      integer, intent(in) :: i_step
      type(place_type) :: place

      place = simulation%model%steps(min(i_step + 1, size(simulation%model%steps)))%place
   end function later_place

end module state_structure
