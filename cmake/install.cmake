# What `cmake --install` installs: the library with its headers, find_package(csrbf), pkg-config csrbf, the program with
# its man page and completions, and the licence.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/csrbf)

install(
  TARGETS csrbf
  EXPORT csrbf-targets
  FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT csrbf-targets NAMESPACE csrbf:: DESTINATION ${package_dir})

get_target_property(library_type csrbf TYPE)
if(library_type STREQUAL "STATIC_LIBRARY")
  set(CSRBF_STATIC ON)
else()
  set(CSRBF_STATIC OFF)
endif()
# The packages of optional formats that are linked.
set(CSRBF_PARTS "")
if(TARGET GDCM::GDCM)
  list(APPEND CSRBF_PARTS GDCM)
  cmake_path(GET GDCM_MSFF_LIBRARY PARENT_PATH gdcm_dir)
  set(gdcm_flags " -L${gdcm_dir} -lgdcmMSFF -lgdcmDSED -lgdcmDICT -lgdcmCommon")
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/FindGDCM.cmake DESTINATION ${package_dir})
endif()
if(TARGET JPEG::JPEG)
  list(APPEND CSRBF_PARTS JPEG)
  set(jpeg_requires " libjpeg")
endif()
if(TARGET LASzip::LASzip)
  list(APPEND CSRBF_PARTS LASzip)
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/FindLASzip.cmake DESTINATION ${package_dir})
elseif(TARGET LAZPERF::lazperf)
  list(APPEND CSRBF_PARTS LAZPERF)
endif()
if(TARGET E57Format)
  list(APPEND CSRBF_PARTS E57Format)
endif()
list(JOIN CSRBF_PARTS " " CSRBF_PARTS)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/csrbf-config.cmake.in ${PROJECT_BINARY_DIR}/csrbf-config.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/csrbf-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/csrbf-config.cmake ${PROJECT_BINARY_DIR}/csrbf-config-version.cmake
        DESTINATION ${package_dir})

# Who links the static library links what it uses, whether or not pkg-config is asked for --static. Of the shared one
# pkg-config would ask for development files that no program needs.
if(CSRBF_STATIC)
  set(CSRBF_PC_REQUIRES " libpng libtiff-4 zlib qhull_r${jpeg_requires}")
  set(CSRBF_PC_LIBS " -pthread${gdcm_flags}")
endif()
if(CSRBF_LARGEST_DIMENSION EQUAL 3)
  set(CSRBF_PC_CFLAGS " -DCSRBF_FEW_DIMENSIONS")
endif()
file(RELATIVE_PATH up_to_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(${CMAKE_CURRENT_LIST_DIR}/csrbf.pc.in ${PROJECT_BINARY_DIR}/csrbf.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/csrbf.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

if(CSRBF_BUILD_APP)
  install(TARGETS csrbf-cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  if(NOT CMAKE_CROSSCOMPILING)
    install(DIRECTORY ${PROJECT_BINARY_DIR}/share/man/ DESTINATION ${CMAKE_INSTALL_MANDIR})
    install(DIRECTORY ${PROJECT_BINARY_DIR}/share/ DESTINATION ${CMAKE_INSTALL_DATAROOTDIR} PATTERN man EXCLUDE)
  endif()
endif()
