# Finds the double precision solver of MUMPS for MPI: MUMPS::MUMPS, MUMPS_FOUND, MUMPS_VERSION.
find_path(MUMPS_INCLUDE_DIR dmumps_c.h PATH_SUFFIXES MUMPS mumps)
find_library(MUMPS_LIBRARY dmumps)
mark_as_advanced(MUMPS_INCLUDE_DIR MUMPS_LIBRARY)
if(MUMPS_INCLUDE_DIR)
  file(STRINGS ${MUMPS_INCLUDE_DIR}/dmumps_c.h version_line REGEX "define MUMPS_VERSION " LIMIT_COUNT 1)
  string(REGEX MATCH "[0-9]+\\.[0-9.]+[0-9]" MUMPS_VERSION "${version_line}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(MUMPS REQUIRED_VARS MUMPS_LIBRARY MUMPS_INCLUDE_DIR VERSION_VAR MUMPS_VERSION)
if(MUMPS_FOUND AND NOT TARGET MUMPS::MUMPS)
  add_library(MUMPS::MUMPS UNKNOWN IMPORTED)
  set_target_properties(MUMPS::MUMPS PROPERTIES IMPORTED_LOCATION ${MUMPS_LIBRARY}
                                                INTERFACE_INCLUDE_DIRECTORIES ${MUMPS_INCLUDE_DIR})
endif()
