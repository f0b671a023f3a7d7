#pragma once

#include "csrbf/core/types.hpp"

#include <cmath>

namespace csrbf {

/// Root mean square deviation of values (n x k, one component per column) from the means of their columns.
inline double deviation_of(const Eigen::MatrixXd& values) {
  const Eigen::MatrixXd centered = values.rowwise() - values.colwise().mean();
  return std::sqrt(centered.squaredNorm() / static_cast<double>(centered.size()));
}

}  // namespace csrbf
