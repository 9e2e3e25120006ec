!> Words of CalculiX and Abaqus decks, as gmsh and FreeCAD write them, that have no meaning here:
!> what to write instead.
module foreign_words
   use words, only: squeezed, find_word
   implicit none
   private

   public :: type_cure, keyword_cure

   integer, parameter :: cure_length = 160

   !> Beginnings of element types, and what to do about them.
   integer, parameter :: n_types = 14
   character(len=8), parameter :: types(n_types) = [character(len=8) :: &
         'M3D9', 'M3D', 'C3D', 'STRI', 'SC6', 'SC8', 'S3', 'S4', 'S6', 'S8', 'B2', 'B3', 'CONN3D', &
         'DCOUP3D']
   integer, parameter :: type_cures(n_types) = [1, 2, 3, 4, 4, 4, 4, 4, 4, 4, 5, 5, 6, 6]
   character(len=cure_length), parameter :: cures_of_types(6) = [character(len=cure_length) :: &
         'quadrilaterals have 4 or 8 nodes: in gmsh set Mesh.SecondOrderIncomplete = 1 before '// &
         'the mesh is made', &
         'membranes do not exist here: write CPE, CPS or CAX elements; in FreeCAD set the '// &
         'model space of the solver', &
         'bodies are plane or axisymmetric: mesh a surface in the x, y plane; in gmsh leave '// &
         'out the volumes', &
         'shells do not exist here: write CPE, CPS or CAX elements; in FreeCAD set the model '// &
         'space of the solver', &
         'beams do not exist here: trusses are T2D2 and T3D2, lines without section T2D3, T3D3', &
         'leave it out: no element here does the like']

   integer, parameter :: n_keywords = 61, keyword_length = 40
   character(len=keyword_length), parameter :: keywords(n_keywords) = &
         [character(len=keyword_length) :: &
         'SURFACE BEHAVIOR', 'SHELL SECTION', 'MEMBRANE SECTION', 'BEAM SECTION', 'CONTROLS', &
         'EXPANSION', 'CONDUCTIVITY', 'SPECIFIC HEAT', 'PHYSICAL CONSTANTS', 'HEAT TRANSFER', &
         'COUPLED TEMPERATURE-DISPLACEMENT', 'UNCOUPLED TEMPERATURE-DISPLACEMENT', &
         'TEMPERATURE', 'FILM', 'RADIATE', 'CFLUX', 'DFLUX', &
         'TIE', 'RIGID BODY', 'MPC', 'COUPLING', 'KINEMATIC', 'KINEMATIC COUPLING', &
         'DISTRIBUTING', 'DISTRIBUTING COUPLING', &
         'TRANSFORM', 'SECTION PRINT', 'BUCKLE', 'NO ANALYSIS', &
         'DSLOAD', 'VISCO', 'CREEP', 'TIME POINTS', 'MODAL DAMPING', &
         'MODAL DYNAMIC', 'STEADY STATE DYNAMICS', 'RANDOM RESPONSE', 'RESPONSE SPECTRUM', &
         'COMPLEX FREQUENCY', &
         'PART', 'END PART', 'INSTANCE', 'END INSTANCE', 'ASSEMBLY', 'END ASSEMBLY', &
         'ORIENTATION', 'HYPERELASTIC', 'HYPERFOAM', 'USER MATERIAL', 'VISCOELASTIC', &
         'CONTACT', 'CONTACT INCLUSIONS', 'CONTACT PROPERTY ASSIGNMENT', 'CONTACT CONTROLS', &
         'SECTION CONTROLS', 'HOURGLASS STIFFNESS', &
         'BULK VISCOSITY', 'FIXED MASS SCALING', 'VARIABLE MASS SCALING', &
         'MONITOR', 'MODEL CHANGE']
   integer, parameter :: keyword_cures(n_keywords) = [1, 2, 2, 2, 3, 4, 4, 4, 4, 4, 4, 4, &
         4, 4, 4, 4, 4, 5, 5, 5, 5, 5, 5, 5, 5, 6, 7, 8, 9, &
         10, 11, 11, 12, 13, 14, 14, 14, 14, 15, 16, 16, 16, 16, 16, 16, 17, 18, 18, 18, 18, &
         19, 19, 19, 20, 21, 21, 22, 22, 22, 23, 24]
   character(len=cure_length), parameter :: cures_of_keywords(24) = [character(len=cure_length) :: &
         'write *IMPACT in its place: METHOD=TRANSFORMATION, or METHOD=PENALTY with STIFFNESS', &
         'write *SOLID SECTION for CPE, CPS or CAX elements', &
         'remove it: what ends Newton''s method is fixed; *STATIC has dt min, dt max', &
         'remove it: there are no temperatures here', &
         'write *EQUATION for single freedoms, or give both parts the same nodes', &
         'freedoms are along x and y: write *EQUATION for a slanted support', &
         'write *NODE PRINT with RF for the nodes of a support', &
         'write *FREQUENCY or *DYNAMIC: loads of buckling are not computed', &
         'write *STATIC, and call carom check', &
         'write *DLOAD: a line is element or set, P1 to P4, pressure; P1 is the edge from node '// &
         '1 to 2, as S1 of *SURFACE', &
         'there is no creep here: without it *STATIC has the place of *VISCO', &
         'remove it: FREQUENCY=n on *NODE FILE and the like records every n-th increment', &
         'write *DAMPING, ALPHA=, BETA= in *MATERIAL: it damps in *DYNAMIC', &
         'write *DYNAMIC: motion is computed in time, not by modes', &
         'write *FREQUENCY: modes are those without damping', &
         'write the deck without parts: Abaqus/CAE does with "Do not use parts and assemblies '// &
         'in input files" of the model''s attributes', &
         'remove it: materials are isotropic', &
         'materials have *ELASTIC, and *PLASTIC if they yield', &
         'write *CONTACT PAIR for each two surfaces that may touch', &
         'remove it: how contact is solved is a matter of *IMPACT', &
         'remove it: elements have the settings of *SOLID SECTION and *ELEMENT GROUP alone', &
         'remove it: there is neither artificial viscosity nor scaled mass here', &
         'remove it: *NODE PRINT records single nodes', &
         'remove it: all elements and pairs take part in all steps']

contains

   !> What to do about an element type of others; empty if there is nothing to say.
   pure function type_cure(name) result(cure)
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: cure
      character(len=:), allocatable :: wanted
      integer :: i

      cure = ''
      wanted = squeezed(name)
      do i = 1, n_types
         if (index(wanted, trim(types(i))) /= 1) cycle
         cure = trim(cures_of_types(type_cures(i)))
         return
      end do
   end function type_cure

   !> What to do about a keyword of others; empty if there is nothing to say.
   pure function keyword_cure(keyword) result(cure)
      character(len=*), intent(in) :: keyword
      character(len=:), allocatable :: cure
      integer :: i

      cure = ''
      i = find_word(keyword, keywords)
      if (i > 0) cure = trim(cures_of_keywords(keyword_cures(i)))
   end function keyword_cure

end module foreign_words
