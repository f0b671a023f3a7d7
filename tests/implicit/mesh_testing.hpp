#pragma once

#include "core/error_testing.hpp"
#include "csrbf/core/mesh.hpp"

#include <numbers>
#include <string>
#include <vector>

namespace csrbf {

/// Triangle with its right angle at the origin and legs of length 2 along x and y.
inline Mesh right_triangle() {
  Mesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0, 2, 0,  //
      0, 0, 2,               //
      0, 0, 0;
  mesh.triangles.resize(3, 1);
  mesh.triangles << 0, 1, 2;
  return mesh;
}

/// Unit sphere of `rings` bands between the poles, 2 * rings segments each; vertices on the sphere, outward normals.
inline Mesh unit_sphere(int rings) {
  const int segments = 2 * rings;
  Mesh mesh;
  mesh.vertices.resize(3, 2 + (rings - 1) * segments);
  mesh.vertices.col(0) = Point<3>::UnitZ();
  mesh.vertices.col(1) = -Point<3>::UnitZ();
  const auto vertex = [&](int ring, int segment) {
    if (ring == 0) return 0;
    if (ring == rings) return 1;
    return 2 + (ring - 1) * segments + segment % segments;
  };
  std::vector<Eigen::Vector3i> faces;
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < segments; ++j) {
      const double theta = std::numbers::pi * i / rings, phi = std::numbers::pi * j / rings;
      const Point<3> p(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      if (i > 0) mesh.vertices.col(vertex(i, j)) = p;
      if (i > 0) faces.emplace_back(vertex(i, j), vertex(i + 1, j), vertex(i, j + 1));
      if (i < rings - 1) faces.emplace_back(vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1));
    }
  }
  mesh.triangles.resize(3, static_cast<Index>(faces.size()));
  for (std::size_t f = 0; f < faces.size(); ++f) mesh.triangles.col(static_cast<Index>(f)) = faces[f];
  mesh.normals = mesh.vertices;
  return mesh;
}

}  // namespace csrbf
