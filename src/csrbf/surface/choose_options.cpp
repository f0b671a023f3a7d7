#include "csrbf/surface/choose_options.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/surface/patch_fitter.hpp"

#include <array>
#include <cmath>

namespace csrbf {
namespace {

constexpr Index fold = 10;            // one sample in `fold` is left out
constexpr Index trials = 400;         // patches tried per choice
constexpr int predicted = 2;          // left-out samples predicted per patch
constexpr Index fewest_trials = 8;    // below this there is too little to choose from
constexpr double thickest = 0.1;      // error against patch radius; smaller patches follow layers of the noise
constexpr double flat_enough = 0.05;  // the same, where even samples off the surface find the middle of the sheet
constexpr double confidence = 0.5;    // standard errors: a smoother choice this close to the best one is preferred

constexpr std::array<Index, 9> leaf_sizes = {6, 9, 14, 24, 40, 70, 120, 200, 350};
constexpr std::array<double, 6> normal_weights = {0.01, 0.03, 0.1, 0.3, 1, 3};
constexpr std::array<Index, 3> center_counts = {0, 16, 32};
constexpr std::array<double, 3> smoothings = {1e-1, 1e-3, 1e-6};

class CrossValidation {
 public:
  explicit CrossValidation(const OrientedPoints& cloud) : training_(split(cloud)), tree_(training_.points) {
    const KdTree<3> left_out(left_out_);
    const Index n = left_out_.cols(), count = std::min(trials, n);
    std::array<Index, predicted> nearest{};
    std::array<double, predicted> distance{};
    for (Index t = 0; t < count; ++t) {
      const Point<3> center = left_out_.col(t * n / count);
      const Index found = left_out.nearest(center, predicted, nearest.data(), distance.data());
      trials_.push_back({center, {}});
      for (int i = 0; i < predicted; ++i)
        trials_.back().targets.col(i) = left_out_.col(nearest[static_cast<std::size_t>(std::min<Index>(i, found - 1))]);
    }
  }

  [[nodiscard]] Index size() const { return static_cast<Index>(trials_.size()); }
  [[nodiscard]] Index training_size() const { return training_.size(); }

  // Mean prediction error of every trial patch; all infinite when the patches are hardly wider than the errors.
  [[nodiscard]] Eigen::ArrayXd errors(const CompositeOptions& options) const {
    Eigen::ArrayXd error(size()), radius(size());
    for_each_patch(options, [&](Index t, const FittedPatch& patch) {
      const Trial& trial = trials_[static_cast<std::size_t>(t)];
      double sum = 0;
      for (int i = 0; i < predicted; ++i) sum += patch.step_to_surface(trial.targets.col(i)).norm();
      error[t] = sum / predicted;
      radius[t] = patch.patch.radius;
    });
    if (error.mean() > thickest * radius.mean()) error.setConstant(std::numeric_limits<double>::infinity());
    return error;
  }

  // Moves the patch centres from noisy samples to the middle of the sheet. A patch around a noisy sample holds samples
  // with like errors, so it would predict that sample too well.
  void center_on_sheet(CompositeOptions options, const std::vector<Index>& leaf_sizes_upwards) {
    for (const Index leaf_size : leaf_sizes_upwards) {
      options.leaf_size = leaf_size;
      Eigen::ArrayXd error(size()), radius(size());
      Points<3> step(3, size());
      for_each_patch(options, [&](Index t, const FittedPatch& patch) {
        step.col(t) = patch.step_to_surface(trials_[static_cast<std::size_t>(t)].center);
        error[t] = step.col(t).norm();
        radius[t] = patch.patch.radius;
      });
      if (error.mean() > flat_enough * radius.mean() && leaf_size != leaf_sizes_upwards.back()) continue;
      for (Index t = 0; t < size(); ++t)
        if (error[t] < radius[t]) trials_[static_cast<std::size_t>(t)].center += step.col(t);
      return;
    }
  }

 private:
  struct Trial {
    Point<3> center;
    Eigen::Matrix<double, 3, predicted> targets;
  };

