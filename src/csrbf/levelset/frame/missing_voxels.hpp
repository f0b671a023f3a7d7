#pragma once

#include "csrbf/core/grid.hpp"

#include <optional>
#include <span>
#include <vector>

namespace csrbf {

/// The mask (empty: all voxels) without those whose values are not numbers (NaN) or that have `value` in all
/// components; 0 in these. As it was, and maybe empty, where there are none.
std::vector<std::uint8_t> without_missing_voxels(const Volume<float>& image, std::optional<double> value,
                                                 std::vector<std::uint8_t> mask);

/// Voxels that have one value exactly, as those without data do.
struct MissingBlock {
  float value;
  double share;  ///< of the voxels in the mask
  /// 0, 1 and the ends of 8 to 14 bits are also what the darkest and brightest things have.
  bool may_be_dark_or_bright;
};

/// The least or the greatest value, if it is farther from all others than these are from one another, and in a block
/// that hangs together and reaches the border of the image; or a negative one, where no other is or which is ten times
/// as far, anywhere. Of drawings, with at most 16 values, none. Of images with one component; O(voxels).
std::optional<MissingBlock> find_missing_block(const Volume<float>& image, std::span<const std::uint8_t> mask);

}  // namespace csrbf
