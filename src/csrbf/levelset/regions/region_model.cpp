#include "csrbf/levelset/regions/region_model.hpp"

#include "csrbf/levelset/regions/bin_probabilities.hpp"
#include "csrbf/levelset/regions/gamma_functions.hpp"
#include "csrbf/linalg/decompositions.hpp"

#include <Eigen/LU>

#include <numbers>

namespace csrbf {
namespace {

// Chosen by hand: from a sharp peak to an almost uniform law (generalised Gaussian) or an almost normal one (gamma).
constexpr double smallest_gaussian_shape = .2;
constexpr double largest_gaussian_shape = 20;
constexpr double smallest_gamma_shape = .05;
constexpr double largest_gamma_shape = 1e4;

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

// Location, logarithm of the spread (mean absolute deviation; gamma: standard deviation), logarithm of the shape:
// unlike scales, spreads have bounds that do not depend on the shape.
struct Coordinates {
  IntensityLaw law;
  Vector x = Vector::Zero();

  explicit Coordinates(const RegionModel& model) : law(model.law) {
    x << model.location, std::log(model.scale) + log_spread(model.shape), std::log(model.shape);
  }
  [[nodiscard]] RegionModel model() const {
    const double shape = std::exp(x[2]);
    return {law, x[0], std::exp(x[1] - log_spread(shape)), shape};
  }
  // Derivative of log_spread by log shape.
  [[nodiscard]] double spread_by_shape() const {
    const double s = std::exp(-x[2]);
    if (law == IntensityLaw::generalized_gaussian) return s * digamma(s) - 2 * s * digamma(2 * s);
    return law == IntensityLaw::gamma ? .5 : 0;
  }

 private:
  // Logarithm of the spread for scale 1.
  [[nodiscard]] double log_spread(double shape) const {
    if (law == IntensityLaw::generalized_gaussian) return std::lgamma(2 / shape) - std::lgamma(1 / shape);
    return law == IntensityLaw::gamma ? .5 * std::log(shape) : 0;
  }
};

struct Limits {
  Vector lo, hi;

  Limits(IntensityLaw law, const IntensityBins& bins, bool moves, double location) {
    const bool gamma = law == IntensityLaw::gamma;
    const bool shaped = gamma || law == IntensityLaw::generalized_gaussian;
    const double smallest = gamma ? .5 : .25;  // bins; narrower densities are not seen by the quadrature
    lo << (moves ? bins.lo : location), std::log(smallest * bins.width()),
        std::log(!shaped ? 2
                 : gamma ? smallest_gamma_shape
                         : smallest_gaussian_shape);
    hi << (moves ? bins.hi : location), std::log(4 * (bins.hi - bins.lo)),
        std::log(!shaped ? 2
                 : gamma ? largest_gamma_shape
                         : largest_gaussian_shape);
  }
};

// Makes hessian * moved = change, where that can be of a positive definite matrix.
void update(Matrix& hessian, const Vector& moved, const Vector& change) {
  constexpr double least_curvature = 1e-3;  // of the one expected: keeps the matrix positive definite; by hand
  const Vector expected = hessian * moved;
  const double curvature = moved.dot(change);
  if (!(curvature > least_curvature * moved.dot(expected))) return;
  hessian += change * change.transpose() / curvature - expected * expected.transpose() / moved.dot(expected);
}

class Search {
 public:
  Search(const Histogram& histogram, const Limits& limits)
      : bins_(histogram.bins),
        limits_(limits),
        share_(Eigen::Map<const Eigen::ArrayXd>(histogram.counts.data(), std::ssize(histogram.counts)) /
               histogram.total()) {}

  [[nodiscard]] Coordinates clamped(Coordinates c) const {
    c.x = c.x.cwiseMax(limits_.lo).cwiseMin(limits_.hi);
    return c;
  }

  // Mean log-likelihood of a voxel; leaves the shares of the bins for `step`.
  double likelihood(const Coordinates& c) {
    bin_probabilities(c.model(), bins_, p_);
    return (share_ * p_.values.array().log()).sum();
  }

  RegionModel climb(const Coordinates& start);

 private:
  // Of the minus log-likelihood.
  struct Slope {
    Vector gradient;
    Matrix information;  // of Fisher
  };
  Slope slope(const Coordinates& c);
  Vector step(const Coordinates& c, const Vector& gradient, Matrix hessian) const;

