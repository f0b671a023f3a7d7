#pragma once

#include "csrbf/approx/levels/level_sum.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <chrono>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace csrbf::thesis {

/// sin(pi x) / (pi x), 1 at 0.
double sinc(double x);

/// The signal of thesis eq. (3.5) on [0, 1]; sinc as in Matlab.
double wavy_signal(double x);

/// Matlab's peaks on [-3, 3]^2.
double peaks(const Point<2>& p);

/// `count` points, uniform in [lo, hi]^Dim.
template <int Dim>
Points<Dim> random_points(Index count, unsigned seed, double lo = 0, double hi = 1) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(lo, hi);
  return Points<Dim>::NullaryExpr(Dim, count, [&] { return uniform(random); });
}

template <int Dim, class Function>
Eigen::VectorXd values_at(const Points<Dim>& points, const Function& function) {
  Eigen::VectorXd values(points.cols());
  for (Index i = 0; i < points.cols(); ++i) values[i] = function(Point<Dim>(points.col(i)));
  return values;
}

/// count points at equal distances on [0, 1], ends included.
Points<1> line(Index count);

/// count x count points on [lo, hi]^2, x fastest, borders included.
Points<2> lattice(Index count, double lo, double hi);

/// Adds white Gaussian noise such that 10 log10(mean square of the values / variance of the noise) = snr, in dB.
/// Returns its standard deviation.
double add_noise(Eigen::Ref<Eigen::VectorXd> values, double snr, unsigned seed);

/// sqrt(mean (a - b)^2)
double rms(const Eigen::Ref<const Eigen::VectorXd>& a, const Eigen::Ref<const Eigen::VectorXd>& b);

/// |a - b| / |b|, the error of thesis eqs. (3.10) and (3.11).
double relative_error(const Eigen::Ref<const Eigen::VectorXd>& a, const Eigen::Ref<const Eigen::VectorXd>& b);

/// f^0, f^1, ... of thesis eqs. (2.17)-(2.19) at the points: one column per level.
template <int Dim>
Eigen::MatrixXd values_by_level(const LevelSum<Dim>& sum, const PointsRef<Dim>& x) {
  Eigen::MatrixXd values(x.cols(), static_cast<Index>(sum.levels().size()));
  Eigen::VectorXd total = Eigen::VectorXd::Zero(x.cols());
  for (Index level = 0; level < values.cols(); ++level) {
    total += sum.levels()[level]->evaluate(x).value;
    values.col(level) = total;
  }
  return values;
}

/// Seconds of work; the shortest of `repetitions` runs.
double seconds(const std::function<void()>& work, int repetitions = 1);

}  // namespace csrbf::thesis
