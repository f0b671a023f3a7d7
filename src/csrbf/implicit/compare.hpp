#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/core/progress.hpp"

namespace csrbf {

struct CompareOptions {
  Index samples = 200000;  ///< points sampled on each mesh, uniformly by area
  std::uint64_t seed = 7;
  Progress progress = {};  ///< stage "compare"
};

/// Distances from sample points to the other surface, as fractions of the diagonal of the bounding box of the
/// reference.
struct DistanceStatistics {
  double mean = 0;
  double rms = 0;
  double p99 = 0;  ///< 99th percentile
  double max = 0;  ///< the largest at any sample
};

/// How a mesh differs from a reference mesh. Distances are exact point-to-triangle distances at the samples.
struct MeshComparison {
  DistanceStatistics accuracy;      ///< mesh to reference
  DistanceStatistics completeness;  ///< reference to mesh
  double chamfer_mean = 0;          ///< (accuracy.mean + completeness.mean) / 2
  double hausdorff99 = 0;           ///< max(accuracy.p99, completeness.p99)
  double normal_error_deg = 0;  ///< mean angle between the triangle normals at a sample and at its closest point, over
                                ///< both directions, in [0, 180]: an inverted normal counts 180
  double diagonal = 0;          ///< of the bounding box of the triangles of the reference
  Topology topology;            ///< of the mesh
};

/// Compares a mesh with a reference mesh. The result depends only on the meshes, samples and seed, and stays the same
/// if both meshes are rotated, moved and scaled together. Throws InvalidInput if a mesh has no surface or is corrupt,
/// or if samples < 1; Cancelled. O((samples + triangles) log triangles).
MeshComparison compare(const Mesh& mesh, const Mesh& reference, const CompareOptions& options = {});

/// How far reference points are from a mesh.
struct PointComparison {
  DistanceStatistics distance;  ///< points to mesh
  double normal_error_deg = 0;  ///< mean angle between the normals of points and closest triangles, NaN without normals
  double diagonal = 0;          ///< of the points' bounding box
  Topology topology;            ///< of the mesh
};

/// Compares a mesh with all points of a cloud; of the options only `progress` is used. Throws InvalidInput if the mesh
/// has no surface, or if there are no points, or these are not finite or coincide; Cancelled.
PointComparison compare(const Mesh& mesh, const PointCloud& reference, const CompareOptions& options = {});

}  // namespace csrbf
