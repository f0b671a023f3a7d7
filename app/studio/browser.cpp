#include "studio/browser.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace csrbf::app {

void open_in_browser(const std::string& address) {
#ifdef __APPLE__
  const char* opener = "open";
#else
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  const char* opener = "xdg-open";
#endif
  if (fork() != 0) return;
  std::freopen("/dev/null", "w", stdout);
  std::freopen("/dev/null", "w", stderr);
  execlp(opener, opener, address.c_str(), static_cast<char*>(nullptr));
  _exit(127);
}

}  // namespace csrbf::app
