#include "csrbf/approx/rbf_interpolator.hpp"

#include "csrbf/approx/global/local_interpolants.hpp"
#include "csrbf/approx/global/many_rbfs.hpp"
#include "csrbf/core/parallel.hpp"

#include <utility>

namespace csrbf {
namespace {

using Matrix = Eigen::MatrixXd;
using MatrixRef = Eigen::Ref<const Eigen::MatrixXd>;

constexpr const char* function = "RBFInterpolator";
constexpr Index most_dense = 10000;  // points of a system too ill conditioned for iterations: 800 MB; chosen by hand

Kernel make_kernel(const std::string& name, Index dimension) {
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

struct RbfInterpolator::Data {
  Matrix points;  // in Morton order with neighbours
  Matrix values;  // with neighbours, in the same order
  Eigen::VectorXd smoothing;
  Index neighbors = 0;
  double epsilon = 1;
  int degree = -1;
  RbfBasis basis;
  RbfCoefficients solution = {};
  std::unique_ptr<const NearestSamples> search = {};
  std::unique_ptr<const ManyRbfs> many = {};  // without neighbours, of many points

  Data(const MatrixRef& given, const RbfInterpolatorOptions& options)
      : points(given),
        smoothing(checked_smoothing(options.smoothing, given.cols())),
        neighbors(std::min(options.neighbors, given.cols())),
        basis{make_kernel(options.kernel, given.rows()), 1, {static_cast<int>(given.rows()), -1}} {
    require(points.rows() > 0 && points.cols() > 0, function, "points", points.cols(),
            "at least one point of one coordinate is needed");
    require(points.allFinite(), function, "points", "NaN or infinity", "every coordinate must be finite");
    require(options.neighbors >= 0, function, "neighbors", options.neighbors, "must not be negative");
    epsilon = checked_epsilon(basis.kernel, options.epsilon);
    basis.epsilon2 = epsilon * epsilon;
    degree = checked_degree(basis.kernel, options.degree);
    basis.monomials = MonomialSteps(static_cast<int>(points.rows()), degree);
    const Index Q = basis.monomials.size();
    require(Q <= (neighbors > 0 ? neighbors : points.cols()), function, "degree", degree,
            "a polynomial of this degree in " + std::to_string(points.rows()) + " variables needs at least " +
                std::to_string(Q) + " points");
  }

  void solve(const MatrixRef& given, const Progress& progress) {
    require(given.cols() == points.cols(), function, "values", given.cols(), "there must be one for each point");
    require(given.allFinite(), function, "values", "NaN or infinity",
            "every value must be finite; leave out the points without value");
    report(progress, "solve", 0);
    if (neighbors == 0) {
      solve_all(given, progress);
      return;
    }
    const std::vector<Index> order = nearby_order(points);
    points = points(Eigen::all, order).eval();
    smoothing = smoothing(order).eval();
    values = given(Eigen::all, order);
    search = nearest_samples(points);
  }

  void solve_all(const MatrixRef& given, const Progress& progress) {
    if (has_many()) try {
        solution = ManyRbfs::solve(basis, points, given, smoothing, progress);
        many = ManyRbfs::make(basis, points, solution);
        return;
      } catch (const ManyRbfs::IllConditioned&) {
        if (points.cols() > most_dense) throw;
      }
    solution = basis.solve(points, given, smoothing);
  }

  [[nodiscard]] bool has_many() const {
    return neighbors == 0 && smoothing.minCoeff() >= 0 && ManyRbfs::suits(basis, points.rows(), points.cols());
  }
};

RbfInterpolator::RbfInterpolator(std::unique_ptr<const Data> data) : data_(std::move(data)) {}

RbfInterpolator::RbfInterpolator(const MatrixRef& points, const MatrixRef& values,
                                 const RbfInterpolatorOptions& options) {
  auto data = std::make_unique<Data>(points, options);
  data->solve(values, options.progress);
  data_ = std::move(data);
}

RbfInterpolator::RbfInterpolator(RbfInterpolator&&) noexcept = default;
RbfInterpolator& RbfInterpolator::operator=(RbfInterpolator&&) noexcept = default;
RbfInterpolator::~RbfInterpolator() = default;

Index RbfInterpolator::dimension() const {
  return data_->points.rows();
}

Index RbfInterpolator::neighbors() const {
  return data_->neighbors;
}

int RbfInterpolator::degree() const {
  return data_->degree;
}

double RbfInterpolator::epsilon() const {
  return data_->epsilon;
}

Eigen::MatrixXi RbfInterpolator::powers() const {
  return data_->basis.monomials.powers();
}

int RbfInterpolator::smallest_degree(const std::string& kernel, Index dimension) {
  return make_kernel(kernel, dimension).order() - 1;
}

RbfInterpolator RbfInterpolator::restore(const MatrixRef& points, const MatrixRef& coefficients,
                                         const RbfInterpolatorOptions& options) {
  auto data = std::make_unique<Data>(points, options);
  const Index Q = data->basis.monomials.size();
  require(data->neighbors == 0 && coefficients.cols() == points.cols() + Q, function, "coefficients",
          coefficients.cols(), "there must be one for each point and monomial");
  data->solution = RbfBasis::frame(data->points);
  data->solution.alpha = coefficients.leftCols(points.cols()).transpose();
  data->solution.pi = coefficients.rightCols(Q).transpose();
  if (data->has_many()) data->many = ManyRbfs::make(data->basis, data->points, data->solution);
  return RbfInterpolator(std::move(data));
}

Matrix RbfInterpolator::coefficients() const {
  if (data_->neighbors > 0) return {};
  const RbfCoefficients& solution = data_->solution;
  Matrix result(solution.alpha.cols(), solution.alpha.rows() + solution.pi.rows());
  result << solution.alpha.transpose(), solution.pi.transpose();
  return result;
}

Matrix RbfInterpolator::evaluate(const MatrixRef& x, const Progress& progress) const {
  require(x.rows() == dimension(), function, "x", x.rows(),
          "the points must have " + std::to_string(dimension()) + " coordinates");
  const auto& data = *data_;
  if (data.many != nullptr) return data.many->evaluate(x);
  const Index m = x.cols();
  const Index n = data.neighbors > 0 ? data.neighbors : data.points.cols();
  if (data.neighbors == 0) {
    Matrix out(data.solution.alpha.cols(), m);
    const Index part = part_size(static_cast<double>(n));
    for (Index begin = 0; begin < m; begin += part) {
      report(progress, "evaluate", static_cast<double>(begin) / static_cast<double>(m));
      parallel_for(std::min(part, m - begin), 64, [&](Index first, Index last) {
        data.basis.evaluate(data.points, data.solution, x.middleCols(begin + first, last - first),
                            out.middleCols(begin + first, last - first));
      });
    }
    return out;
  }
  require(x.allFinite(), function, "x", "NaN or infinity", "every coordinate must be finite to find its neighbors");
  const LocalInterpolants local{data.basis, *data.search, data.points, data.values, data.smoothing, data.neighbors};
  const std::vector<Index> order = nearby_order(x);
  Matrix out(data.values.rows(), m);
  const Index part = part_size(static_cast<double>(n * n * n));
  for (Index begin = 0; begin < m; begin += part) {
    report(progress, "evaluate", static_cast<double>(begin) / static_cast<double>(m));
    parallel_for(std::min(part, m - begin), 256, [&](Index first, Index last) {
      const std::vector<Index> queries(order.begin() + begin + first, order.begin() + begin + last);
      Matrix found(data.values.rows(), last - first);
      local.evaluate(x(Eigen::all, queries), found);
      for (Index i = 0; i < last - first; ++i) out.col(queries[i]) = found.col(i);
    });
  }
  return out;
}

}  // namespace csrbf
