#include "common.hpp"
#include "studio/server.hpp"

#ifndef CSRBF_HAS_HTTPLIB

namespace csrbf::app {

void serve_studio(const StudioOptions& /*options*/) {
  throw UsageError(
      "this csrbf was built without the studio: install cpp-httplib, three.js and esbuild (Debian: libcpp-httplib-dev "
      "libjs-three esbuild) and build it again");
}

}  // namespace csrbf::app

#endif
