# Writes csrbf.spdx.json, the bill of materials (SPDX 2.3): what this build uses, with versions as found and licences.

set(sbom_packages "")
set(sbom_relationships "")

# sbom_package(NAME VERSION LICENCE HOMEPAGE RELATION): RELATION as in SPDX, from the package to csrbf.
macro(sbom_package name version licence homepage relation)
  string(REPLACE "_" "-" id "SPDXRef-${name}")
  string(
    APPEND
    sbom_packages
    ",\n    {\"SPDXID\": \"${id}\", \"name\": \"${name}\", \"versionInfo\": \"${version}\", "
    "\"licenseConcluded\": \"${licence}\", \"licenseDeclared\": \"${licence}\", \"copyrightText\": \"NOASSERTION\", "
    "\"homepage\": \"${homepage}\", \"downloadLocation\": \"NOASSERTION\", \"filesAnalyzed\": false}")
  string(APPEND sbom_relationships ",\n    {\"spdxElementId\": \"${id}\", \"relationshipType\": \"${relation}\", "
                                   "\"relatedSpdxElement\": \"SPDXRef-csrbf\"}")
endmacro()

# sbom_dependency(PACKAGE FOLDER VERSION-VARIABLE LICENCE HOMEPAGE RELATION): a package that find_package() found in the
# folder; nothing when it was not found.
macro(sbom_dependency package folder version_variable licence homepage relation)
  get_directory_property(found DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DEFINITION ${package}_FOUND)
  get_directory_property(found_version DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DEFINITION ${version_variable})
  if(NOT found_version)
    set(found_version NOASSERTION)
  endif()
  if(found)
    sbom_package(${package} ${found_version} ${licence} ${homepage} ${relation})
  endif()
endmacro()

