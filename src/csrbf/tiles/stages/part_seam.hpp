#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/implicit/polygonize/extraction.hpp"
#include "csrbf/surface/check/data_support.hpp"

#include <array>
#include <string>

namespace csrbf {

/// The triangles of a tile.
struct TilePart {
  Mesh mesh;
  std::vector<polygonization::SharedVertex> shared;  ///< vertices that other tiles may have, ascending
  Index weak_features = 0;                           ///< see MeshPart
};

/// What joining the parts of all tiles needs to know of one.
struct PartSeam {
  Index vertices = 0;
  /// But for open edges and broken fans along `shared`; without vertices, components and euler.
  Topology topology;
  std::vector<polygonization::SharedVertex> shared;
  std::vector<std::int32_t> component;  ///< of each of them
  std::vector<DataSupport> supports;    ///< of each component

  // Numbers of vertices in what follows are positions in `shared`.
  std::vector<std::array<std::int32_t, 3>> open;  ///< edges from, to, and how often more than from `to` to `from`
  /// A fan of triangles around a vertex has a chain of entries that name its neighbours: vertex, neighbour, neighbour.
  /// Both are -1 for a fan without neighbours in `shared`.
  std::vector<std::array<std::int32_t, 3>> fans;

  Box<3> bounds;
  double moved = 0;  ///< coordinates by rounding to float
  Index weak_features = 0;
};

/// O(t log t). Without supports.
PartSeam make_seam(const TilePart& part, const std::vector<Index>& component);

void write_seam(const std::string& path, const PartSeam& seam);
/// Throws IoError.
PartSeam read_seam(const std::string& path);

void write_part(const std::string& path, const TilePart& part);
/// Throws IoError.
TilePart read_part(const std::string& path);

}  // namespace csrbf
