#include "csrbf/linalg/quasi_newton_search.hpp"

#include "csrbf/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {

QuasiNewtonMinimum quasi_newton_search(
    const std::function<double(const Eigen::VectorXd&, Eigen::VectorXd& gradient)>& f, const Eigen::VectorXd& start,
    const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, const QuasiNewtonOptions& options) {
  const Eigen::Index n = start.size();
  require(n > 0 && lower.size() == n && upper.size() == n, "quasi_newton_search", "start", n,
          "there must be a variable, and a lower and an upper bound for each");
  constexpr double sufficient = 1e-4;  // share of the decrease that the slope promises (Armijo)
  constexpr double cut = 0.25;         // of a step that does not lower the value
  constexpr int most_cuts = 6;
  Eigen::VectorXd x = start.cwiseMax(lower).cwiseMin(upper), gradient = Eigen::VectorXd::Zero(n), next_gradient(n);
  int count = 0;
  const auto at = [&](const Eigen::VectorXd& place, Eigen::VectorXd& slope) {
    ++count;
    const double value = f(place, slope);
    return std::isfinite(value) && slope.allFinite() ? value : std::numeric_limits<double>::infinity();
  };
  double value = at(x, gradient);
  if (!std::isfinite(value)) return {x, value};
  Eigen::MatrixXd H = Eigen::MatrixXd::Identity(n, n);
  bool is_scaled = false;
  while (count < options.evaluations) {
    // Variables at a bound that the slope pushes them across stay there.
    Eigen::VectorXd free = Eigen::VectorXd::Ones(n);
    for (Eigen::Index i = 0; i < n; ++i)
      if ((x[i] <= lower[i] && gradient[i] > 0) || (x[i] >= upper[i] && gradient[i] < 0)) free[i] = 0;
    const Eigen::VectorXd slope = gradient.cwiseProduct(free);
    Eigen::VectorXd step = -(H * slope).cwiseProduct(free);
    if (!(step.dot(slope) < 0)) {
      H.setIdentity();
      is_scaled = false;
      step = -slope;
    }
    const double size = step.cwiseAbs().maxCoeff();
    if (!(size > 0)) break;
    const double wanted = is_scaled ? std::min(size, options.largest_step) : options.first_step;
    step *= wanted / size;
    Eigen::VectorXd next;
    double next_value = std::numeric_limits<double>::infinity();
    for (int k = 0; k < most_cuts && count < options.evaluations; ++k, step *= cut) {
      next = (x + step).cwiseMax(lower).cwiseMin(upper);
      next_value = at(next, next_gradient);
      if (next_value <= value + sufficient * slope.dot(next - x)) break;
      next_value = std::numeric_limits<double>::infinity();
    }
    if (!(next_value < value)) break;
    const Eigen::VectorXd s = next - x, y = next_gradient - gradient;
    const double curvature = s.dot(y);
    if (curvature > 1e-10 * s.norm() * y.norm()) {
      if (!is_scaled) H = Eigen::MatrixXd::Identity(n, n) * (curvature / y.squaredNorm());
      const Eigen::VectorXd Hy = H * y;
      H += (1 + y.dot(Hy) / curvature) / curvature * s * s.transpose() -
           (Hy * s.transpose() + s * Hy.transpose()) / curvature;
      is_scaled = true;
    }
    const double gain = value - next_value;
    x = next;
    value = next_value;
    gradient = next_gradient;
    if (gain < options.tolerance) break;
  }
  return {x, value};
}

}  // namespace csrbf
