#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/mesh.hpp"

#include <memory>

namespace csrbf {

class TriangleTree;

/// Signed distance to a closed mesh, positive inside: exact up to rounding, with the edges and corners of the mesh. The
/// gradient has length 1 and jumps where the closest point does. The sign is that of the angle-weighted normal at the
/// closest point (Baerentzen and Aanaes 2005). About O(log t) per point.
class MeshDistance final : public Field<3> {
 public:
  /// Throws InvalidInput if the mesh is not closed and consistently oriented, or is corrupt.
  explicit MeshDistance(const Mesh& mesh);

  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<3> bounds() const override;
  /// A point of the largest triangle of each component.
  [[nodiscard]] Points<3> seeds() const override { return seeds_; }

 private:
  // Where the closest point of a triangle lies.
  struct Place {
    Point<3> normal;                    // of the faces that meet there, not of unit length
    Point<3> along = Point<3>::Zero();  // unit vector of the edge that holds it
    bool on_face = false;               // else on an edge or at a vertex
  };
  [[nodiscard]] Place place_of(Index triangle, const Point<3>& p) const;
  [[nodiscard]] double signed_distance(const Point<3>& x, Point<3>& gradient, Eigen::Matrix3d* hessian) const;

  std::shared_ptr<const TriangleTree> tree_;
  Points<3> vertices_;
  Triangles triangles_;
  Triangles neighbours_;      // across the edge from each corner to the next
  Points<3> face_normals_;    // unit, or zero
  Points<3> vertex_normals_;  // weighted by angles
  Points<3> seeds_{3, 0};
  double touching_;  // smaller distances are rounding
};

}  // namespace csrbf
