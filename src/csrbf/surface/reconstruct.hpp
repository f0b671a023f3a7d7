#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/mesh.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/surface/prepare.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace csrbf {

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
  /// How the fit is told about the normals.
  NormalRows normal_rows = NormalRows::gradient;
  Progress progress = {};
};

/// What was found, chosen and measured by reconstruct().
struct ReconstructReport {
  std::string method;                 ///< the one used
  std::string normals;                ///< "file", "estimated" or "re-oriented"
  Index points = 0;                   ///< given
  Index points_used = 0;              ///< after cleaning
  Index centers = 0;                  ///< CSRBF centres of the finest level
  double smoothing = 0;               ///< used or chosen
  Index patches = 0;                  ///< composite: patches of the finest level
  Index levels = 0;                   ///< composite: levels of patches, finest included
  Index contours = 0;                 ///< contours: closed curves used
  Index slices = 0;                   ///< contours: planes that they lie in
  Index lids = 0;                     ///< contours: ends of stacks that had to be closed
  CompositeOptions options;           ///< composite: of the finest level, also where chosen automatically
  double cross_validation_error = 0;  ///< mean distance of left-out points to the surface, fraction of the diagonal
  double rms_distance = 0;            ///< of the points used to the surface, fraction of the diagonal
  double p99_distance = 0;            ///< 99th percentile of the same
  double max_distance = 0;            ///< largest of the same
  double prepare_seconds = 0;
  double fit_seconds = 0;
  double evaluate_seconds = 0;  ///< of the distances above
  std::vector<std::string> warnings;
};

/// An implicit surface with the cloud it was made from.
struct Reconstruction {
  std::shared_ptr<const Field<3>> field;  ///< f > 0 inside, close to the signed distance near the data
  std::vector<Index> source;              ///< input indices of the points used
  Points<3> normals;                      ///< of the points used: given, estimated or re-oriented; unit, outward
  ReconstructReport report;
};

/// Implicit surface through (or, under noise, near) a point cloud. Closed wherever the data are open: use polygonize()
/// for the watertight mesh, and trim() to open it again far from data. Where a surface turns out much farther from its
/// points than cross-validation promised, it is fitted again with smaller patches. O(n log n). Throws InvalidInput for
/// bad options, fewer than four distinct points, collinear points, or missing normals when normals = file;
/// SolverFailure when no surface comes out or the tolerance cannot be reached.
Reconstruction reconstruct(const PointCloud& cloud, const ReconstructOptions& options = {});

}  // namespace csrbf