sbom_dependency(Eigen3 src Eigen3_VERSION MPL-2.0 https://eigen.tuxfamily.org DEPENDENCY_OF)
sbom_dependency(nanoflann src nanoflann_VERSION BSD-2-Clause https://github.com/jlblancoc/nanoflann DEPENDENCY_OF)
sbom_dependency(PNG src PNG_VERSION_STRING libpng-2.0 http://www.libpng.org/pub/png/libpng.html DEPENDENCY_OF)
sbom_dependency(TIFF src TIFF_VERSION_STRING libtiff https://libtiff.gitlab.io/libtiff DEPENDENCY_OF)
sbom_dependency(ZLIB src ZLIB_VERSION_STRING Zlib https://zlib.net DEPENDENCY_OF)
sbom_dependency(Qhull src Qhull_VERSION Qhull http://www.qhull.org DEPENDENCY_OF)
sbom_dependency(GDCM src GDCM_VERSION BSD-3-Clause https://gdcm.sourceforge.net OPTIONAL_DEPENDENCY_OF)
sbom_dependency(JPEG src JPEG_VERSION IJG https://libjpeg-turbo.org OPTIONAL_DEPENDENCY_OF)
sbom_dependency(LAZPERF src LAZPERF_VERSION Apache-2.0 https://github.com/hobuinc/laz-perf OPTIONAL_DEPENDENCY_OF)
sbom_dependency(LASzip src LASzip_VERSION Apache-2.0 https://laszip.org OPTIONAL_DEPENDENCY_OF)
sbom_dependency(E57Format src E57Format_VERSION BSL-1.0 https://github.com/asmaloney/libE57Format OPTIONAL_DEPENDENCY_OF)
# In csrbf-gdal, which the library loads when it is needed.
sbom_dependency(GDAL src GDAL_VERSION MIT https://gdal.org OPTIONAL_DEPENDENCY_OF)
# Threads come from the C library, whose licence depends on the system.
sbom_dependency(Threads src Threads_VERSION NOASSERTION NONE RUNTIME_DEPENDENCY_OF)
if(CSRBF_BUILD_APP)
  sbom_dependency(CLI11 app CLI11_VERSION BSD-3-Clause https://github.com/CLIUtils/CLI11 DEPENDENCY_OF)
  sbom_dependency(nlohmann_json app nlohmann_json_VERSION MIT https://json.nlohmann.me DEPENDENCY_OF)
endif()
# three.js is embedded in the program when reports are interactive.
if(CSRBF_BUILD_VIEWER AND CSRBF_THREE_MODULE AND CSRBF_ESBUILD)
  file(STRINGS ${CSRBF_THREE_MODULE} three_version REGEX "REVISION = " LIMIT_COUNT 1)
  string(REGEX MATCH "[0-9]+" three_version "${three_version}")
  sbom_package(three 0.${three_version} MIT https://threejs.org OPTIONAL_DEPENDENCY_OF)
endif()
if(TARGET csrbf-httplib)
  file(STRINGS ${CSRBF_HTTPLIB_INCLUDE}/httplib.h httplib_version REGEX "define CPPHTTPLIB_VERSION \"" LIMIT_COUNT 1)
  string(REGEX MATCH "[0-9.]+" httplib_version "${httplib_version}")
  if(NOT httplib_version)
    set(httplib_version NOASSERTION)
  endif()
  sbom_package(cpp-httplib ${httplib_version} MIT https://github.com/yhirose/cpp-httplib OPTIONAL_DEPENDENCY_OF)
endif()
if(CSRBF_BUILD_PYTHON)
  sbom_dependency(Python3 python Python3_VERSION Python-2.0.1 https://www.python.org OPTIONAL_DEPENDENCY_OF)
  sbom_dependency(pybind11 python pybind11_VERSION BSD-3-Clause https://github.com/pybind/pybind11 OPTIONAL_DEPENDENCY_OF)
endif()
if(CSRBF_BUILD_TESTS)
  sbom_dependency(GTest tests GTest_VERSION BSD-3-Clause https://github.com/google/googletest TEST_DEPENDENCY_OF)
endif()
if(CSRBF_BUILD_BENCHMARKS)
  sbom_dependency(benchmark benchmarks benchmark_VERSION Apache-2.0 https://github.com/google/benchmark TEST_DEPENDENCY_OF)
  if(CSRBF_BENCHMARK_PEERS)
    sbom_dependency(ITK benchmarks ITK_VERSION Apache-2.0 https://itk.org TEST_DEPENDENCY_OF)
    sbom_dependency(ALGLIB benchmarks ALGLIB_VERSION GPL-2.0-or-later https://www.alglib.net TEST_DEPENDENCY_OF)
  endif()
endif()

string(TIMESTAMP sbom_created "%Y-%m-%dT%H:%M:%SZ" UTC)
string(MD5 sbom_digest "${PROJECT_VERSION}${sbom_packages}")
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/csrbf.spdx.json @ONLY CONTENT [[{
  "spdxVersion": "SPDX-2.3",
  "dataLicense": "CC0-1.0",
  "SPDXID": "SPDXRef-DOCUMENT",
  "name": "csrbf-@PROJECT_VERSION@",
  "documentNamespace": "urn:csrbf:sbom:@PROJECT_VERSION@:@sbom_digest@",
  "creationInfo": {"created": "@sbom_created@", "creators": ["Tool: csrbf-@PROJECT_VERSION@/cmake/sbom.cmake"]},
  "packages": [
    {"SPDXID": "SPDXRef-csrbf", "name": "csrbf", "versionInfo": "@PROJECT_VERSION@", "licenseConcluded": "MIT",
     "licenseDeclared": "MIT", "copyrightText": "the csrbf authors", "downloadLocation": "NOASSERTION",
     "filesAnalyzed": false}@sbom_packages@
  ],
  "relationships": [
    {"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": "SPDXRef-csrbf"}@sbom_relationships@
  ]
}
]])
install(FILES ${PROJECT_BINARY_DIR}/csrbf.spdx.json DESTINATION ${CMAKE_INSTALL_DOCDIR})
