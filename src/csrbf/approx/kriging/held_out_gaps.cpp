#include "csrbf/approx/kriging/held_out_gaps.hpp"

#include "csrbf/approx/kriging/local_kriging.hpp"
#include "csrbf/approx/kriging/spread_point.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
// Chosen by hand.
constexpr Index tries = 12;        // samples in the place of a gap
constexpr double close = 0.25;     // of a sample to its place, in distances from the middle
constexpr double enough = 0.5;     // share of the samples around a gap that are matched
constexpr double significant = 2;  // standard errors
constexpr double worth_it = 0.08;  // of the score
constexpr double share_within = 0.95, within = 1.96;
constexpr double locals[] = {0, 0.25, 0.5, 0.75, 1};      // see Covariance
constexpr double least_growth = 0.3, largest_growth = 1;  // of errors
constexpr double negligible = 1e-4;                       // of squared errors, as a share of their mean
constexpr double tiny = 1e-300;

struct Usual {
  const char* kernel;
  double parameter, length;  // in extents of the samples
};
constexpr double none = std::numeric_limits<double>::quiet_NaN();
// Correlated over all samples, like powers of the distance up to 1, .7, 1.2, 3 and 5.
constexpr Usual usual[] = {{"matern-c0", none, 3},
                           {"powered-exponential", 0.7, 3},
                           {"powered-exponential", 1.2, 3},
                           {"matern-c2", none, 1},
                           {"matern-c4", none, 0.7}};

// Of an error over the standard deviation of a normal prediction, in units of that.
double ranked_probability_score(double z) {
  constexpr double pi = 3.14159265358979324;
  const double density = std::exp(-.5 * z * z) / std::sqrt(2 * pi);
  return z * std::erf(z / std::sqrt(2.0)) + 2 * density - 1 / std::sqrt(pi);
}

// Of the logarithm of squared errors over that of their expected shares, by least squares: errors of all sizes count.
double slope(const Eigen::VectorXd& shares, const Eigen::MatrixXd& squares) {
  const double floor = std::max(tiny, negligible * squares.mean());
  const Eigen::ArrayXd x = shares.array().max(tiny).log(), y = squares.array().max(floor).log().rowwise().mean();
  const Eigen::ArrayXd dx = x - x.mean();
  const double spread = dx.square().sum();
  return spread > 0 ? (dx * y).sum() / spread : 0;
}

}  // namespace

template <int Dim>
HeldOutGaps<Dim>::HeldOutGaps(const Samples<Dim>& samples, const ThinnedLevels<Dim>& levels, const Points<Dim>& gaps)
    : samples_(samples), levels_(levels) {
  const Index n = samples.size();
  const Eigen::RowVectorXd mean = samples.values.colwise().mean();
  deviations_ =
      (samples.values.rowwise() - mean).colwise().stableNorm().transpose() / std::sqrt(static_cast<double>(n));
  const auto& all = levels.levels().front();
  const Box<Dim> box = bounding_box<Dim>(samples.points);
  std::vector<Case> found(static_cast<std::size_t>(gaps.cols()));
  parallel_for(gaps.cols(), 4, [&](Index begin, Index end) {
    for (Index g = begin; g < end; ++g) {
      const std::vector<Index> pattern = samples_around(levels, Point<Dim>(gaps.col(g)));
      Case& best = found[static_cast<std::size_t>(g)];
      for (Index k = 0; k < tries; ++k) {
        Index start = 0;
        double distance2 = 0;
        all.tree->nearest(box.lo + spread_point<Dim>(tries * g + k).cwiseProduct(box.extent()), 1, &start, &distance2);
        Case next{all.indices[static_cast<std::size_t>(start)], {}};
        auto left = pattern.size();
        for (const Index s : pattern) {
          if (next.around.size() + left-- <= best.around.size()) break;  // no better
          const Point<Dim> offset = samples.points.col(s) - gaps.col(g);
          Index nearest = 0;
          double r2 = 0;
          all.tree->nearest(samples.points.col(next.target) + offset, 1, &nearest, &r2);
          nearest = all.indices[static_cast<std::size_t>(nearest)];
          if (nearest != next.target && r2 < close * close * offset.squaredNorm()) next.around.push_back(nearest);
        }
        std::sort(next.around.begin(), next.around.end());
        next.around.erase(std::unique(next.around.begin(), next.around.end()), next.around.end());
        if (next.around.size() > best.around.size()) best = std::move(next);
      }
      if (static_cast<double>(best.around.size()) < enough * static_cast<double>(pattern.size())) best.around.clear();
    }
  });
  for (Case& c : found)
    if (!c.around.empty() && samples.weight(c.target) > 0) cases_.push_back(std::move(c));
}

