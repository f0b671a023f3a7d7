#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/mesh.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/surface/reconstruct_options.hpp"

#include <memory>

namespace csrbf {

/// Of surfaces by the composite method.
struct CompositeReport {
  Index patches = 0;                  ///< of the finest level
  Index levels = 0;                   ///< of patches, finest included
  CompositeSettings settings = {};    ///< of the finest level, also those chosen automatically
  double cross_validation_error = 0;  ///< mean distance of left-out points to the surface, fraction of the diagonal
};

/// Of surfaces made from contours.
struct ContoursReport {
  Index contours = 0;  ///< closed curves used
  Index slices = 0;    ///< planes that they lie in
  Index caps = 0;      ///< ends of stacks that had to be closed
};

/// What was found, chosen and measured by reconstruct().
struct ReconstructReport {
  std::string method;  ///< the one used
  NormalSource normals = NormalSource::file;
  Index points = 0;         ///< given
  Index points_used = 0;    ///< after cleaning
  Index centers = 0;        ///< CSRBF centres of the finest level
  double smoothing = 0;     ///< used or chosen
  double rms_distance = 0;  ///< of the points used to the surface, fraction of the diagonal
  double p99_distance = 0;  ///< 99th percentile of the same
  double max_distance = 0;  ///< largest of the same
  double prepare_seconds = 0;
  double fit_seconds = 0;
  double evaluate_seconds = 0;  ///< of the distances above
  std::optional<CompositeReport> composite = {};
  std::optional<ContoursReport> contours = {};
  std::vector<std::string> warnings;

  /// Fills in rms_distance, p99_distance and max_distance from those of the points used.
  void set_distances(const std::vector<double>& distance);
};

/// An implicit surface with the cloud it was made from.
struct Reconstruction {
  std::shared_ptr<const Field<3>> field;  ///< f > 0 inside, close to the signed distance near the data
  std::vector<Index> source;              ///< input indices of the points used
  Points<3> normals;                      ///< of the points used: given, estimated or re-oriented; unit, outward
  std::vector<Index> measured;            ///< which of the points used are in the region
  std::vector<double> distance;           ///< of these to the surface, fraction of the diagonal
  ReconstructReport report;
};

/// Implicit surface through (or, under noise, near) a point cloud. Closed wherever the data are open: use polygonize()
/// for the watertight mesh, and trim() to open it again far from data. Where a surface turns out much farther from its
/// points than cross-validation promised, it is fitted again with smaller patches. O(n log n). Throws InvalidInput for
/// bad options, fewer than four distinct points, collinear points, or missing normals when normals = file;
/// SolverFailure when no surface comes out or the tolerance cannot be reached.
Reconstruction reconstruct(const PointCloud& cloud, const ReconstructOptions& options = {});

/// The same for points, and normals if there are any, held as one array each.
Reconstruction reconstruct(std::span<const std::array<double, 3>> points,
                           std::span<const std::array<double, 3>> normals = {}, const ReconstructOptions& options = {});

/// The method of polygonize() that suits a field: dual contouring for the method composite, which has edges, unless it
/// smooths noise away, and for what is combined of such; else marching cubes, whose triangles never fold over.
PolygonizeMethod mesh_method(const Field<3>& field);

}  // namespace csrbf