  template <class Body>
  void for_each_patch(const CompositeOptions& options, const Body& body) const {
    parallel_for(size(), 16, [&](Index begin, Index end) {
      PatchFitter fitter(training_, tree_, options);
      std::vector<Index> leaf(static_cast<std::size_t>(options.leaf_size));
      std::vector<double> distance(leaf.size());
      for (Index t = begin; t < end; ++t) {
        const Point<3>& center = trials_[static_cast<std::size_t>(t)].center;
        const Index found = tree_.nearest(center, options.leaf_size, leaf.data(), distance.data());
        body(t, fitter.fit(leaf.data(), found));
      }
    });
  }

  OrientedPoints split(const OrientedPoints& cloud) {
    std::vector<Index> kept, left;
    for (Index i = 0; i < cloud.size(); ++i) (i % fold == fold / 2 ? left : kept).push_back(i);
    left_out_ = cloud.points(Eigen::all, left);
    return {cloud.points(Eigen::all, kept), cloud.normals(Eigen::all, kept), cloud.spacing(kept)};
  }

  Points<3> left_out_;
  OrientedPoints training_;
  KdTree<3> tree_;
  std::vector<Trial> trials_;
};

// The first of `choices` (smoothest first) whose errors are within the confidence of the best one's.
template <class Choices>
std::size_t smoothest_good(const Choices& errors) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < errors.size(); ++i)
    if (errors[i].mean() < errors[best].mean()) best = i;
  if (!std::isfinite(errors[best].mean())) return 0;
  for (std::size_t i = 0; i < best; ++i) {
    if (!std::isfinite(errors[i].mean())) continue;
    const Eigen::ArrayXd difference = errors[i] - errors[best];
    const double mean = difference.mean();
    const double variance = (difference - mean).square().sum() / static_cast<double>(difference.size() - 1);
    if (mean <= confidence * std::sqrt(variance / static_cast<double>(difference.size()))) return i;
  }
  return best;
}

// Tries each value of one option, smoothest first, and keeps the choice; returns its errors.
template <class Value, class Values>
Eigen::ArrayXd choose(const CrossValidation& validation, CompositeOptions& options, Value CompositeOptions::*member,
                      const Values& values) {
  std::vector<Eigen::ArrayXd> errors;
  for (const Value value : values) {
    options.*member = value;
    errors.push_back(validation.errors(options));
  }
  const std::size_t chosen = smoothest_good(errors);
  options.*member = values[chosen];
  return errors[chosen];
}

}  // namespace

ChosenOptions choose_options(const OrientedPoints& cloud, const GivenOptions& given) {
  ChosenOptions result;
  CompositeOptions& options = result.options;
  options.normal_rows = given.normal_rows;
  options.smoothing = given.smoothing.value_or(options.smoothing);
  options.leaf_size = given.leaf_size.value_or(options.leaf_size);
  CrossValidation validation(cloud);
  if (validation.size() < fewest_trials) return result;

  // Large leaves first, as long as a few of them make up the cloud.
  std::vector<Index> sizes;
  for (auto size = leaf_sizes.rbegin(); size != leaf_sizes.rend(); ++size)
    if (20 * *size <= validation.training_size()) sizes.push_back(*size);
  if (sizes.empty()) return result;
  options.normal_weight = 0.1;
  if (!given.leaf_size) {
    options.centers_per_patch = 0;
    validation.center_on_sheet(options, {sizes.rbegin(), sizes.rend()});
    options.centers_per_patch = CompositeOptions{}.centers_per_patch;
    choose(validation, options, &CompositeOptions::leaf_size, sizes);
  }
  options.leaf_size = std::min(options.leaf_size, sizes.front());
  choose(validation, options, &CompositeOptions::normal_weight, normal_weights);
  Eigen::ArrayXd errors = choose(validation, options, &CompositeOptions::centers_per_patch, center_counts);
  if (!given.smoothing && options.centers_per_patch > 0)
    errors = choose(validation, options, &CompositeOptions::smoothing, smoothings);
  options.leaf_size = given.leaf_size.value_or(options.leaf_size);
  result.cross_validation_error = errors.mean();
  return result;
}

}  // namespace csrbf
