#pragma once

#include "figure.hpp"

#include <vector>

namespace csrbf::thesis {

/// PCA multiresolution of `peaks` from 500 random samples of [-3, 3]^2, first clusters of at most 100 samples.
struct PeaksLevels {
  Eigen::MatrixXd levels;               ///< values on a lattice of 61 x 61 points: one column per level
  Eigen::VectorXd truth;                ///< there
  std::vector<double> centers = {};     ///< by level
  std::vector<double> rmse = {};        ///< on the lattice, by level
  std::vector<double> max_errors = {};  ///< at the samples, by level
};

PeaksLevels peaks_levels(double tolerance);

/// RMSE on the lattice of the default fit of the library to the same samples.
double peaks_default_fit();

Figure figure_3_9();

}  // namespace csrbf::thesis
