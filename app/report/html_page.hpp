#pragma once

#include "command_line.hpp"
#include "report/page.hpp"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace csrbf::app {

/// Everything that a page shows.
struct PageContent {
  const nlohmann::ordered_json& report;     ///< the JSON report
  const CommonOptions& common;              ///< the command as typed, its flags
  const std::vector<std::string>& summary;  ///< lines shown on the terminal
  const Page& page;                         ///< what the command adds
};

/// One HTML file that needs nothing else: no network, no other file. The JSON report is in it as well.
std::string html_page(const PageContent& content);

}  // namespace csrbf::app
