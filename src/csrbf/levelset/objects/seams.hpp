#pragma once

#include "csrbf/core/grid.hpp"

#include <span>
#include <vector>

namespace csrbf {

/// Voxels inside (not 0) where the image has a valley, seen from the objects: after a Gaussian of 1.5 voxels it is
/// least across (brightest, where objects are darker than the outside), and bent more than noise and than a share of
/// the contrast. The mean counts of several components. O(voxels).
std::vector<std::uint8_t> find_seams(const Volume<float>& image, const std::vector<std::uint8_t>& inside);

/// Basins of the distance to the outside and to seams. Seams belong to the nearest basins; 0 where none is connected.
std::vector<std::int32_t> basins_between(const std::vector<std::uint8_t>& seams,
                                         const std::vector<std::uint8_t>& inside, const Grid& grid);

/// Leaves the voxels of seams that are deeper than two voxels inside.
void keep_deep(std::vector<std::uint8_t>& seams, const std::vector<std::uint8_t>& inside, const Grid& grid);

/// Whether another label than 0 and its own is beside a voxel or beside one of its neighbours in an object.
bool is_at_border(std::span<const std::int32_t> labels, Index voxel, const Grid& grid);

}  // namespace csrbf
