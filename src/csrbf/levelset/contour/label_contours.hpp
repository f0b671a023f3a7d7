#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/levelset/lattice/lattice.hpp"
#include "csrbf/levelset/segment_options.hpp"

#include <span>
#include <vector>

namespace csrbf {

/// Level sets with these labels at the voxels, as nearly as the lattice can: one of region 1 for two regions, else one
/// of each, the largest of which labels a voxel. `force`: of two regions the cost inside minus that outside, which says
/// where the contour lies between voxels; empty: midway. A least-squares fit, then every voxel on the wrong side is
/// pushed across. Labels are replaced by those of the level sets.
template <int Dim>
std::vector<std::vector<float>> label_contours(const Lattice<Dim>& lattice, std::span<const float> force, int regions,
                                               std::vector<std::uint8_t>& labels);

/// Gives label 0, and level sets of it, to voxels outside the mask of the options, where contours follow nothing, and
/// label 1 to holes where `fill_holes` is true. Other labels stay, and so do the level sets there.
template <int Dim>
void correct_labels(const Lattice<Dim>& lattice, const Grid& grid, const SegmentOptions& options,
                    std::vector<std::uint8_t>& labels, std::vector<std::vector<float>>& coefficients);

}  // namespace csrbf
