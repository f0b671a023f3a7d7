#include "csrbf/approx/kriging/distance_growth.hpp"

#include "csrbf/approx/kriging/find_gaps.hpp"
#include "csrbf/approx/unity/cell_constants.hpp"
#include "csrbf/approx/unity/local_fit.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/approx/unity/patch_samples.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index most_balls = 128;
constexpr Index most_targets = 4;                              // samples predicted in each
constexpr std::array<double, 4> radii = {0.8, 1.2, 1.6, 2.2};  // of the balls, in distances of samples
constexpr Index most_samples = 400;                            // of a patch
constexpr Index fewest_errors = 60;
constexpr double nearest_begin = 0.9;  // distances of samples; by chance one point in twelve of the plane is as far
constexpr double noticed = 1.2;        // factor of a variance
constexpr double largest_exponent = 16;
constexpr double share_inside = 0.95, quantile_inside = 1.96;
constexpr double least_ratio = 1e-6;  // of squared errors over their variance

// The samples around the middle of a cell but for those in a ball, which are `targets`.
template <int Dim>
bool leave_out_ball(const Cover<Dim>& cover, Index cell, Index samples, double anisotropy, double ball,
                    typename Cover<Dim>::Search& search, FoundSamples<Dim>& patch, std::vector<Index>& targets,
                    double& spacing) {
  const Box<Dim>& box = cover.cell(cell);
  patch.metric = find_patch_samples(cover, cell, samples, anisotropy, search);
  const auto near = std::min<Index>(samples, std::ssize(search.found));
  spacing =
      std::sqrt(search.found.back().first) * std::pow(unit_ball_volume<Dim> / static_cast<double>(near), 1.0 / Dim);
  const double radius = ball * spacing;
  const auto inside = static_cast<Index>(std::ceil(2 * unit_ball_volume<Dim> * std::pow(ball, Dim))) + 8;
  if (samples + inside > cover.points().cols()) return false;
  cover.nearest(box.center(), samples + inside, box.diagonal(), search);
  targets.clear();
  patch.found.clear();
  for (const auto& sample : search.found) {
    if (sample.first < radius * radius)
      targets.push_back(sample.second);
    else if (std::ssize(patch.found) < samples)
      patch.found.push_back(sample);
  }
  return !targets.empty() && std::ssize(patch.found) == samples;
}

}  // namespace

template <int Dim>
DistanceGrowth<Dim>::DistanceGrowth(const Samples<Dim>& samples, const PartitionOfUnityFit<Dim>& fit,
                                    const std::vector<std::shared_ptr<const Field<Dim>>>& variances)
    : cover_(fit.data->cover),
      growth_(static_cast<std::size_t>(samples.components())),
      begin_(std::numeric_limits<double>::infinity()) {
  const LocalOptions& options = fit.report.local;
  const Index n = std::min(options.samples, cover_.points().cols()), C = samples.components();
  if (n > most_samples) return;
  const Eigen::MatrixXd values = cover_.in_order(samples.values);
  const Eigen::VectorXd weights = cover_.in_order(samples.weights);
  const Index balls = std::min(most_balls, std::ssize(radii) * cover_.size());
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  Eigen::MatrixXd squares(C, balls * most_targets);
  Points<Dim> points = Points<Dim>::Zero(Dim, squares.cols());
  Eigen::VectorXd distances = Eigen::VectorXd::Constant(squares.cols(), none);
  parallel_for(balls, 8, [&](Index begin, Index end) {
    LocalFitter<Dim> fitter(cover_, values, weights, options);
    LocalModels<Dim> models = fitter.models();
    models.resize(1);
    typename Cover<Dim>::Search search;
    FoundSamples<Dim> patch;
    std::vector<Index> targets;
    constexpr int lanes = LocalEvaluator<Dim>::lanes;
    double at[Dim * lanes], f[LocalEvaluator<Dim>::terms][lanes];
    for (Index b = begin; b < end; ++b) {
      const Index cell = b * cover_.size() / balls;
      double spacing = 0;
      const double ball = radii[static_cast<std::size_t>(b) % radii.size()];
      if (!leave_out_ball(cover_, cell, n, options.anisotropy, ball, search, patch, targets, spacing)) continue;
      if (!(spacing > 0)) continue;
      FoundSamples<Dim>* known = &patch;
      fitter.fit(&cell, 1, models, 0, &known);
      LocalEvaluator<Dim> evaluator(models);
      const Index count = std::min(most_targets, std::ssize(targets));
      for (Index t = 0; t < count; ++t) {
        const Index id = targets[static_cast<std::size_t>(t * std::ssize(targets) / count)], k = b * most_targets + t;
        const Point<Dim> x = cover_.points().col(id);
        double nearest2 = std::numeric_limits<double>::infinity();
        for (const auto& sample : patch.found)
          nearest2 = std::min(nearest2, (cover_.points().col(sample.second) - x).squaredNorm());
        for (int a = 0; a < Dim; ++a) std::fill_n(at + lanes * a, lanes, x[a]);
        for (Index c = 0; c < C; ++c) {
          evaluator.evaluate(0, c, at, Derivatives::none, f);
          squares(c, k) = (weights.size() == 0 ? 1 : weights[id]) * std::pow(values(id, c) - f[0][0], 2);
        }
        points.col(k) = x;
        distances[k] = std::sqrt(nearest2) / spacing;
      }
    }
  });
  std::vector<Index> used;
  for (Index k = 0; k < distances.size(); ++k)
    if (distances[k] > 0) used.push_back(k);
  if (std::ssize(used) < fewest_errors) return;
  learn(points(Eigen::all, used), squares(Eigen::all, used), distances(used), variances);
}

