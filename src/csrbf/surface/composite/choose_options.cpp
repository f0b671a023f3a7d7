#include "csrbf/surface/composite/choose_options.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/partition.hpp"
#include "csrbf/surface/composite/patch_fitter.hpp"

namespace csrbf {
namespace {

// Chosen by hand. More samples: time in proportion, a more reliable choice.
constexpr Index block_size = 48;                // samples predicted together
constexpr Index around_block = 4 * block_size;  // nearest samples of which a block takes those along the sheet
constexpr Index blocks = 100;                   // some five thousand samples in all; half as many choose worse at times

// Chosen by hand.
constexpr double thickest = 0.2;      // largest error over the patch radius; smaller patches follow layers of the noise
constexpr double confidence = 0.5;    // standard errors by which a smoother choice may be worse under noise
constexpr double margin = 0.1;        // relative: by which a closer fit may be worse without noise
constexpr Index noisy_leaf = 12;      // the cloud is noisy if the best leaves have at least this many points
constexpr double least_noise = 0.05;  // spacings for which leaves are chosen place by place; clean clouds have .01
constexpr Index screening_stride = 4;  // every fourth block screens the values of an option: ...
constexpr double reject_ratio = 1.3;   // ... those whose error exceeds the least by this factor are not tried further
constexpr double give_up_ratio = 2;    // ... nor are larger leaves after two sizes that exceed it by this one

// Values tried. Leaf sizes: repeated halves of a block, and larger ones.
constexpr std::array<Index, 7> leaf_sizes = {6, 12, 24, 48, 96, 200, 350};
constexpr std::array<double, 6> normal_weights = {3, 1, 0.3, 0.1, 0.03, 0.01};
constexpr std::array<Index, 3> center_counts = {0, 16, 32};
constexpr std::array<double, 4> smoothings = {1e-1, 1e-2, 1e-3, 1e-6};

// Samples in blocks all over the cloud, each predicted by a patch fitted without it.
class CrossValidation {
 public:
  CrossValidation(const OrientedPoints& cloud, const KdTree<3>& tree, const std::optional<Box<3>>& region)
      : cloud_(cloud), tree_(tree) {
    std::vector<Index> inside;  // the region, if there is one
    for (Index i = 0; i < cloud.size() && region; ++i)
      if (region->contains(cloud.points.col(i))) inside.push_back(i);
    const Index n = region ? std::ssize(inside) : cloud.size(), count = std::min(blocks, n / block_size);
    for (Index t = 0; t < count; ++t) {
      const Index middle = (2 * t + 1) * n / (2 * count);
      blocks_.push_back({block_around(region ? inside[middle] : middle)});
    }
  }

  [[nodiscard]] bool empty() const { return blocks_.empty(); }

  // Mean errors and patch radii per block.
  struct Prediction {
    Eigen::ArrayXd error, radius;

    // All infinite if the errors are large compared with the patches.
    [[nodiscard]] Eigen::ArrayXd checked_errors() const {
      if (error.mean() <= thickest * radius.mean()) return error;
      return Eigen::ArrayXd::Constant(error.size(), std::numeric_limits<double>::infinity());
    }
  };

  // Of every `screening_stride`-th block.
  const Prediction& screen(const CompositeOptions& options) { return tried(options).screened; }

  // Of all blocks.
  const Prediction& complete(const CompositeOptions& options) {
    Tried& done = tried(options);
    if (done.complete) return *done.complete;
    std::vector<Index> others;
    for (Index t = 0; t < count(); ++t)
      if (t % screening_stride != 0) others.push_back(t);
    const Prediction rest = predict(options, others);
    Prediction all{Eigen::ArrayXd(count()), Eigen::ArrayXd(count())};
    const auto first = Eigen::seq(0, count() - 1, Eigen::fix<screening_stride>);
    all.error(first) = done.screened.error;
    all.radius(first) = done.screened.radius;
    all.error(others) = rest.error;
    all.radius(others) = rest.radius;
    return done.complete.emplace(std::move(all));
  }

 private:
  // A leaf of a block, which is left out, and the samples around it.
  struct Leaf {
    std::vector<Index> ids;
    std::vector<Index> predicted;  // of the block
    PatchSamples around;
  };

  struct Block {
    std::vector<Index> samples;
    Index leaf_size = 0;  // of the leaves
    std::vector<Leaf> leaves = {};
  };

  // What was predicted with some settings.
  struct Tried {
    CompositeSettings settings;
    Prediction screened;
    std::optional<Prediction> complete = {};
  };

