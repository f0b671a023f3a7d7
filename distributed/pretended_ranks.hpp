#pragma once

#include "shares.hpp"

#include <vector>

namespace csrbf::distributed {

/// A single process that computes everything and counts what several ranks would exchange.
class PretendedRanks : public WorkSharing {
 public:
  explicit PretendedRanks(int ranks) : traffic_(static_cast<std::size_t>(ranks)) {}

  void share(const SharedWork& work) override;

  /// One table per rank.
  [[nodiscard]] const std::vector<TrafficTable>& traffic() const { return traffic_; }

 private:
  std::vector<TrafficTable> traffic_;
};

}  // namespace csrbf::distributed
