#pragma once

#include "approx/approx_testing.hpp"

namespace csrbf {

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

/// peaks() on [-3, 3]^2.
inline double wide_peaks(const Point<2>& p) {
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
