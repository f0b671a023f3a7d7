#pragma once

#include "csrbf/core/grid.hpp"

#include <span>
#include <vector>

namespace csrbf {

/// What two labellings of an image by two regions cost in nats above the better one, as constant means with one
/// deviation (PartitionPrice).
struct TwoMeansPrices {
  double first = 0, second = 0;
  bool second_is_better = false;  ///< by more than a tenth of the contour of the first
};

/// `mask`: 0 in voxels that do not count; may be empty. `length`: nats for each voxel edge of a contour.
TwoMeansPrices two_means_prices(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask,
                                double length, std::span<const std::uint8_t> first,
                                std::span<const std::uint8_t> second);

}  // namespace csrbf
