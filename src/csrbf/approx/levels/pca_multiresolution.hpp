#pragma once

#include "csrbf/approx/levels/level_fit.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <string>

namespace csrbf {

struct PcaMultiresolutionOptions {
  std::string kernel = "wendland-c2";  ///< compactly supported
  /// Largest error at any sample, in the unit of the values; unset: 1 % of their range.
  std::optional<double> tolerance = {};
  Index cluster_size = 0;  ///< largest number of samples in a cluster of the first level; 0: N / 30, at least 1
  double support = 3;      ///< radius of the first level, in fill distances of its centres
  std::optional<double> lambda0 = 1e-6;  ///< regularisation, see RidgeOptions::lambda0; unset: chosen from the data
  Index max_levels = 20;                 ///< before the last level, which removes the remaining errors
  Progress progress = {};                ///< stages "levels", "choose smoothing", "solve"
};

/// Multiresolution approximation by principal component clusters (thesis section 3.1, Algorithm 1). Planes through the
/// centroids, across the principal axis, split the samples into clusters. The centroids are the centres of the first
/// level, fitted by regularised least squares. Clusters with an error above the tolerance are split further; their
/// centroids are the centres of the next level, which fits the residual.
///
/// Three changes make the published loop end within the tolerance. The support shrinks by 2^(-1/Dim) per level, as a
/// binary split requires; halving leaves most samples outside all supports. All clusters are checked on every level,
/// since later levels disturb those that had converged. After max_levels, or when nothing can be split any more, the
/// samples still above the tolerance get basis functions of their own, as in error_bounded(). So **the bound always
/// holds, at every sample**, up to rounding.
///
/// Samples at the same point and errors are treated as in error_bounded().
template <int Dim>
LevelFit<Dim> pca_multiresolution(const Samples<Dim>& samples, const PcaMultiresolutionOptions& options = {});

}  // namespace csrbf
