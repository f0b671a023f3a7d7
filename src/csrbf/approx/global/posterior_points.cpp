#include "csrbf/approx/global/posterior_points.hpp"

#include "csrbf/linalg/decompositions.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace csrbf {

PosteriorPoints posterior_points(const Eigen::VectorXd& mode, const Eigen::MatrixXd& hessian,
                                 const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  constexpr double widest = 2;  // standard deviation, of logarithms; chosen by hand
  const Index p = mode.size();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(hessian);
  const Eigen::ArrayXd deviations = axes.eigenvalues().array().max(1 / (widest * widest)).rsqrt();
  const double reach = std::sqrt(static_cast<double>(p + 1));
  PosteriorPoints result;
  result.points.push_back(mode);
  for (Index k = 0; k < p; ++k)
    for (const double side : {-reach, reach})
      result.points.emplace_back(
          (mode + side * deviations[k] * axes.eigenvectors().col(k)).cwiseMax(lower).cwiseMin(upper));
  // Weights 1 / (p + 1), and half of it for each other point, over densities that fall by exp(-reach^2 / 2).
  result.log_volumes.setConstant(2 * p + 1, reach * reach / 2 - std::log(2));
  result.log_volumes[0] = 0;
  result.log_volumes.array() += deviations.log().sum();
  return result;
}

std::vector<Share> even_shares(const Eigen::VectorXd& log_weights, Index count) {
  const Eigen::ArrayXd weights = (log_weights.array() - log_weights.maxCoeff()).exp();
  std::vector<Index> order(static_cast<std::size_t>(weights.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return weights[a] > weights[b]; });
  const double share = 1 / static_cast<double>(count);
  std::vector<Share> result;
  double sum = 0, given = 0;
  for (const Index k : order) {
    sum += weights[k] / weights.sum();
    const double here = share * std::floor(sum / share + 0.5) - given;
    if (here > 0) result.push_back({static_cast<std::size_t>(k), here});
    given += std::max(here, 0.0);
  }
  return result;
}

}  // namespace csrbf
