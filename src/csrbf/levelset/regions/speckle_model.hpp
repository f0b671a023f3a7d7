#pragma once

#include "csrbf/core/grid.hpp"

#include <optional>

namespace csrbf {

/// Fully developed speckle of two regions: echoes of many scatterers add up to a complex amplitude that is normal, so
/// their power P is exponential around the mean of the region, and the image shows P^(exponent / 2), scaled and
/// shifted: 0 the logarithm (an ultrasound image as displayed), 1 the envelope, 2 the power.
struct SpeckleModel {
  double exponent = 0;
  double mean = 1;                          ///< grey level of the brighter region on average
  double black = 0;                         ///< grey level of no echo
  std::array<double, 2> power{1, 1};        ///< mean power in the regions; 1 belongs to `mean`, roughly
  std::array<double, 3> grain = {0, 0, 0};  ///< standard deviation of the point spread of amplitudes, in voxels

  /// The power that a grey level shows.
  [[nodiscard]] double power_of(double grey) const;
  /// Voxels that one independent amplitude covers.
  [[nodiscard]] double voxels_per_grain() const;
};

/// The speckle of the image, or none where it does not follow that law: `labels` 0 and 1 are its regions, other voxels
/// are ignored. The means and deviations of the regions give the exponent; the image counts as speckle when neighbours
/// are correlated, distant voxels are not, and the skewness of the greys fits the law. From voxels away from the border
/// between the regions. O(n).
template <int Dim>
std::optional<SpeckleModel> find_speckle(std::span<const float> values, const Grid& grid,
                                         std::span<const std::uint8_t> labels);

}  // namespace csrbf
