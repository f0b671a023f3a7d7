#pragma once

#include "command_line.hpp"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace csrbf::app {

/// Every option with the value used, who decided it and why, and what it means.
std::string option_table(const nlohmann::ordered_json& report, const std::vector<FlagUse>& flags);

}  // namespace csrbf::app