// Of the logarithms of squared errors over their variance on those of distances by least squares; then 95 % of the
// errors are within the interval.
template <int Dim>
void DistanceGrowth<Dim>::learn(const Points<Dim>& points, const Eigen::MatrixXd& squares,
                                const Eigen::VectorXd& distances,
                                const std::vector<std::shared_ptr<const Field<Dim>>>& variances) {
  const Eigen::ArrayXd x = distances.array().log(), dx = x - x.mean();
  for (Index c = 0; c < squares.rows(); ++c) {
    const Eigen::ArrayXd variance = variances[static_cast<std::size_t>(c)]->evaluate(points).value;
    if (!(variance > 0).all()) continue;
    const Eigen::ArrayXd ratio = squares.row(c).transpose().array() / variance;
    const Eigen::ArrayXd y = ratio.max(least_ratio * ratio.mean()).log();
    GrowthWithDistance& growth = growth_[static_cast<std::size_t>(c)];
    growth.exponent = std::clamp((dx * y).sum() / std::max(dx.square().sum(), 1e-300), 0.0, largest_exponent);
    const Eigen::ArrayXd z2 = ratio / (growth.exponent * x).exp();
    growth.amount =
        percentile(std::vector<double>(z2.begin(), z2.end()), share_inside) / (quantile_inside * quantile_inside);
    if (!(growth.amount > 0)) continue;
    const double begin = growth.exponent > 0       ? std::pow(noticed / growth.amount, 1 / growth.exponent)
                         : growth.amount > noticed ? 0
                                                   : std::numeric_limits<double>::infinity();
    begin_ = std::min(begin_, std::max(nearest_begin, begin));
  }
}

template <int Dim>
Eigen::VectorXd DistanceGrowth<Dim>::factor(double distance) const {
  Eigen::VectorXd factors(std::ssize(growth_));
  for (Index c = 0; c < factors.size(); ++c) factors[c] = growth_[static_cast<std::size_t>(c)].factor(distance);
  return factors;
}

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> DistanceGrowth<Dim>::grown(
    const PatchErrors<Dim>& patches, const std::vector<std::shared_ptr<const Field<Dim>>>& variances) const {
  if (!std::isfinite(begin_)) return {};
  constexpr double share = 0.45;  // of the diagonal of a cell: about the radius of a ball of as many samples
  const auto unknowns = static_cast<double>(patches.unknowns());
  Eigen::MatrixXd spacing(1, cover_.size());
  std::atomic<bool> is_noticed = false;
  parallel_for(cover_.size(), 64, [&](Index first, Index last) {
    typename PatchErrors<Dim>::Patch work;
    for (Index i = first; i < last; ++i) {
      const Box<Dim>& cell = cover_.cell(i);
      const double crowd = unknowns / static_cast<double>(std::max<Index>(1, cover_.count(i)));
      work.radius = share * cell.diagonal() * std::pow(crowd, 1.0 / Dim);
      spacing(0, i) = patches.spacing_at(cell.center(), work);
      if (is_noticed) continue;
      const Points<Dim> x = probes(cell);
      for (Index k = 0; k < x.cols() && !is_noticed; ++k)
        if (!cover_.any_within(x.col(k), begin_ * spacing(0, i))) is_noticed = true;
    }
  });
  if (!is_noticed) return {};
  const auto places = std::make_shared<const SamplePlaces<Dim>>(cover_.points());
  const auto distances = cell_constants<Dim>(Cover<Dim>(cover_.tree()), spacing).front();
  std::vector<std::shared_ptr<const Field<Dim>>> result;
  for (std::size_t c = 0; c < variances.size(); ++c)
    result.push_back(std::make_shared<const GrownVariance<Dim>>(variances[c], distances, places, growth_[c]));
  return result;
}

#define CSRBF_INSTANTIATE(Dim) template class DistanceGrowth<Dim>;
CSRBF_INSTANTIATE(1)
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
