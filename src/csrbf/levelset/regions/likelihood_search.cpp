#include "csrbf/levelset/regions/likelihood_search.hpp"

#include "csrbf/levelset/regions/bin_probabilities.hpp"
#include "csrbf/levelset/regions/gamma_functions.hpp"

#include <Eigen/LU>

#include <Eigen/Cholesky>

namespace csrbf {
namespace {

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
  /// Derivative of log_spread by log shape.
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

  /// Mean log-likelihood of a voxel; leaves the shares of the bins for `step`.
  double likelihood(const Coordinates& c) {
    bin_probabilities(c.model(), bins_, p_);
    return (share_ * p_.values.array().log()).sum();
  }

  RegionModel climb(const Coordinates& start);

 private:
  /// Of the minus log-likelihood.
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
  return hessian.ldlt().solve(b);
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

}  // namespace

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

}  // namespace csrbf
