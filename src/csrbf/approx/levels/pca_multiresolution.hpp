#pragma once

#include "csrbf/approx/levels/level_fit.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <string>

namespace csrbf {

struct PcaMultiresolutionOptions {
  std::string kernel = "wendland-c2";    ///< compactly supported
  std::optional<double> tolerance = {};  ///< largest error at any sample, in units of the values; default: 1 % of
                                         ///< their range
  Index cluster_size = 0;                ///< largest cluster of the first level, in samples; 0: N / 30, at least 1
  double support = 3;                    ///< radius of the first level, in fill distances of its centres
  std::optional<double> lambda0 = 1e-6;  ///< regularisation (see sparse_least_squares); empty: chosen from the data
  Index max_levels = 20;                 ///< before the last level, which removes the remaining errors
  Progress progress = {};                ///< stages "levels", "choose smoothing", "solve"
};

/// Multiresolution approximation by principal component clusters (thesis section 3.1, Algorithm 1): the samples are
/// split by planes through their centroids across the principal axis into clusters; the centroids are the centres of
/// the first level, fitted by regularised least squares. Clusters with an error above the tolerance are split further,
/// and their centroids are the centres of the next level, which fits the residual.
///
/// Three departures make the published loop end within the tolerance: the support shrinks by 2^(-1/Dim) per level, as a
/// binary split requires (halving leaves most samples outside of all supports); all clusters are checked on every
/// level, since later levels disturb those that had converged; and after max_levels, or when nothing can be split any
/// more, the samples still above the tolerance get basis functions of their own, as in error_bounded: so **the bound
/// always holds, at every sample**, up to rounding.
///
/// Treats several samples at one point as error_bounded, and throws the same.
template <int Dim>
LevelFit<Dim> pca_multiresolution(const Samples<Dim>& samples, const PcaMultiresolutionOptions& options = {});

}  // namespace csrbf
