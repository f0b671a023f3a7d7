#pragma once

#include "csrbf/core/types.hpp"

#include <cmath>

namespace csrbf {

/// Root mean square of errors (n x k, one component per column), with a weight per row (n, positive sum).
inline double weighted_rms(const Eigen::MatrixXd& errors, const Eigen::VectorXd& weights) {
  return std::sqrt((weights.cwiseSqrt().asDiagonal() * errors).squaredNorm() /
                   (weights.sum() * static_cast<double>(errors.cols())));
}

/// The weighted_rms of values after subtracting the weighted mean of each column.
inline double weighted_deviation(const Eigen::MatrixXd& values, const Eigen::VectorXd& weights) {
  const Eigen::RowVectorXd mean = weights.transpose() * values / weights.sum();
  return weighted_rms(values.rowwise() - mean, weights);
}

}  // namespace csrbf
