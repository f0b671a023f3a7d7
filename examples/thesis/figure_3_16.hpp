#pragma once

#include "figure.hpp"
#include "slice.hpp"

#include <vector>

namespace csrbf::thesis {

/// error_bounded of a slice, level by level.
struct BoundedLevels {
  double tolerance = 0;              ///< in units of the values
  Eigen::MatrixXd levels = {};       ///< pixels x levels
  std::vector<double> centers = {};  ///< by level
  Eigen::VectorXd max_errors = {};   ///< at the samples, by level
  Eigen::VectorXd above = {};        ///< share of the samples above the tolerance, by level
  double largest_error = 0;          ///< of the model at any sample
  std::vector<double> rmse = {};     ///< over all pixels, by level
};

/// `tolerance`: in ranges of the values; `centers`: of the first level.
BoundedLevels bounded_levels(const SampledSlice& sampled, double tolerance, Index centers);

Figure figure_3_16();

}  // namespace csrbf::thesis
