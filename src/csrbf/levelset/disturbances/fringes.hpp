#pragma once

#include "csrbf/core/grid.hpp"

#include <optional>
#include <span>
#include <vector>

namespace csrbf {

/// Waves that cover an image: of interference, of lines that a detector reads in turns, of a mesh.
struct Fringes {
  std::vector<float> values;  ///< the image without them
  Index waves;
};

/// Plane waves of which at least four cross the image and whose power is far above that of all frequencies close by, as
/// nothing of limited extent has it. In images with two axes. `mask` may be empty. O(voxels log(voxels)), 16 bytes for
/// each.
std::optional<Fringes> find_fringes(std::span<const float> values, const Grid& grid,
                                    std::span<const std::uint8_t> mask);

}  // namespace csrbf
