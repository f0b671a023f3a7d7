#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/core/field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace csrbf {

/// Uniform in [0, 1]^Dim.
template <int Dim>
Points<Dim> random_points(Index count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  return Points<Dim>::NullaryExpr(Dim, count, [&] { return uniform(random); });
}

/// n x n grid on [0, 1]^2.
inline Points<2> unit_grid(Index n) {
  Points<2> points(2, n * n);
  for (Index i = 0; i < n * n; ++i)
    points.col(i) << static_cast<double>(i % n) / static_cast<double>(n - 1),
        static_cast<double>(i / n) / static_cast<double>(n - 1);
  return points;
}

/// Franke's function (Franke 1982).
inline double franke(const Point<2>& p) {
  const auto square = [](double x) { return x * x; };
  const double x = 9 * p[0];
  const double y = 9 * p[1];
  return .75 * std::exp(-(square(x - 2) + square(y - 2)) / 4) + .75 * std::exp(-square(x + 1) / 49 - (y + 1) / 10) +
         .5 * std::exp(-(square(x - 7) + square(y - 3)) / 4) - .2 * std::exp(-square(x - 4) - square(y - 7));
}

/// The peaks function on [0, 1]^2 instead of [-3, 3]^2; its range is about 14.4.
inline double peaks(const Point<2>& p) {
  const double x = 6 * p[0] - 3;
  const double y = 6 * p[1] - 3;
  return 3 * (1 - x) * (1 - x) * std::exp(-x * x - (y + 1) * (y + 1)) -
         10 * (x / 5 - x * x * x - std::pow(y, 5)) * std::exp(-x * x - y * y) -
         std::exp(-(x + 1) * (x + 1) - y * y) / 3;
}

/// A smooth function in any dimension.
template <int Dim>
double waves(const Point<Dim>& p) {
  double sum = 0;
  for (int axis = 0; axis < Dim; ++axis) sum += std::sin((2 + axis) * p[axis] + axis);
  return sum;
}

/// Waves of random directions whose amplitude falls as a power of their frequency.
inline double fractal(const Point<2>& p) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  double sum = 0;
  for (int k = 0; k < 60; ++k) {
    const double frequency = std::exp2(8 * uniform(random)), angle = 6.283 * uniform(random);
    const Point<2> wave = 6.283 * frequency * Point<2>(std::cos(angle), std::sin(angle));
    sum += std::pow(frequency, -.8) * std::cos(wave.dot(p) + 6.283 * uniform(random));
  }
  return sum;
}

template <int Dim, class Function>
Samples<Dim> sample(const Points<Dim>& points, const Function& function) {
  Samples<Dim> samples{points, Eigen::MatrixXd(points.cols(), 1), {}};
  for (Index i = 0; i < points.cols(); ++i) samples.values(i, 0) = function(points.col(i));
  return samples;
}

/// Root mean square error of the field at 4000 random points of the unit cube.
template <int Dim, class Function>
double rms_error(const Field<Dim>& field, const Function& function) {
  const Points<Dim> x = random_points<Dim>(4000, 99);
  const Eigen::VectorXd value = field.evaluate(x).value;
  double sum = 0;
  for (Index i = 0; i < x.cols(); ++i) sum += std::pow(value[i] - function(x.col(i)), 2);
  return std::sqrt(sum / static_cast<double>(x.cols()));
}

/// Largest error of the field at the samples (first component).
template <int Dim>
double largest_error(const Field<Dim>& field, const Samples<Dim>& samples, Index component = 0) {
  return (field.evaluate(samples.points).value - samples.values.col(component)).cwiseAbs().maxCoeff();
}

/// Checks gradient and Hessian of the field at x against central differences with step h.
template <int Dim>
void expect_true_derivatives(const Field<Dim>& field, const Points<Dim>& x, double h, double tolerance) {
  const Jet<Dim> jet = field.evaluate(x, Derivatives::hessian);
  for (int a = 0; a < Dim; ++a) {
    const Points<Dim> ahead = x.colwise() + h * Point<Dim>::Unit(a);
    const Points<Dim> behind = x.colwise() - h * Point<Dim>::Unit(a);
    const Jet<Dim> plus = field.evaluate(ahead, Derivatives::gradient);
    const Jet<Dim> minus = field.evaluate(behind, Derivatives::gradient);
    for (Index i = 0; i < x.cols(); ++i) {
      EXPECT_NEAR(jet.gradient(a, i), (plus.value[i] - minus.value[i]) / (2 * h), tolerance);
      for (int b = 0; b < Dim; ++b)
        EXPECT_NEAR(jet.hessian_matrix(i)(a, b), (plus.gradient(b, i) - minus.gradient(b, i)) / (2 * h), tolerance);
    }
  }
}

/// Checks that call() throws InvalidInput with `part` in its message.
template <class Call>
void expect_refusal(const Call& call, const std::string& part) {
  try {
    call();
    FAIL() << "no error: " << part;
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what() << "\nlacks: " << part;
  }
}

}  // namespace csrbf
