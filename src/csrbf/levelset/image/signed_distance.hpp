#pragma once

#include "csrbf/core/grid.hpp"

#include <vector>

namespace csrbf {

/// Distance of every voxel centre to the nearest voxel centre of the other label, less half the shortest edge, so that
/// contours lie midway between the voxels; positive where the label is not 0 (inside). In the unit of the spacing.
/// Where there is one label only: the diagonal of the image. O(voxels), on all threads.
std::vector<float> signed_distance(const Grid& grid, const unsigned char* labels);

}  // namespace csrbf
