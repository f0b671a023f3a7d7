#include "csrbf/surface/contours/contour_fit.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/basis/polynomial_block.hpp"
#include "csrbf/approx/levels/level_sum.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/linalg/saddle.hpp"
#include "csrbf/linalg/sparse_cholesky.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/contours/contour_points.hpp"

namespace csrbf {
namespace {

// Chosen by hand unless noted.
constexpr Index fewest_points = 8;               // least number of contour points fitted
constexpr Index coarse_points = 400;             // contour points of the fits that find the normals
constexpr int coarse_fits = 5;                   // leaves normals within about a degree of the fixed point
constexpr int fewest_fits = 2;                   // fits of all points: at least two, ...
constexpr int most_fits = 4;                     // ... and at most four while signs are wrong
constexpr double least_slope = 0.05;             // floor of the cosine: a slope of zero carries no sign
constexpr double largest_regularization = 1e-9;  // lambda at most, added where rounding errors make a system indefinite
constexpr double tolerance = 1e-5;               // of the diagonal: smaller residuals at contours are not corrected
constexpr double level_support = 4;              // separation distances; larger: smoother corrections, denser systems
constexpr double across = 1.5;   // slice spacings that a correction reaches to either side: past the next slice
constexpr int most_levels = 20;  // each level halves the separation: 2^20 in all

using Spline = std::shared_ptr<const Expansion<3>>;

Spline triharmonic(const Samples<3>& given, double lambda) {
  const Samples<3> samples = merge_duplicates<3>(given).samples;
  const PolynomialBlock<3> linear = polynomial_block<3>(samples.points, 1, RankDeficiency::reduce);
  const auto basis =
      std::make_shared<const RadialBasis<3>>(Kernel("cubic", 3), samples.points, Eigen::VectorXd::Constant(1, 1));
  const SaddleSolution solution =
      solve_saddle(basis->dense_matrix(samples.points), linear.G, samples.values,
                   {.lambda = lambda, .leave_one_out = false, .largest_rescue = largest_regularization});
  return std::make_shared<const Expansion<3>>(basis, solution.alpha.col(0), linear.tail(solution.pi.col(0)));
}

// The conditions on the spline.
Samples<3> conditions(const std::vector<ContourPoint>& points, const SignSamples& signs) {
  std::vector<Point<3>> places;
  std::vector<double> values;
  for (const ContourPoint& p : points) {
    places.push_back(p.position);
    values.push_back(0);
    if (p.offset == 0) continue;
    places.push_back(p.position - p.offset * p.outward);
    values.push_back(p.offset * p.slope);
  }
  places.insert(places.end(), signs.places.begin(), signs.places.end());
  values.insert(values.end(), signs.values.begin(), signs.values.end());
  const auto n = static_cast<Index>(places.size());
  return {Eigen::Map<const Points<3>>(places.front().data(), 3, n),
          Eigen::Map<const Eigen::VectorXd>(values.data(), n),
          {}};
}

Points<3> positions(const std::vector<ContourPoint>& points) {
  Points<3> result(3, std::ssize(points));
  for (Index i = 0; i < result.cols(); ++i) result.col(i) = points[i].position;
  return result;
}

// Sets slopes to the in-plane share of the gradient of the fit.
void update_slopes(const Field<3>& field, std::vector<ContourPoint>& points) {
  const Jet<3> jet = field.evaluate(positions(points), Derivatives::gradient);
  for (Index i = 0; i < std::ssize(points); ++i) {
    const Point<3> g = jet.gradient.col(i);
    const double share = -g.dot(points[i].outward) / g.norm();
    points[i].slope = std::isfinite(share) ? std::clamp(share, least_slope, 1.0) : 1;
  }
}

// One level of CSRBFs at the points that interpolates the residuals; supports reach across the spacing of the slices.
Spline correction(const Points<3>& at, const Eigen::VectorXd& residual, double separation, const SliceStacks& stacks) {
  const double support = level_support * separation;
  RadialMetric<3> metric;
  const double reach = std::max(support, across * stacks.largest_spacing);
  if (stacks.common_normal) {
    const Point<3> n = *stacks.common_normal;
    metric.transforms = {Eigen::Matrix3d::Identity() - (1 - support / reach) * n * n.transpose()};
  }
  const auto basis = std::make_shared<const RadialBasis<3>>(Kernel("wendland-c2", 3), at,
                                                            Eigen::VectorXd::Constant(1, support), metric);
  SparseCholesky solver;
  if (!solver.factorize(Eigen::SparseMatrix<double>(basis->matrix(at))))
    throw SolverFailure("reconstruct_contours: the correction at " + std::to_string(at.cols()) +
                        " points has no numerical solution; merge points that are very close");
  return std::make_shared<const Expansion<3>>(basis, solver.solve(residual).col(0));
}

class ContourFitter {
 public:
  ContourFitter(const Points<3>& points, const std::vector<ContourLoop>& loops, const Slices& slices,
                const ContourFitOptions& options)
      : points_(points), loops_(loops), slices_(slices), options_(options), stacks_(find_stacks(points, slices)) {
    for (const ContourLoop& loop : loops) used_.insert(used_.end(), loop.begin(), loop.end());
    picks_ = farthest_points<3>(points_(Eigen::all, used_), static_cast<Index>(used_.size()),
                                {.first = 0, .progress = options.progress});
  }

