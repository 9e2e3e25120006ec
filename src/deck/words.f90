!> Words of the deck: comparison without case and blanks, and advice on misspelt ones.
module words
   use text, only: upper_case
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: word_length, squeezed, find_word, advice, is_blank

   !> Room for one keyword, parameter or value.
   integer, parameter :: word_length = 32

contains

   !> Upper case without blanks and tabs: the form in which words are compared.
   pure function squeezed(string) result(word)
      character(len=*), intent(in) :: string
      character(len=:), allocatable :: word
      character(len=:), allocatable :: buffer    ! not on the stack: lines may be very long
      integer :: i, n, status

      allocate (character(len=len(string)) :: buffer, stat=status)
      call check_allocation(status)
      n = 0
      do i = 1, len(string)
         if (is_blank(string(i:i))) cycle
         n = n + 1
         buffer(n:n) = string(i:i)
      end do
      word = buffer(:n)
      call raise(word)
   end function squeezed

   !> Makes a-z A-Z in place.
   pure subroutine raise(word)
      character(len=:), allocatable, intent(inout) :: word
      integer :: i

      do i = 1, len(word)
         word(i:i) = upper_case(word(i:i))
      end do
   end subroutine raise

   !> True for a blank or a tab.
   elemental function is_blank(letter) result(blank)
      character(len=1), intent(in) :: letter
      logical :: blank

      blank = letter == ' ' .or. iachar(letter) == 9
   end function is_blank

   !> Position of a word in a list, 0 if it is not there.
   pure function find_word(word, list) result(position)
      character(len=*), intent(in) :: word, list(:)
      integer :: position
      character(len=:), allocatable :: wanted

      wanted = squeezed(word)
      do position = 1, size(list)
         if (squeezed(list(position)) == wanted) return
      end do
      position = 0
   end function find_word

   !> "did you mean X? allowed: A, B, C"; of a very long list the first words.
   pure function advice(word, list) result(string)
      character(len=*), intent(in) :: word, list(:)
      character(len=:), allocatable :: string
      character(len=:), allocatable :: wanted
      integer, parameter :: most = 60
      integer :: i, nearest, distance, least

      nearest = 0
      wanted = squeezed(word)
      least = min(3, 1 + len(wanted)/3)
      do i = 1, size(list)
         distance = edit_distance(wanted, squeezed(list(i)))
         if (distance >= least) cycle
         least = distance
         nearest = i
      end do
      string = ''
      if (nearest > 0) string = "did you mean '"//trim(list(nearest))//"'? "
      if (size(list) == 0) then
         string = 'none is defined'
         return
      end if
      string = string//'allowed: '//trim(list(1))
      do i = 2, min(size(list), most)
         string = string//', '//trim(list(i))
      end do
      if (size(list) > most) string = string//', ...'
   end function advice

   !> Letters to insert, drop or replace to make one word the other (Levenshtein).
   pure function edit_distance(a, b) result(distance)
      character(len=*), intent(in) :: a, b
      integer :: distance
      integer :: row(0:len(b)), i, j, diagonal, above

      if (abs(len(a) - len(b)) > 3) then
         distance = max(len(a), len(b))
         return
      end if
      row = [(j, j=0, len(b))]
      do i = 1, len(a)
         diagonal = row(0)
         row(0) = i
         do j = 1, len(b)
            above = row(j)
            if (a(i:i) /= b(j:j)) diagonal = diagonal + 1
            row(j) = min(diagonal, above + 1, row(j - 1) + 1)
            diagonal = above
         end do
      end do
      distance = row(len(b))
   end function edit_distance

end module words
