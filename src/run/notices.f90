!> Warnings and notes of a run: each stands once in a list, with how often it came and when first.
module notices
   use kinds, only: wp, int64
   use text, only: to_text
   use state_archive, only: archive_type
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: notice_type, notice_list_type, is_warning, without_mark

   !> One of them.
   type :: notice_type
      character(len=:), allocatable :: text      !! with its cure, in lines
      logical :: warning = .true.                !! else a note
      integer(int64) :: count = 0
      logical :: timed = .false.                 !! it came at a time of the run
      real(wp) :: t = 0.0_wp                     !! total time when it came first
   contains
      procedure :: line
      procedure :: pass_state => pass_notice
   end type notice_type

   !> All of a run, those before it that it goes on from among them.
   type :: notice_list_type
      integer :: n = 0
      type(notice_type), allocatable :: items(:)   !! grown by doubling
   contains
      procedure :: add
      procedure :: n_warnings
      procedure :: pass_state
   end type notice_list_type

   character(len=*), parameter :: mark = 'warning: '

contains

   !> Counts a warning or note; what is said before the first increment counts once.
   subroutine add(self, text, warning, is_new, t, times)
      class(notice_list_type), intent(inout) :: self
      character(len=*), intent(in) :: text
      logical, intent(in) :: warning
      logical, intent(out) :: is_new             !! it is there for the first time
      real(wp), intent(in), optional :: t        !! total time, of what comes in the run
      integer(int64), intent(in), optional :: times   !! that it came since it was counted last
      integer :: i
      integer(int64) :: more

      more = 1
      if (present(times)) more = times
      do i = 1, self%n
         if (self%items(i)%text == text) exit
      end do
      is_new = i > self%n
      if (is_new) then
         call make_room(self)
         self%items(i)%text = text
         self%items(i)%warning = warning
         self%items(i)%timed = present(t)
         if (present(t)) self%items(i)%t = t
         self%items(i)%count = more
      else if (present(t)) then
         self%items(i)%count = self%items(i)%count + more
      end if
   end subroutine add

   subroutine make_room(self)
      class(notice_list_type), intent(inout) :: self
      type(notice_type), allocatable :: longer(:)
      integer :: status

      if (.not. allocated(self%items)) then
         allocate (self%items(8), stat=status)
         call check_allocation(status)
      end if
      if (self%n == size(self%items)) then
         allocate (longer(2*self%n), stat=status)
         call check_allocation(status)
         longer(:self%n) = self%items
         call move_alloc(longer, self%items)
      end if
      self%n = self%n + 1
   end subroutine make_room

   pure integer function n_warnings(self)
      class(notice_list_type), intent(in) :: self

      n_warnings = 0
      if (self%n > 0) n_warnings = count(self%items(:self%n)%warning)
   end function n_warnings

   !> "warning: ..." or "note (500 times, first at t = 0.2): ...".
   pure function line(self) result(text)
      class(notice_type), intent(in) :: self
      character(len=:), allocatable :: text

      text = trim(merge('warning', 'note   ', self%warning))
      if (self%timed) then
         if (self%count > 1) then
            text = text//' ('//to_text(self%count)//' times, first at t = '//to_text(self%t)//')'
         else
            text = text//' (at t = '//to_text(self%t)//')'
         end if
      end if
      text = text//': '//self%text
   end function line

   !> Whether a remark says behind its place in the deck, if it has one, that it is a warning.
   pure logical function is_warning(remark)
      character(len=*), intent(in) :: remark

      is_warning = mark_place(remark) > 0
   end function is_warning

   !> The remark without that word.
   pure function without_mark(remark) result(text)
      character(len=*), intent(in) :: remark
      character(len=:), allocatable :: text
      integer :: place

      text = remark
      place = mark_place(remark)
      if (place > 0) text = remark(:place - 1)//remark(place + len(mark):)
   end function without_mark

   pure integer function mark_place(remark)
      character(len=*), intent(in) :: remark

      mark_place = index(remark, ': '//mark)
      if (mark_place > 0) mark_place = mark_place + 2
      if (index(remark, mark) == 1) mark_place = 1
   end function mark_place

   !> All of it; nothing of an archive that has none.
   subroutine pass_state(self, archive)
      class(notice_list_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive
      integer :: i, n

      if (archive%reading .and. .not. archive%has('n_notices')) return
      n = self%n
      call archive%pass('n_notices', n)
      if (archive%reading) self%n = 0
      do i = 1, n
         if (archive%reading) call make_room(self)
         call archive%enter('notice_'//to_text(i))
         call self%items(i)%pass_state(archive)
         call archive%leave()
      end do
   end subroutine pass_state

   !> A text is kept as the codes of its letters.
   subroutine pass_notice(self, archive)
      class(notice_type), intent(inout) :: self
      type(archive_type), intent(inout) :: archive
      integer, allocatable :: codes(:)
      integer :: i, status

      if (.not. archive%reading) codes = [(iachar(self%text(i:i)), i=1, len(self%text))]
      call archive%pass('text', codes)
      call archive%pass('warning', self%warning)
      call archive%pass('timed', self%timed)
      call archive%pass('count', self%count)
      call archive%pass('t', self%t)
      if (.not. archive%reading) return
      if (.not. allocated(codes)) codes = [integer ::]
      if (allocated(self%text)) deallocate (self%text)
      allocate (character(len=size(codes)) :: self%text, stat=status)
      call check_allocation(status)
      do i = 1, size(codes)
         self%text(i:i) = achar(codes(i))
      end do
   end subroutine pass_notice

end module notices
