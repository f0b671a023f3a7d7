#include "csrbf/approx/hermite/hermite_kernel.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/joined.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

// M_p(r) e^r = sqrt(2 / pi) r^(p + 1/2) K_(p + 1/2)(r) e^r, p from 0 to 4.
double matern_polynomial(int p, double r) {
  switch (p) {
    case 0:
      return 1;
    case 1:
      return 1 + r;
    case 2:
      return 3 + r * (3 + r);
    case 3:
      return 15 + r * (15 + r * (6 + r));
    default:
      return 105 + r * (105 + r * (45 + r * (10 + r)));
  }
}

}  // namespace

const std::vector<std::string>& HermiteKernel::names() {
  static const std::vector<std::string> all = {"matern-c4", "matern-c6", "matern-c8", "gaussian"};
  return all;
}

HermiteKernel::HermiteKernel(const std::string& name) : name_(name) {
  const auto found = std::find(names().begin(), names().end(), name);
  require(found != names().end(), "fit", "kernel", name, "with derivatives, use one of " + joined(names()));
  const auto place = static_cast<int>(found - names().begin());
  order_ = place == 3 ? -1 : 2 + place;
}

std::array<double, 4> HermiteKernel::psi(double r2) const {
  if (order_ < 0) {
    const double phi = std::exp(-r2);
    return {phi, -2 * phi, 4 * phi, -8 * phi};
  }
  const double r = std::sqrt(r2), scale = std::exp(-r) / matern_polynomial(order_, 0);
  std::array<double, 4> result = {0, 0, 0, 0};
  for (int k = 0; k < 4; ++k) {
    const double sign = k % 2 == 0 ? scale : -scale;
    const int p = order_ - k;
    result[static_cast<std::size_t>(k)] = p >= 0 ? sign * matern_polynomial(p, r) : (r > 1e-100 ? sign / r : 0);
  }
  return result;
}

}  // namespace csrbf
