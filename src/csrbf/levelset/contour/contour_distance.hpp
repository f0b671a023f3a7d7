#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/grid.hpp"

#include <cstdint>
#include <vector>

namespace csrbf {

/// Signed distance of every voxel centre to the contour f = 0 of a segmentation, positive inside, in the unit of the
/// spacing. In the voxels next to the contour f / |grad f|; elsewhere signed_distance(). O(voxels), on all
/// threads.
template <int Dim>
std::vector<float> contour_distance(const Grid& grid, const std::vector<std::uint8_t>& labels, const Field<Dim>& field);

}  // namespace csrbf
