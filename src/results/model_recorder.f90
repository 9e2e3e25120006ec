!> Writes /model: what was computed. The deck's text, its ids, rigid and deformable surfaces.
module model_recorder
   use kinds, only: wp
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use places, only: source_type
   use model, only: model_type
   use surfaces, only: surface_type, rigid_plane, rigid_circle
   use hdf5_file, only: hdf5_file_type
   implicit none
   private

   public :: write_model

contains

   !> Makes the group with all that the deck alone tells.
   subroutine write_model(file, model, error)
      type(hdf5_file_type), intent(inout) :: file
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      call file%create_group('/model', 'what was computed and by what', error)
      if (allocated(error)) return
      call file%write_dataset('/model/deck', deck_text(model%source), &
            'the deck, included files behind it', error)
      if (allocated(error)) return
      call file%write_dataset('/model/node_id', model%nodes%id(:model%nodes%n), &
            'ids of the nodes in the deck, in the order of the points', error)
      if (allocated(error)) return
      call file%write_dataset('/model/element_id', model%elements%id(:model%elements%n), &
            'ids of the elements in the deck, in the order of the cells', error)
      if (allocated(error)) return
      call write_rigid_surfaces(file, model, error)
      do i = 1, size(model%surfaces)
         if (allocated(error)) return
         call write_surface(file, model%surfaces(i), error)
      end do
   end subroutine write_model

   !> Planes and circles, where there are any.
   subroutine write_rigid_surfaces(file, model, error)
      type(hdf5_file_type), intent(inout) :: file
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: planes(:, :), circles(:, :)
      integer :: i, n_planes, n_circles, status

      allocate (planes(6, count(model%rigid_surfaces%kind == rigid_plane)), stat=status)
      call check_allocation(status)
      allocate (circles(4, count(model%rigid_surfaces%kind == rigid_circle)), stat=status)
      call check_allocation(status)
      n_planes = 0
      n_circles = 0
      do i = 1, size(model%rigid_surfaces)
         associate (rigid => model%rigid_surfaces(i))
            if (rigid%kind == rigid_plane) then
               n_planes = n_planes + 1
               planes(:, n_planes) = [rigid%point, rigid%normal]
            else
               n_circles = n_circles + 1
               circles(:, n_circles) = [rigid%point, rigid%radius]
            end if
         end associate
      end do
      if (n_planes > 0) call file%write_dataset('/model/rigid_planes', planes, &
            'a point and the outward normal of each rigid plane at the start', error)
      if (allocated(error) .or. n_circles == 0) return
      call file%write_dataset('/model/rigid_circles', circles, 'centre x, y, z and radius of ' &
            //'each rigid circle at the start; radius negative if bodies are inside', error)
   end subroutine write_rigid_surfaces

   !> The nodes of a surface and the edges between them.
   subroutine write_surface(file, surface, error)
      type(hdf5_file_type), intent(inout) :: file
      type(surface_type), intent(in) :: surface
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: group

      group = '/model/surface_'//trim(surface%name)
      call file%create_group(group, 'the surface '//trim(surface%name)//' of the deck', error)
      if (allocated(error)) return
      call file%write_dataset(group//'/nodes', surface%nodes - 1, &
            'its points, counted from 0', error)
      if (allocated(error) .or. size(surface%edges, 2) == 0) return
      call file%write_dataset(group//'/edges', surface%edges - 1, 'points of its edges, counted ' &
            //'from 0: first, last, middle or -1; the body is on the left of the way', error)
   end subroutine write_surface

   pure function deck_text(source) result(text)
      type(source_type), intent(in) :: source
      character(len=:), allocatable :: text
      integer :: f, i, n, length, status

      n = 0
      do f = 1, source%n_files
         do i = 1, source%files(f)%n_lines
            n = n + source%files(f)%last(i) - source%files(f)%first(i) + 2
         end do
      end do
      allocate (character(len=n) :: text, stat=status)
      call check_allocation(status)
      n = 0
      do f = 1, source%n_files
         do i = 1, source%files(f)%n_lines
            associate (from => source%files(f))
               length = from%last(i) - from%first(i) + 1
               text(n + 1:n + length) = from%content(from%first(i):from%last(i))
               n = n + length + 1
               text(n:n) = new_line('a')
            end associate
         end do
      end do
   end function deck_text

end module model_recorder
