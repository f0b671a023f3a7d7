#pragma once

#include "csrbf/levelset/partition/partition.hpp"

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace csrbf {

/// Classes of an image after a Gaussian.
struct BlurredClasses {
  std::vector<std::uint8_t> labels;       ///< by ascending mean
  double deviation = 0;                   ///< of the Gaussian, in voxels of the shortest edge
  MeanShape light = MeanShape::constant;  ///< that was taken off before, for all regions; smooth: a local mean
};

/// Regions by classes of the blurred image, where these follow the image without its noise better than others do: for
/// tissues that grow into each other, whose borders are no short contours between constant means, and where contours
/// of two regions cost more than what they tell apart. To judge, noise e of the deviation s of that in the image is
/// added and subtracted: x + 0.7 e and x - e / 0.7 have independent noise, so that labels found in the first leave the
/// fewer squares about their means in the second, the better they suit the image without noise (Leiner et al. 2023).
/// The others are those that `find` finds there; of two regions those of `found`, whose noise may differ and which
/// classes have to be worth a parameter more than. Where the means of `found` vary, classes of the image without light
/// are tried, too, and quadratics are the means. None when the others suit the image as well, or there is no noise.
/// `mask`: 0 in voxels that do not count; may be empty.
std::optional<BlurredClasses> blurred_classes(
    std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask, int regions,
    const Partition& found, const std::function<std::vector<std::uint8_t>(std::span<const float>)>& find);

}  // namespace csrbf
