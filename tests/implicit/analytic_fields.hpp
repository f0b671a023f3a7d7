#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/taylor.hpp"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

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

  AnalyticField(Expression expression, const Box<3>& bounds, const Points<3>& seeds = Points<3>(3, 0),
                double feature_size = 0)
      : expression_(std::move(expression)), bounds_(bounds), seeds_(seeds), feature_size_(feature_size) {}

  void evaluate_block(const PointsRef<3>& p, const JetBlock& out) const override {
    for (Index i = 0; i < p.cols(); ++i) {
      Variables x;
      for (int k = 0; k < 3; ++k) {
        x[k].value = p(k, i);
        x[k].gradient[k] = 1;
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
  [[nodiscard]] double feature_size() const override { return feature_size_; }

 private:
  Expression expression_;
  Box<3> bounds_;
  Points<3> seeds_;
  double feature_size_;
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

/// A ball that knows bounds on boxes.
class EnclosedBall : public AnalyticField {
 public:
  explicit EnclosedBall(double R, const Point<3>& c = Point<3>::Zero()) : AnalyticField(ball(R, c)), R_(R), c_(c) {}

  [[nodiscard]] std::optional<Enclosure> enclose(const Box<3>& box) const override {
    const double nearest = (c_ - c_.cwiseMax(box.lo).cwiseMin(box.hi)).norm();
    const double farthest = (c_ - box.lo).cwiseAbs().cwiseMax((c_ - box.hi).cwiseAbs()).norm();
    return Enclosure{R_ - farthest, R_ - nearest, 1,
                     nearest > 0 ? 1 / nearest : std::numeric_limits<double>::infinity()};
  }

 private:
  double R_;
  Point<3> c_;
};

/// The signed distance to a sphere near it that does not grow beyond 3 details: 3 d tanh((R - |x - c|) / (3 d)).
inline AnalyticField saturated_ball(double R, const Point<3>& c, double feature_size) {
  return {[=](const AnalyticField::Variables& x) {
            Taylor<3> s;
            for (int k = 0; k < 3; ++k) s = s + (x[k] - c[k]) * (x[k] - c[k]);
            const Taylor<3> d = (1 / (3 * feature_size)) * (R - square_root(s));
            const double t = std::tanh(d.value), u = 1 - t * t;
            return (3 * feature_size) * apply(d, t, u, -2 * t * u);
          },
          box_around(c, Point<3>::Constant(R)), c + Point<3>(R, 0, 0), feature_size};
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

/// Uniform random points of a box.
inline Points<3> random_points_in(const Box<3>& box, Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  Points<3> points(3, n);
  for (Index i = 0; i < points.size(); ++i)
    points.data()[i] = box.lo[i % 3] + (box.hi - box.lo)[i % 3] * uniform(random);
  return points;
}

/// Largest differences between the derivatives of a field and central differences, over points where all are defined.
struct DerivativeErrors {
  double gradient = 0, hessian = 0;
};

inline DerivativeErrors derivative_errors(const Field<3>& field, const Points<3>& x, double step) {
  const Jet<3> jet = field.evaluate(x, Derivatives::hessian);
  DerivativeErrors errors;
  for (int k = 0; k < 3; ++k) {
    const Point<3> h = step * Point<3>::Unit(k);
    const Jet<3> ahead = field.evaluate(x.colwise() + h, Derivatives::gradient);
    const Jet<3> behind = field.evaluate(x.colwise() - h, Derivatives::gradient);
    for (Index i = 0; i < x.cols(); ++i) {
      const double slope = (ahead.value[i] - behind.value[i]) / (2 * step);
      const Point<3> bend = (ahead.gradient.col(i) - behind.gradient.col(i)) / (2 * step);
      errors.gradient = std::max(errors.gradient, std::abs(slope - jet.gradient(k, i)));
      errors.hessian = std::max(errors.hessian, (bend - jet.hessian_matrix(i).col(k)).cwiseAbs().maxCoeff());
    }
  }
  return errors;
}

/// Do bounds that a field gives on random boxes hold at random points of them?
inline testing::AssertionResult encloses(const Field<3>& field, const Box<3>& around, unsigned seed) {
  const Points<3> corners = random_points_in(around, 400, seed);
  for (Index i = 0; i + 1 < corners.cols(); i += 2) {
    Box<3> box;
    box.add(Point<3>(corners.col(i)));
    // Of sizes from a thousandth to the whole.
    box.add(Point<3>(corners.col(i) +
                     std::pow(10, -3 * (static_cast<double>(i) / 400)) * (corners.col(i + 1) - corners.col(i))));
    const std::optional<Enclosure> e = field.enclose(box);
    if (!e) return testing::AssertionFailure() << "there is no enclosure";
    const Jet<3> jet = field.evaluate(random_points_in(box, 50, seed + 1), Derivatives::hessian);
    for (Index k = 0; k < jet.value.size(); ++k) {
      const double slack = 1e-12 * (1 + std::abs(jet.value[k]));
      const double bend = jet.hessian_matrix(k).selfadjointView<Eigen::Lower>().eigenvalues().cwiseAbs().maxCoeff();
      if (jet.value[k] < e->lo - slack || jet.value[k] > e->hi + slack)
        return testing::AssertionFailure() << jet.value[k] << " is not in [" << e->lo << ", " << e->hi << "]";
      if (jet.gradient.col(k).norm() > e->lipschitz * (1 + 1e-12) || !(bend <= e->hessian_bound * (1 + 1e-9) + slack))
        return testing::AssertionFailure() << "slope " << jet.gradient.col(k).norm() << " of " << e->lipschitz
                                           << ", bend " << bend << " of " << e->hessian_bound;
    }
  }
  return testing::AssertionSuccess();
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
