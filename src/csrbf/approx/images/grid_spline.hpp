#pragma once

#include "csrbf/core/grid.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace csrbf {

/// The smoothest values of unknown voxels beside the known ones, on the grid itself: they minimise the sum of the
/// squared second differences (thin plates), plus `tension` times that of the first ones in units of a voxel, of all
/// voxels. 0: biharmonic; large: harmonic, which overshoots nowhere.
///
/// `values`: one row per voxel, x fastest, one column per component; rows of unknown voxels (not 0 in `unknown`) are
/// replaced. At least one voxel must be known. Cost: a sparse Cholesky factor of as many rows as there are unknown
/// voxels, about 5 us each in the plane.
void fill_by_grid_spline(const Grid& grid, std::span<const std::uint8_t> unknown, double tension,
                         Eigen::Ref<Eigen::MatrixXd> values);

}  // namespace csrbf
