!> The whole deck as data: what the scene is, with no formula and no syntax in it.
module model
   use mesh, only: node_table_type, element_table_type, set_type, element_group_type
   use properties, only: material_type, section_type
   use surfaces, only: surface_type, rigid_surface_type, interaction_type, contact_pair_type
   use histories, only: amplitude_type, boundary_type, nodal_value_type, equation_type
   use steps, only: step_type
   use places, only: source_type, source_line_type
   use name_map, only: name_map_type
   implicit none
   private

   public :: model_type

   !> Everything the deck said; references between parts are indices, 0 for none.
   type :: model_type
      type(source_type) :: source
      character(len=:), allocatable :: heading
      type(node_table_type) :: nodes
      type(element_table_type) :: elements
      type(set_type), allocatable :: node_sets(:), element_sets(:)
      type(material_type), allocatable :: materials(:)
      type(section_type), allocatable :: sections(:)
      type(element_group_type), allocatable :: groups(:)
      type(amplitude_type), allocatable :: amplitudes(:)
      type(surface_type), allocatable :: surfaces(:)
      type(rigid_surface_type), allocatable :: rigid_surfaces(:)
      type(interaction_type), allocatable :: interactions(:)
      type(contact_pair_type), allocatable :: pairs(:)
      type(equation_type), allocatable :: equations(:)
      type(boundary_type), allocatable :: boundaries(:)
      type(nodal_value_type), allocatable :: initial_displacements(:)
      type(nodal_value_type), allocatable :: initial_velocities(:)
      type(step_type), allocatable :: steps(:)
      type(source_line_type), allocatable :: notes(:)   !! remarks on the deck, for the log
      !> Names to indices
      type(name_map_type) :: node_set_of, element_set_of, material_of, amplitude_of
      type(name_map_type) :: surface_of, rigid_surface_of, interaction_of
      integer :: compression = 0                 !! level of the results' compression, 0 to 9
   end type model_type

end module model