  Tried& tried(const CompositeOptions& options) {
    for (Tried& t : tried_)
      if (t.settings == options) return t;
    std::vector<Index> chosen;
    for (Index t = 0; t < count(); t += screening_stride) chosen.push_back(t);
    return tried_.emplace_back(Tried{static_cast<const CompositeSettings&>(options), predict(options, chosen)});
  }

  // The samples nearest to sample `middle` along the sheet, whatever their noise across it.
  [[nodiscard]] std::vector<Index> block_around(Index middle) const {
    std::vector<Index> near(std::min(around_block, cloud_.size()));
    std::vector<double> squared(near.size());
    const Point<3> center = cloud_.points.col(middle);
    tree_.nearest(center, std::ssize(near), near.data(), squared.data());
    Point<3> normal = Point<3>::Zero();
    for (Index i = 0; i < block_size; ++i)
      if (cloud_.normals.col(near[i]).dot(cloud_.normals.col(middle)) > 0) normal += cloud_.normals.col(near[i]);
    normal.normalize();
    std::vector<std::pair<double, Index>> along;
    for (const Index i : near) {
      const Point<3> d = cloud_.points.col(i) - center;
      if (cloud_.normals.col(i).dot(normal) > 0) along.emplace_back(d.squaredNorm() - std::pow(d.dot(normal), 2), i);
    }
    std::sort(along.begin(), along.end());
    along.resize(std::min(along.size(), static_cast<std::size_t>(block_size)));
    std::vector<Index> block;
    block.reserve(along.size());
    for (const auto& [distance, i] : along) block.push_back(i);
    return block;
  }

  [[nodiscard]] Index count() const { return std::ssize(blocks_); }

  [[nodiscard]] Prediction predict(const CompositeOptions& options, const std::vector<Index>& chosen) {
    const Index n = std::ssize(chosen);
    Prediction result{Eigen::ArrayXd(n), Eigen::ArrayXd(n)};
    const auto compute = [&](Index first, Index last) {
      PatchFitter fitter(cloud_, tree_, options);
      for (Index i = first; i < last; ++i) {
        const Sum sum = predict(fitter, options.leaf_size, blocks_[chosen[i]]);
        result.error[i] = sum.error / sum.samples;
        result.radius[i] = sum.radius / sum.samples;
      }
    };
    parallel_for(n, 4, compute);
    return result;
  }

  struct Sum {
    double error = 0, radius = 0, samples = 0;
  };

  Sum predict(PatchFitter& fitter, Index leaf_size, Block& block) const {
    if (block.leaf_size != leaf_size) find_leaves(fitter, leaf_size, block);
    Sum sum;
    for (Leaf& leaf : block.leaves) add(fitter, leaf, sum);
    return sum;
  }

  // A block is split into leaves, or is the middle of a larger leaf.
  void find_leaves(PatchFitter& fitter, Index leaf_size, Block& block) const {
    block.leaf_size = leaf_size;
    block.leaves.clear();
    std::vector<Index> ids = block.samples;
    if (leaf_size <= std::ssize(ids)) {
      add_leaves(fitter, leaf_size, ids, block.leaves);
    } else {
      Point<3> center = Point<3>::Zero();
      for (const Index i : ids) center += cloud_.points.col(i) / static_cast<double>(ids.size());
      std::vector<Index> leaf(leaf_size);
      std::vector<double> distance(leaf.size());
      leaf.resize(tree_.nearest(center, leaf_size, leaf.data(), distance.data()));
      block.leaves.push_back({leaf, std::move(ids), fitter.around(leaf.data(), std::ssize(leaf))});
    }
  }

  void add_leaves(PatchFitter& fitter, Index leaf_size, std::span<Index> ids, std::vector<Leaf>& leaves) const {
    const auto n = static_cast<Index>(ids.size());
    if (n > leaf_size) {
      const auto cut = static_cast<std::size_t>(halve<3>(cloud_.points, cloud_.normals, ids.data(), n));
      add_leaves(fitter, leaf_size, ids.first(cut), leaves);
      add_leaves(fitter, leaf_size, ids.subspan(cut), leaves);
      return;
    }
    leaves.push_back({{ids.begin(), ids.end()}, {ids.begin(), ids.end()}, fitter.around(ids.data(), n)});
  }

  // Adds the errors of the patch over a leaf, and their share of its error at samples of other sheets. Where a left-out
  // sample alone holds the patch, as strays do, its error may be anything: it counts up to the radius.
  static void add(PatchFitter& fitter, Leaf& leaf, Sum& sum) {
    const FittedPatch patch = fitter.fit(leaf.ids.data(), std::ssize(leaf.ids), leaf.around);
    const auto predicted = static_cast<double>(leaf.predicted.size());
    std::vector<double> distance(leaf.predicted.size());
    fitter.left_out_distances(patch, leaf.predicted, distance.data());
    for (const double d : distance) sum.error += std::min(d, patch.frame().radius);
    sum.error += fitter.error_on_other_sheets(patch) * predicted / static_cast<double>(leaf.ids.size());
    sum.radius += patch.frame().radius * predicted;
    sum.samples += predicted;
  }

