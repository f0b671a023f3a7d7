#pragma once

#include "csrbf/core/grid.hpp"

#include <optional>
#include <span>
#include <vector>

namespace csrbf {

/// What may have been drawn over a picture: text, scale bars, arrows, outlines.
struct DrawnOver {
  std::vector<std::uint8_t> voxels;  ///< nonzero: it, or beside it
  float value;                       ///< of its first component
};

/// Thin strokes that have exactly the least or the greatest value of each component, and sharp edges: two voxels beside
/// them the picture is as it is farther away, which it is not beside bright things that a camera saw. In images with
/// two axes; none in drawings, in which strokes are the picture. O(voxels).
std::optional<DrawnOver> find_drawn_over(const Volume<float>& image, std::span<const std::uint8_t> mask);

}  // namespace csrbf
