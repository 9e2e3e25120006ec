!> The error of bodies that contact presses from opposite sides and that cannot yield.
module contact_room
   use kinds, only: wp
   use errors, only: error_type, new_error, status_numerical
   use text, only: to_text
   implicit none
   private

   public :: no_room

   !> Where rows depend on each other, conditions that stay violated by more than this part of the
   !> largest contradict each other.
   real(wp), parameter, public :: room_tolerance = 1.0e-3_wp

contains

   subroutine no_room(node_id, t, overlap, error)
      integer, intent(in) :: node_id             !! the deck's id of a node that overlaps
      real(wp), intent(in) :: t                  !! time
      real(wp), intent(in) :: overlap            !! what remains of it
      type(error_type), allocatable, intent(out) :: error

      call new_error(error, status_numerical, 'contact leaves node '//to_text(node_id) &
            //' no room at time '//to_text(t)//': it is pressed from opposite sides and cannot ' &
            //'yield; an overlap of '//to_text(overlap)//' remains'//new_line('a') &
            //'  cure: end the motion of walls before they meet, or put what yields between them')
   end subroutine no_room

end module contact_room
