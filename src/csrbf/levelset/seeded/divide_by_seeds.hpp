#pragma once

#include "csrbf/levelset/partition/partition.hpp"

#include <array>
#include <set>

namespace csrbf {

/// Pairs of labels that intensities do not tell apart, in ascending order.
struct AlikeLabels {
  std::set<std::array<int, 2>> divided;  ///< by their seeds
  std::set<std::array<int, 2>> open;     ///< seeds leave open where one of them ends: labels stay

  [[nodiscard]] bool empty() const { return divided.empty() && open.empty(); }
};

/// Where two of more than two regions are alike, the shortest contour runs around the seeds of one, and the other takes
/// all the rest. So those whose seeds differ by little more than two deviations become one region, whose contours are
/// found again and which nearest_seeds() divide, where one mean describes both in fewer nats, or where one is unlike
/// its own seeds, as what became the blurred border of both is. By the seeds that are certain; nothing without any.
AlikeLabels divide_by_seeds(PartitionPrice& price, const SeedCosts& seeds, int regions, Partition& found);

}  // namespace csrbf
