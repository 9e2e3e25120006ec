!> Writes /energy: the ledger of the run and, below it, the energies of each element group.
module energy_recorder
   use kinds, only: wp
   use errors, only: error_type
   use text, only: to_text
   use mesh, only: scheme_implicit
   use energy_ledger, only: group_energies
   use impact_scene, only: scene_type, contact_motion_type
   use hdf5_file, only: hdf5_file_type
   use column_table, only: column_table_type
   implicit none
   private

   public :: new_energies, record_energies

   character(len=13), parameter :: columns(10) = ['time         ', 'kinetic      ', &
         'strain       ', 'damping      ', 'plastic      ', 'friction     ', 'impact_loss  ', &
         'external_work', 'total        ', 'balance_error']
   character(len=64), parameter :: meanings(10) = [ &
         'total time                                                      ', &
         'kinetic energy                                                  ', &
         'strain energy                                                   ', &
         'energy taken by damping                                         ', &
         'energy taken by plastic deformation                             ', &
         'energy taken by friction                                        ', &
         'energy taken by impacts and contact forces                      ', &
         'work of loads, prescribed motion and moving walls               ', &
         'kinetic and strain energy                                       ', &
         'total + losses - external work - initial total                  ']

contains

   !> Makes the columns: the ledger's, then kinetic and strain energy of every group where there are
   !> several.
   subroutine new_energies(table, file, scene, error)
      type(column_table_type), intent(inout) :: table
      type(hdf5_file_type), intent(inout) :: file
      type(scene_type), intent(in) :: scene
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: name, scheme
      integer :: i

      call table%create(file, '/energy', 'energies and works since the start', error)
      do i = 1, size(columns)
         if (allocated(error)) return
         call table%add_column(file, trim(columns(i)), trim(meanings(i)), error)
      end do
      if (size(scene%system%structure%groups) < 2) return
      do i = 1, size(scene%system%structure%groups)
         if (allocated(error)) return
         name = 'group_'//to_text(i)
         associate (group => scene%system%structure%groups(i))
            scheme = 'explicit'
            if (group%scheme == scheme_implicit) scheme = 'implicit'
            scheme = ' energy of group '//to_text(i)//': '//to_text(size(group%member))//' ' &
                  //scheme//' elements from number '//to_text(group%member(1))//' of the deck on'
         end associate
         call table%add_column(file, name//'/kinetic', 'kinetic'//scheme, error)
         if (allocated(error)) return
         call table%add_column(file, name//'/strain', 'strain'//scheme, error)
      end do
   end subroutine new_energies

   !> Appends a row.
   subroutine record_energies(table, file, scene, motion, error)
      type(column_table_type), intent(inout) :: table
      type(hdf5_file_type), intent(inout) :: file
      type(scene_type), intent(inout) :: scene
      type(contact_motion_type), intent(in) :: motion
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: row(:)

      associate (ledger => scene%ledger)
         row = [motion%motion%t, ledger%kinetic, ledger%strain, ledger%damping, ledger%plastic, &
               ledger%friction, ledger%impact_loss, ledger%external_work, ledger%total, &
               ledger%balance_error]
      end associate
      if (size(scene%system%structure%groups) > 1) row = [row, group_energies(scene%system, &
            motion%motion)]
      call table%append_row(file, row, error)
   end subroutine record_energies

end module energy_recorder
