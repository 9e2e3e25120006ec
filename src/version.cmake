# The version of a build, from git if this is a checkout, else from src/version.txt (source archives have
# it), else the number of project() alone. As a script it writes a source file when the version changed:
# cmake -DSOURCE=... -DNUMBER=... -DTEMPLATE=... -DTARGET=... -P version.cmake

# Sets CAROM_VERSION_TEXT, for example `0.1.0 (1161fc7)`: the number is that of the last tag v1.2.3, and
# stands alone if the checkout is that tag without changes
function(carom_find_version source number)
  if(EXISTS ${source}/src/version.txt)
    file(STRINGS ${source}/src/version.txt text LIMIT_COUNT 1)
    set(CAROM_VERSION_TEXT "${text}" PARENT_SCOPE)
    return()
  endif()
  set(CAROM_VERSION_TEXT "${number}" PARENT_SCOPE)
  find_program(CAROM_GIT git)
  if(NOT CAROM_GIT OR NOT EXISTS ${source}/.git)
    return()
  endif()
  execute_process(COMMAND ${CMAKE_COMMAND} -E env GIT_OPTIONAL_LOCKS=0
    ${CAROM_GIT} -C ${source} describe --tags --always --dirty
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(failed OR NOT commit MATCHES "^[0-9A-Za-z._+-]+$")
    return()
  endif()
  if(commit MATCHES "^v([0-9]+\\.[0-9]+\\.[0-9]+)")
    set(number ${CMAKE_MATCH_1})
  endif()
  if(commit STREQUAL "v${number}")
    set(CAROM_VERSION_TEXT "${number}" PARENT_SCOPE)
  else()
    set(CAROM_VERSION_TEXT "${number} (${commit})" PARENT_SCOPE)
  endif()
endfunction()

if(CMAKE_SCRIPT_MODE_FILE)
  carom_find_version(${SOURCE} ${NUMBER})
  configure_file(${TEMPLATE} ${TARGET} @ONLY)
endif()
