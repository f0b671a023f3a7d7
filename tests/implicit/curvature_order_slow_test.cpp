#include "csrbf/approx/fit.hpp"
#include "csrbf/implicit/curvature.hpp"
#include "implicit/analytic_fields.hpp"

#include <gtest/gtest.h>

namespace csrbf::curvature_order_slow_test {
namespace {

constexpr double shell = 0.25;  // samples lie this far from the surface at most

// n samples of `f` at random places near its zero set.
Samples<3> samples_near(const AnalyticField& f, Index n) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform;
  const Box<3> box = f.bounds().inflated(shell);
  Samples<3> samples;
  samples.points.resize(3, n);
  samples.values.resize(n, 1);
  for (Index i = 0; i < n;) {
    const Point<3> p = box.lo + box.extent().cwiseProduct(Point<3>(uniform(random), uniform(random), uniform(random)));
    const Jet<3> jet = f.evaluate(p, Derivatives::gradient);
    if (!(std::abs(jet.value[0]) < shell * jet.gradient.col(0).norm())) continue;
    samples.points.col(i) = p;
    samples.values(i++, 0) = jet.value[0] * std::exp(0.5 * p[0]);  // no polynomial: those are fitted exactly
  }
  return samples;
}

// Root mean square errors of the mean and the Gaussian curvature on the surface of a field fitted to n samples.
Point<2> errors_of_fit(const AnalyticField& f, const Points<3>& surface, Index n) {
  // Wendland's function of smoothness 4 (k = 2) and quartic polynomials.
  const Fit<3> fitted = fit(
      samples_near(f, n),
      {.method = "partition-of-unity", .kernel = "wendland-c4", .smoothing = 0.0, .degree = 4, .scale_axes = false});
  const Curvatures exact = curvature(f, surface), found = curvature(*fitted.components.front(), surface);
  const double root = std::sqrt(static_cast<double>(surface.cols()));
  return {(exact.mean() - found.mean()).norm() / root, (exact.gaussian() - found.gaussian()).norm() / root};
}

void expect_second_order(const AnalyticField& f, const Points<3>& surface) {
  // Eight times as many samples are twice as dense.
  const Point<2> coarse = errors_of_fit(f, surface, 8000), fine = errors_of_fit(f, surface, 64000);
  EXPECT_GE(std::log2(coarse[0] / fine[0]), 2) << coarse[0] << " " << fine[0];
  EXPECT_GE(std::log2(coarse[1] / fine[1]), 2) << coarse[1] << " " << fine[1];
}

TEST(CurvatureOfFits, IsOfSecondOrderOnASphere) {
  expect_second_order(ball(1), random_directions(500, 7));
}

TEST(CurvatureOfFits, IsOfSecondOrderOnATorus) {
  constexpr double major = 1, minor = 0.6;
  Points<3> surface(3, 500);
  for (Index i = 0; i < 500; ++i) {
    const double a = 2.4 * static_cast<double>(i), b = 0.02 * pi * static_cast<double>(i);
    const double rho = major + minor * std::cos(b);
    surface.col(i) << rho * std::cos(a), rho * std::sin(a), minor * std::sin(b);
  }
  const AnalyticField torus(
      [](const AnalyticField::Variables& x) {
        const Taylor<3> u = square_root(x[0] * x[0] + x[1] * x[1]) - major;
        return minor * minor - u * u - x[2] * x[2];
      },
      distance_torus(major, minor).bounds());
  expect_second_order(torus, surface);
}

TEST(CurvatureOfFits, IsOfSecondOrderOnAnEllipsoid) {
  const Point<3> axes(1.5, 1, 0.8);
  expect_second_order(ellipsoid(axes), axes.asDiagonal() * random_directions(500, 8));
}

}  // namespace
}  // namespace csrbf::curvature_order_slow_test
