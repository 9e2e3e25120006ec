# Gives add_pfunit_ctest(<name> TEST_SOURCES <test_x.pf>... [LINK_LIBRARIES ...] [LABELS ...]):
# pFUnit's own where pFUnit is installed and its module funit compiles, that of
# pfunit_lite/PfunitLite.cmake elsewhere. PFUNIT_LITE=ON asks for the substitute anyway.

include_guard(GLOBAL)
option(PFUNIT_LITE "Run the tests under the substitute even if pFUnit is installed" OFF)

# Makes `found` true if pFUnit is installed and `use funit` compiles with this compiler
function(pfunit_look_for_real found)
  set(${found} FALSE PARENT_SCOPE)
  if(PFUNIT_LITE OR NOT TARGET PFUNIT::funit)
    return()
  endif()
  set(directory "${CMAKE_CURRENT_BINARY_DIR}/pfunit_check")
  file(WRITE "${directory}/check.f90"
    "program check\n   use funit, only: TestSuite\n   implicit none\nend program check\n")
  unset(PFUNIT_COMPILES CACHE)
  try_compile(PFUNIT_COMPILES "${directory}" SOURCES "${directory}/check.f90"
    LINK_LIBRARIES PFUNIT::funit)
  set(${found} "${PFUNIT_COMPILES}" PARENT_SCOPE)
endfunction()

# For the generated files: long lines, no -Werror, a module directory of their own. What a test
# must print to pass: under pFUnit a program that executes `stop`, or runs no test, has status 0.
# And what it must not: with that, ctest no longer looks at the status, by which sanitizers fail.
function(pfunit_set_test_properties name)
  target_compile_options(${name} PRIVATE
    $<$<COMPILE_LANG_AND_ID:Fortran,GNU>:-ffree-line-length-none -Wno-error>)
  set_target_properties(${name} PROPERTIES
    Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/${name}_modules")
  set_tests_properties(${name} PROPERTIES PASS_REGULAR_EXPRESSION
    "OK[\r\n]+ \\([1-9][0-9]* test"
    FAIL_REGULAR_EXPRESSION "AddressSanitizer|LeakSanitizer|runtime error:")
  set_property(GLOBAL APPEND PROPERTY carom_unit_tests ${name})
endfunction()

if(NOT PFUNIT_LITE)
  find_package(PFUNIT QUIET)
endif()
pfunit_look_for_real(PFUNIT_IS_REAL)
if(PFUNIT_IS_REAL)
  message(STATUS "Tests run under pFUnit: ${PFUNIT_DIR}")
  # CMake keeps pFUnit's function under the name _add_pfunit_ctest
  function(add_pfunit_ctest name)
    _add_pfunit_ctest(${name} ${ARGN})
    pfunit_set_test_properties(${name})
  endfunction()
else()
  message(STATUS "Tests run under tests/pfunit_lite, the substitute for pFUnit")
  include("${CMAKE_CURRENT_LIST_DIR}/pfunit_lite/PfunitLite.cmake")
endif()
