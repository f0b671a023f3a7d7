#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/implicit/mesh/triangle_tree_build.hpp"

#include <vector>

namespace csrbf {

/// Closest points and ray hits on the triangles of a mesh, through a bounding volume hierarchy. Holds its own copy of
/// the geometry (about 35 bytes per triangle and 24 per vertex). Construction O(t log t); queries about O(log t),
/// thread safe, without allocation, with the same relative accuracy at every scale and position. Degenerate triangles
/// are part of the surface for closest points and invisible to rays.
class TriangleTree {
 public:
  /// Throws InvalidInput if the mesh has no triangle, an index outside its vertices or a used vertex that is not
  /// finite.
  explicit TriangleTree(const Mesh& mesh);

  struct Closest {
    Index triangle = -1;  ///< of the mesh; -1 if nothing is within the given distance
    Point<3> point = Point<3>::Zero();
    double distance = std::numeric_limits<double>::infinity();
  };
  /// Point of the surface closest to x among those nearer than `max_distance`. Exact up to rounding.
  [[nodiscard]] Closest closest(const Point<3>& x, double max_distance = std::numeric_limits<double>::infinity()) const;

  struct Hit {
    Index triangle = -1;                                 ///< of the mesh; -1 if there is no hit
    double t = std::numeric_limits<double>::infinity();  ///< the hit is origin + t * direction
    Point<3> weights = Point<3>::Zero();                 ///< barycentric, of the triangle's three vertices
  };
  /// First hit with 0 <= t <= t_max, from either side. No ray passes through an edge shared by two triangles
  /// (Woop, Benthin, Wald 2013). A direction that is zero or not finite hits nothing.
  [[nodiscard]] Hit first_hit(const Point<3>& origin, const Point<3>& direction,
                              double t_max = std::numeric_limits<double>::infinity()) const;

  /// Whether there is any hit with 0 <= t <= t_max. Faster than first_hit.
  [[nodiscard]] bool occluded(const Point<3>& origin, const Point<3>& direction,
                              double t_max = std::numeric_limits<double>::infinity()) const;

  /// Number of triangles.
  [[nodiscard]] Index size() const { return static_cast<Index>(leaves_.size()); }
  /// Box of all vertices that belong to a triangle.
  [[nodiscard]] const Box<3>& bounds() const { return bounds_; }

 private:
  struct LeafTriangle {
    std::array<std::int32_t, 3> vertex;
    std::int32_t marked;  // number of the triangle, complemented for the last one of a leaf

    [[nodiscard]] bool is_last() const { return marked < 0; }
    [[nodiscard]] std::int32_t triangle() const { return is_last() ? ~marked : marked; }
  };
  struct LocalRay;

  [[nodiscard]] Point<3> to_local(const Point<3>& x) const { return (x - center_) * scale_; }
  [[nodiscard]] bool enter(const Point<3>& origin, const Point<3>& direction, double t_max, LocalRay& ray) const;
  bool intersect(const LeafTriangle& leaf, LocalRay& ray) const;
  template <bool AnyHit>
  bool traverse(LocalRay& ray) const;

  // Local coordinates have the origin at the centre of the box and its longest side between 1 and 2.
  Box<3> bounds_;
  Point<3> center_;
  double scale_;
  Point<3> local_half_extent_;
  Points<3> vertices_;
  std::vector<LeafTriangle> leaves_;
  std::vector<TreeNode> nodes_;
};

}  // namespace csrbf
