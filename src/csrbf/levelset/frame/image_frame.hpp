#pragma once

#include "csrbf/core/grid.hpp"

#include <optional>
#include <span>
#include <vector>

namespace csrbf {

/// What surrounds the picture in an image that was turned, stitched, padded or seen through a round aperture.
struct ImageFrame {
  std::vector<std::uint8_t> outside;  ///< 1 in its voxels, and in those beside it whose values are mixed with its own
  float value;                        ///< of its first component, where it is largest
  int values;                         ///< how many different ones it has
  double share;                       ///< of the voxels in the mask
};

/// Parts at the border of the image that have exactly the value of a corner, or the least or the greatest one, and that
/// end at straight lines or planes, a few for each, or all at one circle or cylinder around the middle: things rarely
/// do. The greatest value, which bright things have, must have a corner if its ends are straight. None of drawings, and
/// none where at least half of the rest has one value, too, or fewer than 100 voxels are left. O(voxels) for each of
/// these values.
std::optional<ImageFrame> find_image_frame(const Volume<float>& image, std::span<const std::uint8_t> mask);

/// Whether it has at most 16 values.
bool is_drawing(std::span<const float> values);

}  // namespace csrbf
