#pragma once

#include "report/page.hpp"

#include "csrbf/surface/reconstruct.hpp"

#include <functional>

namespace csrbf::app {

/// A reconstruction, to be shown.
struct ReconstructionShown {
  const Reconstruction& surface;
  const PointCloud& used;  ///< points
  const Mesh& mesh;
  int resolution;                    ///< of the mesh
  std::function<Mesh(int)> mesh_at;  ///< the mesh of another resolution
};

/// An interactive view of the surface, the distances of the points from it, and its function on three planes.
void show(const ReconstructionShown& shown, Page& page);

}  // namespace csrbf::app
