# What is installed beside the program, and the packages made of it: `cpack` in the build directory makes
# a .deb and a .tar.gz, `cpack --config CPackSourceConfig.cmake` an archive of the sources.

set(packaging ${CMAKE_CURRENT_LIST_DIR})
set(data_folder ${CMAKE_INSTALL_DATADIR}/carom)

# gzipped as Debian has it, without name and time: the same bytes in every build
find_program(CAROM_GZIP gzip)
function(carom_install_gzipped source name folder)
  if(NOT CAROM_GZIP)
    install(FILES ${source} DESTINATION ${folder} RENAME ${name})
    return()
  endif()
  set(zipped ${PROJECT_BINARY_DIR}/${name}.gz)
  add_custom_command(OUTPUT ${zipped} DEPENDS ${source} VERBATIM
    COMMAND sh -c "\"$1\" -9nc \"$2\" > \"$3\"" gzip ${CAROM_GZIP} ${source} ${zipped})
  add_custom_target(gzipped_${name} ALL DEPENDS ${zipped})
  add_dependencies(carom gzipped_${name})
  install(FILES ${zipped} DESTINATION ${folder})
endfunction()

carom_install_gzipped(${packaging}/carom.1 carom.1 ${CMAKE_INSTALL_MANDIR}/man1)
carom_install_gzipped(${PROJECT_SOURCE_DIR}/CHANGELOG.md changelog ${CMAKE_INSTALL_DOCDIR})
carom_install_gzipped(${PROJECT_BINARY_DIR}/changelog.plain changelog.Debian ${CMAKE_INSTALL_DOCDIR})
install(FILES ${packaging}/carom.bash RENAME carom
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES README.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES LICENSE RENAME copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY input DESTINATION ${data_folder} FILES_MATCHING
  PATTERN *.inp PATTERN *.inc PATTERN *.md PATTERN *.py PATTERN *.png PATTERN *.geo
  PATTERN __pycache__ EXCLUDE)
# Those that need results only; the others are for a checkout
file(GLOB scripts CONFIGURE_DEPENDS scripts/carom_*.py scripts/plot_*.py scripts/mesh_from_*.py scripts/gmsh_*.py
  scripts/*_solutions.py)
install(FILES ${scripts} scripts/animate.py scripts/compare_exact.py scripts/requirements.txt
  DESTINATION ${data_folder}/scripts)

include(${PROJECT_SOURCE_DIR}/src/version.cmake)
carom_find_version(${PROJECT_SOURCE_DIR} ${PROJECT_VERSION})
string(REGEX MATCH "^[0-9.]+" number "${CAROM_VERSION_TEXT}")

set(CPACK_PACKAGE_NAME carom)
set(CPACK_PACKAGE_VENDOR "the carom developers")
set(CPACK_PACKAGE_VERSION ${number})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "structural dynamics with impact, contact and friction")
set(CPACK_PACKAGE_DESCRIPTION
  "carom computes how structures move when they hit something: masses, springs,
trusses, plane and axisymmetric solids, elastic or plastic, in time, at rest
and in free vibration, with contact, impact and friction. It reads decks of
keyword cards as in Abaqus and CalculiX, and writes HDF5 files that ParaView
opens.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE
  GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_GENERATOR TGZ)
find_program(CAROM_DPKG dpkg)
if(CAROM_DPKG)
  list(APPEND CPACK_GENERATOR DEB)
endif()

set(CAROM_MAINTAINER "the carom developers <carom@carom.invalid>" CACHE STRING
  "Name and address of who makes the package; .invalid has no mail")
set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${CAROM_MAINTAINER})
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
string(TIMESTAMP package_date "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(${packaging}/changelog.Debian.in ${PROJECT_BINARY_DIR}/changelog.plain @ONLY)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-h5py (>= 3.5), python3-matplotlib (>= 3.6), python3-numpy")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "paraview")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)

# Of a checkout what git would take: no build directories, environments, results
set(CPACK_SOURCE_GENERATOR TGZ)
set(CPACK_SOURCE_PACKAGE_FILE_NAME carom-${number})
string(REGEX REPLACE "([][+.*()^$?|\\])" "\\\\\\1" top "${PROJECT_SOURCE_DIR}")
set(CPACK_SOURCE_IGNORE_FILES "^${top}/\\.git$" "^${top}/\\.git/" "^${top}/build" "^${top}/\\.venv/"
  "^${top}/demo/" "^${top}/bench/" "^${top}/report/" "^${top}/fuzz/" "/__pycache__/" "\\.pyc$"
  "\\.h5$" "\\.h5\\.part$" "\\.h5\\.next$" "\\.sta$" "\\.log$" "\\.stop$")
set(CPACK_INSTALL_SCRIPTS ${packaging}/keep_version.cmake)
set(CPACK_CAROM_SOURCE ${PROJECT_SOURCE_DIR})
set(CPACK_CAROM_NUMBER ${PROJECT_VERSION})
include(CPack)
