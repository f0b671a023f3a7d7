#include "csrbf/approx/samples/local_deviations.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

template <int Dim>
constexpr Index supporters = local_neighbors<Dim> / 5;  // of these that agree, for a sample to be like others
constexpr int rounds = 4;                               // of reweighting
constexpr double cutoff = 4.685;           // deviations beyond which a neighbour has no weight (Tukey's biweight)
constexpr double most = 0.75;              // share of the neighbours whose differences are their noise, and slopes
constexpr double most_of_normal = 1.1503;  // the same of |x| for normal x of standard deviation 1
constexpr double similar = 0.5;            // difference of samples that agree, over that to the fit; chosen by hand

// Of differences: their standard deviation if they are normal.
double spread(const Eigen::VectorXd& differences) {
  const Eigen::VectorXd sizes = differences.cwiseAbs();
  return percentile(std::vector<double>(sizes.begin(), sizes.end()), most) / most_of_normal;
}

double median_of(Eigen::VectorXd values) {
  return median(std::vector<double>(values.begin(), values.end()));
}

struct LocalFit {
  double difference = 0;  // of the sample
  double scale = 0;       // of the others
};

// `B`: 1 and the coordinates of the others from the sample, s: their values less its own. Where the others are on one
// side, the plane is extrapolated: what it leaves of a curved function grows with the square of the distance from their
// middle in their deviations, which is the variance of its value there (`lever`) less one. That is 3 in each direction
// at the corner of a box full of samples, where planes still tell errors.
LocalFit robust_fit(const Eigen::MatrixXd& B, const Eigen::VectorXd& s, const Eigen::VectorXd& w) {
  const double middle = median_of(s);
  Eigen::VectorXd residual = s.array() - middle;
  double value = middle, scale = spread(residual), lever = 1;
  for (int k = 0; k < rounds && scale > 0; ++k) {
    const Eigen::ArrayXd share = (residual.array() / (cutoff * scale)).abs().min(1.0);
    const Eigen::VectorXd weight = w.array() * (1 - share.square()).square();
    Eigen::MatrixXd normal = B.transpose() * weight.asDiagonal() * B;
    constexpr double ridge = 1e-9;
    normal.diagonal().array() += ridge * normal.trace();
    const Eigen::LDLT<Eigen::MatrixXd> factor(normal);
    const Eigen::VectorXd beta = solve(factor, Eigen::VectorXd(B.transpose() * (weight.asDiagonal() * s)));
    lever = weight.sum() * solve(factor, Eigen::VectorXd(Eigen::VectorXd::Unit(B.cols(), 0)))[0];
    residual = s - B * beta;
    value = beta[0];
    const double degrees = static_cast<double>(s.size() - B.cols()) / static_cast<double>(s.size());
    scale = spread(residual) / std::sqrt(degrees);
  }
  const double at_corner = 1 + 3 * static_cast<double>(B.cols() - 1);
  return {-value, scale * std::max(1.0, lever / at_corner)};
}

}  // namespace

template <int Dim>
Eigen::VectorXd local_deviations(const Samples<Dim>& samples, const std::vector<Index>& targets) {
  const auto count = std::ssize(targets);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(count);
  const Index k = std::min(local_neighbors<Dim>, samples.size() - 1), C = samples.components();
  if (k < 2 * (Dim + 1) || count == 0) return result;
  const KdTree<Dim> tree(samples.points);
  Eigen::MatrixXd difference(count, C), scale(count, C);
  Eigen::VectorXd expected = Eigen::VectorXd::Ones(count);  // deviation by the weight, in that of the others
  std::vector<char> has_support(static_cast<std::size_t>(count * C), 0);
  parallel_for(count, 64, [&](Index begin, Index end) {
    std::vector<Index> found(static_cast<std::size_t>(k + 1));
    std::vector<double> r2(found.size());
    Eigen::MatrixXd B(k, Dim + 1);
    Eigen::VectorXd s(k), w(k), weight(k);
    for (Index t = begin; t < end; ++t) {
      const Index i = targets[static_cast<std::size_t>(t)];
      tree.nearest(samples.points.col(i), k + 1, found.data(), r2.data());
      const double reach = std::max(std::sqrt(r2.back()), 1e-300);
      for (Index c = 0; c < C; ++c) {
        Index row = 0;
        for (const Index j : found) {
          if (j == i || row == k) continue;
          B.row(row) << 1, (samples.points.col(j) - samples.points.col(i)).transpose() / reach;
          s[row] = samples.values(j, c) - samples.values(i, c);
          weight[row] = samples.weight(j);
          w[row++] = samples.weight(j) > 0 ? 1 : 0;
        }
        const LocalFit fit = robust_fit(B, s, w);
        difference(t, c) = fit.difference;
        scale(t, c) = fit.scale;
        const double tolerance = similar * std::abs(fit.difference);
        has_support[static_cast<std::size_t>(t * C + c)] = (s.array().abs() < tolerance).count() >= supporters<Dim>;
      }
      if (samples.weights.size() > 0 && samples.weight(i) > 0)
        expected[t] = std::sqrt(std::max(1.0, median_of(weight) / samples.weight(i)));
    }
  });
  for (Index c = 0; c < C; ++c) {
    const double usual = median_of(scale.col(c));
    for (Index t = 0; t < count; ++t) {
      const Index i = targets[static_cast<std::size_t>(t)];
      const double unit = std::max(scale(t, c), usual) * expected[t];
      if (samples.weight(i) == 0 || !(unit > 0)) continue;
      double deviation = std::abs(difference(t, c)) / unit;
      if (has_support[static_cast<std::size_t>(t * C + c)] != 0) deviation = std::min(deviation, cutoff);
      result[t] = std::max(result[t], deviation);
    }
  }
  return result;
}

#define CSRBF_INSTANTIATE(Dim) \
  template Eigen::VectorXd local_deviations<Dim>(const Samples<Dim>&, const std::vector<Index>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
