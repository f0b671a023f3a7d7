#include "csrbf/approx/global/choose_kernel.hpp"

#include "csrbf/approx/basis/polynomial_block.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/linalg/saddle.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/squared_distances.hpp"

#include <algorithm>
#include <numeric>

namespace csrbf {
namespace {

constexpr double unreachable_score = std::numeric_limits<double>::infinity();
// Chosen by hand, relative to the mean diagonal entry: more would smooth noticeably, with less many flat kernels fail.
constexpr double largest_trial_jitter = 1e-9;
constexpr double grid_step = 1.8;  // ratio of consecutive supports of the grid, refined afterwards; chosen by hand

struct Candidate {
  Kernel kernel;
  int degree;
  std::vector<double> supports;
};

struct Trial {
  double support = 1;
  double smoothing = 0;
  double score = unreachable_score;
};

// A neighbourhood: samples nearest first, so that the first `core` of them have neighbours on all sides.
struct Patch {
  Eigen::MatrixXd r2;      // squared distances
  Eigen::MatrixXd values;  // in units of the standard deviations of all
  Eigen::VectorXd weights;
  Index core = 0;
  std::vector<Eigen::MatrixXd> G;  // by degree + 1
};

template <int Dim>
double median_spacing(const Points<Dim>& points, const KdTree<Dim>& tree) {
  constexpr Index sample = 1000;  // points that the median is taken of, chosen by hand
  const Index step = std::max<Index>(1, points.cols() / sample);
  std::vector<double> spacings;
  for (Index i = 0; i < points.cols(); i += step) {
    Index indices[2];
    double r2[2];
    if (tree.nearest(points.col(i), 2, indices, r2) == 2) spacings.push_back(std::sqrt(r2[1]));
  }
  if (spacings.empty()) return 1;
  return median(spacings);
}

Patch make_patch(const SampleView& samples, const std::vector<Index>& indices, Index core,
                 const Eigen::RowVectorXd& units) {
  const auto n = static_cast<Index>(indices.size());
  const Eigen::MatrixXd x = samples.points(Eigen::all, indices);
  Patch patch;
  patch.r2 = Eigen::MatrixXd::Zero(n, n);
  for (Index j = 0; j < n; ++j) squared_distances(x, 0, x.col(j).data(), patch.r2.col(j).data());
  patch.values = samples.values(indices, Eigen::all) * units.cwiseInverse().asDiagonal();
  patch.weights.resize(n);
  for (Index i = 0; i < n; ++i) patch.weights[i] = samples.weight(indices[i]);
  patch.core = core;
  return patch;
}

// Root mean square deviation of every component; 1 for constants.
Eigen::RowVectorXd deviations(const Eigen::MatrixXd& values) {
  Eigen::RowVectorXd units = (values.rowwise() - values.colwise().mean()).cwiseAbs2().colwise().mean().cwiseSqrt();
  const Eigen::RowVectorXd sizes = values.cwiseAbs().colwise().maxCoeff();
  constexpr double rounding = 1e-14;  // largest deviation of a constant, relative to it
  for (Index c = 0; c < units.size(); ++c)
    if (!(units[c] > rounding * sizes[c])) units[c] = sizes[c] > 0 ? sizes[c] : 1;
  return units;
}

template <int Dim>
std::vector<Patch> make_patches(const Samples<Dim>& samples, const KdTree<Dim>& tree, Index size, int largest_degree) {
  const Index n = samples.size();
  const Eigen::RowVectorXd units = deviations(samples.values);
  std::vector<Patch> patches;
  const auto add = [&](const std::vector<Index>& indices, Index core) {
    patches.push_back(make_patch(SampleView(samples), indices, core, units));
    const Points<Dim> x = chosen_points<Dim>(samples.points, indices);
    for (int degree = -1; degree <= largest_degree; ++degree)
      patches.back().G.push_back(polynomial_block<Dim>(x, degree, RankDeficiency::reduce).G);
  };
  if (n <= size) {
    std::vector<Index> all(n);
    std::iota(all.begin(), all.end(), Index{0});
    add(all, n);
    return patches;
  }
  constexpr Index count = 3;  // neighbourhoods, chosen by hand: more cost time, fewer may not be representative
  std::vector<double> r2(size);
  for (Index k = 0; k < count; ++k) {
    std::vector<Index> indices(size);
    tree.nearest(samples.points.col((2 * k + 1) * n / (2 * count)), size, indices.data(), r2.data());
    add(indices, size / 2);
  }
  return patches;
}

class CrossValidation {
 public:
  CrossValidation(std::vector<Patch> patches, const ChooseKernelOptions& options)
      : patches_(std::move(patches)), options_(options) {}

