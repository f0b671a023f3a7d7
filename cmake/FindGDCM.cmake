# Grassroots DICOM (BSD licence): the target GDCM::GDCM. The package's own configuration requires its programs and VTK
# too.
find_path(
  GDCM_INCLUDE_DIR gdcmImageReader.h
  PATH_SUFFIXES gdcm-3.0 gdcm
  DOC "Folder of the headers of GDCM")
set(gdcm_parts MSFF DSED DICT Common)
foreach(part IN LISTS gdcm_parts)
  find_library(GDCM_${part}_LIBRARY gdcm${part})
  mark_as_advanced(GDCM_${part}_LIBRARY)
  list(APPEND gdcm_libraries GDCM_${part}_LIBRARY)
endforeach()
mark_as_advanced(GDCM_INCLUDE_DIR)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(GDCM REQUIRED_VARS GDCM_INCLUDE_DIR ${gdcm_libraries})

if(GDCM_FOUND AND NOT TARGET GDCM::GDCM)
  add_library(GDCM::GDCM INTERFACE IMPORTED)
  target_include_directories(GDCM::GDCM INTERFACE ${GDCM_INCLUDE_DIR})
  foreach(library IN LISTS gdcm_libraries)
    target_link_libraries(GDCM::GDCM INTERFACE ${${library}})
  endforeach()
endif()
