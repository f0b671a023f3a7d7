#include "common.hpp"
#include "studio/server.hpp"

#ifndef CSRBF_HAS_HTTPLIB

namespace csrbf::app {

void serve_studio(const StudioOptions& /*options*/) {
#ifdef _WIN32
  throw UsageError("csrbf studio: not on Windows; WSL runs the one for Linux");
#elif defined(__EMSCRIPTEN__)
  throw UsageError("csrbf studio: this is the one in the browser");
#else
  throw UsageError(
      "this csrbf was built without the studio: install cpp-httplib, three.js and esbuild (Debian: libcpp-httplib-dev "
      "libjs-three esbuild) and build it again");
#endif
}

}  // namespace csrbf::app

#endif