  [[nodiscard]] Trial attempt(const Candidate& candidate, double support) const {
    Trial trial{support, options_.smoothing.value_or(0), unreachable_score};
    double squares = 0;
    double weights = 0;
    double log_smoothing = 0;
    const int columns = candidate.degree + 1;  // of polynomials, by degree
    try {
      for (const Patch& patch : patches_) {
        const Eigen::MatrixXd& G = patch.G[columns];
        const Eigen::MatrixXd A = matrix(candidate.kernel, patch, support);
        SaddleOptions saddle{
            .lambda = trial.smoothing, .weights = patch.weights, .largest_rescue = largest_trial_jitter};
        if (!options_.smoothing) {
          saddle.lambda =
              choose_smoothing(A, G, patch.values, {.criterion = options_.criterion, .weights = patch.weights}).lambda;
          log_smoothing += std::log(saddle.lambda) / static_cast<double>(patches_.size());
        }
        const Eigen::MatrixXd errors = solve_saddle(A, G, patch.values, saddle).leave_one_out.topRows(patch.core);
        const Eigen::VectorXd w = patch.weights.head(patch.core);
        squares += (w.cwiseSqrt().asDiagonal() * errors).squaredNorm();
        weights += w.sum() * static_cast<double>(errors.cols());
      }
    } catch (const SolverFailure&) {
      return trial;
    }
    const double score = std::sqrt(squares / weights);
    if (!options_.smoothing) trial.smoothing = std::exp(log_smoothing);
    if (std::isfinite(score)) trial.score = score;
    return trial;
  }

 private:
  static Eigen::MatrixXd matrix(const Kernel& kernel, const Patch& patch, double support) {
    const Index n = patch.r2.rows();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd r2(n);
    for (Index j = 0; j < n; ++j) {
      r2.head(n - j) = patch.r2.col(j).tail(n - j) / (support * support);
      kernel.values(r2.data(), n - j, &A(j, j));
    }
    return A;
  }

  std::vector<Patch> patches_;
  const ChooseKernelOptions& options_;
};

// Golden section between the neighbours of the best support of the grid.
Trial refine(const CrossValidation& validation, const Candidate& candidate, Trial best) {
  constexpr double ratio = 0.6180339887498949;
  constexpr int steps = 6;  // leave an interval of 6 % of the support
  double a = std::log(best.support / grid_step);
  double b = std::log(std::min(best.support * grid_step, candidate.supports.back()));
  const auto at = [&](double exponent) {
    const Trial trial = validation.attempt(candidate, std::exp(exponent));
    if (trial.score < best.score) best = trial;
    return trial.score;
  };
  double left = b - ratio * (b - a);
  double right = a + ratio * (b - a);
  double f_left = at(left);
  double f_right = at(right);
  for (int step = 0; step < steps; ++step) {
    const bool lower = f_left <= f_right;
    (lower ? b : a) = lower ? right : left;
    (lower ? right : left) = lower ? left : right;
    (lower ? f_right : f_left) = lower ? f_left : f_right;
    double& moved = lower ? left : right;
    moved = lower ? b - ratio * (b - a) : a + ratio * (b - a);
    (lower ? f_left : f_right) = at(moved);
  }
  return best;
}

std::vector<double> supports_of(const Kernel& kernel, const ChooseKernelOptions& options, double spacing,
                                double diagonal) {
  if (options.support > 0) return {options.support};
  if (!kernel.has_scale()) return {};
  const double largest = options.largest_support > 0 ? options.largest_support : 2 * diagonal;
  double support = std::min(largest, spacing * (kernel.compact() ? 3 : 1));
  std::vector<double> supports;
  for (; support < largest; support *= grid_step) supports.push_back(support);
  supports.push_back(largest);
  return supports;
}

// What the candidates depend on.
struct Extent {
  int dimension;
  Index samples;
  double spacing, half, diagonal;

  template <int Dim>
  Extent(const Samples<Dim>& of, const KdTree<Dim>& tree)
      : dimension(Dim), samples(of.size()), spacing(median_spacing<Dim>(of.points, tree)) {
    const Box<Dim> box = bounding_box<Dim>(of.points);
    half = .5 * box.extent().maxCoeff();
    diagonal = box.diagonal() > 0 ? box.diagonal() : 1;
  }

