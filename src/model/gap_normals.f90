!> Direction in which a gap element opens.
module gap_normals
   use kinds, only: wp
   use model, only: model_type
   implicit none
   private

   public :: gap_normal

contains

   !> Unit normal of gap element e, from its node 1 to its node 2: the section's own, else along the
   !> line between the nodes; zero if that has no length.
   pure function gap_normal(model, e) result(normal)
      type(model_type), intent(in) :: model
      integer, intent(in) :: e              !! element index
      real(wp) :: normal(3)
      real(wp) :: length
      integer :: first

      normal = model%sections(model%elements%section(e))%normal
      if (norm2(normal) > 0.0_wp) return
      first = model%elements%first(e)
      normal = model%nodes%x(:, model%elements%nodes(first + 1)) &
            - model%nodes%x(:, model%elements%nodes(first))
      length = norm2(normal)
      if (length > 0.0_wp) normal = normal/length
   end function gap_normal

end module gap_normals
