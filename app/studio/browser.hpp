#pragma once

#include <string>

namespace csrbf::app {

/// Opens an address in the user's browser, where there is a screen. Does nothing when that fails.
void open_in_browser(const std::string& address);

}  // namespace csrbf::app
