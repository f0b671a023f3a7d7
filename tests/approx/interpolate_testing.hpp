#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/core/field.hpp"

#include <cmath>
#include <random>

namespace csrbf {

template <int Dim>
Points<Dim> random_points(Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Points<Dim> x(Dim, n);
  for (double& value : x.reshaped()) value = uniform(random);
  return x;
}

template <int Dim, class Function>
Samples<Dim> sample(const Function& f, Index n, unsigned seed = 1) {
  Samples<Dim> samples{random_points<Dim>(n, seed), Eigen::MatrixXd(n, 1), {}};
  for (Index i = 0; i < n; ++i) samples.values(i, 0) = f(Point<Dim>(samples.points.col(i)));
  return samples;
}

template <int Dim>
double wave(const Point<Dim>& p) {
  return std::sin(3 * p.sum()) + p[0] * p[Dim - 1];
}

inline double franke(const Point<2>& p) {
  const double x = 9 * p[0];
  const double y = 9 * p[1];
  const auto bump = [](double a, double b) { return std::exp(-a * a - b * b); };
  return .75 * bump((x - 2) / 2, (y - 2) / 2) + .75 * std::exp(-(x + 1) * (x + 1) / 49 - (y + 1) / 10) +
         .5 * bump((x - 7) / 2, (y - 3) / 2) - .2 * bump(x - 4, y - 7);
}

inline double peaks(const Point<2>& p) {
  const double x = p[0];
  const double y = p[1];
  return 3 * (1 - x) * (1 - x) * std::exp(-x * x - (y + 1) * (y + 1)) -
         10 * (x / 5 - x * x * x - std::pow(y, 5)) * std::exp(-x * x - y * y) -
         std::exp(-(x + 1) * (x + 1) - y * y) / 3;
}

template <int Dim, class Function>
double rmse(const Field<Dim>& field, const Function& f, const Points<Dim>& x) {
  const Eigen::VectorXd values = field.evaluate(x).value;
  double squares = 0;
  for (Index i = 0; i < x.cols(); ++i) squares += std::pow(values[i] - f(Point<Dim>(x.col(i))), 2);
  return std::sqrt(squares / static_cast<double>(x.cols()));
}

}  // namespace csrbf
