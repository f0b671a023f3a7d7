#pragma once

#include "csrbf/levelset/regions/region_model.hpp"

namespace csrbf {

/// Shares of the intensities of a region that fall in each bin. Internal.
struct BinProbabilities {
  /// One voxel in a million may have any intensity, so that no share is 0; by hand: bounds the energy of a voxel at 14.
  static constexpr double contamination = 1e-6;

  Eigen::VectorXd values;  ///< bins; they sum to 1, as the end bins hold what lies beyond
  /// bins x 3: derivatives by location / scale, log scale and log shape; 0 for parameters that a law lacks or keeps
  /// fixed (the location of rayleigh and gamma).
  Eigen::MatrixX3d derivatives;
};

/// For all laws but chan_vese. O(bins).
void bin_probabilities(const RegionModel& model, const IntensityBins& bins, BinProbabilities& result);

}  // namespace csrbf
