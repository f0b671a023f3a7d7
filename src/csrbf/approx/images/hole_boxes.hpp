#pragma once

#include "csrbf/approx/images/missing_voxels.hpp"

namespace csrbf {

/// A part of an image with a hole and the known voxels that fill it.
struct HoleBox {
  std::array<Index, 3> begin, end;  ///< in the image
  std::vector<Index> hole;          ///< voxels of the image, in ascending order

  /// Its voxels in the image, x fastest.
  [[nodiscard]] std::vector<Index> voxels(const Grid& grid) const;
  [[nodiscard]] Grid grid(const Grid& of_image) const;
};

/// The holes of an image, which two voxels or more separate, each in a box of its own as large as its rim; boxes may
/// overlap. Empty where these have more voxels than the image, or where there is one hole only.
std::vector<HoleBox> hole_boxes(const VoxelMask& missing, const Grid& grid);

/// Voxels of the largest hole.
Index largest_hole(VoxelMask missing, const Grid& grid);

/// A few of these holes, where there are many in space: a trial of all would take longer than to fill the image.
VoxelMask some_holes(VoxelMask holes, const Grid& grid);

}  // namespace csrbf