  const IntensityBins& bins_;
  Limits limits_;
  Eigen::ArrayXd share_;
  BinProbabilities p_;
};

Search::Slope Search::slope(const Coordinates& c) {
  Eigen::MatrixX3d& D = p_.derivatives;
  D.col(0) /= c.model().scale;
  D.col(2) -= c.spread_by_shape() * D.col(1);
  const Eigen::ArrayXd inverse = p_.values.array().inverse();
  return {-D.transpose() * (share_ * inverse).matrix(), D.transpose() * inverse.matrix().asDiagonal() * D};
}

// The solution of hessian * step = -gradient in the coordinates that are not kept by their limits.
Vector Search::step(const Coordinates& c, const Vector& gradient, Matrix hessian) const {
  Vector b = -gradient;
  constexpr double ridge = 1e-9;  // of the diagonal: against rounding where parameters depend on each other
  for (Index i = 0; i < 3; ++i) {
    const bool kept = (c.x[i] <= limits_.lo[i] && b[i] <= 0) || (c.x[i] >= limits_.hi[i] && b[i] >= 0);
    if (kept || !(hessian(i, i) > 0)) {
      hessian.row(i).setZero();
      hessian.col(i).setZero();
      hessian(i, i) = 1;
      b[i] = 0;
    }
    hessian(i, i) *= 1 + ridge;
  }
  return solve(Eigen::LDLT<Eigen::MatrixXd>(hessian), Eigen::VectorXd(b));
}

// Scoring in its first step, then as the method of Broyden, Fletcher, Goldfarb and Shanno: where the law is not that of
// the data, scoring alone takes up to ten times the steps.
RegionModel Search::climb(const Coordinates& start) {
  constexpr int most_steps = 50;       // about ten are needed
  constexpr int most_halvings = 12;    // to 2e-4 of a step; by hand
  constexpr double precision = 1e-10;  // of the log-likelihood of a voxel: parameters to about 1e-5
  Coordinates best = start;
  double value = likelihood(best);
  Slope s = slope(best);
  Matrix hessian = s.information;
  bool scoring = true;
  for (int i = 0; i < most_steps; ++i) {
    const Vector d = step(best, s.gradient, hessian);
    if (!(-s.gradient.dot(d) > precision)) break;
    Coordinates next = best;
    double factor = 1;
    double greater = value;
    for (int halving = 0; halving < most_halvings && !(greater > value); ++halving, factor *= .5) {
      next.x = best.x + factor * d;
      next = clamped(next);
      greater = likelihood(next);
    }
    if (!(greater > value)) {
      if (scoring) break;
      hessian = s.information;
      scoring = true;
      continue;
    }
    const bool done = greater - value < precision;
    const Vector moved = next.x - best.x;
    const Vector old_gradient = s.gradient;
    s = slope(next);
    best = next;
    value = greater;
    if (done) break;
    update(hessian, moved, s.gradient - old_gradient);
    scoring = false;
  }
  return best.model();
}

// The likeliest of `starts`, of one law other than chan_vese, moved to a maximum of the likelihood of the counts by its
// scale, its shape if the law has one, and its location if `moves`. At least as likely as every start.
RegionModel likeliest_model(const Histogram& histogram, const std::vector<RegionModel>& starts, bool moves) {
  const RegionModel& first = starts.front();
  Search search(histogram, Limits(first.law, histogram.bins, moves, starts.back().location));
  Coordinates best(first);
  double greatest = -std::numeric_limits<double>::infinity();
  for (const RegionModel& start : starts) {
    const Coordinates c = search.clamped(Coordinates(start));
    const double value = search.likelihood(c);
    if (value <= greatest) continue;
    greatest = value;
    best = c;
  }
  return search.climb(best);
}

bool is_one_sided(IntensityLaw law) {
  return law == IntensityLaw::rayleigh || law == IntensityLaw::gamma;
}

// The parameters of a law around `location` that have the moments of the histogram.
RegionModel with_moments(IntensityLaw law, const Histogram& histogram, double location) {
  RegionModel model{law, location, 1, 2};
  const double width = histogram.bins.width();
  double absolute = 0;
  double total = 0;
  for (Index k = 0; k < std::ssize(histogram.counts); ++k) {
    const double count = histogram.counts[k];
    absolute += count * std::abs(histogram.bins.center(k) - location);
    total += count;
  }
  absolute = std::max(absolute / total, .25 * width);
  const double square = std::max(histogram.moment(2, location), .1 * width * width);
  switch (law) {
    case IntensityLaw::chan_vese:
      break;
    case IntensityLaw::gaussian:
      model.scale = std::sqrt(square);
      break;
    case IntensityLaw::generalized_gaussian:
      model.shape = shape_of_moment_ratio(square / (absolute * absolute));
      model.scale = absolute * std::exp(std::lgamma(1 / model.shape) - std::lgamma(2 / model.shape));
      break;
    case IntensityLaw::rayleigh:
      model.scale = std::sqrt(.5 * square);
      break;
    case IntensityLaw::gamma: {
      const double mean = std::max(histogram.mean() - location, .5 * width);
      const double variance = std::max(histogram.moment(2, location + mean), .25 * width * width);
      model.shape = std::clamp(mean * mean / variance, smallest_gamma_shape, largest_gamma_shape);
      model.scale = mean / model.shape;
    }
  }
  return model;
}

// A law of exponential tails with the quartiles of the histogram, which clipped tails do not change.
RegionModel with_quartiles(const Histogram& histogram) {
  const double range = histogram.quantile(.75) - histogram.quantile(.25);
  const double scale = std::max(.5 * range / std::numbers::ln2, .25 * histogram.bins.width());
  return {IntensityLaw::generalized_gaussian, histogram.quantile(.5), scale, 1};
}

// The centre of the three neighbouring bins with most voxels.
double mode_of(const Histogram& histogram) {
  const auto& counts = histogram.counts;
  double most = -1;
  Index mode = 0;
  for (Index k = 0; k < std::ssize(counts); ++k) {
    double sum = 0;
    for (Index i = std::max<Index>(0, k - 1); i <= std::min(std::ssize(counts) - 1, k + 1); ++i) sum += counts[i];
    if (sum <= most) continue;
    most = sum;
    mode = k;
  }
  return histogram.bins.center(mode);
}

// A law that spreads over the whole range.
RegionModel spread_out(IntensityLaw law, const IntensityBins& bins, const RegionModelOptions& options) {
  Histogram flat(bins);
  std::fill(flat.counts.begin(), flat.counts.end(), 1.0);
  return fit_region_model(law, flat, {.location = options.location});
}

}  // namespace

RegionModel fit_region_model(IntensityLaw law, const Histogram& histogram, const RegionModelOptions& options) {
  if (!(histogram.total() > 0)) {
    if (options.start) return *options.start;
    if (law != IntensityLaw::chan_vese) return spread_out(law, histogram.bins, options);
  }
  if (law == IntensityLaw::chan_vese)
    return {.law = law, .location = options.location.value_or(histogram.mean()), .scale = 1, .shape = 2};

  std::vector<RegionModel> starts;
  if (options.start) starts.push_back(*options.start);
  const double location = options.location.value_or(is_one_sided(law) ? histogram.bins.lo : histogram.mean());
  starts.push_back(with_moments(law, histogram, location));
  if (law == IntensityLaw::generalized_gaussian) {
    if (!options.location)
      for (const double center : {histogram.quantile(.5), mode_of(histogram)})
        starts.push_back(with_moments(law, histogram, center));
    starts.push_back(with_quartiles(histogram));
    if (options.location) starts.back().location = *options.location;
  }
  const bool moves = !is_one_sided(law) && !options.location;
  return likeliest_model(histogram, starts, moves);
}

double shape_of_moment_ratio(double ratio) {
  // log ratio decreases and is convex in log b nearly everywhere: Newton's method, kept in a shrinking bracket.
  double lo = std::log(smallest_gaussian_shape);
  double hi = std::log(largest_gaussian_shape);
  const auto excess = [&](double log_b) {
    const double s = std::exp(-log_b);
    return std::lgamma(s) + std::lgamma(3 * s) - 2 * std::lgamma(2 * s) - std::log(ratio);
  };
  if (!(excess(lo) > 0)) return smallest_gaussian_shape;
  if (!(excess(hi) < 0)) return largest_gaussian_shape;
  double x = 0;                        // b = 1
  constexpr int most_steps = 60;       // bisection alone needs 46
  constexpr double precision = 1e-13;  // of log b
  for (int i = 0; i < most_steps && hi - lo > precision; ++i) {
    const double f = excess(x);
    (f > 0 ? lo : hi) = x;
    const double s = std::exp(-x);
    const double slope = -s * (digamma(s) + 3 * digamma(3 * s) - 4 * digamma(2 * s));
    double next = x - f / slope;
    if (!(next > lo && next < hi)) next = .5 * (lo + hi);
    if (std::abs(next - x) <= precision) return std::exp(next);
    x = next;
  }
  return std::exp(x);
}

}  // namespace csrbf
