#include "csrbf/surface/composite/composite.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/partition.hpp"
#include "csrbf/surface/composite/coverage_gaps.hpp"
#include "csrbf/surface/composite/patch_fitter.hpp"

#include <numeric>
#include <utility>

namespace csrbf {
namespace {

constexpr Index patches_per_task = 64;  // large enough to hide the cost of a task
constexpr Index tasks_per_report = 64;  // tasks between two progress reports at least ...
constexpr Index most_reports = 32;      // ... and progress reports of one fit at most
constexpr double far_from_region = 3;   // diagonals of a leaf: its patch, about two wide, does not reach the region
constexpr double covering_reach = 4;    // patches over gaps are at most this much wider than the gap
constexpr Index fragment_ratio = 8;     // a leaf with less than this fraction, 1/8, of the usual points is a fragment
constexpr double stray_share = 0.02;    // of the samples; if more are lonely, the cloud is small
constexpr double sufficient_weight = 0.1;  // sum of weights above which a fragment needs no patch; both chosen by hand

// One leaf of the final partition with its patch.
struct Leaf {
  Index begin, end;  // in the order of the partition
  SampleAreas areas;
  FittedPatch patch;
  bool lonely;  // see PatchSamples
};

// Whether a leaf is too far from the region for a patch.
bool is_far(const OrientedPoints& cloud, const CompositeOptions& options, const Index* ids, Index n) {
  const std::optional<Box<3>>& region = options.region;
  if (!region) return false;
  if (!options.from_outside)
    return std::none_of(ids, ids + n, [&](Index i) { return region->contains(cloud.points.col(i)); });
  Box<3> box;
  for (Index i = 0; i < n; ++i) box.add(Point<3>(cloud.points.col(ids[i])));
  return !box.inflated(far_from_region * std::max(box.diagonal(), cloud.spacing[ids[0]])).intersects(*region);
}

// Whether a ball does not reach the region.
bool is_beside(const Box<3>& region, const Point<3>& center, double radius) {
  return (center - center.cwiseMax(region.lo).cwiseMin(region.hi)).norm() >= radius;
}

// Fits leaves; halves them while a tolerance is missed. The smallest leaves then nearly interpolate the positions.
class LeafFitter {
 public:
  LeafFitter(const OrientedPoints& cloud, const KdTree<3>& tree, const CompositeOptions& options,
             std::vector<Index>& order)
      : cloud_(cloud),
        tree_(tree),
        options_(options),
        tight_options_(tight(options)),
        covering_options_(covering(options)),
        order_(order),
        fitter_(cloud, tree, options_),
        tight_fitter_(cloud, tree, tight_options_),
        covering_fitter_(cloud, tree, covering_options_) {}

  void fit(Index begin, Index end, std::vector<Leaf>& leaves) {
    Index* ids = order_.data() + begin;
    FittedPatch patch;
    if (options_.region) {
      PatchSamples samples = fitter_.around(ids, end - begin);
      if (is_beside(*options_.region, samples.frame.center, samples.frame.radius)) return;
      patch = fitter_.fit(ids, end - begin, samples);
    } else {
      patch = fitter_.fit(ids, end - begin);
    }
    if (options_.tolerance.size() > 0 && !fitter_.within_tolerance(patch)) {
      if (end - begin >= 2 * CompositeOptions::smallest_leaf) {
        const Index middle = begin + halve<3>(cloud_.points, cloud_.normals, ids, end - begin);
        fit(begin, middle, leaves);
        fit(middle, end, leaves);
        return;
      }
      patch = tight_fitter_.fit(ids, end - begin);
    }
    leaves.push_back({begin, end, fitter_.areas(), std::move(patch), fitter_.lonely()});
  }

  // The patch over a coverage gap, unless it misses a tolerance.
  std::optional<FittedPatch> cover(const CoverageGap& gap) {
    samples_around(cloud_, tree_, gap, around_);
    if (around_.empty()) return std::nullopt;
    const auto count = static_cast<Index>(around_.size());
    PatchSamples samples = covering_fitter_.around(around_.data(), count);
    if (options_.region && is_beside(*options_.region, samples.frame.center, samples.frame.radius)) return std::nullopt;
    FittedPatch patch = covering_fitter_.fit(around_.data(), count, samples);
    if (options_.tolerance.size() > 0 && !covering_fitter_.within_tolerance(patch)) return std::nullopt;
    return patch;
  }

 private:
  // The factor 1e-4 is chosen by hand: positions dominate, and the system stays regular.
  static CompositeOptions tight(CompositeOptions options) {
    options.normal_weight *= 1e-4;
    options.smoothing *= 1e-4;
    return options;
  }
  // A patch over a coverage gap need not reach farther than its samples.
  static CompositeOptions covering(CompositeOptions options) {
    options.overlap = 1;
    return options;
  }

