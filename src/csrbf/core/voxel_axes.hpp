#pragma once

#include "csrbf/core/grid.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace csrbf {

/// Largest difference from a right angle between two of the axes along which there are voxels, in degrees. Files such
/// as NIfTI with a sheared affine map have other angles.
inline double skew(const Grid& grid) {
  double largest = 0;  // cosine
  for (int a = 0; a < grid.dimension(); ++a)
    for (int b = 0; b < a; ++b) largest = std::max(largest, std::abs(grid.direction.col(a).dot(grid.direction.col(b))));
  return 180 / std::numbers::pi * std::asin(std::min(1.0, largest));
}

/// The steps from a voxel to its neighbours, as columns, in axes at right angles of which the first is that of the
/// image and the first two span its plane: an upper triangular matrix; the spacing on the diagonal where axes are at
/// right angles.
inline Eigen::Matrix3d voxel_axes(const Grid& grid) {
  constexpr double rounding = 1e-3;  // degrees, of directions in single precision
  if (skew(grid) < rounding) return grid.spacing.asDiagonal();
  const Eigen::Matrix3d axes = grid.direction * grid.spacing.asDiagonal();
  return (axes.transpose() * axes).llt().matrixU();
}

/// Length, area or volume of a voxel in so many dimensions as the grid has.
inline double voxel_volume(const Grid& grid) {
  return voxel_axes(grid).diagonal().head(grid.dimension()).prod();
}

}  // namespace csrbf
