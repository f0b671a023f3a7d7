#pragma once

#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/composite/patches.hpp"
#include "csrbf/surface/reconstruct_options.hpp"

namespace csrbf {

/// Oriented samples of a surface, ready to fit: unit outward normals, local spacing.
struct OrientedPoints {
  Points<3> points;         ///< 3 x n
  Points<3> normals;        ///< 3 x n, unit length, outward
  Eigen::VectorXd spacing;  ///< n, distance between neighbouring samples

  [[nodiscard]] Index size() const { return points.cols(); }
};

/// How a cloud is fitted: the settings, and what is given for its samples.
struct CompositeOptions : CompositeSettings {
  /// Candidates for CSRBF centres: indices into the cloud, sorted; empty: every point.
  std::vector<Index> centers = {};
  /// n, or empty. A leaf whose patch misses a sample in the inner part of its support by more than that sample's
  /// tolerance is halved, down to `smallest_leaf` points; unit of the cloud.
  Eigen::VectorXd tolerance = {};
  /// Whether leaves are chosen place by place, from half of `leaf_size` to four times, and centres, all or none: by the
  /// errors of left-out samples. For noise; clean samples would have patches that say too little between them.
  bool choose_leaves = false;
  /// Where the surface is wanted, if not everywhere: leaves too far from it get no patch.
  std::optional<Box<3>> region = {};
  /// Whether leaves without samples in the region get patches that reach into it. Where samples outside are sparser,
  /// such patches are wider, and know less of the surface, than those of the region.
  bool from_outside = true;

  static constexpr Index smallest_leaf = 3;  ///< three points determine a plane
};

/// Patches over a cloud.
struct CompositeFit {
  Patches patches;
  /// n, the area each sample represents, from the samples in the support of its patch, or its spacing without one.
  Eigen::VectorXd areas;
};

/// Fits one patch per leaf of `cloud` (thesis 6.1): a quadric in local scaled coordinates, then a CSRBF
/// residual, both by weighted least squares on positions (f = 0) and normals (grad f = -n). A patch over a crease, a
/// corner or several sheets consists of smooth pieces, joined by minimum and maximum. O(n).
CompositeFit fit_composite(const OrientedPoints& cloud, const KdTree<3>& tree, const CompositeOptions& options,
                           const Progress& progress = {});

/// The same with a tree of its own.
CompositeFit fit_composite(const OrientedPoints& cloud, const CompositeOptions& options, const Progress& progress = {});

}  // namespace csrbf
