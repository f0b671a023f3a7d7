#include "csrbf/surface/composite/leaf_fitter.hpp"

#include <iterator>
#include <utility>

namespace csrbf {
namespace {

constexpr double far_from_region = 3;  // diagonals of a leaf: its patch, about two wide, does not reach the region

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

bool reaches_region(const CompositeOptions& options, const Patch& frame) {
  return !options.region || !is_beside(*options.region, frame.center, frame.radius);
}

// The factor 1e-4 is chosen by hand: positions dominate, and the system stays regular.
CompositeOptions tight(CompositeOptions options) {
  options.normal_weight *= 1e-4;
  options.smoothing *= 1e-4;
  return options;
}

// A patch over a coverage gap need not reach farther than its samples.
CompositeOptions covering(CompositeOptions options) {
  options.overlap = 1;
  return options;
}

CompositeOptions quadric(CompositeOptions options) {
  options.centers_per_patch = 0;
  return options;
}

// The cut that was made first between leaves [first, last) of a part; `last` if only sheets were cut there.
Index first_cut(const PointPartition& parts, Index first, Index last) {
  Index cut = last;
  for (Index i = first + 1; i < last; ++i)
    if (parts.depth[i] >= 0 && (cut == last || parts.depth[i] < parts.depth[cut])) cut = i;
  return cut;
}

void add_joinable(const PointPartition& parts, Index first, Index last, Index largest, std::vector<Index>& begin) {
  const bool is_small = parts.begin[last] - parts.begin[first] <= largest;
  const Index cut = is_small ? last : first_cut(parts, first, last);
  if (cut == last) {
    begin.push_back(first);
    return;
  }
  add_joinable(parts, first, cut, largest, begin);
  add_joinable(parts, cut, last, largest, begin);
}

}  // namespace

bool is_beside(const Box<3>& region, const Point<3>& center, double radius) {
  return (center - center.cwiseMax(region.lo).cwiseMin(region.hi)).norm() >= radius;
}

std::vector<Index> joinable(const PointPartition& parts, Index largest) {
  std::vector<Index> begin;
  add_joinable(parts, 0, parts.leaves(), largest, begin);
  begin.push_back(parts.leaves());
  return begin;
}

LeafFitter::LeafFitter(const OrientedPoints& cloud, const KdTree<3>& tree, const CompositeOptions& options,
                       PointPartition& parts)
    : cloud_(cloud),
      tree_(tree),
      options_(options),
      tight_options_(tight(options)),
      covering_options_(covering(options)),
      quadric_options_(quadric(options)),
      parts_(parts),
      fitter_(cloud, tree, options_),
      tight_fitter_(cloud, tree, tight_options_),
      covering_fitter_(cloud, tree, covering_options_),
      quadric_fitter_(cloud, tree, quadric_options_) {}

void LeafFitter::fit(Index first, Index last, std::vector<Leaf>& leaves) {
  if (last - first == 1) {
    const Index begin = parts_.begin[first], end = parts_.begin[last];
    if (!is_far(cloud_, options_, parts_.order.data() + begin, end - begin)) fit_samples(begin, end, leaves);
    return;
  }
  const Index cut = first_cut(parts_, first, last);
  if (cut == last) {  // sheets are not joined
    for (Index i = first; i < last; ++i) fit(i, i + 1, leaves);
    return;
  }
  std::vector<Leaf> apart;
  fit(first, cut, apart);
  const bool is_whole = apart.size() == 1;
  fit(cut, last, apart);
  std::vector<Leaf> joined;
  const bool may_join = is_whole && apart.size() == 2 && !apart[0].lonely && !apart[1].lonely;
  if (may_join) fit_samples(parts_.begin[first], parts_.begin[last], joined);
  const bool is_better = joined.size() == 1 && joined[0].error <= apart[0].error + apart[1].error;
  std::vector<Leaf>& chosen = is_better ? joined : apart;
  leaves.insert(leaves.end(), std::make_move_iterator(chosen.begin()), std::make_move_iterator(chosen.end()));
}

void LeafFitter::fit_samples(Index begin, Index end, std::vector<Leaf>& leaves) {
  const std::span<Index> ids(parts_.order.data() + begin, static_cast<std::size_t>(end - begin));
  const Index count = end - begin;
  FittedPatch patch;
  PatchSamples samples;
  if (options_.region || options_.choose_leaves) {
    samples = fitter_.around(ids.data(), count);
    if (!reaches_region(options_, samples.frame)) return;
    patch = fitter_.fit(ids.data(), count, samples);
  } else {
    patch = fitter_.fit(ids.data(), count);
  }
  if (options_.tolerance.size() > 0 && !fitter_.within_tolerance(patch)) {
    if (count >= 2 * CompositeOptions::smallest_leaf) {
      const Index middle = begin + halve<3>(cloud_.points, cloud_.normals, ids.data(), count);
      fit_samples(begin, middle, leaves);
      fit_samples(middle, end, leaves);
      return;
    }
    patch = tight_fitter_.fit(ids.data(), count);
  }
  const double error = options_.choose_leaves ? choose_centers(ids, samples, patch) : 0;
  leaves.push_back({begin, end, fitter_.areas(), std::move(patch), fitter_.lonely(), error});
}

// Takes the quadric alone where it predicts the samples better. Returns the error of the patch.
double LeafFitter::choose_centers(std::span<const Index> ids, PatchSamples& samples, FittedPatch& patch) {
  const auto error_of = [&](const PatchFitter& fitter, const FittedPatch& fitted) {
    Eigen::ArrayXd errors(static_cast<Index>(ids.size()));
    fitter.left_out_distances(fitted, ids, errors.data());
    return errors.min(fitted.frame().radius).sum();
  };
  const double error = error_of(fitter_, patch);
  if (options_.centers_per_patch == 0) return error;
  FittedPatch quadric = quadric_fitter_.fit(ids.data(), std::ssize(ids), samples);
  const double error_of_quadric = error_of(quadric_fitter_, quadric);
  if (error_of_quadric > error) return error;
  patch = std::move(quadric);
  return error_of_quadric;
}

std::optional<FittedPatch> LeafFitter::cover(const CoverageGap& gap) {
  samples_around(cloud_, tree_, gap, around_);
  if (around_.empty()) return std::nullopt;
  const auto count = static_cast<Index>(around_.size());
  PatchSamples samples = covering_fitter_.around(around_.data(), count);
  if (!reaches_region(options_, samples.frame)) return std::nullopt;
  FittedPatch patch = covering_fitter_.fit(around_.data(), count, samples);
  if (options_.tolerance.size() > 0 && !covering_fitter_.within_tolerance(patch)) return std::nullopt;
  return patch;
}

}  // namespace csrbf
