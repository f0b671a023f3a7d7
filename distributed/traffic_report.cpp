#include "traffic_report.hpp"

namespace csrbf::distributed {

nlohmann::ordered_json to_json(const TrafficTable& traffic) {
  nlohmann::ordered_json result = nlohmann::ordered_json::object();
  for (const auto& [name, t] : traffic)
    result[name] = {{"works", t.works},    {"items", t.items},     {"computed", t.computed},
                    {"rounds", t.rounds},  {"sent_bytes", t.sent}, {"received_bytes", t.received},
                    {"seconds", t.seconds}};
  return result;
}

}  // namespace csrbf::distributed
