#include "csrbf/linalg/simplex_search.hpp"

#include "csrbf/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace csrbf {

SimplexMinimum simplex_search(const std::function<double(const Eigen::VectorXd&)>& f, const Eigen::VectorXd& start,
                              const Eigen::VectorXd& steps, const SimplexSearchOptions& options) {
  require(start.size() > 0 && start.size() == steps.size(), "simplex_search", "steps", steps.size(),
          "there must be one per variable");
  const auto n = static_cast<std::size_t>(start.size());
  int count = 0;
  const auto at = [&](const Eigen::VectorXd& x) {
    ++count;
    const double value = f(x);
    return SimplexMinimum{x, std::isfinite(value) ? value : std::numeric_limits<double>::infinity()};
  };
  std::vector<SimplexMinimum> corners = {at(start)};
  for (Eigen::Index a = 0; a < start.size(); ++a) {
    Eigen::VectorXd x = start;
    x[a] += steps[a];
    corners.push_back(at(x));
  }
  const auto sort = [&] {
    std::stable_sort(corners.begin(), corners.end(),
                     [](const SimplexMinimum& a, const SimplexMinimum& b) { return a.value < b.value; });
  };
  for (sort(); count < options.evaluations; sort()) {
    if (corners[n].value - corners[0].value < options.tolerance) break;
    Eigen::VectorXd center = Eigen::VectorXd::Zero(start.size());
    for (std::size_t k = 0; k < n; ++k) center += corners[k].x / static_cast<double>(n);
    const auto along = [&](double t) { return at(center + t * (center - corners[n].x)); };
    SimplexMinimum reflected = along(1);
    if (reflected.value < corners[0].value) {
      SimplexMinimum expanded = along(2);
      corners[n] = expanded.value < reflected.value ? std::move(expanded) : std::move(reflected);
      continue;
    }
    if (reflected.value < corners[n - 1].value) {
      corners[n] = std::move(reflected);
      continue;
    }
    SimplexMinimum contracted = along(reflected.value < corners[n].value ? 0.5 : -0.5);
    if (contracted.value < std::min(reflected.value, corners[n].value)) {
      corners[n] = std::move(contracted);
      continue;
    }
    for (std::size_t k = 1; k <= n; ++k) corners[k] = at(0.5 * (corners[0].x + corners[k].x));
  }
  return corners[0];
}

}  // namespace csrbf
