#include "csrbf/approx/global/interpolate.hpp"

#include "csrbf/approx/basis/polynomial_block.hpp"
#include "csrbf/approx/global/choose_kernel.hpp"
#include "csrbf/approx/global/iterative_system.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"
#include "csrbf/approx/global/smoothing_of_many.hpp"
#include "csrbf/approx/samples/deviation.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/linalg/saddle.hpp"
#include "csrbf/linalg/sparse_cholesky.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <algorithm>

namespace csrbf {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
// Chosen by hand.
constexpr double largest_jitter = 1e-9;  // of lambda, where rounding makes a system indefinite, see choose_kernel.cpp
constexpr Index always_dense = 1500;     // samples up to which dense systems are solved whatever the support
constexpr Index spectrum_limit = 1500;   // samples up to which lambda is chosen on all of them: O(9 n^3)
constexpr Index sparse_neighbors = 100;  // per support, where that of a sparse system is chosen: accuracy against cost
constexpr int highest_fast_dimension = 3;     // of fast sums
constexpr double acceptable_residual = 1e-6;  // of them, where rounding allows no smaller one
constexpr Index first_centers = 100;          // of a search for few ...
constexpr Index repeated_dense = 1000;        // ... largest dense system in it ...
constexpr double worth_a_center = .2;         // ... that goes on where errors are this share of the largest one
constexpr double sparse_enough = .1;  // share of entries that are not zero, below which sparse solvers are faster

// The coefficients of the kernel and of the functions of the polynomial block, and the scale of the variance.
struct Coefficients {
  Eigen::MatrixXd alpha;
  Eigen::MatrixXd pi;
  Eigen::VectorXd sigma2;
};

// Distinct points of positive weight, of mean 1 unless they are kept.
template <int Dim>
Samples<Dim> prepare(const Samples<Dim>& samples, bool keep_weights, InterpolationReport& report) {
  require_valid(samples, "interpolate");
  std::vector<Index> used;
  for (Index i = 0; i < samples.size(); ++i)
    if (samples.weight(i) > 0) used.push_back(i);
  const auto count = static_cast<Index>(used.size());
  Samples<Dim> positive = samples;
  if (count < samples.size()) positive = chosen_samples(samples, used);
  MergedSamples<Dim> merged = merge_duplicates(std::move(positive));
  report.merged = merged.merged();
  Samples<Dim>& result = merged.samples;
  if (result.weights.size() > 0 && !keep_weights)
    result.weights *= static_cast<double>(result.size()) / result.weights.sum();
  return std::move(result);
}

template <int Dim>
bool periodic(const RadialMetric<Dim>& metric) {
  return (metric.periods.array() > 0).any();
}

void check(Index samples, int dimension, const InterpolateOptions& options, std::size_t transforms, bool is_periodic) {
  const double lambda = options.smoothing.value_or(0);
  require(lambda >= 0 && std::isfinite(lambda), "interpolate", "smoothing", lambda,
          "must be finite and not negative; leave it empty to have it chosen");
  require(options.support >= 0 && std::isfinite(options.support), "interpolate", "support", options.support,
          "must be positive and finite, or 0 to have it chosen");
  require(options.tolerance >= 0 && options.tolerance < 1, "interpolate", "tolerance", options.tolerance,
          "must be positive and below 1, or 0 for the default");
  require(options.largest_error >= 0 && std::isfinite(options.largest_error), "interpolate", "largest_error",
          options.largest_error, "must be positive and finite, or 0 for radial functions at all samples");
  require(options.degree >= -2, "interpolate", "degree", options.degree,
          "must be -2 (by the kernel), -1 (none), 0, 1, ...");
  require(transforms <= 1, "interpolate", "metric.transforms", transforms,
          "interpolation needs one metric for all centres; use least squares for one per centre");
  if (options.kernel == "auto") return;
  const Kernel kernel(options.kernel, dimension, options.parameter);
  require(options.degree == -2 || options.degree >= kernel.order() - 1, "interpolate", "degree", options.degree,
          options.kernel + " needs at least degree " + std::to_string(kernel.order() - 1));
  require(kernel.compact() || !is_periodic, "interpolate", "kernel", options.kernel,
          "periodic axes need a compactly supported kernel");
  require(kernel.compact() || dimension <= highest_fast_dimension || samples <= options.dense_limit, "interpolate",
          "number of samples", samples,
          "is above dense_limit; use a compactly supported kernel, such as wendland-c2, or a partition of unity");
}

// Median distance to the k-th neighbour.
template <int Dim>
double neighbor_distance(const Points<Dim>& points, Index k) {
  const KdTree<Dim> tree(points);
  constexpr Index at_most = 1000;  // points that the median is taken of, about; chosen by hand
  std::vector<Index> indices(k);
  std::vector<double> r2(k);
  std::vector<double> distances;
  for (Index i = 0; i < points.cols(); i += std::max<Index>(1, points.cols() / at_most)) {
    const Index found = tree.nearest(points.col(i), k, indices.data(), r2.data());
    distances.push_back(std::sqrt(r2[found - 1]));
  }
  return median(distances);
}

// What is compared.
ChooseKernelOptions candidates(const InterpolateOptions& options, int dimension, bool is_sparse, bool is_periodic) {
  ChooseKernelOptions choice{.parameter = options.parameter,
                             .support = options.support,
                             .smoothing = options.smoothing,
                             .criterion = options.criterion,
                             .degree = options.degree};
  if (options.kernel != "auto") {
    choice.names = {options.kernel};
  } else if (is_sparse && dimension <= highest_fast_dimension && !is_periodic) {
    choice.names = {"linear", "thin-plate"};
    if (dimension <= 2) choice.names.emplace_back("cubic");
    choice.parameter = nan;
  } else if (is_sparse || is_periodic) {
    choice.names = {"wendland-c2", "wendland-c4", "wendland-c6"};
    choice.parameter = nan;
  }
  return choice;
}

template <int Dim>
KernelChoice choose(const Samples<Dim>& samples, const InterpolateOptions& options, const RadialMetric<Dim>& metric) {
  const bool sparse = samples.size() > options.dense_limit;
  ChooseKernelOptions choice = candidates(options, Dim, sparse, periodic(metric));
  Samples<Dim> mapped = samples;
  if (metric.transforms.size() == 1) mapped.points = metric.transforms[0] * samples.points;
  const bool compact = choice.names.empty() || Kernel(choice.names.front(), Dim, choice.parameter).compact();
  if (sparse && compact) choice.largest_support = neighbor_distance<Dim>(mapped.points, sparse_neighbors);
  // Everything is given: nothing to compare.
  if (options.kernel != "auto" && options.smoothing) {
    const Kernel kernel(options.kernel, Dim, options.parameter);
    if (options.support > 0) return {kernel, options.support, *options.smoothing, nan};
    if (!kernel.has_scale()) {
      const double half = .5 * bounding_box<Dim>(mapped.points).extent().maxCoeff();
      return {kernel, half > 0 ? half : 1, *options.smoothing, nan};
    }
  }
  return choose_kernel(mapped, choice);
}

// Mean of alpha_k e_k = alpha_k^2 / C_kk (see SaddleSolution) over the samples that can be left out.
Eigen::VectorXd variance_scale(const SaddleSolution& solution) {
  Eigen::VectorXd scale(solution.alpha.cols());
  for (Index c = 0; c < scale.size(); ++c) {
    double sum = 0;
    Index count = 0;
    for (Index k = 0; k < solution.alpha.rows(); ++k) {
      if (!std::isfinite(solution.leave_one_out(k, c))) continue;
      sum += solution.alpha(k, c) * solution.leave_one_out(k, c);
      ++count;
    }
    scale[c] = count > 0 ? sum / static_cast<double>(count) : nan;
  }
  return scale;
}

// Of the samples that can be left out: not those without which the others do not determine a polynomial.
double left_out_rms(const Eigen::MatrixXd& errors, const Eigen::VectorXd& weights) {
  std::vector<Index> can_be;
  for (Index k = 0; k < errors.rows(); ++k)
    if (errors.row(k).allFinite()) can_be.push_back(k);
  if (can_be.empty()) return std::numeric_limits<double>::infinity();
  return weighted_rms(errors(can_be, Eigen::all), weights(can_be));
}

Coefficients solve_dense(const SampleView& samples, const Eigen::MatrixXd& A, const Eigen::MatrixXd& G,
                         const InterpolateOptions& options, InterpolationReport& report) {
  const Eigen::VectorXd weights = samples.all_weights();
  if (!options.smoothing && samples.size() <= spectrum_limit) {
    report.smoothing =
        choose_smoothing(A, G, samples.values, {.criterion = options.criterion, .weights = weights}).lambda;
  }
  SaddleSolution solution = solve_saddle(
      A, G, samples.values, {.lambda = report.smoothing, .weights = weights, .largest_rescue = largest_jitter});
  report.smoothing = solution.lambda;
  report.leave_one_out = left_out_rms(solution.leave_one_out, weights);
  report.condition = solution.condition;
  report.solver = InterpolationSolver::dense;
  const Eigen::VectorXd sigma2 = variance_scale(solution);
  return {std::move(solution.alpha), std::move(solution.pi), sigma2};
}

// By the Schur complement of the polynomial: compactly supported kernels are positive definite.
Coefficients solve_sparse(const SampleView& samples, Eigen::SparseMatrix<double> A, const Eigen::MatrixXd& G,
                          const InterpolateOptions& options, InterpolationReport& report) {
  SparseCholesky solver({.progress = options.progress});
  const Eigen::VectorXd inverse_weights = samples.all_weights().cwiseInverse();
  double added = report.smoothing;
  A.diagonal() += added * inverse_weights;
  constexpr double smallest_jitter = 1e-15;  // a few roundings
  for (double next = smallest_jitter; !solver.factorize(A); next *= 10) {
    if (next > largest_jitter) {
      throw SolverFailure("interpolate: the system of " + std::to_string(samples.size()) +
                          " samples is singular; give smoothing > 0 or a smaller support");
    }
    A.diagonal() += std::max(0.0, next - added) * inverse_weights;
    added = std::max(added, next);
  }
  const Index k = samples.components();
  Eigen::MatrixXd b(samples.size(), k + G.cols());
  b << samples.values, G;
  const Eigen::MatrixXd solved = solver.solve(b);
  const auto K_s = solved.leftCols(k);
  const auto K_G = solved.rightCols(G.cols());
  Coefficients c;
  c.pi = G.cols() == 0 ? Eigen::MatrixXd(0, k)
                       : solve(Eigen::LDLT<Eigen::MatrixXd>(Eigen::MatrixXd(G.transpose() * K_G)),
                               Eigen::MatrixXd(G.transpose() * K_s));
  c.alpha = K_s - K_G * c.pi;
  c.sigma2 = c.alpha.cwiseProduct(samples.values).colwise().sum() / static_cast<double>(samples.size() - G.cols());
  report.smoothing = added;
  report.condition = nan;
  report.solver = solver.direct() ? InterpolationSolver::sparse_direct : InterpolationSolver::sparse_iterative;
  return c;
}

Coefficients of_iterations(IterativeSolution solution, const Eigen::VectorXd& weights, InterpolationReport& report) {
  const Eigen::MatrixXd left_out = solution.alpha.array().colwise() / solution.inverse_diagonal.array();
  report.leave_one_out = weighted_rms(left_out, weights);
  report.condition = nan;
  report.solver = InterpolationSolver::fast_sums;
  report.iterations = solution.iterations;
  report.residual = solution.residual;
  Coefficients c;
  c.sigma2 = solution.alpha.cwiseProduct(left_out).colwise().mean().transpose();
  c.alpha = std::move(solution.alpha);
  c.pi = std::move(solution.pi);
  return c;
}

// Kernels that are not compact, many samples.
template <int Dim>
Coefficients solve_by_fast_sums(const Samples<Dim>& samples, const RadialBasis<Dim>& basis, const Eigen::MatrixXd& G,
                                const InterpolateOptions& options, InterpolationReport& report) {
  if constexpr (Dim > highest_fast_dimension) {
    throw std::logic_error("interpolate: fast sums in too many dimensions");
  } else {
    Points<Dim> points = samples.points;
    if (!basis.metric().transforms.empty()) points = basis.metric().transforms.front() * points;
    const Eigen::VectorXd weights = samples.all_weights();
    const double tolerance = options.tolerance > 0 ? options.tolerance : Dim == 3 ? 1e-7 : 1e-8;
    if (!options.smoothing && report.smoothing > 0)
      report.smoothing = smoothing_of_many<Dim>(
          {points, samples.values, samples.weights}, basis.kernel(), basis.support(0), G,
          {.start = report.smoothing, .left_out = report.leave_one_out, .progress = options.progress});
    IterativeSolution solution = solve_iteratively<Dim>(
        points, basis.kernel(), basis.support(0), report.smoothing * weights.cwiseInverse(), G, samples.values,
        {.tolerance = tolerance, .acceptable = std::max(tolerance, acceptable_residual), .progress = options.progress});
    const double largest = samples.values.cwiseAbs().maxCoeff();
    report.limited_by_rounding = solution.residual > tolerance * largest;
    return of_iterations(std::move(solution), weights, report);
  }
}

template <int Dim>
Interpolation<Dim> fit(const Samples<Dim>& samples, const KernelChoice& choice, const InterpolateOptions& options,
                       const RadialMetric<Dim>& metric, InterpolationReport report) {
  const int degree = options.degree == -2 ? default_degree(choice.kernel) : options.degree;
  const PolynomialBlock<Dim> block = polynomial_block<Dim>(
      samples.points, degree,
      options.degree == -2 || !options.require_degree ? RankDeficiency::reduce : RankDeficiency::keep);
  const auto basis = std::make_shared<const RadialBasis<Dim>>(choice.kernel, samples.points,
                                                              Eigen::VectorXd::Constant(1, choice.support), metric);
  report.kernel = choice.kernel.name();
  report.support = choice.support;
  report.smoothing = choice.smoothing;
  report.degree = degree;

  const Index n = samples.size();
  Coefficients c;
  Eigen::SparseMatrix<double> A;
  if (choice.kernel.compact() && n > always_dense) A = basis->matrix(samples.points);
  const double entries = static_cast<double>(n) * static_cast<double>(n);
  if (A.nonZeros() > 0 && (n > options.dense_limit || static_cast<double>(A.nonZeros()) < sparse_enough * entries)) {
    c = solve_sparse(SampleView(samples), std::move(A), block.G, options, report);
  } else if (n > options.dense_limit) {
    c = solve_by_fast_sums(samples, *basis, block.G, options, report);
  } else {
    c = solve_dense(SampleView(samples), basis->dense_matrix(samples.points), block.G, options, report);
  }
  Interpolation<Dim> result;
  const Box<Dim> box = bounding_box<Dim>(samples.points);
  for (Index k = 0; k < samples.components(); ++k) {
    result.components.push_back(
        std::make_shared<const Expansion<Dim>>(basis, c.alpha.col(k), block.tail(c.pi.col(k)), box));
  }
  result.report = report;
  if ((n > options.dense_limit && report.solver != InterpolationSolver::fast_sums) || !c.sigma2.allFinite())
    return result;
  const auto power = std::make_shared<const PowerFunction<Dim>>(basis, degree, report.smoothing, samples.weights);
  for (const double sigma2 : c.sigma2)
    result.variances.push_back(std::make_shared<const KrigingVariance<Dim>>(power, sigma2, box));
  return result;
}

// Radial functions at some of the samples: at first a few that cover them, then one more in each cell, the samples
// nearest to one of these, whose largest error is among the largest of all.
template <int Dim>
Interpolation<Dim> fit_few(const Samples<Dim>& samples, const KernelChoice& choice, const InterpolateOptions& options,
                           const RadialMetric<Dim>& metric, const InterpolationReport& start) {
  InterpolateOptions often = options;  // well conditioned systems are solved faster by fast sums
  if (!choice.kernel.has_scale() && Dim <= highest_fast_dimension)
    often.dense_limit = std::min(options.dense_limit, repeated_dense);
  std::vector<Index> centers = farthest_points<Dim>(samples.points, std::min(samples.size(), first_centers)).indices;
  for (;;) {
    Interpolation<Dim> result = fit(chosen_samples(samples, centers), choice, often, metric, start);
    if (std::ssize(centers) == samples.size()) return result;
    Eigen::VectorXd error = Eigen::VectorXd::Zero(samples.size());
    for (Index c = 0; c < samples.components(); ++c)
      error = error.cwiseMax((result.components[c]->evaluate(samples.points).value - samples.values.col(c)).cwiseAbs());
    const double largest = error.maxCoeff();
    if (largest <= options.largest_error) return result;
    const double worth = std::max(options.largest_error, worth_a_center * largest);
    const Points<Dim> at = chosen_points<Dim>(samples.points, centers);
    const KdTree<Dim> tree(at);
    std::vector<Index> worst(centers.size(), -1);
    for (Index i = 0; i < samples.size(); ++i) {
      if (!(error[i] > worth)) continue;
      Index cell = 0;
      double squared = 0;
      tree.nearest(samples.points.col(i), 1, &cell, &squared);
      if (squared > 0 && (worst[cell] < 0 || error[i] > error[worst[cell]])) worst[cell] = i;
    }
    const std::size_t before = centers.size();
    for (const Index i : worst)
      if (i >= 0) centers.push_back(i);
    if (centers.size() == before)
      throw SolverFailure("interpolate: errors of " + std::to_string(largest) +
                          " remain at the centres themselves: the system is too ill conditioned for this "
                          "largest_error, or smoothing > 0 forbids it");
    report(options.progress, "solve", 1 - options.largest_error / largest);
  }
}

}  // namespace

