#include "csrbf/surface/baselines/value_field.hpp"

namespace csrbf::baselines {

void ValueField::evaluate_block(const PointsRef<3>& x, const JetBlock& out) const {
  const auto at = [&](const Point<3>& p, int a, double i, int b, double j) {
    return value(p + step_ * (i * Point<3>::Unit(a) + j * Point<3>::Unit(b)));
  };
  for (Index k = 0; k < x.cols(); ++k) {
    const Point<3> p = x.col(k);
    const double f = out.value[k] = value(p);
    if (out.gradient == nullptr) continue;
    for (int a = 0, entry = 0; a < 3; ++a) {
      const double up = at(p, a, 1, a, 0), down = at(p, a, -1, a, 0);
      out.gradient[3 * k + a] = (up - down) / (2 * step_);
      if (out.hessian == nullptr) continue;
      out.hessian[6 * k + entry++] = (up - 2 * f + down) / (step_ * step_);
      for (int b = a + 1; b < 3; ++b, ++entry)
        out.hessian[6 * k + entry] =
            (at(p, a, 1, b, 1) - at(p, a, 1, b, -1) - at(p, a, -1, b, 1) + at(p, a, -1, b, -1)) / (4 * step_ * step_);
    }
  }
}

}  // namespace csrbf::baselines
