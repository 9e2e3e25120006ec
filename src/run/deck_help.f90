!> `carom help`: the deck reference of input/README.md, an entry a card, on the terminal.
module deck_help
   use errors, only: error_type, new_error, status_usage
   use memory_shortage, only: check_allocation
   use card_rules, only: n_rules, rule_text
   use words, only: word_length, squeezed, advice
   use display, only: displayed
   use standard_output, only: print_line
   use reference_text, only: n_reference_lines, reference_line
   implicit none
   private

   public :: print_help, help_contents, help_entry

   character(len=1), parameter :: nl = new_line('a')
   character(len=*), parameter :: entry_mark = '### ', group_mark = '## '
   character(len=*), parameter :: example_indent = '    '

   !> What tests compare the reference with: the reader's own table of cards.
   character(len=*), parameter :: table_topic = '--table'

contains

   !> Prints the entry of a card or topic; without one the list of all.
   subroutine print_help(topic, error)
      character(len=*), intent(in) :: topic
      type(error_type), allocatable, intent(out) :: error   !! status_usage: no such entry
      character(len=:), allocatable :: text
      integer :: i

      if (topic == table_topic) then
         do i = 1, n_rules
            call print_line(trim(rule_text(i)))
         end do
         return
      end if
      if (topic == '') then
         text = help_contents()
      else
         call help_entry(topic, text, error)
         if (allocated(error)) return
      end if
      call print_line(text)
   end subroutine print_help

   !> All entries by groups, each with its first sentence.
   pure function help_contents() result(text)
      character(len=:), allocatable :: text
      integer, parameter :: width = 24
      character(len=:), allocatable :: line
      character(len=width) :: title
      integer :: i

      text = 'carom help CARD prints one of these entries, as in: carom help contact pair'//nl
      do i = 2, n_reference_lines                ! line 1 is the title of all
         line = reference_line(i)
         if (index(line, entry_mark) == 1) then
            title = line(len(entry_mark) + 1:)
            text = text//'  '//title//shown(reference_line(i + 2))//nl
         else if (index(line, group_mark) == 1) then
            text = text//nl//line(len(group_mark) + 1:)//nl
         end if
      end do
      text = text(:len(text) - 1)
   end function help_contents

   !> The entry of a card or topic, whatever the case, with a star or without.
   pure subroutine help_entry(topic, text, error)
      character(len=*), intent(in) :: topic
      character(len=:), allocatable, intent(out) :: text
      type(error_type), allocatable, intent(out) :: error   !! status_usage: no such entry
      character(len=:), allocatable :: line
      integer :: i, first

      do first = 1, n_reference_lines
         line = reference_line(first)
         if (index(line, entry_mark) /= 1) cycle
         if (bare(line(len(entry_mark) + 1:)) == bare(topic)) exit
      end do
      if (first > n_reference_lines) then
         call new_error(error, status_usage, "no entry '"//displayed(topic)// &
               "' in the deck reference"//nl//'  cure: '//near_entries(bare(topic)))
         return
      end if
      text = line(len(entry_mark) + 1:)
      do i = first + 1, n_reference_lines
         line = reference_line(i)
         if (index(line, entry_mark) == 1 .or. index(line, group_mark) == 1) exit
         text = text//nl//shown(line)
      end do
      do while (text(len(text):) == nl)
         text = text(:len(text) - 1)
      end do
   end subroutine help_entry

   !> What to ask for instead: entries with the word in their names, or with a parameter of that
   !! name; else the nearest spelling.
   pure function near_entries(word) result(string)
      character(len=*), intent(in) :: word       !! squeezed, without star
      character(len=:), allocatable :: string
      character(len=word_length), allocatable :: titles(:)
      character(len=:), allocatable :: line, title
      logical :: near
      integer :: i, n, status

      allocate (titles(n_reference_lines), stat=status)
      call check_allocation(status)
      n = 0
      title = ''
      string = ''
      do i = 1, n_reference_lines
         line = reference_line(i)
         near = has_parameter(line, word)
         if (index(line, entry_mark) == 1) then
            title = line(len(entry_mark) + 1:)
            n = n + 1
            titles(n) = title(verify(title, '*'):)
            near = len(word) > 1 .and. index(bare(title), word) > 0
         end if
         if (near .and. index(string, title) == 0) string = string//', '//title
      end do
      if (string /= '') then
         string = 'see '//string(3:)
         return
      end if
      string = advice(word, titles(:n))
      string = string(:index(string, 'allowed: ') - 1)//'carom help lists all entries'
   end function near_entries

   !> Whether a line of an entry is that of a parameter, such as "- `NAME=value`: ...".
   pure function has_parameter(line, name) result(has)
      character(len=*), intent(in) :: line
      character(len=*), intent(in) :: name       !! squeezed
      logical :: has
      character(len=:), allocatable :: start, tight

      start = '-`'//name
      tight = squeezed(line)
      has = index(tight, start) == 1
      if (has) has = scan(tight(len(start) + 1:), '=[`') == 1
   end function has_parameter

   !> A name as names are compared: upper case, neither blanks nor star nor mark of a heading.
   pure function bare(name) result(word)
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: word

      word = squeezed(name)
      word = word(verify(word//'.', '#*'):)
   end function bare

   !> A line of Markdown as a terminal shows it: code without its quotes, examples as they are; the
   !! cells of a table keep their width.
   pure function shown(line) result(plain)
      character(len=*), intent(in) :: line
      character(len=:), allocatable :: plain
      integer :: i, lost

      plain = line
      if (index(line, example_indent) == 1) return
      plain = ''
      lost = 0
      do i = 1, len(line)
         select case (line(i:i))
         case ('`')
            lost = lost + 1
         case ('|')
            if (index(adjustl(line), '|') == 1) plain = plain//repeat(' ', lost)
            lost = 0
            plain = plain//'|'
         case default
            plain = plain//line(i:i)
         end select
      end do
   end function shown

end module deck_help
