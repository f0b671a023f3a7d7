#pragma once

#include "csrbf/core/mesh.hpp"

namespace csrbf {

/// Node of a bounding volume hierarchy with four children, whose boxes are interleaved so that one instruction tests
/// all of them. Slots without a child hold an empty box (lo = inf, hi = -inf).
struct alignas(64) TreeNode {
  using PerChild = Eigen::Array<float, 4, 1>;

  std::array<PerChild, 3> lo;
  std::array<PerChild, 3> hi;
  std::array<std::int32_t, 4> child;  ///< index of a node, or ~index of the first triangle of a leaf in leaf order

  TreeNode();
};

/// Box of one triangle in single precision, and which triangle it is.
struct TriangleBox {
  std::array<float, 3> lo;
  std::array<float, 3> hi;
  std::int32_t triangle;
};

/// Builds the hierarchy over `boxes`, reordering them into leaf order; node 0 is the root. The last triangle of every
/// leaf is marked: its number is complemented (~triangle). Splits by the surface area heuristic on 16 bins (Wald 2007);
/// leaves hold at most four triangles. The result does not depend on the number of threads. O(t log t).
std::vector<TreeNode> build_triangle_tree(std::vector<TriangleBox>& boxes);

/// Upper bound of the depth of the hierarchy: sizes the stacks of traversals.
inline constexpr int max_tree_depth = 72;

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
