#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/mesh.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/surface/reconstruct_options.hpp"

#include <memory>

namespace csrbf {

/// Details of a surface made by the composite method.
struct CompositeReport {
  Index patches = 0;                  ///< on the finest level
  Index levels = 0;                   ///< levels of patches, the finest included
  CompositeSettings settings = {};    ///< used on the finest level, whether given or chosen
  double cross_validation_error = 0;  ///< mean distance of left-out points to the surface over the diagonal
};

/// Details of a surface made from contours.
struct ContoursReport {
  Index contours = 0;  ///< closed curves used
  Index slices = 0;    ///< the planes that they lie in
  Index caps = 0;      ///< ends of stacks that were closed by a flat cap
};

/// What reconstruct() found, chose and measured.
struct ReconstructReport {
  std::string method;  ///< used
  NormalSource normals = NormalSource::file;
  Index points = 0;         ///< given
  Index points_used = 0;    ///< after cleaning
  Index centers = 0;        ///< CSRBF centres on the finest level
  double smoothing = 0;     ///< given or chosen
  double rms_distance = 0;  ///< of the points used to the surface, as a fraction of the diagonal
  double p99_distance = 0;  ///< 99th percentile of these distances
  double max_distance = 0;  ///< largest of these distances
  double prepare_seconds = 0;
  double fit_seconds = 0;
  double evaluate_seconds = 0;  ///< for measuring the distances
  std::optional<CompositeReport> composite = {};
  std::optional<ContoursReport> contours = {};
  std::vector<std::string> warnings;

  /// Sets rms_distance, p99_distance and max_distance from the distances of the points used.
  void set_distances(const std::vector<double>& distance);
};

/// An implicit surface and the points it was made from.
struct Reconstruction {
  std::shared_ptr<const Field<3>> field;  ///< f > 0 inside, close to the signed distance near the points
  std::vector<Index> source;              ///< indices of the points used in the input
  Points<3> normals;                      ///< 3 x n, of the points used: unit, outward
  std::vector<Index> measured;            ///< which of the points used lie in the region
  std::vector<double> distance;           ///< of the measured points to the surface, as a fraction of the diagonal
  ReconstructReport report;
};

/// Makes an implicit surface through a point cloud or, in noise, close to it. It is closed even where points are
/// missing: polygonize() gives the watertight mesh, trim() opens it again far from the points. If the surface is much
/// farther from the points than cross-validation predicted, it is fitted again with smaller patches. O(n log n).
///
/// Throws InvalidInput for bad options, fewer than four distinct points, points on a line, and missing normals with
/// Normals::file; SolverFailure if no surface is found or the tolerance cannot be reached; Cancelled.
Reconstruction reconstruct(const PointCloud& cloud, const ReconstructOptions& options = {});

/// The same for points and, optionally, normals held as one std::array each.
Reconstruction reconstruct(std::span<const std::array<double, 3>> points,
                           std::span<const std::array<double, 3>> normals = {}, const ReconstructOptions& options = {});

/// The method of polygonize() that suits a field. Dual contouring for surfaces of the composite method, which have
/// sharp edges, unless they smooth noise, and for combinations of these. Otherwise marching cubes, whose triangles
/// never fold over.
PolygonizeMethod mesh_method(const Field<3>& field);

}  // namespace csrbf
