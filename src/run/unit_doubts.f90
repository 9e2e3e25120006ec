!> Materials whose modulus and density are those of one substance in two systems of units, and
!> gravity in a third. Any consistent units are right, and numbers of no substance say nothing.
module unit_doubts
   use kinds, only: wp
   use text, only: to_text
   use places, only: note_at
   use properties, only: material_type
   use histories, only: gravity_type
   use scene_setup, only: simulation_type, add_remark
   implicit none
   private

   public :: doubt_units, find_units

   !> Least and largest modulus in N/m2 and density in kg/m3 of substances, rounded outwards from
   !> tables of engineering materials.
   type :: substance_type
      character(len=10) :: name
      real(wp) :: young(2), density(2)
   end type substance_type
   type(substance_type), parameter :: substances(*) = [ &
         substance_type('steel', [1.85e11_wp, 2.2e11_wp], [7600.0_wp, 8100.0_wp]), &
         substance_type('aluminium', [6.5e10_wp, 8.0e10_wp], [2600.0_wp, 2900.0_wp]), &
         substance_type('titanium', [1.0e11_wp, 1.25e11_wp], [4300.0_wp, 4600.0_wp]), &
         substance_type('copper', [1.1e11_wp, 1.35e11_wp], [8800.0_wp, 9000.0_wp]), &
         substance_type('glass', [5.0e10_wp, 9.0e10_wp], [2400.0_wp, 2600.0_wp]), &
         substance_type('concrete', [2.0e10_wp, 5.0e10_wp], [2200.0_wp, 2550.0_wp]), &
         substance_type('wood', [8.0e9_wp, 1.6e10_wp], [350.0_wp, 800.0_wp]), &
         substance_type('rubber', [5.0e5_wp, 2.0e7_wp], [900.0_wp, 1300.0_wp]), &
         substance_type('plastic', [1.5e8_wp, 5.0e9_wp], [880.0_wp, 2300.0_wp])]
   !> Stiffer ones are known by their numbers; of softer ones some are those of any example.
   real(wp), parameter :: stiff = 1.9e10_wp

   !> Units that stresses and densities are written in, with the number that is 1 SI unit.
   integer, parameter :: n_stress = 4, n_density = 5
   character(len=5), parameter :: stress_names(n_stress) = [character(len=5) :: 'N/m2', 'N/mm2', &
         'kN/m2', 'GPa']
   real(wp), parameter :: stress_size(n_stress) = [1.0_wp, 1.0e-6_wp, 1.0e-3_wp, 1.0e-9_wp]
   character(len=6), parameter :: density_names(n_density) = [character(len=6) :: 'kg/m3', &
         't/mm3', 'kg/mm3', 't/m3', 'g/mm3']
   real(wp), parameter :: density_size(n_density) = [1.0_wp, 1.0e-12_wp, 1.0e-9_wp, 1.0e-3_wp, &
         1.0e-6_wp]
   !> The density unit that goes with each stress unit where time is in seconds, and those that do
   !> with other units of time (ms, microseconds).
   integer, parameter :: usual(n_stress) = [1, 2, 4, 3]
   logical, parameter :: fit(n_stress, n_density) = reshape([ &
         .true., .false., .false., .false., &     ! kg/m3
         .false., .true., .false., .false., &     ! t/mm3
         .false., .false., .false., .true., &     ! kg/mm3
         .false., .false., .true., .true., &      ! t/m3
         .false., .true., .false., .false.], [n_stress, n_density])   ! g/mm3
   !> Standard gravity in the units of length and time that go with each stress unit.
   real(wp), parameter :: gravity(n_stress) = [9.81_wp, 9810.0_wp, 9.81_wp, 9.81e-3_wp]
   character(len=6), parameter :: gravity_names(n_stress) = [character(len=6) :: 'm/s2', &
         'mm/s2', 'm/s2', 'mm/ms2']
   real(wp), parameter :: same_gravity = 0.01_wp