  const OrientedPoints& cloud_;
  const KdTree<3>& tree_;
  std::vector<Block> blocks_;
  std::vector<Tried> tried_;
};

// Chooses among values, smoothest first. Under noise: the first whose errors do not differ significantly from the
// least. Without noise the errors of left-out samples overstate those of the surface, which is closer to samples than
// these are to each other: the last value within a margin of the best.
std::size_t choose(const std::vector<Eigen::ArrayXd>& errors, bool noisy) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < errors.size(); ++i)
    if (errors[i].mean() < errors[best].mean()) best = i;
  if (!std::isfinite(errors[best].mean())) return 0;
  if (!noisy) {
    std::size_t last = errors.size() - 1;
    while (errors[last].mean() > (1 + margin) * errors[best].mean()) --last;
    return last;
  }
  for (std::size_t i = 0; i < best; ++i) {
    if (!std::isfinite(errors[i].mean())) continue;
    const Eigen::ArrayXd difference = errors[i] - errors[best];
    const double mean = difference.mean();
    const double variance = (difference - mean).square().sum() / static_cast<double>(difference.size() - 1);
    if (mean <= confidence * std::sqrt(variance / static_cast<double>(difference.size()))) return i;
  }
  return best;
}

// Tries each value of one option, smoothest first, and sets the chosen one; returns its errors. Values that are much
// worse than the best on a few blocks are not tried on the others.
template <class Value, class Values>
Eigen::ArrayXd choose(CrossValidation& validation, CompositeOptions& options, Value CompositeSettings::*member,
                      const Values& values, bool noisy) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Eigen::ArrayXd screened = Eigen::ArrayXd::Constant(static_cast<Index>(values.size()), infinity);
  int worse = 0;                                                // values in a row
  for (std::size_t i = values.size(); i-- > 0 && worse < 2;) {  // least smooth first, which are also the cheapest
    options.*member = values[i];
    screened[static_cast<Index>(i)] = validation.screen(options).checked_errors().mean();
    worse = screened[static_cast<Index>(i)] > give_up_ratio * screened.minCoeff() ? worse + 1 : 0;
  }
  std::vector<Eigen::ArrayXd> errors(values.size(), Eigen::ArrayXd::Constant(1, infinity));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(screened[static_cast<Index>(i)] <= reject_ratio * screened.minCoeff())) continue;
    options.*member = values[i];
    errors[i] = validation.complete(options).checked_errors();
  }
  const std::size_t chosen = choose(errors, noisy);
  options.*member = values[chosen];
  return errors[chosen];
}

}  // namespace

ChosenOptions choose_options(const OrientedPoints& cloud, const KdTree<3>& tree, const GivenOptions& given) {
  ChosenOptions result;
  CompositeOptions& options = result.options;
  options.normal_rows = given.normal_rows;
  options.region = given.region;
  options.smoothing = given.smoothing.value_or(options.smoothing);
  options.leaf_size = given.leaf_size.value_or(options.leaf_size);
  CrossValidation validation(cloud, tree, given.region);
  if (validation.empty()) return result;

  // Large leaves first, provided a body has enough of them.
  const Index body = std::max(given.body_size.value_or(cloud.size()), leaves_of_body * leaf_sizes.front());
  std::vector<Index> sizes;
  for (auto size = leaf_sizes.rbegin(); size != leaf_sizes.rend(); ++size)
    if (leaves_of_body * *size <= std::min(body, cloud.size())) sizes.push_back(*size);
  if (sizes.empty()) return result;
  options.normal_weight = 0.1;
  if (!given.leaf_size) choose(validation, options, &CompositeOptions::leaf_size, sizes, true);
  options.leaf_size = std::min(options.leaf_size, sizes.front());
  const bool noisy = options.leaf_size >= noisy_leaf;
  choose(validation, options, &CompositeOptions::normal_weight, normal_weights, noisy);
  Eigen::ArrayXd errors = choose(validation, options, &CompositeOptions::centers_per_patch, center_counts, noisy);
  if (!given.smoothing && options.centers_per_patch > 0)
    errors = choose(validation, options, &CompositeOptions::smoothing, smoothings, noisy);
  options.leaf_size = given.leaf_size.value_or(options.leaf_size);
  result.cross_validation_error = errors.mean();
  options.choose_leaves =
      noisy && !given.leaf_size && result.cross_validation_error > least_noise * cloud.spacing.mean();
  return result;
}

}  // namespace csrbf
