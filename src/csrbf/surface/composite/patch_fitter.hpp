#pragma once

#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/composite/piece_fitter.hpp"

#include <optional>

namespace csrbf {

/// A patch: one smooth piece, or several that meet in creases or are sheets beside each other, in the order in which
/// they are joined; all in the same frame.
struct FittedPatch {
  std::vector<FittedPiece> pieces = std::vector<FittedPiece>(1);

  /// Centre, axes and support of all pieces.
  [[nodiscard]] const Patch& frame() const { return pieces.front().patch; }

  /// The step -f grad f / |grad f|^2 from x to the surface of the patch, exact to first order; ignores the support.
  [[nodiscard]] Point<3> step_to_surface(const Point<3>& x) const;
};

/// Shares the area of a patch among the samples on it: equally, unless the density jumps. Then few samples stand for
/// as much of the surface as many, and have areas in proportion to the squares of their spacings.
class SampleAreas {
 public:
  SampleAreas() = default;
  SampleAreas(const OrientedPoints& cloud, const std::vector<Index>& samples, double area);

  /// Area of a sample with this spacing.
  [[nodiscard]] double of(double spacing) const { return unit_ * share(spacing); }

 private:
  [[nodiscard]] double share(double spacing) const;

  double usual_ = 0;  // mean squared spacing
  double unit_ = 0;   // area per squared spacing
};

/// The samples around a leaf that its patch is fitted to. Of the settings, only the overlap and the largest number of
/// points play a part.
struct PatchSamples {
  Patch frame;                 ///< centre, axes and support
  std::vector<Index> support;  ///< samples with a normal near that of the patch
  std::vector<Index> foreign;  ///< in the ball of the support, but of another sheet
  Index stride = 1;            ///< of the samples that are used
  bool lonely = false;         ///< no other samples nearby have such a normal: the support reaches far beyond the leaf
  SampleAreas areas;
  std::optional<std::vector<std::vector<Index>>> groups = {};  ///< on smooth pieces, once they were looked for
};

/// Fits patches to leaves of a cloud (thesis 6.1.3 and 6.1.4). Reuses its work arrays: one fitter per thread. The
/// cloud, its tree and the options must outlive it.
class PatchFitter {
 public:
  PatchFitter(const OrientedPoints& cloud, const KdTree<3>& tree, const CompositeOptions& options)
      : cloud_(cloud), tree_(tree), options_(options) {}

  /// The patch over the n points `ids`.
  FittedPatch fit(const Index* ids, Index n);

  /// The same, given what around() returned for these points; keeps there what other settings can use.
  FittedPatch fit(const Index* ids, Index n, PatchSamples& around);

  /// The samples around the n points `ids`.
  [[nodiscard]] PatchSamples around(const Index* ids, Index n);

  /// Whether the last patch meets the tolerance of every sample in the inner part of its support.
  [[nodiscard]] bool within_tolerance(const FittedPatch& patch) const;

  /// Error of the last patch at samples of sheets in its support that it has no piece for, summed over them: blended
  /// with their own patches, it contributes its distance times its share of the weights.
  [[nodiscard]] double error_on_other_sheets(const FittedPatch& patch) const;

  /// Distances of samples from the surface of the last patch as if it had been fitted without their positions (their
  /// normals remain); ignores off-surface rows.
  void left_out_distances(const FittedPatch& patch, std::span<const Index> ids, double* distance) const;

  /// The areas of the samples of the last patch.
  [[nodiscard]] const SampleAreas& areas() const { return samples_.areas; }

  /// Whether the last patch is PatchSamples::lonely.
  [[nodiscard]] bool lonely() const { return samples_.lonely; }

 private:
  void frame(const Index* ids, Index n);
  void gather(const Index* ids, Index n);
  void thin();
  FittedPatch fit_samples(const Index* ids, Index n);
  void split(const Index* ids, Index n, FittedPatch& patch);
  [[nodiscard]] std::vector<std::vector<Index>> smooth_groups(std::span<const Index> leaf) const;

  const OrientedPoints& cloud_;
  const KdTree<3>& tree_;
  const CompositeOptions& options_;
  PatchSamples samples_;  // of the last patch
  // One entry per piece of the last patch: its samples, and what fitted it.
  std::vector<std::vector<Index>> groups_;
  std::vector<PieceFitter> fitters_ = std::vector<PieceFitter>(1);
  std::vector<std::size_t> fitter_of_;
  std::size_t main_ = 0;  // the piece of the leaf
};

}  // namespace csrbf