  // Whether a polynomial has at most half as many coefficients as there are samples.
  [[nodiscard]] bool determines(int degree) const { return 2 * monomial_count(dimension, degree) <= samples; }
};

std::vector<Candidate> make_candidates(const Extent& extent, const ChooseKernelOptions& options) {
  std::vector<std::string> names = options.names;
  if (names.empty())
    names = {"gaussian", "inverse-multiquadric", "multiquadric", "matern-c2", "matern-c6",
             "linear",   "thin-plate",           "cubic",        "quintic"};
  std::vector<Candidate> candidates;
  for (const std::string& name : names) {
    Candidate candidate{Kernel(name, extent.dimension, options.parameter), 0, {}};
    candidate.degree = options.degree == -2 ? default_degree(candidate.kernel) : options.degree;
    if (names.size() > 1 && candidate.degree < candidate.kernel.order() - 1) continue;
    if (names.size() > 1 && !extent.determines(candidate.degree)) continue;
    candidate.supports = supports_of(candidate.kernel, options, extent.spacing, extent.diagonal);
    if (candidate.supports.empty()) candidate.supports = {extent.half > 0 ? extent.half : 1};
    candidates.push_back(std::move(candidate));
  }
  if (candidates.empty()) {  // too few samples to choose
    const Kernel kernel(options.degree == -1 ? "matern-c2" : "linear", extent.dimension);
    const double support = kernel.has_scale() ? extent.diagonal : (extent.half > 0 ? extent.half : 1);
    candidates.push_back({kernel, options.degree == -1 ? -1 : 0, {options.support > 0 ? options.support : support}});
  }
  return candidates;
}

// The best trial over the grid of supports, which ends where rounding errors dominate.
Trial search_grid(const CrossValidation& validation, const Candidate& candidate) {
  constexpr double reject_ratio = 30;  // of a score to the best one, chosen by hand: wider supports are not tried
  Trial best;
  best.support = candidate.supports[candidate.supports.size() / 2];  // without any finite score
  for (const double support : candidate.supports) {
    const Trial trial = validation.attempt(candidate, support);
    if (trial.score < best.score) best = trial;
    if (trial.score > reject_ratio * best.score) break;
  }
  return best;
}

KernelChoice best_of(const std::vector<Candidate>& candidates, const CrossValidation& validation) {
  const auto count = static_cast<Index>(candidates.size());
  std::vector<Trial> best(candidates.size());
  parallel_for(count, 1, [&](Index begin, Index end) {
    for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k)
      best[k] = search_grid(validation, candidates[k]);
  });

  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return best[a].score < best[b].score; });
  constexpr Index finalists = 2;  // candidates whose supports are refined, chosen by hand
  parallel_for(std::min(finalists, count), 1, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) {
      const std::size_t i = order[k];
      if (candidates[i].supports.size() > 1 && best[i].score > 0 && best[i].score < unreachable_score)
        best[i] = refine(validation, candidates[i], best[i]);
    }
  });
  const auto winner = static_cast<std::size_t>(
      std::min_element(best.begin(), best.end(), [](const Trial& a, const Trial& b) { return a.score < b.score; }) -
      best.begin());
  const Trial& trial = best[winner];
  return {candidates[winner].kernel, trial.support, trial.smoothing, trial.score};
}

}  // namespace

int default_degree(const Kernel& kernel) {
  return std::max(kernel.order() - 1, 0);
}

template <int Dim>
KernelChoice choose_kernel(const Samples<Dim>& samples, const ChooseKernelOptions& options) {
  require_valid(samples, "choose_kernel");
  require(options.support >= 0 && options.support < std::numeric_limits<double>::infinity(), "choose_kernel", "support",
          options.support, "must be positive and finite, or 0 to have it chosen");
  const KdTree<Dim> tree(samples.points);
  const std::vector<Candidate> candidates = make_candidates(Extent(samples, tree), options);
  int largest_degree = 0;
  for (const Candidate& candidate : candidates) largest_degree = std::max(largest_degree, candidate.degree);
  constexpr Index enough = 50;  // of equal values, which do not tell kernels apart; chosen by hand
  const bool is_constant = (samples.values.rowwise() - samples.values.row(0)).isZero(0);
  const Index size = options.smoothing ? options.patch : options.smoothing_patch;
  const CrossValidation validation(
      make_patches<Dim>(samples, tree, is_constant ? std::min(size, enough) : size, largest_degree), options);
  return best_of(candidates, validation);
}

#define CSRBF_INSTANTIATE(Dim) \
  template KernelChoice choose_kernel<Dim>(const Samples<Dim>&, const ChooseKernelOptions&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