  const OrientedPoints& cloud_;
  const KdTree<3>& tree_;
  const CompositeOptions& options_;
  const CompositeOptions tight_options_, covering_options_;
  std::vector<Index>& order_;
  PatchFitter fitter_, tight_fitter_, covering_fitter_;
  std::vector<Index> around_;
};

void append(const FittedPatch& fitted, Patches& patches) {
  for (const FittedPiece& piece : fitted.pieces) patches.add(piece.patch, piece.centers, piece.alpha);
}

// Cuts at gaps leave fragments: stray samples beside a noisy sheet, or the tip of a thin feature. Only the latter,
// which no other patch covers, get a patch of their own.
void add_needed(const OrientedPoints& cloud, const std::vector<Index>& order, const std::vector<Leaf>& fragments,
                Patches& patches) {
  std::vector<char> needed(fragments.size());
  const auto compute = [&](Index begin, Index end) {
    double W = 0;
    for (Index i = begin; i < end; ++i) {
      const Leaf& leaf = fragments[i];
      for (Index k = leaf.begin; k < leaf.end; ++k) {
        patches.weights(cloud.points.col(order[k]), &W, sufficient_weight);
        if (W < sufficient_weight) needed[i] = 1;
      }
    }
  };
  parallel_for(static_cast<Index>(fragments.size()), patches_per_task, compute);
  for (std::size_t i = 0; i < fragments.size(); ++i)
    if (needed[i] != 0) append(fragments[i].patch, patches);
}

// Leaves between two progress reports.
Index batch_size(Index leaves) {
  return patches_per_task * std::max(tasks_per_report, leaves / (patches_per_task * most_reports));
}

// Fits `count` parts of the partition from part `first` on; returns the leaves of each part.
template <class MakeFitter>
std::vector<std::vector<Leaf>> fit_leaves(const OrientedPoints& cloud, PointPartition& parts, Index first, Index count,
                                          const CompositeOptions& options, const MakeFitter& make_fitter) {
  std::vector<std::vector<Leaf>> fitted(count);
  const auto compute = [&](Index begin, Index end) {
    LeafFitter fitter = make_fitter();
    for (Index i = begin; i < end; ++i) {
      const Index from = parts.begin[first + i], to = parts.begin[first + i + 1];
      if (!is_far(cloud, options, parts.order.data() + from, to - from)) fitter.fit(from, to, fitted[i]);
    }
  };
  parallel_for(count, patches_per_task, compute);
  return fitted;
}

// Adds patches over coverage gaps.
template <class MakeFitter>
void cover(const std::vector<CoverageGap>& bare, const MakeFitter& make_fitter, Patches& patches) {
  std::vector<std::optional<FittedPatch>> fitted(bare.size());
  const auto compute = [&](Index begin, Index end) {
    LeafFitter fitter = make_fitter();
    for (Index i = begin; i < end; ++i) fitted[i] = fitter.cover(bare[i]);
  };
  parallel_for(static_cast<Index>(bare.size()), patches_per_task, compute);
  for (const std::optional<FittedPatch>& patch : fitted)
    if (patch) append(*patch, patches);
}

}  // namespace

CompositeFit fit_composite(const OrientedPoints& cloud, const CompositeOptions& options, const Progress& progress) {
  return fit_composite(cloud, KdTree<3>(cloud.points), options, progress);
}

CompositeFit fit_composite(const OrientedPoints& cloud, const KdTree<3>& tree, const CompositeOptions& options,
                           const Progress& progress) {
  report(progress, "fit", 0);
  PointPartition parts = partition<3>(cloud.points, cloud.normals, cloud.spacing, {.leaf_size = options.leaf_size});
  CompositeFit result;
  result.areas = cloud.spacing.cwiseAbs2();
  const Index usual_leaf = options.tolerance.size() > 0 ? 1 : options.leaf_size;
  std::vector<Leaf> fragments, strays;
  result.patches.reserve(parts.leaves(), options.centers_per_patch);
  const Index batch = batch_size(parts.leaves());
  for (Index done = 0; done < parts.leaves(); done += batch) {
    const Index count = std::min(parts.leaves() - done, batch);
    std::vector<std::vector<Leaf>> fitted =
        fit_leaves(cloud, parts, done, count, options, [&] { return LeafFitter(cloud, tree, options, parts.order); });
    for (std::vector<Leaf>& part : fitted) {
      for (Leaf& leaf : part) {
        for (Index k = leaf.begin; k < leaf.end; ++k)
          result.areas[parts.order[k]] = leaf.areas.of(cloud.spacing[parts.order[k]]);
        if (leaf.lonely) {
          strays.push_back(std::move(leaf));
        } else if (fragment_ratio * (leaf.end - leaf.begin) >= usual_leaf) {
          append(leaf.patch, result.patches);
        } else {
          fragments.push_back(std::move(leaf));
        }
      }
    }
    report(progress, "fit", static_cast<double>(done + count) / static_cast<double>(parts.leaves()));
  }
  // The patches of a few strays would reach so far that they spoil others.
  const Index stray_samples = std::accumulate(strays.begin(), strays.end(), Index{0},
                                              [](Index n, const Leaf& leaf) { return n + leaf.end - leaf.begin; });
  if (static_cast<double>(stray_samples) > stray_share * static_cast<double>(cloud.size()))
    for (const Leaf& leaf : strays) append(leaf.patch, result.patches);
  result.patches.build();
  if (!fragments.empty()) {
    add_needed(cloud, parts.order, fragments, result.patches);
    result.patches.build();
  }
  std::vector<CoverageGap> bare = find_coverage_gaps(result.patches);
  if (options.region)
    // Outside of the region patches may be missing because nobody asked for them.
    std::erase_if(bare, [&](const CoverageGap& gap) {
      return options.from_outside ? is_beside(*options.region, gap.middle, covering_reach * gap.reach)
                                  : !options.region->contains(gap.middle);
    });
  if (!bare.empty()) {
    cover(
        bare, [&] { return LeafFitter(cloud, tree, options, parts.order); }, result.patches);
    result.patches.build();
  }
  return result;
}

}  // namespace csrbf
