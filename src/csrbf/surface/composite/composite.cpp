#include "csrbf/surface/composite/composite.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/surface/composite/leaf_fitter.hpp"

#include <numeric>
#include <utility>

namespace csrbf {
namespace {

constexpr Index patches_per_task = 64;  // large enough to hide the cost of a task
constexpr Index tasks_per_report = 64;  // tasks between two progress reports at least ...
constexpr Index most_reports = 32;      // ... and progress reports of one fit at most
constexpr double covering_reach = 4;    // patches over gaps are at most this much wider than the gap
constexpr Index fragment_ratio = 8;     // a leaf with less than this fraction, 1/8, of the usual points is a fragment
constexpr double stray_share = 0.02;    // of the samples; if more are lonely, the cloud is small
constexpr double sufficient_weight = 0.1;  // sum of weights above which a fragment needs no patch; both chosen by hand
// Leaves are chosen between these; larger ranges gain nothing.
constexpr Index smallest_chosen = 6;  // samples, or half a usual leaf
constexpr Index most_joined = 4;      // usual leaves

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

// Fits `count` ranges of leaves from range `first` on; returns the leaves made of each.
template <class MakeFitter>
std::vector<std::vector<Leaf>> fit_leaves(const std::vector<Index>& ranges, Index first, Index count, Index per_task,
                                          const MakeFitter& make_fitter) {
  std::vector<std::vector<Leaf>> fitted(count);
  const auto compute = [&](Index begin, Index end) {
    LeafFitter fitter = make_fitter();
    for (Index i = begin; i < end; ++i) fitter.fit(ranges[first + i], ranges[first + i + 1], fitted[i]);
  };
  parallel_for(count, per_task, compute);
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
  const Index leaf = options.choose_leaves ? std::max(smallest_chosen, options.leaf_size / 2) : options.leaf_size;
  PointPartition parts = partition<3>(cloud.points, cloud.normals, cloud.spacing, {.leaf_size = leaf});
  const std::vector<Index> ranges = joinable(parts, options.choose_leaves ? most_joined * options.leaf_size : 0);
  const auto make_fitter = [&] { return LeafFitter(cloud, tree, options, parts); };
  CompositeFit result;
  result.areas = cloud.spacing.cwiseAbs2();
  const Index usual_leaf = options.tolerance.size() > 0 ? 1 : leaf;
  std::vector<Leaf> fragments, strays;
  result.patches.reserve(parts.leaves(), options.centers_per_patch);
  const Index total = std::ssize(ranges) - 1;
  const Index per_task = std::max<Index>(1, patches_per_task * total / std::max<Index>(1, parts.leaves()));
  const Index batch = batch_size(total);
  for (Index done = 0; done < total; done += batch) {
    const Index count = std::min(total - done, batch);
    std::vector<std::vector<Leaf>> fitted = fit_leaves(ranges, done, count, per_task, make_fitter);
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
    report(progress, "fit", static_cast<double>(done + count) / static_cast<double>(total));
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
    cover(bare, make_fitter, result.patches);
    result.patches.build();
  }
  return result;
}

}  // namespace csrbf
