#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/taylor.hpp"

#include <functional>
#include <memory>
#include <numbers>
#include <random>

// Fields in closed form with exact derivatives, and points on their surfaces.
namespace csrbf {

using std::numbers::pi;

/// A field given by an expression in the three coordinates.
class AnalyticField : public Field<3> {
 public:
  using Variables = std::array<Taylor<3>, 3>;
  using Expression = std::function<Taylor<3>(const Variables& x)>;

  AnalyticField(Expression expression, const Box<3>& bounds, const Points<3>& seeds = Points<3>(3, 0))
      : expression_(std::move(expression)), bounds_(bounds), seeds_(seeds) {}

  void evaluate_block(const PointsRef<3>& p, const JetBlock& out) const override {
    for (Index i = 0; i < p.cols(); ++i) {
      Variables x;
      for (int k = 0; k < 3; ++k) {
        x[static_cast<std::size_t>(k)].value = p(k, i);
        x[static_cast<std::size_t>(k)].gradient[k] = 1;
      }
      const Taylor<3> f = expression_(x);
      out.value[i] = f.value;
      if (out.gradient != nullptr) Eigen::Map<Point<3>>(out.gradient + 3 * i) = f.gradient;
      if (out.hessian == nullptr) continue;
      for (int a = 0, entry = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b, ++entry) out.hessian[6 * i + entry] = f.hessian(a, b);
    }
  }
  [[nodiscard]] Box<3> bounds() const override { return bounds_; }
  [[nodiscard]] Points<3> seeds() const override { return seeds_; }

 private:
  Expression expression_;
  Box<3> bounds_;
  Points<3> seeds_;
};

inline Taylor<3> square_root(const Taylor<3>& x) {
  const double s = std::sqrt(x.value);
  return apply(x, s, 0.5 / s, -0.25 / (s * x.value));
}

inline Box<3> box_around(const Point<3>& center, const Point<3>& half) {
  return {center - half, center + half};
}

/// R^2 - |x - c|^2.
inline AnalyticField quadratic_ball(double R, const Point<3>& c = Point<3>::Zero()) {
  return {[=](const AnalyticField::Variables& x) {
            Taylor<3> f(R * R);
            for (int k = 0; k < 3; ++k) f = f - (x[k] - c[k]) * (x[k] - c[k]);
            return f;
          },
          box_around(c, Point<3>::Constant(R)), c + Point<3>(R, 0, 0)};
}

/// R - |x - c|, the signed distance.
inline AnalyticField ball(double R, const Point<3>& c = Point<3>::Zero()) {
  return {[=](const AnalyticField::Variables& x) {
            Taylor<3> s;
            for (int k = 0; k < 3; ++k) s = s + (x[k] - c[k]) * (x[k] - c[k]);
            return R - square_root(s);
          },
          box_around(c, Point<3>::Constant(R)), c + Point<3>(R, 0, 0)};
}

/// Torus about the z axis, the signed distance.
inline AnalyticField distance_torus(double R, double r) {
  return {[=](const AnalyticField::Variables& x) {
            const Taylor<3> u = square_root(x[0] * x[0] + x[1] * x[1]) - R;
            return r - square_root(u * u + x[2] * x[2]);
          },
          box_around(Point<3>::Zero(), Point<3>(R + r, R + r, r)), Point<3>(R + r, 0, 0)};
}

/// 1 - x^2/a^2 - y^2/b^2 - z^2/c^2.
inline AnalyticField ellipsoid(const Point<3>& axes, const Point<3>& center = Point<3>::Zero()) {
  return {[=](const AnalyticField::Variables& x) {
            Taylor<3> f(1);
            for (int k = 0; k < 3; ++k) f = f - (1 / (axes[k] * axes[k])) * ((x[k] - center[k]) * (x[k] - center[k]));
            return f;
          },
          box_around(center, axes), center + Point<3>(axes[0], 0, 0)};
}

/// Random unit vectors.
inline Points<3> random_directions(Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Points<3> directions(3, n);
  for (Index i = 0; i < n; ++i)
    directions.col(i) = Point<3>(normal(random), normal(random), normal(random)).normalized();
  return directions;
}

}  // namespace csrbf
