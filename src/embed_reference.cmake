# Writes a Fortran module with the lines of the deck reference: all of TEXT from its line
# "## Deck reference" on. cmake -D TEXT=input/README.md -D MODULE=reference_text.f90 -P embed_reference.cmake
# Bytes are taken as they are (UTF-8 too); lines are cut so that those of the module stay short.

set(width 80)
set(mark "\n## Deck reference\n")

file(READ "${TEXT}" rest)
string(REPLACE "\r" "" rest "${rest}")
string(FIND "${rest}" "${mark}" place)
if(place EQUAL -1)
  message(FATAL_ERROR "${TEXT} has no line '## Deck reference'")
endif()
math(EXPR place "${place} + 1")
string(SUBSTRING "${rest}" ${place} -1 rest)

set(cases "")
set(n 0)
string(FIND "${rest}" "\n" end)
while(NOT end EQUAL -1)
  string(SUBSTRING "${rest}" 0 ${end} line)
  math(EXPR end "${end} + 1")
  string(SUBSTRING "${rest}" ${end} -1 rest)
  math(EXPR n "${n} + 1")
  string(APPEND cases "      case (${n})\n         line = ")
  string(LENGTH "${line}" length)
  while(length GREATER width)
    string(SUBSTRING "${line}" 0 ${width} piece)
    string(SUBSTRING "${line}" ${width} -1 line)
    string(LENGTH "${line}" length)
    string(REPLACE "'" "''" piece "${piece}")
    string(APPEND cases "'${piece}'// &\n               ")
  endwhile()
  string(REPLACE "'" "''" line "${line}")
  string(APPEND cases "'${line}'\n")
  string(FIND "${rest}" "\n" end)
endwhile()

file(WRITE "${MODULE}" "!> The deck reference, line by line. Written by the build from input/README.md.
module reference_text
   implicit none
   private

   public :: n_reference_lines, reference_line

   integer, parameter :: n_reference_lines = ${n}

contains

   !> Line i of the reference; empty beyond its end.
   pure function reference_line(i) result(line)
      integer, intent(in) :: i
      character(len=:), allocatable :: line

      select case (i)
${cases}      case default
         line = ''
      end select
   end function reference_line

end module reference_text
")
