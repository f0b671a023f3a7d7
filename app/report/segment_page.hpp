#pragma once

#include "report/page.hpp"

#include "csrbf/core/grid.hpp"
#include "csrbf/core/mesh.hpp"
#include "csrbf/levelset/segment.hpp"

#include <nlohmann/json.hpp>

#include <functional>

namespace csrbf::app {

/// The regions on the image, their intensities, the descent of the energy and, in a volume, an interactive view of the
/// surface.
/// `measures`: the contour as in the report; `mesh_at`: the surface of a given resolution, 0 for the automatic one.
template <int Dim>
void show(const Volume<float>& image, const Segmentation<Dim>& segmentation, const nlohmann::ordered_json& measures,
          const std::function<Mesh(int)>& mesh_at, Page& page);

}  // namespace csrbf::app
