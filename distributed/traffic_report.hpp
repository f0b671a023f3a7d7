#pragma once

#include "shares.hpp"

#include <nlohmann/json.hpp>

namespace csrbf::distributed {

/// For the report: what was shared, by name of the work.
nlohmann::ordered_json to_json(const TrafficTable& traffic);

}  // namespace csrbf::distributed
