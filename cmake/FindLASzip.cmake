# LASzip (LGPL 2.1, from version 3.5 on Apache 2.0): the target LASzip::LASzip. It brings no configuration of its own.
find_path(LASzip_INCLUDE_DIR laszip/laszip_api.h DOC "Folder of the headers of LASzip")
find_library(LASzip_LIBRARY NAMES laszip laszip3)
mark_as_advanced(LASzip_INCLUDE_DIR LASzip_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LASzip REQUIRED_VARS LASzip_LIBRARY LASzip_INCLUDE_DIR)
if(LASzip_FOUND AND NOT TARGET LASzip::LASzip)
  add_library(LASzip::LASzip UNKNOWN IMPORTED)
  set_target_properties(LASzip::LASzip PROPERTIES IMPORTED_LOCATION ${LASzip_LIBRARY}
                                                  INTERFACE_INCLUDE_DIRECTORIES ${LASzip_INCLUDE_DIR})
endif()
