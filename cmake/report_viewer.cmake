# Bundles the interactive view of reports (viewer/) with three.js into one script. CSRBF_VIEWER_SCRIPT is its path and
# the target csrbf-viewer makes it; or it is empty: then reports and notebooks show still pictures. three.js and esbuild come from Debian (libjs-three, esbuild) or, after
# `npm install` in viewer/, from there.
find_file(CSRBF_THREE_MODULE three.module.js
          PATHS ${PROJECT_SOURCE_DIR}/viewer/node_modules/three/build /usr/share/javascript/three
          NO_DEFAULT_PATH)
find_program(CSRBF_ESBUILD esbuild HINTS ${PROJECT_SOURCE_DIR}/viewer/node_modules/.bin)
mark_as_advanced(CSRBF_THREE_MODULE CSRBF_ESBUILD)

option(CSRBF_BUILD_VIEWER "Make surfaces in reports interactive, when three.js and esbuild are found" ON)

set(CSRBF_VIEWER_SCRIPT "")
if(CSRBF_BUILD_VIEWER AND CSRBF_THREE_MODULE AND CSRBF_ESBUILD)
  set(CSRBF_VIEWER_SCRIPT ${PROJECT_BINARY_DIR}/viewer/report_viewer.js)
  file(GLOB viewer_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/viewer/src/*.js)
  add_custom_command(
    OUTPUT ${CSRBF_VIEWER_SCRIPT}
    COMMAND ${CSRBF_ESBUILD} ${PROJECT_SOURCE_DIR}/viewer/src/main.js --bundle --minify --format=iife --target=es2020
            --charset=ascii --legal-comments=inline --log-level=warning --alias:three=${CSRBF_THREE_MODULE}
            --outfile=${CSRBF_VIEWER_SCRIPT}
    DEPENDS ${viewer_sources} ${CSRBF_THREE_MODULE}
    COMMENT "Bundling the viewer of reports"
    VERBATIM)
  add_custom_target(csrbf-viewer DEPENDS ${CSRBF_VIEWER_SCRIPT})
else()
  message(STATUS "HTML reports show still pictures: three.js (libjs-three) and esbuild make them interactive")
endif()
