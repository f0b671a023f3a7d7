#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/levelset/baselines/node_system.hpp"

namespace csrbf {

/// Labels of the voxels inside a level set on nodes, for repeated use. Keeps the values of all basis functions at all
/// voxels as a sparse matrix where that takes at most about 400 MB, and sums them anew where it does not.
template <int Dim>
class VoxelSampler {
 public:
  VoxelSampler(const RadialBasis<Dim>& basis, Points<Dim> voxels);

  /// Writes 1 where the function with these coefficients is positive and 0 elsewhere; returns how many labels changed.
  Index labels(const NodeSystem<Dim>& system, const Eigen::VectorXd& mu, unsigned char* labels) const;

 private:
  Points<Dim> voxels_;  // none when there is a matrix
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix_;
};

/// The weights with which values at the voxels are averaged around points (rows; they sum to 1): a Wendland function of
/// this radius around each point, in physical units; only the nearest voxel where none is closer than that.
template <int Dim>
Eigen::SparseMatrix<float, Eigen::RowMajor> velocity_weights(const Grid& grid, const Points<Dim>& points,
                                                             double radius);

/// The weights (points x voxels) of the multilinear interpolant of values at the voxels; that of the nearest place in
/// the image for points outside it.
template <int Dim>
Eigen::SparseMatrix<double, Eigen::RowMajor> linear_weights(const Grid& grid, const Points<Dim>& points);

}  // namespace csrbf
