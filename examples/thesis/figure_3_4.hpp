#pragma once

#include "figure.hpp"

#include <vector>

namespace csrbf::thesis {

/// 100 random samples of the signal (3.5), uniform on [0, 1], and their PCA multiresolution approximation with clusters
/// of at most 40 samples.
struct SignalLevels {
  Eigen::VectorXd points;
  Eigen::VectorXd values;
  Eigen::VectorXd x;                    ///< 1001 places
  Eigen::VectorXd truth;                ///< there
  Eigen::MatrixXd levels;               ///< 1001 x levels: the approximations there
  std::vector<double> max_errors = {};  ///< at the samples, by level
  std::vector<double> centers = {};     ///< by level
};

/// Fig. 3.4: tolerance 0.1, no noise.
SignalLevels signal_levels(double tolerance);

/// Fig. 3.6: error of the approximation against the tolerance, median over `draws` draws of places and noise.
struct ThresholdCurve {
  double snr = 0;    ///< dB
  double noise = 0;  ///< standard deviation, mean over the draws
  std::vector<double> thresholds = {};
  std::vector<double> errors = {};  ///< root mean square at the samples, against the signal without noise
  [[nodiscard]] std::size_t best() const;
};

ThresholdCurve threshold_curve(double snr, const std::vector<double>& thresholds, int draws);

/// Figs. 3.4, 3.5 and 3.6.
Figure figure_3_4();

}  // namespace csrbf::thesis
