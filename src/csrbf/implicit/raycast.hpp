#pragma once

#include "csrbf/implicit/rays/candidate_cells.hpp"
#include "csrbf/implicit/rays/ray.hpp"

#include <limits>
#include <span>

namespace csrbf {

struct RaycastOptions {
  /// Cells along the longest side of the field's bounds, 4 ... 1024; 0 = automatic_resolution(field), at most 512.
  int resolution = 0;
  /// Only hits nearer than this along the ray count; > 0.
  double t_max = std::numeric_limits<double>::infinity();
  Progress progress{};  ///< stages "polygonize", "cells" and "raycast"
};

/// Where a ray first meets a surface.
struct RayHit {
  double t = std::numeric_limits<double>::infinity();  ///< distance; infinite if there is no hit
  Point<3> normal = Point<3>::Zero();                  ///< outward

  [[nodiscard]] bool exists() const { return t < std::numeric_limits<double>::infinity(); }
};

/// The surface f = 0 in the bounds of a field (plus four cells), prepared for rays. References the field.
class RayCaster {
 public:
  /// `resolution`: of the cells, 4 ... 1024. Throws InvalidInput if it is out of range, and whatever polygonize throws.
  RayCaster(const Field<3>& field, int resolution, const Progress& progress = {});

  /// With a given polygonization of the field of that resolution, which need not outlive this.
  RayCaster(const Field<3>& field, int resolution, const Mesh& mesh, const Progress& progress = {});

  /// The first hit of each ray with t < t_max, on the calling thread; fast for rays that are close to each other.
  void cast(std::span<const Ray> rays, double t_max, std::span<RayHit> hits) const;

  /// Whether no hit can be missed: see CandidateCells.
  [[nodiscard]] bool guaranteed() const { return cells_.guaranteed(); }
  [[nodiscard]] const CandidateCells& cells() const { return cells_; }

 private:
  const Field<3>& field_;
  CandidateCells cells_;
  double tolerance_;
};

/// Where n rays first meet the surface.
struct RayHits {
  Eigen::VectorXd t;  ///< n, distances; infinite for rays that meet nothing
  Points<3> normals;  ///< 3 x n, outward; NaN for rays that meet nothing
  bool guaranteed = false;
};

/// First zero of f along each ray origin + t direction, 0 <= t < t_max, from either side, in the bounds of the field
/// (plus four cells). Directions may have any nonzero length; t is in units of length. Zeros are exact up to rounding.
/// None is missed for fields with enclosures (`guaranteed`); for others, parts that polygonize() misses are not
/// searched, and high curvature between the vertices of a polygonization may hide a hit. Zeros where f touches 0
/// without changing sign do not count. About five gradients for each ray that comes near the surface, after a
/// preparation that costs as much as polygonize().
///
/// Throws InvalidInput for origins or directions that are not finite, zero directions, different numbers of both, and
/// options out of range; Cancelled.
RayHits raycast(const Field<3>& field, const PointsRef<3>& origins, const PointsRef<3>& directions,
                const RaycastOptions& options = {});

}  // namespace csrbf
