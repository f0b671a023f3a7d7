#pragma once

#include "csrbf/levelset/lattice/lattice.hpp"

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

/// Level sets of label 0 outside a mask, where contours follow nothing; labels within it stay. Does nothing where no
/// other label is outside; empty: no mask.
template <int Dim>
void keep_to_mask(const Lattice<Dim>& lattice, std::span<const std::uint8_t> mask, int regions,
                  std::vector<std::uint8_t>& labels, std::vector<std::vector<float>>& coefficients);

}  // namespace csrbf