template <int Dim>
Interpolation<Dim> interpolate(const Samples<Dim>& samples, const InterpolateOptions& options,
                               const RadialMetric<Dim>& metric) {
  InterpolationReport start;
  const Samples<Dim> used = prepare(samples, options.keep_weights, start);
  check(used.size(), Dim, options, metric.transforms.size(), periodic(metric));
  report(options.progress, "choose", 0);
  KernelChoice choice = choose(used, options, metric);
  // The estimate in units of the standard deviations, for sparse systems; dense ones replace it.
  start.leave_one_out = choice.leave_one_out * weighted_deviation(used.values, used.all_weights());
  report(options.progress, "solve", 0);
  if (options.largest_error > 0) return fit_few(used, choice, options, metric, start);
  Interpolation<Dim> result = fit(used, choice, options, metric, start);

  // A support chosen on neighbourhoods may be too wide for all samples together, when the system is close to singular.
  // Chosen by hand: the ratio of errors that shows it, the reduction of the support, and how often that is tried.
  constexpr double worse = 3, reduction = 1.4;
  constexpr int most_attempts = 3;
  const bool adjustable =
      options.support == 0 && choice.kernel.has_scale() && used.size() > ChooseKernelOptions{}.patch;
  for (int attempt = 0; adjustable && attempt < most_attempts; ++attempt) {
    if (!(result.report.leave_one_out > worse * start.leave_one_out)) break;
    choice.support /= reduction;
    Interpolation<Dim> narrower = fit(used, choice, options, metric, start);
    if (!(narrower.report.leave_one_out < result.report.leave_one_out)) break;
    result = std::move(narrower);
  }
  report(options.progress, "solve", 1);
  return result;
}

template <int Dim>
Interpolation<Dim> interpolate(const Samples<Dim>& samples, const InterpolateOptions& options) {
  return interpolate(samples, options, RadialMetric<Dim>{});
}

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> Interpolation<Dim>::model() const {
  return {components.begin(), components.end()};
}

#define CSRBF_INSTANTIATE(Dim)                                                                  \
  template Interpolation<Dim> interpolate<Dim>(const Samples<Dim>&, const InterpolateOptions&,  \
                                               const RadialMetric<Dim>&);                       \
  template Interpolation<Dim> interpolate<Dim>(const Samples<Dim>&, const InterpolateOptions&); \
  template std::vector<std::shared_ptr<const Field<Dim>>> Interpolation<Dim>::model() const;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
