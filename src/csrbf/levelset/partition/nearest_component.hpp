#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/levelset/convex/convex_contour.hpp"

#include <span>
#include <vector>

namespace csrbf {

/// For every voxel the connected component (by faces) of the voxels of one label that it belongs to.
struct VoxelComponents {
  std::vector<std::int32_t> component;  ///< 0 to count - 1, in the order of their first voxels; -1: none
  std::size_t count = 0;
  std::vector<std::int32_t> steps = {};  ///< of nearest_components(): from each voxel to its component
};

/// O(voxels).
VoxelComponents voxel_components(std::span<const std::uint8_t> labels, std::uint8_t label, const Grid& grid);

/// The same, and for voxels of other labels the component that is nearest by steps along the axes. When no voxel has
/// the label, all belong to component 0 of 1. O(voxels), two sweeps; 8 bytes per voxel.
VoxelComponents nearest_components(std::span<const std::uint8_t> labels, std::uint8_t label, const Grid& grid);

/// Of each of the nearest_components() whether its mean is above at least half of the other voxels up to three steps
/// from it by more than `step`, or below for a negative step; true if there are none. `mask` may be empty.
std::vector<bool> stand_out(const VoxelComponents& nearest, std::span<const float> values,
                            std::span<const std::uint8_t> mask, std::span<const double> means, double step);

/// Gives the parts of labels 0 and 1 that save less than the price of a place beyond their contour, by the cost of each
/// voxel in 1 minus that in 0, to the other label.
void drop_parts(std::span<const float> force, const Grid& grid, const ContourWeight& weight, double place_price,
                std::span<std::uint8_t> labels);

}  // namespace csrbf
