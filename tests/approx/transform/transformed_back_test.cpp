#include "csrbf/approx/transform/transformed_back.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace csrbf::transformed_back_test {
namespace {

// x^2 y - .3 x, or a constant.
class Plane : public Field<2> {
 public:
  explicit Plane(double constant = std::numeric_limits<double>::quiet_NaN()) : constant_(constant) {}
  void evaluate_block(const PointsRef<2>& x, const JetBlock& out) const override {
    for (Index i = 0; i < x.cols(); ++i) {
      const double a = x(0, i), b = x(1, i);
      const bool is_constant = std::isfinite(constant_);
      out.value[i] = is_constant ? constant_ : a * a * b - .3 * a;
      if (out.gradient != nullptr) Point<2>::Map(out.gradient + 2 * i) << 2 * a * b - .3, a * a;
      if (out.hessian != nullptr) Point<3>::Map(out.hessian + 3 * i) << 2 * b, 2 * a, 0;
    }
  }
  [[nodiscard]] Box<2> bounds() const override { return {Point<2>(0, 0), Point<2>(1, 1)}; }

 private:
  double constant_;
};

// The mean of g(z) over a normal law.
template <class G>
double expected(double mean, double variance, const G& g) {
  constexpr int steps = 4000;
  constexpr double reach = 9;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double t = reach * (2 * (i + .5) / steps - 1);
    sum += g(mean + std::sqrt(variance) * t) * std::exp(-t * t / 2);
  }
  return sum * 2 * reach / steps / std::sqrt(2 * std::numbers::pi);
}

double back(Transform transform, double z) {
  if (transform == Transform::none) return z;
  return transform == Transform::logarithm ? std::exp(z) : z * z;
}

constexpr std::array transforms = {Transform::none, Transform::square_root, Transform::logarithm};

TEST(TransformedBack, HasTheDerivativesOfItsValues) {
  constexpr double h = 1e-5;
  for (const Transform transform : transforms) {
    const TransformedBack<2> f({transform, TransformedBack<2>::Of::value, .4, std::make_shared<const Plane>()});
    const Point<2> x(1.3, .9);
    const Jet<2> jet = f.evaluate(Points<2>(x), Derivatives::hessian);
    for (int a = 0; a < 2; ++a) {
      const Point<2> step = h * Point<2>::Unit(a);
      EXPECT_NEAR(jet.gradient(a, 0), (f(x + step) - f(x - step)) / (2 * h), 1e-8);
      const Points<2> before = Points<2>(x - step), after = Points<2>(x + step);
      const Eigen::Vector2d bend =
          (f.evaluate(after, Derivatives::gradient).gradient - f.evaluate(before, Derivatives::gradient).gradient) /
          (2 * h);
      EXPECT_LT((jet.hessian_matrix(0).col(a) - bend).norm(), 1e-7);
    }
    EXPECT_DOUBLE_EQ(f.evaluate_grid({Eigen::VectorXd::Constant(1, 1.3), Eigen::VectorXd::Constant(1, .9)})[0], f(x));
  }
}

TEST(TransformedBack, IsTheMeanOverTheNoise) {
  for (const Transform transform : transforms)
    for (const double z : {.8, 2.0})
      EXPECT_NEAR(mean_value(transform, z, .3).value, expected(z, .09, [&](double at) { return back(transform, at); }),
                  1e-9);
}

TEST(TransformedBack, KnowsTheErrorsOfItsValues) {
  using Of = TransformedBack<2>::Of;
  constexpr double z = 2.5, variance = .3, noise = .4;
  const auto mean = std::make_shared<const Plane>(z), spread = std::make_shared<const Plane>(variance);
  const Point<2> anywhere(.5, .5);
  for (const Transform transform : transforms) {
    const double value = mean_value(transform, z, noise).value;
    const TransformedBack<2> sample({transform, Of::sample, noise, mean, spread});
    const TransformedBack<2> function({transform, Of::function, noise, mean, spread});
    EXPECT_NEAR(sample(anywhere),
                expected(z, variance, [&](double at) { return std::pow(back(transform, at) - value, 2); }), 1e-7);
    EXPECT_NEAR(function(anywhere),
                expected(z, variance - noise * noise,
                         [&](double at) { return std::pow(mean_value(transform, at, noise).value - value, 2); }),
                1e-7);
    EXPECT_NEAR(
        noise_of_value(transform, z, noise),
        std::sqrt(expected(z, noise * noise, [&](double at) { return std::pow(back(transform, at) - value, 2); })),
        1e-7);
  }
}

}  // namespace
}  // namespace csrbf::transformed_back_test
