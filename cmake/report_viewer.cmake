# Bundles the interactive view of reports (viewer/) with three.js into one script. CSRBF_VIEWER_SCRIPT is its path and
# the target csrbf-viewer makes it; or it is empty: then reports and notebooks show still pictures. CSRBF_PLOTS_SCRIPT is
# that of pages without such a view, CSRBF_STUDIO_PAGE the page of the studio, likewise. three.js and esbuild come from Debian (libjs-three, esbuild) or, after
# `npm install` in viewer/, from there.
find_file(CSRBF_THREE_MODULE three.module.js
          PATHS ${PROJECT_SOURCE_DIR}/viewer/node_modules/three/build /usr/share/javascript/three
          NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH)
find_program(CSRBF_ESBUILD esbuild HINTS ${PROJECT_SOURCE_DIR}/viewer/node_modules/.bin)
mark_as_advanced(CSRBF_THREE_MODULE CSRBF_ESBUILD)

option(CSRBF_BUILD_VIEWER "Make surfaces in reports interactive, when three.js and esbuild are found" ON)

# csrbf_bundle(<entry> <output> [<view> <compile>]): one script of viewer/src/<entry> with what it imports; the picture in
# space of the studio is that of viewer/src/<view>, space/view.js if it is not given; <compile> compiles the programs of
# the studio without a server.
function(csrbf_bundle entry output)
  set(view space/view.js)
  if(ARGC GREATER 2)
    set(view ${ARGV2})
  endif()
  set(compile "")
  if(ARGC GREATER 3)
    set(compile ${ARGV3})
  endif()
  file(GLOB_RECURSE viewer_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/viewer/src/*.js)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CSRBF_ESBUILD} ${PROJECT_SOURCE_DIR}/viewer/src/${entry} --bundle --minify --format=iife --target=es2020
            --charset=ascii --legal-comments=inline --log-level=warning --alias:three=${CSRBF_THREE_MODULE}
            --alias:csrbf-view=${PROJECT_SOURCE_DIR}/viewer/src/${view} $<$<BOOL:${compile}>:--alias:csrbf-compile=${compile}>
            --outfile=${output}
    DEPENDS ${viewer_sources} ${CSRBF_THREE_MODULE} ${compile}
    COMMENT "Bundling viewer/src/${entry}"
    VERBATIM COMMAND_EXPAND_LISTS)
endfunction()

set(CSRBF_VIEWER_SCRIPT "")
set(CSRBF_PLOTS_SCRIPT "")
set(CSRBF_STUDIO_PAGE "")
if(CSRBF_BUILD_VIEWER AND CSRBF_THREE_MODULE AND CSRBF_ESBUILD)
  set(CSRBF_VIEWER_SCRIPT ${PROJECT_BINARY_DIR}/viewer/report_viewer.js)
  csrbf_bundle(main.js ${CSRBF_VIEWER_SCRIPT})
  set(CSRBF_PLOTS_SCRIPT ${PROJECT_BINARY_DIR}/viewer/report_plots.js)
  csrbf_bundle(plots.js ${CSRBF_PLOTS_SCRIPT})
  set(studio_script ${PROJECT_BINARY_DIR}/viewer/studio.js)
  csrbf_bundle(studio.js ${studio_script})
  set(CSRBF_STUDIO_PAGE ${PROJECT_BINARY_DIR}/viewer/studio.html)
  set(composer ${PROJECT_SOURCE_DIR}/cmake/studio_page.cmake)
  add_custom_command(
    OUTPUT ${CSRBF_STUDIO_PAGE}
    COMMAND ${CMAKE_COMMAND} -D SOURCE_DIR=${PROJECT_SOURCE_DIR} -D SCRIPT=${studio_script}
            -D OUTPUT=${CSRBF_STUDIO_PAGE} -P ${composer}
    DEPENDS ${composer} ${studio_script} ${PROJECT_SOURCE_DIR}/viewer/studio.html
            ${PROJECT_SOURCE_DIR}/viewer/studio.css ${PROJECT_SOURCE_DIR}/viewer/viewer.css
    VERBATIM)
  add_custom_target(csrbf-viewer DEPENDS ${CSRBF_VIEWER_SCRIPT} ${CSRBF_PLOTS_SCRIPT} ${CSRBF_STUDIO_PAGE})
else()
  message(STATUS "HTML reports show still pictures, and there is no studio: three.js (libjs-three) and esbuild make them")
endif()

# The server of the studio, which a page alone does without. Debian's library is compiled with these definitions, which
# change its types.
if(EMSCRIPTEN)
  return()
endif()
find_path(CSRBF_HTTPLIB_INCLUDE httplib.h)
find_library(CSRBF_HTTPLIB_LIBRARY cpp-httplib)
mark_as_advanced(CSRBF_HTTPLIB_INCLUDE CSRBF_HTTPLIB_LIBRARY)
if(CSRBF_HTTPLIB_INCLUDE AND NOT TARGET csrbf-httplib)
  add_library(csrbf-httplib INTERFACE)
  target_include_directories(csrbf-httplib SYSTEM INTERFACE ${CSRBF_HTTPLIB_INCLUDE})
  target_compile_definitions(csrbf-httplib INTERFACE CSRBF_HAS_HTTPLIB)
  if(CSRBF_HTTPLIB_LIBRARY)
    target_link_libraries(csrbf-httplib INTERFACE ${CSRBF_HTTPLIB_LIBRARY})
    target_compile_definitions(csrbf-httplib INTERFACE CPPHTTPLIB_OPENSSL_SUPPORT CPPHTTPLIB_ZLIB_SUPPORT
                                                       CPPHTTPLIB_BROTLI_SUPPORT)
  endif()
elseif(NOT CSRBF_HTTPLIB_INCLUDE)
  message(STATUS "No studio: cpp-httplib (libcpp-httplib-dev) is its server")
endif()
