#pragma once

#include "command_line.hpp"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace csrbf::app {

/// Every option with the value used, why it was chosen, and its meaning.
std::string option_table(const nlohmann::ordered_json& report, const std::vector<FlagUse>& flags);

}  // namespace csrbf::app
