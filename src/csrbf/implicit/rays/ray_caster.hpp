#pragma once

#include "csrbf/implicit/rays/candidate_cells.hpp"

namespace csrbf {

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

 private:
  const Field<3>& field_;
  CandidateCells cells_;
  double tolerance_;
};

}  // namespace csrbf
