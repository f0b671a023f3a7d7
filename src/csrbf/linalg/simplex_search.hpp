#pragma once

#include <Eigen/Core>

#include <functional>

namespace csrbf {

struct SimplexSearchOptions {
  int evaluations = 60;     ///< at most, about
  double tolerance = 1e-3;  ///< ends when the values at all corners differ by less
};

struct SimplexMinimum {
  Eigen::VectorXd x;
  double value = 0;
};

/// Searches a minimum of f from `start` without derivatives (Nelder and Mead 1965). The first simplex has the corners
/// start and start + steps[a] e_a. Values that are not finite count as infinite. Deterministic.
SimplexMinimum simplex_search(const std::function<double(const Eigen::VectorXd&)>& f, const Eigen::VectorXd& start,
                              const Eigen::VectorXd& steps, const SimplexSearchOptions& options = {});

}  // namespace csrbf