template <int Dim>
typename HeldOutGaps<Dim>::Predictions HeldOutGaps<Dim>::predict(const Covariance& covariance) const {
  const Index C = samples_.components(), count = std::ssize(cases_);
  Predictions result{Eigen::MatrixXd(count, C), Eigen::VectorXd(count), Eigen::MatrixXd(count, C)};
  parallel_for(count, 4, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) {
      const Case& c = cases_[static_cast<std::size_t>(k)];
      const Point<Dim> x = samples_.points.col(c.target);
      const KrigingPatch<Dim> patch(samples_, covariance, x, c.around);
      result.errors.row(k) = samples_.values.row(c.target) - patch.value(x).transpose();
      result.shares[k] = patch.share(x) + covariance.nugget * (1 / samples_.weight(c.target) - 1);
      result.scales.row(k) = patch.scale().transpose();
    }
  });
  return result;
}

template <int Dim>
Eigen::VectorXd HeldOutGaps<Dim>::Predictions::variances(const Covariance& covariance, Index component) const {
  Eigen::VectorXd result(shares.size());
  for (Index k = 0; k < result.size(); ++k)
    result[k] = prediction_variance(covariance, component, shares[k], scales(k, component));
  return result;
}

// With the growth that errors have, and 95 % of them within the interval, by the power of local scales of the best
// score.
template <int Dim>
void HeldOutGaps<Dim>::calibrate(Covariance& covariance, const Predictions& p) const {
  const Index C = p.errors.cols(), n = p.errors.rows();
  covariance.sigma2.resize(C);
  for (Index c = 0; c < C; ++c) {
    const Eigen::VectorXd scales = p.scales.col(c);
    covariance.sigma2[c] = median(std::vector<double>(scales.begin(), scales.end()));
  }
  double least = unbounded;
  Covariance best = covariance;
  for (const double local : locals) {
    covariance.local = local;
    covariance.growth = 1;
    covariance.inflation = Eigen::VectorXd::Ones(C);
    Eigen::MatrixXd z2(n, C);
    for (Index c = 0; c < C; ++c)
      z2.col(c) = p.errors.col(c).array().square() / p.variances(covariance, c).array().max(tiny);
    covariance.growth = std::clamp(1 + slope(p.shares, z2), least_growth, largest_growth);
    for (Index c = 0; c < C; ++c) {
      const Eigen::VectorXd z = (p.errors.col(c).array().abs() / p.variances(covariance, c).array().max(tiny).sqrt());
      covariance.inflation[c] = std::pow(percentile(std::vector<double>(z.begin(), z.end()), share_within) / within, 2);
    }
    const double score = scores(covariance, p).mean();
    if (!(score < least)) continue;
    least = score;
    best = covariance;
  }
  covariance = best;
}

template <int Dim>
Eigen::VectorXd HeldOutGaps<Dim>::scores(const Covariance& covariance, const Predictions& p) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(p.errors.rows());
  for (Index c = 0; c < p.errors.cols(); ++c) {
    if (!(deviations_[c] > 0)) continue;
    const Eigen::VectorXd variance = p.variances(covariance, c);
    for (Index k = 0; k < result.size(); ++k) {
      const double deviation = std::sqrt(variance[k]), error = std::abs(p.errors(k, c));
      result[k] += (deviation > 0 ? deviation * ranked_probability_score(error / deviation) : error) / deviations_[c];
    }
  }
  return result;
}

template <int Dim>
HeldOutChoice HeldOutGaps<Dim>::choose(const Covariance& likely) const {
  const double extent = bounding_box<Dim>(samples_.points).extent().maxCoeff();
  std::vector<Covariance> candidates;
  for (const auto& [name, parameter, length] : usual) {
    Covariance other = likely;
    other.kernel = Kernel(name, Dim, parameter);
    other.length = length * extent;
    other.degree = 0;
    candidates.push_back(with_nearby_nugget(samples_, levels_, std::move(other)));
  }
  candidates.push_back(likely);
  std::vector<Eigen::VectorXd> score;
  std::size_t best = 0;
  for (Covariance& candidate : candidates) {
    const Predictions p = predict(candidate);
    calibrate(candidate, p);
    score.push_back(scores(candidate, p));
    if (score.back().mean() < score[best].mean()) best = score.size() - 1;
  }
  const Eigen::ArrayXd gain = (score[0] - score[best]).array();
  const double error = std::sqrt((gain - gain.mean()).square().mean() / static_cast<double>(gain.size()));
  const bool is_better = gain.mean() > std::max(significant * error, worth_it * score[0].mean());
  return is_better ? HeldOutChoice{candidates[best], false} : HeldOutChoice{candidates[0], true};
}

#define CSRBF_INSTANTIATE(Dim) template class HeldOutGaps<Dim>;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
