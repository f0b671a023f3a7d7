#pragma once

#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/composite/composite.hpp"
#include "csrbf/surface/medial/medial_axis_field.hpp"
#include "csrbf/surface/medial/medial_supports.hpp"

namespace csrbf {

struct MedialAxisOptions {
  /// Number of centres, farthest points of the cloud; 0: an eighth of the points, 500 to 10 000.
  Index centers = 0;
  /// Alternatively the indices of the samples that are centres, distinct.
  std::vector<Index> center_indices = {};
  /// (epsilon / t)^2 of eq. (6.32), the weight of the slope penalty relative to the sum of squares. Not set: chosen by
  /// generalised cross-validation (see slope_penalty.hpp).
  std::optional<double> smoothing = {};
  Progress progress = {};  ///< stages "farthest points", "poles", "fit", "choose smoothing", "solve"
};

struct MedialAxisFit {
  std::shared_ptr<const MedialAxisField> field;
  Eigen::VectorXd scales;  ///< of the centres: distances to the medial axis, estimated from the centres
  double smoothing = 0;    ///< used or chosen
};

/// Fits a fixed budget of CSRBFs with supports adapted to the medial axis (thesis section 6.2): quadrics g_i fitted to
/// the samples in each support by positions and normals (eq. 6.24 in local, scaled coordinates), then coefficients
/// alpha_i that minimise
///
///     |f|^2 at the samples + (epsilon / t)^2 sum_k |sum_i alpha_i sigma_i / K' grad w_i(p_k)|^2,
///
/// eq. (6.32) for the normalised functions w_i = phi_i / sum phi, by a sparse Cholesky factorisation (by conjugate
/// gradients where it would take more than about 20 s). The winding number of the centres, each with the area of its
/// cell in the tangent plane, decides far from the data: the surface is closed. Where a quadric leaves residuals that
/// are large compared with its support, as under noise, the support grows. Time is dominated by the linear solve, which
/// grows with the number of centres in a support: below 10 s for 10 000 centres and clean samples.
///
/// Throws InvalidInput for a negative budget or smoothing.
MedialAxisFit fit_medial_axis(const OrientedPoints& cloud, const KdTree<3>& tree,
                              const MedialAxisOptions& options = {});

}  // namespace csrbf
