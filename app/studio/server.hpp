#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace csrbf::app {

struct StudioOptions {
  std::vector<std::string> files;  ///< opened from the start
  int port = 0;                    ///< 0: a free one
  bool opens_browser = true;
  std::string folder;       ///< to work in; empty: a temporary one
  std::size_t largest = 0;  ///< bytes of a file that can be sent to it
};

/// Answers the studio's page (viewer/src/studio.js) on 127.0.0.1 until Ctrl-C. Its address, printed on standard output,
/// has a random token, without which nothing is answered. Commands run in processes of their own, one at a time and one
/// preview beside it; a closed page ends them. Throws UsageError when the port is taken or the program was built
/// without the studio.
void serve_studio(const StudioOptions& options);

}  // namespace csrbf::app
