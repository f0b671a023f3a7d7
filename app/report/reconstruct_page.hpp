#pragma once

#include "report/page.hpp"

#include "csrbf/core/field.hpp"
#include "csrbf/core/mesh.hpp"
#include "csrbf/surface/reconstruct.hpp"

#include <functional>

namespace csrbf::app {

/// What was made of points, to be shown.
struct ReconstructionShown {
  const Reconstruction& surface;
  const PointCloud& used;  ///< points
  const Mesh& mesh;
  int resolution;                    ///< of the mesh
  std::function<Mesh(int)> mesh_at;  ///< the same with another one
};

/// The surface to turn, how far the points are from it, and its function on three planes.
void show(const ReconstructionShown& shown, Page& page);

}  // namespace csrbf::app
