# The substitute for pFUnit: the library pfunit_lite (module funit) and
#
#   add_pfunit_ctest(<name> TEST_SOURCES <test_x.pf>... [OTHER_SOURCES <helper.f90>...]
#                    [LINK_LIBRARIES <targets>...] [LABELS <labels>...])
#
# which builds the program <name> from the test files and registers it with ctest.
# Included by ../pfunit.cmake, which has the properties common to pFUnit and this.

include_guard(GLOBAL)
find_package(Python3 3.9 REQUIRED COMPONENTS Interpreter)

set(PFUNIT_LITE_DIR "${CMAKE_CURRENT_LIST_DIR}" CACHE INTERNAL "")
set(PFUNIT_LITE_PYTHON "${Python3_EXECUTABLE}" CACHE INTERNAL "")

set(modules lite_text lite_exceptions lite_basic lite_int32 lite_int64 lite_real32 lite_real64
  lite_suite lite_runner funit)
list(TRANSFORM modules PREPEND "${PFUNIT_LITE_DIR}/")
list(TRANSFORM modules APPEND ".f90")
add_library(pfunit_lite STATIC ${modules})
set_target_properties(pfunit_lite PROPERTIES
  Fortran_MODULE_DIRECTORY "${CMAKE_BINARY_DIR}/pfunit_lite_modules")
target_include_directories(pfunit_lite INTERFACE "${CMAKE_BINARY_DIR}/pfunit_lite_modules")
target_compile_options(pfunit_lite PRIVATE
  $<$<COMPILE_LANG_AND_ID:Fortran,GNU>:-std=f2008 -pedantic -Wall -Wextra -Wimplicit-interface
    -Wconversion>)

function(add_pfunit_ctest name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "TEST_SOURCES;OTHER_SOURCES;LINK_LIBRARIES;LABELS")
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_TEST_SOURCES)
    message(FATAL_ERROR "add_pfunit_ctest(${name}): needs TEST_SOURCES <test_x.pf>..., and takes "
      "OTHER_SOURCES, LINK_LIBRARIES and LABELS; not in use: '${arg_UNPARSED_ARGUMENTS}'")
  endif()

  set(directory "${CMAKE_CURRENT_BINARY_DIR}/${name}_generated")
  file(MAKE_DIRECTORY "${directory}")
  set(tool "${PFUNIT_LITE_DIR}/preprocess.py")
  set(python "${PFUNIT_LITE_PYTHON}" -B)
  set(suites)
  set(generated)
  foreach(source IN LISTS arg_TEST_SOURCES)
    get_filename_component(source "${source}" ABSOLUTE)
    get_filename_component(suite "${source}" NAME_WE)
    set(output "${directory}/${suite}.F90")
    add_custom_command(OUTPUT "${output}"
      COMMAND ${python} "${tool}" "${source}" "${output}"
      DEPENDS "${source}" "${tool}" "${PFUNIT_LITE_DIR}/pf_source.py"
      COMMENT "Preprocessing ${suite}.pf" VERBATIM)
    list(APPEND suites "${suite}")
    list(APPEND generated "${output}")
  endforeach()

  # The list of suites is a file so that Make, too, writes the driver again when it changes
  set(list "${directory}/suites.txt")
  file(GENERATE OUTPUT "${list}" CONTENT "${suites}\n")
  set(driver "${directory}/${name}_driver.f90")
  add_custom_command(OUTPUT "${driver}"
    COMMAND ${python} "${tool}" --driver "${driver}" ${suites}
    DEPENDS "${tool}" "${list}" COMMENT "Writing the driver of ${name}" VERBATIM)

  add_executable(${name} ${generated} "${driver}" ${arg_OTHER_SOURCES})
  target_link_libraries(${name} PRIVATE pfunit_lite ${arg_LINK_LIBRARIES})
  add_test(NAME ${name} COMMAND ${name} --verbose)
  pfunit_set_test_properties(${name})
  set_tests_properties(${name} PROPERTIES LABELS "${arg_LABELS}")
endfunction()
