#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/patches.hpp"

namespace csrbf {

/// Oriented samples of a surface, ready to fit: unit outward normals, local spacing.
struct OrientedPoints {
  Points<3> points;         ///< 3 x n
  Points<3> normals;        ///< 3 x n, unit length, outward
  Eigen::VectorXd spacing;  ///< n, distance between neighbouring samples

  [[nodiscard]] Index size() const { return points.cols(); }
};

/// How normals enter the fit of the CSRBF residual.
enum class NormalRows {
  gradient,     ///< grad f = -n at the samples: better under noise, no offset to choose
  off_surface,  ///< f = -+ kappa at p +- kappa n, kappa half the local spacing (thesis 6.1.4)
};

/// How the local models are fitted. The defaults suit clean, dense samples and were chosen by hand; choose_options()
/// adapts them to the data.
struct CompositeOptions {
  /// Points per leaf of the partition: one patch each.
  Index leaf_size = 8;
  /// Expected number of points in the support of a patch, as a multiple of leaf_size.
  double overlap = 4;
  /// Largest number of CSRBF centres per patch; 0: the quadric alone.
  Index centers_per_patch = 16;
  /// Weight of the normals relative to the positions, in units of the patch radius (rho of eq. (6.4)).
  double normal_weight = 0.03;
  NormalRows normal_rows = NormalRows::gradient;
  /// Native-space ridge of the CSRBF residual, relative to the trace of the normal matrix.
  double smoothing = 1e-6;
  /// Largest number of points a patch is fitted to; denser ones are thinned evenly. Bounds time.
  Index max_fit_points = 400;
  /// Candidates for CSRBF centres: indices into the cloud, sorted; empty: every point.
  std::vector<Index> centers;
  /// n, or empty. A leaf whose patch misses a sample in the inner part of its support by more than that sample's
  /// tolerance is halved, down to `smallest_leaf` points; unit of the cloud.
  Eigen::VectorXd tolerance;

  static constexpr Index smallest_leaf = 3;  ///< three points determine a plane
};

/// Patches over a cloud.
struct CompositeFit {
  Patches patches;
  /// n, the area each sample represents, from the number of samples in the support of its patch.
  Eigen::VectorXd areas;
};

/// Fits one patch per leaf of `cloud` (thesis 6.1): a quadric in local scaled coordinates, then a CSRBF
/// residual, both by weighted least squares on positions (f = 0) and normals (grad f = -n). A patch uses only points
/// whose normal is within 78 degrees of its own, so that it never joins two sheets. O(n).
CompositeFit fit_composite(const OrientedPoints& cloud, const KdTree<3>& tree, const CompositeOptions& options,
                           const Progress& progress = {});

/// The same with a tree of its own.
CompositeFit fit_composite(const OrientedPoints& cloud, const CompositeOptions& options, const Progress& progress = {});

}  // namespace csrbf
