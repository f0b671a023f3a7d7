# Not built yet: vcpkg was not at hand. Checked: the syntax, the version, the libraries and the options of CMake.
set(SOURCE_PATH ${CURRENT_PORT_DIR}/../..) # at a release: vcpkg_from_github with the checksum of its archive

vcpkg_check_features(OUT_FEATURE_OPTIONS features FEATURES tools CSRBF_BUILD_APP)
vcpkg_cmake_configure(
  SOURCE_PATH ${SOURCE_PATH} OPTIONS ${features} -DCSRBF_BUILD_TESTS=OFF -DCSRBF_BUILD_PYTHON=OFF -DCSRBF_USE_GDCM=OFF
          -DCSRBF_USE_GDAL=OFF -DCSRBF_USE_JPEG=OFF -DCSRBF_USE_LAZ=OFF -DCSRBF_USE_E57=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/csrbf)
vcpkg_fixup_pkgconfig()
if("tools" IN_LIST FEATURES)
  vcpkg_copy_tools(TOOL_NAMES csrbf AUTO_CLEAN)
endif()
file(REMOVE_RECURSE ${CURRENT_PACKAGES_DIR}/debug/include ${CURRENT_PACKAGES_DIR}/debug/share)
vcpkg_install_copyright(FILE_LIST ${SOURCE_PATH}/LICENSE)
