#pragma once

#include "csrbf/core/grid.hpp"

#include <span>
#include <vector>

namespace csrbf {

/// What a local mean averages over: about a Gaussian whose standard deviation is `reach` times the longest side.
struct LocalMean {
  LocalMean(const Grid& grid, double reach);

  /// Replaces values by their local means.
  void average(std::span<float> values, const Grid& grid) const;

  std::array<Index, 3> half_width{0, 0, 0};  ///< of the three boxes with about that profile
  double parameters = 1;                     ///< independent numbers of such a mean over the image
};

/// The means of regions that have a background in common: the local mean of what their `means` leave, which are fitted
/// to the rest of it in turns, and each of these added to it. `mask`: empty, or 0 where values mean nothing. O(voxels).
std::vector<std::vector<float>> means_in_background(std::span<const float> values, std::span<const std::uint8_t> labels,
                                                    std::span<const std::uint8_t> mask, const Grid& grid,
                                                    const LocalMean& local_mean, std::vector<double>& means);

}  // namespace csrbf
