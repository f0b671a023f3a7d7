#include "csrbf/core/taylor.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace csrbf::taylor_test {
namespace {

constexpr double rounding = 1e-13;  // of a few operations on numbers of order one

template <int Dim>
std::array<Taylor<Dim>, Dim> variables(const Point<Dim>& p) {
  std::array<Taylor<Dim>, Dim> x;
  for (int a = 0; a < Dim; ++a) {
    const auto i = static_cast<std::size_t>(a);
    x[i] = Taylor<Dim>(p[a]);
    x[i].gradient[a] = 1;
  }
  return x;
}

Taylor<3> sine(const Taylor<3>& a) {
  return apply(a, std::sin(a.value), std::cos(a.value), -std::sin(a.value));
}

Taylor<3> exponential(const Taylor<3>& a) {
  return apply(a, std::exp(a.value), std::exp(a.value), std::exp(a.value));
}

// Every operation, nested.
Taylor<3> involved(const Point<3>& p) {
  const auto [x, y, z] = variables<3>(p);
  const Taylor<3> quotient = (x * y - 2.0 * z) / (1.5 + exponential(z) + y * y);
  return sine(quotient) * smooth_step(0.5 * (x + 1.0)) + exponential(-1.0 * (x * x)) / (2.0 - x) - 3.0;
}

Point<3> random_point(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> coordinate(-0.9, 0.9);
  return Point<3>::NullaryExpr([&] { return coordinate(generator); });
}

// Largest difference between the carried derivatives and central differences of the carried values and gradients.
double difference_error(const Point<3>& p, double h) {
  const Taylor<3> f = involved(p);
  double error = 0;
  for (int a = 0; a < 3; ++a) {
    const Taylor<3> after = involved(p + h * Point<3>::Unit(a)), before = involved(p - h * Point<3>::Unit(a));
    error = std::max(error, std::abs((after.value - before.value) / (2 * h) - f.gradient[a]));
    error = std::max(error, ((after.gradient - before.gradient) / (2 * h) - f.hessian.col(a)).cwiseAbs().maxCoeff());
  }
  return error;
}

TEST(Taylor, OfAConstantHasNoDerivatives) {
  const Taylor<3> c = 2.5;
  EXPECT_EQ(c.value, 2.5);
  EXPECT_TRUE(c.gradient.isZero(0));
  EXPECT_TRUE(c.hessian.isZero(0));
  EXPECT_EQ(Taylor<3>().value, 0);
}

TEST(Taylor, OfAPolynomialIsExact) {
  // f = x^2 y - 3 x z + 4 at (2, 3, 5), in whole numbers.
  const auto [x, y, z] = variables<3>(Point<3>(2, 3, 5));
  const Taylor<3> f = x * x * y - 3.0 * x * z + 4.0;
  Eigen::Matrix3d H;
  H << 6, 4, -3,  //
      4, 0, 0,    //
      -3, 0, 0;
  EXPECT_EQ(f.value, -14);
  EXPECT_EQ(f.gradient, Point<3>(12 - 15, 4, -6));
  EXPECT_EQ(f.hessian, H);
}

TEST(Taylor, OfAQuotientIsItsClosedForm) {
  // f = x / y: (1/y, -x/y^2), Hessian [[0, -1/y^2], [-1/y^2, 2x/y^3]].
  const Point<2> p(0.7, -1.3);
  const auto [x, y] = variables<2>(p);
  const Taylor<2> f = x / y;
  const double v = 1 / p[1];
  EXPECT_NEAR(f.value, p[0] * v, rounding);
  EXPECT_NEAR((f.gradient - Point<2>(v, -p[0] * v * v)).norm(), 0, rounding);
  Eigen::Matrix2d H;
  H << 0, -v * v, -v * v, 2 * p[0] * v * v * v;
  EXPECT_NEAR((f.hessian - H).norm(), 0, rounding);
}

TEST(Taylor, FollowsTheChainRule) {
  // f = sin(x + 2y): gradient (1, 2) cos, Hessian -(1, 2)(1, 2)^T sin.
  const auto [x, y, z] = variables<3>(Point<3>(0.3, 0.2, 7));
  const Taylor<3> f = sine(x + 2.0 * y + 0.0 * z);
  const Point<3> v(1, 2, 0);
  EXPECT_NEAR(f.value, std::sin(0.7), rounding);
  EXPECT_NEAR((f.gradient - v * std::cos(0.7)).norm(), 0, rounding);
  EXPECT_NEAR((f.hessian + v * v.transpose() * std::sin(0.7)).norm(), 0, rounding);
}

TEST(Taylor, ObeysTheLawsOfArithmetic) {
  std::mt19937_64 generator(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Point<3> p = random_point(generator);
    const auto [x, y, z] = variables<3>(p);
    const Taylor<3> a = sine(x * y) + z, b = 2.0 + x * z;
    const auto expect_zero = [](const Taylor<3>& difference) {
      EXPECT_NEAR(difference.value, 0, rounding);
      EXPECT_NEAR(difference.gradient.norm(), 0, rounding);
      EXPECT_NEAR(difference.hessian.norm(), 0, rounding);
    };
    expect_zero(a * b - b * a);
    expect_zero((a + b) * (a - b) - (a * a - b * b));
    expect_zero(a / b * b - a);
    expect_zero(1.0 / (1.0 / b) - b);
    const Eigen::Matrix3d H = involved(p).hessian;
    EXPECT_NEAR((H - H.transpose()).norm(), 0, rounding);
  }
}

TEST(Taylor, AgreesWithCentralDifferencesToSecondOrder) {
  std::mt19937_64 generator(2);
  for (int trial = 0; trial < 20; ++trial) {
    const Point<3> p = random_point(generator);
    const double coarse = difference_error(p, 1.0 / 512), fine = difference_error(p, 1.0 / 4096);
    EXPECT_GE(std::log2(coarse / fine) / 3, 1.9);
    EXPECT_LT(fine, 1e-5);  // third and fourth derivatives of order 100 times h^2 = 6e-8
  }
}

TEST(SmoothStep, GoesFromZeroToOne) {
  EXPECT_EQ(smooth_step(-3.0), 0);
  EXPECT_EQ(smooth_step(0.0), 0);
  EXPECT_EQ(smooth_step(0.5), 0.5);
  EXPECT_EQ(smooth_step(1.0), 1);
  EXPECT_EQ(smooth_step(8.0), 1);
  for (double t = 0; t < 1; t += 1.0 / 64) {
    EXPECT_LT(smooth_step(t), smooth_step(t + 1.0 / 64));
    EXPECT_NEAR(smooth_step(t) + smooth_step(1 - t), 1, rounding);
  }
}

TEST(SmoothStep, HasTwoContinuousDerivatives) {
  const auto derivatives = [](double t) {
    Taylor<1> x(t);
    x.gradient[0] = 1;
    const Taylor<1> step = smooth_step(x);
    EXPECT_EQ(step.value, smooth_step(t));
    return Eigen::Vector2d(step.gradient[0], step.hessian(0, 0));
  };
  for (const double end : {0.0, 1.0}) {
    EXPECT_EQ(derivatives(end), Eigen::Vector2d(0, 0));
    EXPECT_EQ(derivatives(3 * end - 1), Eigen::Vector2d(0, 0));
    const double inside = end == 0 ? 1e-9 : 1 - 1e-9;
    EXPECT_NEAR(derivatives(inside)[0], 0, 1e-16);  // 30 t^2 (1 - t)^2
    EXPECT_NEAR(derivatives(inside)[1], 0, 1e-7);   // 60 t (1 - t) (1 - 2t)
  }
  constexpr double h = 1.0 / 4096;
  constexpr double truncation = 60 * h * h;  // third and fourth derivatives are at most 60 and 360, a sixth of them
  for (double t = -0.25; t < 1.25; t += 1.0 / 32) {
    if (std::min(std::abs(t), std::abs(t - 1)) <= h) continue;  // the third derivative jumps at the ends
    EXPECT_NEAR((smooth_step(t + h) - smooth_step(t - h)) / (2 * h), derivatives(t)[0], truncation);
    EXPECT_NEAR((derivatives(t + h)[0] - derivatives(t - h)[0]) / (2 * h), derivatives(t)[1], truncation);
  }
}

}  // namespace
}  // namespace csrbf::taylor_test
