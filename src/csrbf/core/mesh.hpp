#pragma once

#include "csrbf/core/types.hpp"

#include <string>
#include <vector>

namespace csrbf {

/// A named scalar per point. `type` is its PLY type on disk (char uchar short ushort int uint float double). Colours
/// are the properties red, green, blue (and alpha) of type uchar.
struct Property {
  std::string name;
  std::string type = "float";
  Eigen::VectorXd values;
};

/// Points in space with optional outward normals and any further properties.
struct PointCloud {
  Points<3> points;                  ///< 3 x n
  Points<3> normals{3, 0};           ///< 3 x n, or no columns
  std::vector<Property> properties;  ///< all others, n values each

  [[nodiscard]] Index size() const { return points.cols(); }
  [[nodiscard]] bool has_normals() const { return normals.cols() > 0 && normals.cols() == points.cols(); }
};

/// Triangles over shared vertices, counter-clockwise seen from outside.
using Triangles = Eigen::Matrix<std::int32_t, 3, Eigen::Dynamic>;

/// A triangle mesh with optional outward vertex normals and any further vertex properties.
struct Mesh {
  Points<3> vertices{3, 0};          ///< 3 x v
  Triangles triangles{3, 0};         ///< 3 x t, 0-based vertex indices
  Points<3> normals{3, 0};           ///< 3 x v, or no columns
  std::vector<Property> properties;  ///< v values each
  Space space = Space::unknown;      ///< of the coordinates
};

/// Curves made of straight segments over shared vertices, with any further vertex properties.
struct Polylines {
  Points<3> vertices{3, 0};                                    ///< 3 x v
  Eigen::Matrix<std::int32_t, 2, Eigen::Dynamic> edges{2, 0};  ///< 2 x e, 0-based vertex indices
  std::vector<Property> properties;                            ///< v values each
};

/// Topology of a mesh, from its connectivity.
struct Topology {
  Index vertices = 0;  ///< vertices used by a triangle
  Index edges = 0;
  Index triangles = 0;
  Index components = 0;            ///< connected components
  Index boundary_edges = 0;        ///< edges of a single triangle
  Index nonmanifold_edges = 0;     ///< edges of more than two triangles
  Index nonmanifold_vertices = 0;  ///< vertices whose triangles do not form one fan
  Index inconsistent_edges = 0;    ///< edges whose two triangles are oriented differently
  Index euler = 0;                 ///< vertices - edges + triangles

  /// Whether every edge has exactly two triangles, with consistent orientation.
  [[nodiscard]] bool watertight() const {
    return triangles > 0 && boundary_edges == 0 && nonmanifold_edges == 0 && inconsistent_edges == 0;
  }
  [[nodiscard]] bool manifold() const { return nonmanifold_edges == 0 && nonmanifold_vertices == 0; }
};

/// Counts the topology of a mesh. O(t log t).
Topology topology(const Mesh& mesh);

}  // namespace csrbf
