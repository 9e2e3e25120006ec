!> What in a deck is legal and yet most often a mistake: remarks that name the cure. What is wrong
!> for certain is an error where it is read.
module deck_doubts
   use kinds, only: wp
   use text, only: to_text, plural
   use places, only: note_at
   use mesh, only: is_solid_kind, solid_plane, solid_topology, solid_reduced, plane_stress, &
         tri3, quad4
   use element_types, only: kind_name
   use steps, only: procedure_frequency, is_frame_request
   use model, only: model_type
   use continuum_bodies, only: body_list_type
   use contact_outlook, only: side_spacing
   use wave_speeds, only: material_of
   use bending_doubts, only: doubt_bending
   use surface_sides, only: doubt_sides
   use unit_doubts, only: doubt_units
   use scene_setup, only: simulation_type, add_remark
   implicit none
   private

   public :: doubt_deck

   !> A slave whose nodes are so many times as far apart as its master's.
   real(wp), parameter :: much_coarser = 1.5_wp
   !> Poisson's ratio from which elements of constant volume lock.
   real(wp), parameter :: nearly_incompressible(2) = [0.45_wp, 0.48_wp]   !! triangles, others

contains

   !> Remarks on the model of a scene that has been built.
   subroutine doubt_deck(simulation, bodies)
      type(simulation_type), intent(inout) :: simulation
      type(body_list_type), intent(in) :: bodies

      call doubt_units(simulation)
      call doubt_output(simulation)
      call doubt_frames(simulation)
      if (any(is_solid_kind(simulation%model%elements%kind(:simulation%model%elements%n)))) then
         call doubt_elements(simulation)
         call doubt_bending(simulation, bodies)
      end if
      call doubt_sides(simulation)
      call doubt_order(simulation)
      call doubt_restitution(simulation, bodies)
   end subroutine doubt_deck

   !> A deck that asks for nothing; modes are written unasked.
   subroutine doubt_output(simulation)
      type(simulation_type), intent(inout) :: simulation
      integer :: s

      associate (steps => simulation%model%steps)
         if (any(steps%procedure == procedure_frequency)) return
         do s = 1, size(steps)
            if (size(steps(s)%requests) > 0) return
         end do
         call add_remark(simulation, note_at(simulation%model%source, steps(1)%place, 'warning: ' &
               //'no output is asked for: the results will have frames of the start and the end ' &
               //'of a step only, no history and no energies'//new_line('a') &
               //'  cure: in *STEP write *NODE PRINT with U, V for histories, *NODE FILE with U ' &
               //'and *EL FILE with S for frames, *CONTACT PRINT with CF, CDIS, and *ENERGY PRINT'))
      end associate
   end subroutine doubt_output

   !> Frames of states asked for where the grid holds modes.
   subroutine doubt_frames(simulation)
      type(simulation_type), intent(inout) :: simulation
      integer :: s, r

      associate (steps => simulation%model%steps)
         if (.not. any(steps%procedure == procedure_frequency)) return
         do s = 1, size(steps)
            if (steps(s)%procedure == procedure_frequency) cycle
            do r = 1, size(steps(s)%requests)
               if (.not. is_frame_request(steps(s)%requests(r))) cycle
               call add_remark(simulation, note_at(simulation%model%source, &
                     steps(s)%requests(r)%place, 'warning: with a *FREQUENCY step all frames ' &
                     //'are modes: this step records none'//new_line('a')//'  cure: run it in a ' &
                     //'deck without *FREQUENCY too, or write *NODE PRINT and *EL PRINT'))
               return
            end do
         end do
      end associate
   end subroutine doubt_frames

   !> Elements that lock near incompressibility: linear triangles always, CPE4 and CAX4 unless their
   !> volumetric strain is averaged or their quadrature is reduced.
   subroutine doubt_elements(simulation)
      type(simulation_type), intent(inout) :: simulation
      logical :: told(size(simulation%model%sections))
      integer :: e
      character(len=:), allocatable :: why

      told = .false.
      associate (model => simulation%model)
         do e = 1, model%elements%n
            if (.not. is_solid_kind(model%elements%kind(e))) cycle
            if (told(model%elements%section(e))) cycle
            why = locking_cause(model, e)
            if (len(why) == 0) cycle
            told(model%elements%section(e)) = .true.
            call add_remark(simulation, note_at(model%source, &
                  model%sections(model%elements%section(e))%place, 'warning: elements ' &
                  //kind_name(model%elements%kind(e))//' lock, they are far too stiff, ' &
                  //why//' (element '//to_text(model%elements%id(e))//')'//new_line('a') &
                  //'  cure: '//locking_cure(model%elements%kind(e))))
         end do
      end associate
   end subroutine doubt_elements

   !> Why an element locks; nothing if it does not.
   pure function locking_cause(model, e) result(why)
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      character(len=:), allocatable :: why
      real(wp) :: limit

      why = ''
      associate (kind => model%elements%kind(e), material => model%materials(material_of(model, e)))
         if (solid_plane(kind) == plane_stress .or. solid_reduced(kind)) return
         if (model%sections(model%elements%section(e))%b_bar) return
         limit = huge(1.0_wp)
         if (solid_topology(kind) == tri3) limit = nearly_incompressible(1)
         if (solid_topology(kind) == quad4) limit = nearly_incompressible(2)
         if (solid_topology(kind) == tri3 .and. material%has_plastic) why = 'where ' &
               //trim(material%name)//' yields'
         if (material%poisson >= limit) why = 'with a Poisson''s ratio of ' &
               //to_text(material%poisson)
      end associate
   end function locking_cause

   pure function locking_cure(kind) result(cure)
      integer, intent(in) :: kind
      character(len=:), allocatable :: cure
      character(len=3) :: family

      family = kind_name(kind)
      if (solid_topology(kind) == quad4) then
         cure = 'BBAR=YES on *SOLID SECTION, or '//family//'8R'
      else
         cure = 'mesh with '//family//'6, '//family//'8R, or '//family//'4 with BBAR=YES on ' &
               //'*SOLID SECTION'
      end if
   end function locking_cure

   !> A slave much coarser than its master, of which nodes may pass between the slave's.
   subroutine doubt_order(simulation)
      type(simulation_type), intent(inout) :: simulation
      real(wp) :: slave, master
      integer :: p

      associate (model => simulation%model)
         do p = 1, size(model%pairs)
            associate (pair => model%pairs(p))
               if (pair%target == 0 .or. pair%target == pair%contactor) cycle
               if (pair%weighted .or. pair%passes == 2) cycle
               slave = side_spacing(model, model%surfaces(pair%contactor))
               master = side_spacing(model, model%surfaces(pair%target))
               if (.not. slave > much_coarser*master) cycle
               call add_remark(simulation, note_at(model%source, pair%place, 'warning: the nodes ' &
                     //'of the slave '//trim(model%surfaces(pair%contactor)%name)//' are ' &
                     //to_text(slave/master, 2)//' times as far apart as those of the master ' &
                     //trim(model%surfaces(pair%target)%name)//': the master can pass between ' &
                     //'them'//new_line('a')//'  cure: exchange them, ' &
                     //trim(model%surfaces(pair%target)%name)//', ' &
                     //trim(model%surfaces(pair%contactor)%name) &
                     //' (the finer surface is the slave), or write TYPE=SURFACE TO SURFACE or ' &
                     //'PASSES=2'))
            end associate
         end do
      end associate
   end subroutine doubt_order

   !> A restitution on nodes of bodies that deform: each node would bounce for itself.
   subroutine doubt_restitution(simulation, bodies)
      type(simulation_type), intent(inout) :: simulation
      type(body_list_type), intent(in) :: bodies
      integer :: p, n

      associate (model => simulation%model)
         do p = 1, size(model%pairs)
            associate (pair => model%pairs(p), law => model%interactions(model%pairs(p) &
                  %interaction))
               if (.not. law%has_restitution .or. .not. law%restitution > 0.0_wp) cycle
               n = count(bodies%of_node(model%surfaces(pair%contactor)%nodes) > 0)
               if (n == 0) cycle
               call add_remark(simulation, note_at(model%source, law%place, 'warning: ' &
                     //'RESTITUTION='//to_text(law%restitution)//' acts on '//plural(n, 'node') &
                     //' of a body that deforms ('//trim(model%surfaces(pair%contactor)%name) &
                     //'): every node bounces for itself, and contact chatters'//new_line('a') &
                     //'  cure: leave RESTITUTION away, the body rebounds by its elasticity; ' &
                     //'RESTITUTION is for rigid masses'))
            end associate
         end do
      end associate
   end subroutine doubt_restitution

end module deck_doubts
