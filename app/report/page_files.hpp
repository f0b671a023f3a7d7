#pragma once

#include <string_view>

namespace csrbf::app {

// Files that are embedded in the program at build time (cmake/embed_page.cmake).

extern const std::string_view page_style;         ///< viewer/report.css
extern const std::string_view page_script;        ///< viewer/src with three.js; empty when that was not found
extern const std::string_view page_plots_script;  ///< without three.js, for pages without a view in space; or empty
extern const std::string_view page_licence;       ///< of both
extern const std::string_view studio_page;  ///< viewer/studio.html with its style and script; empty without script

}  // namespace csrbf::app
