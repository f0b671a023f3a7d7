#pragma once

#include "csrbf/core/grid.hpp"

#include <cmath>
#include <optional>
#include <span>
#include <vector>

namespace csrbf {

/// How the variance of the noise grows with intensity: linearly between two intensities, as that of photons does.
struct NoiseLaw {
  double lo = 0, hi = 1;                   ///< intensities, lo < hi
  double dark_variance = 1, variance = 1;  ///< at lo and at hi; positive

  /// Deviation at the bright end over that at the dark end.
  [[nodiscard]] double growth() const { return std::sqrt(variance / dark_variance); }
};

/// The law of an image, from second differences in windows of 3 x 3 voxels of one region and the means of these; none
/// when the variance does not at least double, when less than a fifth of a region is farther than two voxels from its
/// border, so that blurred edges count for much, or when too few windows show. `mask`: 0 in voxels that do not count;
/// may be empty. O(voxels), 8 bytes for each.
std::optional<NoiseLaw> noise_law(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> labels,
                                  std::span<const std::uint8_t> mask);

/// The values on a scale that agrees with theirs at lo and hi and rises like variance^(-1/5) between: two fifths
/// of the way, by ratios, from the scale of the image to that on which the noise is even. What makes voxels of a region
/// differ is part noise, part structure that does not grow with it.
std::vector<float> even_noise(std::span<const float> values, const NoiseLaw& law);

}  // namespace csrbf
