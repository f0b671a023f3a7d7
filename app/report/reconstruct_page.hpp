#pragma once

#include "report/page.hpp"

#include "csrbf/surface/reconstruct.hpp"

namespace csrbf::app {

/// A reconstruction, to be shown.
struct ReconstructionShown {
  const Reconstruction& surface;
  const PointCloud& used;  ///< points
  const Mesh& mesh;
};

/// An interactive view of the surface, the distances of the points from it, and its function on three planes.
void show(const ReconstructionShown& shown, Page& page);

}  // namespace csrbf::app
