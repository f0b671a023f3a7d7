#pragma once

#include "csrbf/approx/images/missing_voxels.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <algorithm>

namespace csrbf {

/// Physical coordinates along the (long) axes of the image: distances are what they are in space.
template <int Dim>
Points<Dim> voxel_positions(const std::vector<Index>& voxels, const Grid& grid) {
  const std::vector<int> axes = long_axes(grid);
  Points<Dim> points = Points<Dim>::Zero(Dim, static_cast<Index>(voxels.size()));
  for (Index k = 0; k < points.cols(); ++k) {
    Index rest = voxels[k];
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const Index size = grid.size[axes[i]];
      points(static_cast<Index>(i), k) = grid.spacing[axes[i]] * static_cast<double>(rest % size);
      rest /= size;
    }
  }
  return points;
}

/// Components of one frame with the same missing voxels.
template <class Scalar>
struct ImagePart {
  Eigen::Map<typename Volume<Scalar>::Values> frame;  // components x voxels
  Index first, count;                                 // components
  const Grid& grid;
  VoxelMask missing;

  [[nodiscard]] Index missing_voxels() const {
    return static_cast<Index>(missing.size()) - std::count(missing.begin(), missing.end(), 0);
  }
};

/// The values of some of its voxels.
template <int Dim, class Scalar>
Samples<Dim> samples_at(const std::vector<Index>& voxels, const ImagePart<Scalar>& part) {
  return {voxel_positions<Dim>(voxels, part.grid),
          part.frame(Eigen::seqN(part.first, part.count), voxels).transpose().template cast<double>(),
          {}};
}

}  // namespace csrbf
