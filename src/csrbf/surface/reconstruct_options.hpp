#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

#include <optional>

namespace csrbf {

/// Where the normals of a reconstruction come from.
enum class Normals {
  automatic,  ///< the given ones if there are any, corrected where they have errors, re-oriented if they contradict
              ///< each other and flipped where they point inward; else estimated
  file,       ///< the given ones, unchanged
  estimate,   ///< always estimated
};

/// Where the normals that a surface was made from come from.
enum class NormalSource {
  file,           ///< given
  estimated,      ///< from the points
  reoriented,     ///< given, and turned where they contradicted each other or pointed inward
  corrected,      ///< given, and where they had errors replaced by better estimates from the points and each other
  within_slices,  ///< of contours: within the planes of the slices
};

/// Its words in reports: file, estimated, re-oriented, corrected, within the slices.
const char* name_of(NormalSource source);

/// How normals enter the fit of the CSRBF residual.
enum class NormalRows {
  gradient,     ///< grad f = -n at the samples: better under noise, no offset to choose
  off_surface,  ///< f = -+ kappa at p +- kappa n, kappa half the local spacing (thesis 6.1.4)
};

/// How the local models of the composite method are fitted. The defaults suit clean, dense samples and were
/// chosen by hand; choose_options() adapts them to the data.
struct CompositeSettings {
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

  bool operator==(const CompositeSettings&) const = default;
};

/// How reconstruct() turns a cloud into a surface. Lengths are relative to the data; results turn, move and scale with
/// it.
struct ReconstructOptions {
  /// "auto" or "composite" (partition of unity with CSRBF residual, thesis 6.1), or the name of one of
  /// surface_methods(): "medial-axis" (a budget of CSRBFs with supports adapted to the medial axis, thesis 6.2), ...
  std::string method = "auto";
  /// Where normals come from.
  Normals normals = Normals::automatic;
  /// Budget of CSRBF centres; 0 lets the data decide. Methods without centres ignore it.
  Index centers = 0;
  /// Largest distance from an input point to the surface, as a fraction of the bounding-box diagonal; 0 = no bound
  /// asked. For the composite method only.
  double tolerance = 0;
  /// Weight of the method's penalty (of the composite method: ridge of the CSRBF residual): 0 = none, larger is
  /// smoother; not set = chosen from the data by cross-validation.
  std::optional<double> smoothing = {};
  /// How normals enter the fit.
  NormalRows normal_rows = NormalRows::gradient;
  /// Where the surface is wanted; not set: everywhere. Points outside tell only what is around: settings are chosen,
  /// distances measured and patches fitted for the region. For the composite method only.
  std::optional<Box<3>> region = {};
  Progress progress = {};
};

}  // namespace csrbf
