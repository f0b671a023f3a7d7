#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace csrbf::app {

/// Why an option that was not given has its value, in a few words; empty for fixed defaults. `report` is the JSON
/// report.
std::string option_reason(const nlohmann::ordered_json& report, const std::string& option);

/// The meaning of an option that is chosen automatically and has no flag; empty for others.
std::string option_meaning(const std::string& subcommand, const std::string& option);

}  // namespace csrbf::app
