#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

#include <optional>

namespace csrbf {

/// Where the normals of a reconstruction come from.
enum class Normals {
  /// The given ones, if there are any: corrected where they have errors, re-oriented if they contradict each other and
  /// flipped if they point inward. Otherwise estimated.
  automatic,
  file,      ///< the given ones, unchanged
  estimate,  ///< estimated, even if there are some
};

/// Where the normals used for a surface came from.
enum class NormalSource {
  file,           ///< given
  estimated,      ///< from the points
  reoriented,     ///< given, flipped where they contradicted each other or pointed inward
  corrected,      ///< given, but replaced by better estimates where they had errors
  within_slices,  ///< for contours: normals within the planes of the slices
};

/// The name in reports: file, estimated, re-oriented, corrected, within the slices.
const char* name_of(NormalSource source);

/// How normals enter the fit of the CSRBFs.
enum class NormalRows {
  gradient,     ///< grad f = -n at the samples: better in noise, and no offset to choose
  off_surface,  ///< f = -+ kappa at p +- kappa n, with kappa half the local spacing (thesis 6.1.4)
};

/// How the patches of the composite method are fitted. The defaults, chosen by hand, suit clean, dense samples;
/// reconstruct() adapts them to the data.
struct CompositeSettings {
  /// Points per leaf of the partition. There is one patch per leaf.
  Index leaf_size = 8;
  /// Expected number of points in the support of a patch, as a multiple of leaf_size.
  double overlap = 4;
  /// Largest number of CSRBF centres per patch; 0: the quadric alone.
  Index centers_per_patch = 16;
  /// Weight of the normals relative to the positions, in units of the patch radius: rho of eq. (6.4).
  double normal_weight = 0.03;
  NormalRows normal_rows = NormalRows::gradient;
  /// Penalty on the native-space norm of the CSRBFs, relative to the trace of the normal matrix.
  double smoothing = 1e-6;
  /// Largest number of points that a patch is fitted to; denser ones are thinned evenly. Bounds the time.
  Index max_fit_points = 400;

  bool operator==(const CompositeSettings&) const = default;
};

/// How reconstruct() turns points into a surface. Lengths are relative to the data: the result rotates, moves and
/// scales with them.
struct ReconstructOptions {
  /// "auto" or "composite": a partition of unity of quadrics and CSRBFs, thesis 6.1. Or a name from surface_methods(),
  /// such as "medial-axis": a budget of CSRBFs whose supports follow the medial axis, thesis 6.2.
  std::string method = "auto";
  /// Where normals come from.
  Normals normals = Normals::automatic;
  /// Budget of CSRBF centres; 0: chosen from the data. Methods without centres ignore it.
  Index centers = 0;
  /// Largest distance from a point used to the surface, as a fraction of the diagonal of the bounding box, below 1; 0:
  /// no limit. For the composite method only.
  double tolerance = 0;
  /// Weight of the penalty of the method, see CompositeSettings::smoothing: 0: none; larger: smoother. Unset: chosen by
  /// cross-validation.
  std::optional<double> smoothing = {};
  /// How normals enter the fit.
  NormalRows normal_rows = NormalRows::gradient;
  /// Where the surface is wanted; unset: everywhere. Settings are chosen, patches fitted and distances measured for
  /// this box; points outside only tell what surrounds it. At least one point must be inside. For the composite method
  /// only.
  std::optional<Box<3>> region = {};
  Progress progress = {};
};

}  // namespace csrbf