  ContourFit fit() {
    const Index distinct = std::ssize(picks_.indices);
    const Index most = std::clamp<Index>(options_.centers / 2, std::min<Index>(distinct, fewest_points), distinct);
    std::vector<ContourPoint> kept = prepare(std::min(most, coarse_points));
    for (int i = 0; i < coarse_fits; ++i) refit(kept, 0.1 * i);
    if (most > coarse_points) {
      kept = prepare(most);
      update_slopes(*smooth_, kept);
    }
    for (int i = 0; i < most_fits; ++i) {
      refit(kept, 0.5 + 0.1 * i);
      if (!add_wrong_signs(*smooth_, slices_, stacks_, signs_) && i + 1 >= fewest_fits) break;
    }
    ContourFit result;
    result.spacing = picks_.radii[kept.size() - 1];
    result.seeds = positions(kept);
    const std::vector<Spline> levels = corrected(std::ssize(kept));
    for (const Spline& level : levels) result.centers += level->basis().size();
    result.field = std::make_shared<const LevelSum<3>>(levels, bounding_box<3>(points_(Eigen::all, used_)));
    result.caps = find_caps(*result.field, slices_, stacks_);
    return result;
  }

 private:
  std::vector<ContourPoint> prepare(Index count) {
    std::vector<Index> places(picks_.indices.begin(), picks_.indices.begin() + count);
    return contour_points(points_, loops_, slices_, places, picks_.radii[count - 1]);
  }

  void refit(std::vector<ContourPoint>& kept, double done) {
    report(options_.progress, "fit", done);
    smooth_ = triharmonic(conditions(kept, signs_), options_.smoothing);
    update_slopes(*smooth_, kept);
  }

  std::vector<Spline> corrected(Index kept) {
    std::vector<Spline> levels{smooth_};
    if (options_.smoothing > 0) return levels;
    const Points<3> all = points_(Eigen::all, used_)(Eigen::all, picks_.indices);
    const Index n = all.cols();
    Eigen::VectorXd residual = -smooth_->evaluate(all).value;
    for (int level = 0; level < most_levels && residual.cwiseAbs().maxCoeff() > tolerance; ++level) {
      report(options_.progress, "fit", 0.9);
      const double separation = 0.5 * picks_.radii[kept - 1];
      const auto end =
          std::partition_point(picks_.radii.begin(), picks_.radii.end(), [&](double r) { return r >= separation; });
      kept = std::min(n, std::max<Index>(end - picks_.radii.begin(), kept + 1));
      levels.push_back(correction(all.leftCols(kept), residual.head(kept), separation, stacks_));
      residual -= levels.back()->evaluate(all).value;
      if (kept == n) break;
    }
    return levels;
  }

  const Points<3>& points_;
  const std::vector<ContourLoop>& loops_;
  const Slices& slices_;
  const ContourFitOptions& options_;
  SliceStacks stacks_;
  std::vector<Index> used_;
  FarthestPoints picks_;
  SignSamples signs_;
  Spline smooth_;
};

}  // namespace

ContourFit fit_contours(const Points<3>& points, const std::vector<ContourLoop>& loops, const Slices& slices,
                        const ContourFitOptions& options) {
  return ContourFitter(points, loops, slices, options).fit();
}

}  // namespace csrbf
