#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// Points that stand for a probability density about its largest value: the place of that and two along each principal
/// axis (Julier and Uhlmann 1997).
struct PosteriorPoints {
  std::vector<Eigen::VectorXd> points;
  /// Logarithms of what a point stands for over the density there, under a normal law; but for a constant.
  Eigen::VectorXd log_volumes;
};

/// `hessian`: of minus the logarithm of the density, at `mode`. Points lie between the bounds.
PosteriorPoints posterior_points(const Eigen::VectorXd& mode, const Eigen::MatrixXd& hessian,
                                 const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

/// Few of many by their weights: each stands for the same share of the sum, but for those that stand for several.
struct Share {
  std::size_t number;
  double weight;  ///< the sum is 1
};
std::vector<Share> even_shares(const Eigen::VectorXd& log_weights, Index count);

}  // namespace csrbf
