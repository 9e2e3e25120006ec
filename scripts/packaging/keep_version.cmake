# Run by CPack: an archive of the sources keeps its version, since it has no git, in src/version.txt.
if(CPACK_SOURCE_INSTALLED_DIRECTORIES)
  include(${CPACK_CAROM_SOURCE}/src/version.cmake)
  carom_find_version(${CPACK_CAROM_SOURCE} ${CPACK_CAROM_NUMBER})
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/src/version.txt "${CAROM_VERSION_TEXT}\n")
endif()
