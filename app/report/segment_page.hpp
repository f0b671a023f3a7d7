#pragma once

#include "report/page.hpp"

#include "csrbf/core/mesh.hpp"
#include "csrbf/levelset/segment.hpp"

#include <functional>

namespace csrbf::app {

/// The level sets of all regions but the outside; that of label i is at i - 1.
template <int Dim>
std::vector<const Field<Dim>*> inside_fields(const Segmentation<Dim>& segmentation) {
  std::vector<const Field<Dim>*> fields;
  for (Index k = segmentation.fields.size() > 1 ? 1 : 0; k < std::ssize(segmentation.fields); ++k)
    fields.push_back(segmentation.fields[k].get());
  return fields;
}

/// The regions on the image, their intensities, the descent of the energy and, in a volume, an interactive view of the
/// surface.
/// `mask`: of the voxels that count, empty for all; `measures`: the contour as in the report; `mesh`: the surface, of a
/// volume.
template <int Dim>
void show(const Volume<float>& image, const std::vector<std::uint8_t>& mask, const Segmentation<Dim>& segmentation,
          const Json& measures, const std::function<Mesh()>& mesh, Page& page);

}  // namespace csrbf::app
