#pragma once

#include "csrbf/levelset/partition/partition.hpp"

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace csrbf {

/// How values are priced, and the best labels by a price, of one model or of all, from a start, too.
struct PartitionSearch {
  std::function<PartitionPrice(std::span<const float>)> price;
  std::function<Partition(PartitionPrice&, const std::optional<PartitionModel>&, std::span<const std::uint8_t>)> find;
};

/// What was found of the noise.
struct FollowedNoise {
  std::vector<float> values = {};           ///< of the image on the scale that was taken, if it is another
  std::optional<double> uneven_noise = {};  ///< growth of its deviation over the place (find_uneven_noise())
  std::optional<double> noise_growth = {};  ///< and with the intensity (noise_law())
};

/// Finds labels once more with voxels that count by the noise at their place, and takes them and their price where that
/// describes two regions better; where the noise grows with intensity, once more by the same model on a scale on which
/// it grows less.
FollowedNoise follow_noise(std::span<const float> values, Partition& found, std::optional<PartitionPrice>& price,
                           const PartitionSearch& search);

}  // namespace csrbf
