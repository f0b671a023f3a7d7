#include "csrbf/approx/fit_with_faults.hpp"

#include "csrbf/approx/faults/fault_field.hpp"
#include "csrbf/approx/kriging/local_kriging.hpp"
#include "csrbf/approx/samples/fitted_field.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/approx/samples/robust_weights.hpp"
#include "csrbf/approx/samples/usable_samples.hpp"
#include "csrbf/approx/unity/cover.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/seconds_since.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/linalg/simplex_search.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index patch_samples = 48, cell_samples = 16, block_samples = 64, blocks = 24;
constexpr Index candidates = 4;  // times as many samples are looked at
constexpr double smallest_nugget = 1e-11;
constexpr double longest_covariance = 20;  // lengths of a covariance over the extent of the samples

// A set of samples that see an anchor.
struct Neighborhood {
  std::vector<Index> rows;
  double radius = 0;  // of the ways to them
};

class FaultFit {
 public:
  FaultFit(const Samples<2>& given, const FitOptions& options)
      : options_(options), faults_(options.faults), samples_(select(given)), tree_(samples_.points) {}

  Fit<2> fit() {
    const auto start = std::chrono::steady_clock::now();
    warn_of_place();
    choose();
    report_.choose_seconds = seconds_since(start);
    const auto solved = std::chrono::steady_clock::now();
    const std::vector<Index> anchors = find_anchors();
    const auto count = std::ssize(anchors), k = samples_.components();
    LocalModels<2> models;
    models.degree = covariance_.degree;
    models.kernel = covariance_.kernel;
    models.support = 1;
    models.centers_each = std::min(patch_samples, samples_.size());
    models.components = k;
    models.resize(count);
    Eigen::VectorXd radii(count);
    Eigen::MatrixXd scales(k, count);
    FaultField::Prediction prediction{covariance_.nugget, covariance_.sigma2,
                                      Eigen::MatrixXd::Zero(models.centers_each, count)};
    parallel_for(count, 8, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        const Point<2> anchor = samples_.points.col(anchors[static_cast<std::size_t>(i)]);
        const Neighborhood here = around(anchor, patch_samples);
        const KrigingPatch<2> patch(samples_, covariance_, anchor, here.rows);
        patch.store(models, i);
        radii[i] = here.radius;
        // Samples that are all alike tell that hardly more than one in as many is not.
        const Eigen::ArrayXd least = covariance_.sigma2 / static_cast<double>(here.rows.size());
        scales.col(i) = (patch.scale().array() > 0).select(patch.scale().array(), least);
        for (std::size_t p = 0; p < here.rows.size(); ++p)
          prediction.weights(static_cast<Index>(p), i) = samples_.weight(here.rows[p]);
      }
    });
    const Points<2> places = samples_.points(Eigen::all, anchors);
    typename FittedField<2>::Frame frame{.box = bounding_box<2>(samples_.points),
                                         .extrapolation = options_.extrapolation};
    if (frame.extrapolation == Extrapolation::trend) frame.extrapolation = Extrapolation::linear;
    if (frame.extrapolation == Extrapolation::automatic) frame.rim = FittedField<2>::rim_of(samples_.points);
    const auto data = std::make_shared<const FaultField::Data>(faults_, places, radii, std::move(models), scales,
                                                               frame.box, std::move(prediction));
    auto constant = frame;
    constant.extrapolation = Extrapolation::constant;
    constant.rim.setZero();
    Fit<2> result;
    for (Index c = 0; c < k; ++c) {
      result.components.push_back(
          std::make_shared<FittedField<2>>(std::make_shared<FaultField>(data, c, false), frame));
      result.variances.push_back(
          std::make_shared<FittedField<2>>(std::make_shared<FaultField>(data, c, true), constant));
      if (covariance_.nugget > 2 * smallest_nugget)
        report_.noise.push_back(std::sqrt(covariance_.nugget * covariance_.sigma2[c]));
    }
    if (report_.noise.empty()) report_.noise.assign(static_cast<std::size_t>(k), 0.0);
    report_.method = "partition-of-unity";
    report_.kernel = covariance_.kernel.name();
    report_.degree = covariance_.degree;
    report_.smoothing = covariance_.nugget > 2 * smallest_nugget ? covariance_.nugget : 0;
    report_.centers = count * std::min(patch_samples, samples_.size());
    report_.partition = {count, patch_samples, 0};
    report_.axis_scales = {1, 1};
    report_.support = covariance_.length;
    report_.fit_seconds = seconds_since(solved);
    result.report = report_;
    return result;
  }

 private:
  Samples<2> select(const Samples<2>& given) {
    auto [some, rows] = usable_samples<2>(given, options_.missing);
    report_.missing = options_.missing ? given.size() - std::ssize(rows) : 0;
    // Samples across a fault are no neighbours: "auto" would take jumps for gross errors.
    if (options_.loss != "auto") {
      const RobustWeights robust = robust_weights(some, options_.loss);
      if (robust.factors.size() > 0) some.weights = some.all_weights().cwiseProduct(robust.factors);
      for (const Index row : robust.gross_errors) report_.gross_errors.push_back(rows[static_cast<std::size_t>(row)]);
    }
    MergedSamples<2> merged = merge_duplicates(std::move(some));
    report_.merged_duplicates = merged.merged();
    report_.samples = report_.samples_fitted = merged.samples.size();
    return normalize_weights(merged.samples);
  }

  void warn_of_place() {
    const Box<2> box = bounding_box<2>(samples_.points);
    const auto is_beside = [&](const Eigen::Matrix2Xd& line) { return !box.intersects(bounding_box<2>(line)); };
    if (std::all_of(options_.faults.begin(), options_.faults.end(), is_beside))
      report_.warnings.emplace_back(
          "all faults lie outside the box of the samples; their coordinates may be in another order or unit");
  }

  // The `count` samples nearest to a point that see it directly. Those around the end of a fault may be near as well,
  // but not to each other.
  [[nodiscard]] Neighborhood around(const Point<2>& p, Index count) const {
    const Index n = samples_.size();
    for (Index looked = std::min(n, candidates * count);; looked = std::min(n, 4 * looked)) {
      std::vector<Index> found(static_cast<std::size_t>(looked));
      std::vector<double> d2(found.size());
      tree_.nearest(p, looked, found.data(), d2.data());
      const double reach = std::sqrt(d2.back());
      const auto nearby = faults_.within(p, reach);
      std::vector<std::pair<double, Index>> seen;
      for (const Index row : found) {
        const Sight sight = faults_.sight(p, samples_.points.col(row), nearby);
        if (sight.seen && sight.offset == 0) seen.emplace_back((samples_.points.col(row) - p).norm(), row);
      }
      if (std::ssize(seen) < std::min(count, n) && looked < n && looked < most_looked) continue;
      std::sort(seen.begin(), seen.end());
      if (std::ssize(seen) > count) seen.resize(static_cast<std::size_t>(count));
      Neighborhood result;
      for (const auto& [length, row] : seen) {
        result.rows.push_back(row);
        result.radius = std::max(result.radius, length);
      }
      if (!(result.radius > 0)) result.radius = std::max(reach, 1e-300);
      return result;
    }
  }

  // Samples of which each cell has one per side of the faults in it.
  [[nodiscard]] std::vector<Index> find_anchors() const {
    const Cover<2> cover(samples_.points, cell_samples, 1.5, CoverUse::fitting);
    std::vector<std::vector<Index>> cells(static_cast<std::size_t>(cover.size()));
    Index column = 0;
    for (Index cell = 0; cell < cover.size(); ++cell)
      for (Index k = 0; k < cover.count(cell); ++k)
        cells[static_cast<std::size_t>(cell)].push_back(cover.order()[static_cast<std::size_t>(column++)]);
    std::vector<Index> anchors;
    for (std::vector<Index>& rest : cells)
      while (!rest.empty()) {
        const Index anchor = middle_of(seen_from(rest.front(), rest));
        anchors.push_back(anchor);
        const std::vector<Index> seen = seen_from(anchor, rest);
        std::erase_if(rest, [&](Index row) { return std::find(seen.begin(), seen.end(), row) != seen.end(); });
      }
    return anchors;
  }

  // Those of some samples that see one of them directly, itself included.
  [[nodiscard]] std::vector<Index> seen_from(Index from, const std::vector<Index>& rows) const {
    const Point<2> p = samples_.points.col(from);
    double reach = 0;
    for (const Index row : rows) reach = std::max(reach, (samples_.points.col(row) - p).norm());
    const auto nearby = faults_.within(p, reach);
    std::vector<Index> seen;
    for (const Index row : rows) {
      const Sight sight = faults_.sight(p, samples_.points.col(row), nearby);
      if (row == from || (sight.seen && sight.offset == 0)) seen.push_back(row);
    }
    return seen;
  }

  [[nodiscard]] Index middle_of(const std::vector<Index>& rows) const {
    const Point<2> mean = samples_.points(Eigen::all, rows).rowwise().mean();
    return *std::min_element(rows.begin(), rows.end(), [&](Index a, Index b) {
      return (samples_.points.col(a) - mean).squaredNorm() < (samples_.points.col(b) - mean).squaredNorm();
    });
  }

  // The samples of a neighbourhood, in units of deviation and extent.
  struct Block {
    Points<2> x;
    Eigen::MatrixXd values;
    Eigen::VectorXd inverse_weights;
  };

  void choose() {
    const double extent = std::max(bounding_box<2>(samples_.points).extent().maxCoeff(), 1e-300);
    const Eigen::RowVectorXd mean = samples_.values.colwise().mean();
    Eigen::RowVectorXd units =
        (samples_.values.rowwise() - mean).colwise().stableNorm() / std::sqrt(static_cast<double>(samples_.size()));
    for (double& unit : units) unit = unit > 0 ? unit : 1;
    std::vector<Block> all;
    const std::vector<Index> order = morton_order<2>(samples_.points);
    const Index count = std::min(blocks, samples_.size());
    for (Index b = 0; b < count; ++b) {
      const Index middle = order[static_cast<std::size_t>((2 * b + 1) * samples_.size() / (2 * count))];
      const Neighborhood here = around(samples_.points.col(middle), block_samples);
      Block block{samples_.points(Eigen::all, here.rows) / extent,
                  samples_.values(here.rows, Eigen::all) * units.cwiseInverse().asDiagonal(),
                  samples_.all_weights()(here.rows).cwiseInverse()};
      all.push_back(std::move(block));
    }
    const auto fixed = options_.smoothing;
    const auto nugget = [&](double logarithm) {
      return fixed ? std::max(*fixed, smallest_nugget) : std::max(std::exp(logarithm), smallest_nugget);
    };
    struct Model {
      const char* kernel;
      double parameter;
    };
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    std::vector<Model> models = {{"powered-exponential", 0.7}, {"matern-c0", none}, {"matern-c2", none},
                                 {"matern-c4", none},          {"matern-c6", none}, {"gaussian", none}};
    if (options_.kernel != "auto") models = {{options_.kernel.c_str(), options_.kernel_parameter}};
    double best = std::numeric_limits<double>::infinity();
    Eigen::VectorXd start = Eigen::Vector2d(std::log(0.3), std::log(1e-3));
    for (const Model& model : models) {
      const Kernel kernel(model.kernel, 2, model.parameter);
      require(kernel.order() == 0, "fit", "kernel", options_.kernel,
              "is only conditionally positive definite; with faults use another one, such as matern-c2");
      Eigen::RowVectorXd sigma2;
      const auto cost = [&](const Eigen::VectorXd& p) {
        return likelihood(all, kernel, std::exp(p[0]), nugget(p[1]), sigma2);
      };
      const SimplexMinimum found =
          simplex_search(cost, start, Eigen::Vector2d(-1, -4), {.evaluations = 40, .tolerance = 0.1});
      if (!(found.value < best)) continue;
      best = found.value;
      start = found.x;
      (void)cost(found.x);
      covariance_ = {.kernel = kernel,
                     .length = std::exp(found.x[0]) * extent,
                     .nugget = nugget(found.x[1]),
                     .degree = kernel.is_rough() ? 1 : 0,
                     .sigma2 = sigma2.cwiseProduct(units.cwiseAbs2()).transpose()};
    }
    require(best < std::numeric_limits<double>::infinity(), "fit", "faults", samples_.size(),
            "no covariance describes the samples");
  }

  // Minus twice the logarithm of the restricted likelihood of the blocks, up to a constant.
  static double likelihood(const std::vector<Block>& all, const Kernel& kernel, double length, double nugget,
                           Eigen::RowVectorXd& sigma2) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if (length > longest_covariance || nugget > 1e3) return infinity;
    double sum = 0, degrees = 0;
    const Index k = all.front().values.cols();
    Eigen::RowVectorXd squares = Eigen::RowVectorXd::Zero(k);
    for (const Block& block : all) {
      const Index n = block.x.cols();
      if (n < 2) continue;
      Eigen::MatrixXd K(n, n);
      for (Index j = 0; j < n; ++j)
        for (Index i = j; i < n; ++i) K(i, j) = kernel.value((block.x.col(i) - block.x.col(j)).norm() / length);
      K.diagonal() += nugget * block.inverse_weights;
      const Eigen::LLT<Eigen::MatrixXd> llt(K);
      if (llt.info() != Eigen::Success) return infinity;
      Eigen::MatrixXd white(n, 1 + k);
      white << Eigen::VectorXd::Ones(n), block.values;
      solve_lower(llt, white);
      const double information = white.col(0).squaredNorm();
      const Eigen::RowVectorXd mean = white.col(0).transpose() * white.rightCols(k) / information;
      squares += (white.rightCols(k) - white.col(0) * mean).colwise().squaredNorm();
      sum += static_cast<double>(k) * (2 * llt.matrixLLT().diagonal().array().log().sum() + std::log(information));
      degrees += static_cast<double>(n - 1);
    }
    if (degrees == 0) return 0;
    sigma2 = squares / degrees;
    for (const double s : sigma2) sum += degrees * std::log(std::max(s, 1e-300));
    return sum;
  }

  static constexpr Index most_looked = 4096;

  const FitOptions& options_;
  FitReport report_;
  FaultLines faults_;
  Samples<2> samples_;
  KdTree<2> tree_;
  Covariance covariance_{.kernel = Kernel("matern-c2", 2), .sigma2 = {}};
};

}  // namespace

Fit<2> fit_with_faults(const Samples<2>& samples, const FitOptions& options) {
  const auto refuse = [](bool given, const char* option) {
    require(!given, "fit", option, "given", "this cannot be combined with faults; leave one of both out");
  };
  refuse(!options.sphere.empty(), "sphere");
  refuse(!options.periods.empty(), "periods");
  refuse(options.tolerance > 0, "tolerance");
  refuse(options.centers > 0, "centers");
  refuse(options.method != "auto" && options.method != "partition-of-unity", "method");
  return FaultFit(samples, options).fit();
}

}  // namespace csrbf
