#include "csrbf/approx/rbf_interpolator.hpp"

#include "csrbf/approx/global/local_interpolants.hpp"
#include "csrbf/core/parallel.hpp"

#include <utility>

namespace csrbf {
namespace {

using Matrix = Eigen::MatrixXd;
using MatrixRef = Eigen::Ref<const Eigen::MatrixXd>;

constexpr const char* function = "RBFInterpolator";

Kernel make_kernel(std::string name, Index dimension) {
  std::replace(name.begin(), name.end(), '_', '-');
  if (name == "thin-plate-spline") name = "thin-plate";
  return Kernel(name, static_cast<int>(std::max<Index>(dimension, 1)));
}

double checked_epsilon(const Kernel& kernel, const std::optional<double>& epsilon) {
  require(epsilon.has_value() || !kernel.has_scale(), function, "epsilon", "none",
          "the kernel " + kernel.name() + " needs a scale: about 1 / (2 spacings of the points) is a start");
  const double value = epsilon.value_or(1);
  require(std::isfinite(value), function, "epsilon", value, "must be finite");
  return value;
}

int checked_degree(const Kernel& kernel, const std::optional<int>& degree) {
  const int value = degree.value_or(std::max(kernel.order() - 1, 0));
  require(value >= -1, function, "degree", value, "must be -1 (no polynomial) or more");
  return value;
}

Eigen::VectorXd checked_smoothing(const Eigen::VectorXd& smoothing, Index n) {
  if (smoothing.size() == 0) return Eigen::VectorXd::Zero(n);
  require(smoothing.allFinite(), function, "smoothing", "NaN or infinity", "must be finite");
  if (smoothing.size() == 1) return Eigen::VectorXd::Constant(n, smoothing[0]);
  require(smoothing.size() == n, function, "smoothing", smoothing.size(), "must be one number, or one for each point");
  return smoothing;
}

// Points per part of an evaluation, between reports of progress. Chosen by hand.
Index part_size(double cost_per_point) {
  constexpr double work = 1e8;         // some tenths of a second
  constexpr Index block = 512;         // points, enough for several threads
  constexpr Index most_blocks = 4096;  // bounds the memory of a part
  return block * std::clamp<Index>(static_cast<Index>(work / (block * cost_per_point)), 1, most_blocks);
}

}  // namespace

RbfInterpolator::RbfInterpolator(const MatrixRef& points, const RbfInterpolatorOptions& options)
    : points_(points),
      smoothing_(checked_smoothing(options.smoothing, points.cols())),
      neighbors_(std::min(options.neighbors, points.cols())),
      basis_{make_kernel(options.kernel, points.rows()), 1, {static_cast<int>(points.rows()), -1}} {
  require(points.rows() > 0 && points.cols() > 0, function, "points", points.cols(),
          "at least one point of one coordinate is needed");
  require(points.allFinite(), function, "points", "NaN or infinity", "every coordinate must be finite");
  require(options.neighbors >= 0, function, "neighbors", options.neighbors, "must be positive");
  epsilon_ = checked_epsilon(basis_.kernel, options.epsilon);
  basis_.epsilon2 = epsilon_ * epsilon_;
  degree_ = checked_degree(basis_.kernel, options.degree);
  basis_.monomials = MonomialSteps(static_cast<int>(points.rows()), degree_);
  const Index Q = basis_.monomials.size();
  require(Q <= (neighbors_ > 0 ? neighbors_ : points.cols()), function, "degree", degree_,
          "a polynomial of this degree in " + std::to_string(points.rows()) + " variables needs at least " +
              std::to_string(Q) + " points");
}

RbfInterpolator::RbfInterpolator(const MatrixRef& points, const MatrixRef& values,
                                 const RbfInterpolatorOptions& options)
    : RbfInterpolator(points, options) {
  require(values.cols() == points.cols(), function, "values", values.cols(), "there must be one for each point");
  require(values.allFinite(), function, "values", "NaN or infinity",
          "every value must be finite; leave out the points without value");
  report(options.progress, "solve", 0);
  if (neighbors_ == 0) {
    solution_ = basis_.solve(points_, values, smoothing_);
    return;
  }
  const std::vector<Index> order = nearby_order(points_);
  points_ = points_(Eigen::all, order).eval();
  smoothing_ = smoothing_(order).eval();
  values_ = values(Eigen::all, order);
  search_ = nearest_samples(points_);
}

int RbfInterpolator::smallest_degree(const std::string& kernel, Index dimension) {
  return make_kernel(kernel, dimension).order() - 1;
}

RbfInterpolator RbfInterpolator::restore(const MatrixRef& points, const MatrixRef& coefficients,
                                         const RbfInterpolatorOptions& options) {
  RbfInterpolator result(points, options);
  const Index Q = result.basis_.monomials.size();
  require(result.neighbors_ == 0 && coefficients.cols() == points.cols() + Q, function, "coefficients",
          coefficients.cols(), "there must be one for each point and monomial");
  result.solution_ = RbfBasis::frame(result.points_);
  result.solution_.alpha = coefficients.leftCols(points.cols()).transpose();
  result.solution_.pi = coefficients.rightCols(Q).transpose();
  return result;
}

Matrix RbfInterpolator::coefficients() const {
  if (neighbors_ > 0) return {};
  Matrix result(solution_.alpha.cols(), solution_.alpha.rows() + solution_.pi.rows());
  result << solution_.alpha.transpose(), solution_.pi.transpose();
  return result;
}

Matrix RbfInterpolator::evaluate(const MatrixRef& x, const Progress& progress) const {
  require(x.rows() == dimension(), function, "x", x.rows(),
          "the points must have " + std::to_string(dimension()) + " coordinates");
  const Index m = x.cols();
  const Index n = neighbors_ > 0 ? neighbors_ : points_.cols();
  if (neighbors_ == 0) {
    Matrix out(solution_.alpha.cols(), m);
    const Index part = part_size(static_cast<double>(n));
    for (Index begin = 0; begin < m; begin += part) {
      report(progress, "evaluate", static_cast<double>(begin) / static_cast<double>(m));
      parallel_for(std::min(part, m - begin), 64, [&](Index first, Index last) {
        basis_.evaluate(points_, solution_, x.middleCols(begin + first, last - first),
                        out.middleCols(begin + first, last - first));
      });
    }
    return out;
  }
  require(x.allFinite(), function, "x", "NaN or infinity", "every coordinate must be finite to find its neighbors");
  const LocalInterpolants local{basis_, *search_, points_, values_, smoothing_, neighbors_};
  const std::vector<Index> order = nearby_order(x);
  Matrix out(values_.rows(), m);
  const Index part = part_size(static_cast<double>(n * n * n));
  for (Index begin = 0; begin < m; begin += part) {
    report(progress, "evaluate", static_cast<double>(begin) / static_cast<double>(m));
    parallel_for(std::min(part, m - begin), 256, [&](Index first, Index last) {
      const std::vector<Index> queries(order.begin() + begin + first, order.begin() + begin + last);
      Matrix found(values_.rows(), last - first);
      local.evaluate(x(Eigen::all, queries), found);
      for (Index i = 0; i < last - first; ++i) out.col(queries[static_cast<std::size_t>(i)]) = found.col(i);
    });
  }
  return out;
}

}  // namespace csrbf
