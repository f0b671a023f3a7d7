#pragma once

#include "csrbf/spatial/partition.hpp"
#include "csrbf/surface/composite/coverage_gaps.hpp"
#include "csrbf/surface/composite/patch_fitter.hpp"

namespace csrbf {

/// Samples [begin, end) of the order of a partition, and the patch over them.
struct Leaf {
  Index begin, end;
  SampleAreas areas;
  FittedPatch patch;
  bool lonely;       ///< see PatchSamples
  double error = 0;  ///< where leaves are chosen: sum over the samples, each predicted without it; unit of the cloud
};

/// Whether a ball does not reach the region.
bool is_beside(const Box<3>& region, const Point<3>& center, double radius);

/// Ranges of consecutive leaves, by where they begin and the number of leaves, that may be joined to one: parts of a
/// partition with at most `largest` samples.
std::vector<Index> joinable(const PointPartition& parts, Index largest);

/// Fits patches to leaves of a partition. Halves leaves while a tolerance is missed; the smallest ones then nearly
/// interpolate the positions. With CompositeOptions::choose_leaves, joins leaves and leaves centres out where left-out
/// samples are predicted better so. One fitter per thread.
class LeafFitter {
 public:
  LeafFitter(const OrientedPoints& cloud, const KdTree<3>& tree, const CompositeOptions& options,
             PointPartition& parts);

  /// Appends the leaves made of leaves [first, last).
  void fit(Index first, Index last, std::vector<Leaf>& leaves);

  /// The patch over a coverage gap, unless it misses a tolerance.
  std::optional<FittedPatch> cover(const CoverageGap& gap);

 private:
  void fit_samples(Index begin, Index end, std::vector<Leaf>& leaves);
  double choose_centers(std::span<const Index> ids, PatchSamples& samples, FittedPatch& patch);

  const OrientedPoints& cloud_;
  const KdTree<3>& tree_;
  const CompositeOptions& options_;
  const CompositeOptions tight_options_, covering_options_, quadric_options_;
  PointPartition& parts_;
  PatchFitter fitter_, tight_fitter_, covering_fitter_, quadric_fitter_;
  std::vector<Index> around_;
};

}  // namespace csrbf
