#include "signals.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

namespace csrbf::thesis {

using std::numbers::pi;

double sinc(double x) {
  return x == 0 ? 1 : std::sin(pi * x) / (pi * x);
}

double wavy_signal(double x) {
  return 2 * sinc(10 * x) + 0.75 * std::exp(-2.5 * std::abs(x - 0.75)) * std::sin(50 * x + 0.1) -
         2 * std::exp(-10 * x) * std::cos(55 * x);
}

double peaks(const Point<2>& p) {
  const double x = p[0];
  const double y = p[1];
  return 3 * (1 - x) * (1 - x) * std::exp(-x * x - (y + 1) * (y + 1)) -
         10 * (x / 5 - x * x * x - std::pow(y, 5)) * std::exp(-x * x - y * y) -
         std::exp(-(x + 1) * (x + 1) - y * y) / 3;
}

Points<1> line(Index count) {
  return Eigen::RowVectorXd::LinSpaced(count, 0, 1);
}

Points<2> lattice(Index count, double lo, double hi) {
  Points<2> points(2, count * count);
  const Eigen::VectorXd at = Eigen::VectorXd::LinSpaced(count, lo, hi);
  for (Index i = 0; i < points.cols(); ++i) points.col(i) << at[i % count], at[i / count];
  return points;
}

double add_noise(Eigen::Ref<Eigen::VectorXd> values, double snr, unsigned seed) {
  const double power = values.squaredNorm() / static_cast<double>(values.size());
  const double deviation = std::sqrt(power * std::pow(10, -snr / 10));
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, deviation);
  for (double& value : values) value += normal(random);
  return deviation;
}

double rms(const Eigen::Ref<const Eigen::VectorXd>& a, const Eigen::Ref<const Eigen::VectorXd>& b) {
  return (a - b).norm() / std::sqrt(static_cast<double>(a.size()));
}

double relative_error(const Eigen::Ref<const Eigen::VectorXd>& a, const Eigen::Ref<const Eigen::VectorXd>& b) {
  return (a - b).norm() / b.norm();
}

double seconds(const std::function<void()>& work, int repetitions) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

}  // namespace csrbf::thesis
