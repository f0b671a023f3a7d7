#pragma once

#include "csrbf/core/grid.hpp"

#include <vector>

namespace csrbf {

/// One entry per voxel, not 0 in those that are marked.
using VoxelMask = std::vector<unsigned char>;

/// The axes of more than one voxel.
std::vector<int> long_axes(const Grid& grid);
/// Geometric mean of the spacings along these.
double mean_spacing(const Grid& grid);

/// City-block distance of every voxel to the nearest one with (mask[i] != 0) == wanted, in the unit of the spacing.
std::vector<float> distance_to(bool wanted, const VoxelMask& mask, const Grid& grid);

/// The voxels that are marked, in ascending order.
std::vector<Index> marked(const VoxelMask& mask);
/// Marks the voxels within `reach` voxels of marked ones along every axis.
VoxelMask grown(VoxelMask mask, const Grid& grid, Index reach);

/// Width of the rims of holes whose voxels are samples, in the unit of the spacing; at least one voxel is known.
double rim_of(const VoxelMask& missing, const Grid& grid);

/// The known voxels that become samples, in ascending order: those in rims of missing ones, or all of them.
std::vector<Index> sample_voxels(const VoxelMask& missing, const Grid& grid, Index known);

/// Holes of the same shape among the known voxels, to test fits on; empty when the missing voxels are scattered.
VoxelMask trial_holes(const VoxelMask& missing, const Grid& grid, Index known);
/// Some of the known voxels near missing ones, at most about 1000: one of each run of 5 or more, not always at the same
/// place in it.
VoxelMask trial_voxels(const std::vector<Index>& known, std::size_t voxels);

}  // namespace csrbf