contains

   !> Remarks on the materials and on gravity.
   subroutine doubt_units(simulation)
      type(simulation_type), intent(inout) :: simulation
      integer :: i, j, stress, density, substance
      logical :: sound

      do i = 1, size(simulation%model%materials)
         associate (material => simulation%model%materials(i))
            call find_units(material, stress, density, substance)
            if (stress == 0) cycle
            sound = fit(stress, density)
            if (.not. sound) call add_remark(simulation, note_at(simulation%model%source, &
                  material%place, mixed_text(material, stress, density, substance)))
         end associate
         if (.not. sound) cycle
         do j = 1, size(simulation%model%steps)
            call doubt_gravity(simulation, i, stress, density, simulation%model%steps(j)%gravity)
         end do
      end do
   end subroutine doubt_units

   !> The substance that a material is, and its units of stress and density: those that go together
   !> if such are found, else the first that do not; 0 if it is no known substance.
   pure subroutine find_units(material, stress, density, substance)
      type(material_type), intent(in) :: material
      integer, intent(out) :: stress, density, substance
      integer :: i, s, r

      stress = 0
      density = 0
      substance = 0
      ! a density of 1 is that of an example
      if (.not. material%density > 0.0_wp) return
      if (.not. abs(material%density - 1.0_wp) > 0.0_wp) return
      do i = 1, size(substances)
         do s = 1, n_stress
            if (.not. within(material%young, substances(i)%young*stress_size(s))) cycle
            do r = 1, n_density
               if (.not. within(material%density, substances(i)%density*density_size(r))) cycle
               if (stress > 0 .and. .not. fit(s, r)) cycle
               if (substances(i)%young(1) < stiff .and. density_names(r) == 't/m3' .and. &
                     .not. fit(s, r)) cycle
               stress = s
               density = r
               substance = i
               if (fit(s, r)) return
            end do
         end do
      end do
   end subroutine find_units

   pure logical function within(x, range)
      real(wp), intent(in) :: x, range(2)

      within = x >= range(1)*(1.0_wp - 1.0e-9_wp) .and. x <= range(2)*(1.0_wp + 1.0e-9_wp)
   end function within

   pure function mixed_text(material, stress, density, substance) result(text)
      type(material_type), intent(in) :: material
      integer, intent(in) :: stress, density, substance
      character(len=:), allocatable :: text
      integer :: other

      other = findloc(usual, density, dim=1)
      text = 'warning: the units of '//trim(material%name)//' do not go together: E = ' &
            //to_text(material%young)//' is that of '//trim(substances(substance)%name)//' in ' &
            //trim(stress_names(stress))//', the density '//to_text(material%density) &
            //' that in '//trim(density_names(density))//new_line('a')//'  cure: with ' &
            //trim(stress_names(stress))//' write the density '//to_text(material%density &
            *density_size(usual(stress))/density_size(density))//' ' &
            //trim(density_names(usual(stress)))
      if (other > 0) text = text//', or with '//trim(density_names(density))//' E = ' &
            //to_text(material%young*stress_size(other)/stress_size(stress))//' ' &
            //trim(stress_names(other))
      text = text//length_text(stress)
   end function mixed_text

   !> The length and time of a stress unit.
   pure function length_text(stress) result(text)
      integer, intent(in) :: stress
      character(len=:), allocatable :: text

      select case (stress)
      case (2)
         text = '; N/mm2 goes with mm, t, s and gravity 9810'
      case (4)
         text = '; GPa goes with mm, kg, ms'
      case (3)
         text = '; kN/m2 goes with m, t, s'
      case default
         text = '; N/m2 goes with m, kg, s'
      end select
   end function length_text

   !> Gravity that has the size it has in other units than those of the material.
   subroutine doubt_gravity(simulation, i_material, stress, density, loads)
      type(simulation_type), intent(inout) :: simulation
      integer, intent(in) :: i_material, stress, density
      type(gravity_type), intent(in) :: loads(:)
      real(wp) :: size_of
      integer :: i

      if (density /= usual(stress)) return
      do i = 1, size(loads)
         size_of = norm2(loads(i)%acceleration)
         if (abs(size_of/gravity(stress) - 1.0_wp) < same_gravity) cycle
         if (.not. any(abs(size_of/gravity - 1.0_wp) < same_gravity)) cycle
         associate (material => simulation%model%materials(i_material))
            call add_remark(simulation, note_at(simulation%model%source, loads(i)%place, &
                  'warning: gravity '//to_text(size_of)//' with a material in ' &
                  //trim(stress_names(stress))//' ('//trim(material%name)//', E = ' &
                  //to_text(material%young)//')'//new_line('a')//'  cure: write ' &
                  //to_text(gravity(stress))//' '//trim(gravity_names(stress)) &
                  //length_text(stress)))
         end associate
         return
      end do
   end subroutine doubt_gravity

end module unit_doubts
