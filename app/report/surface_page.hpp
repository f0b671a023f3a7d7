#pragma once

#include "report/surface_view.hpp"

#include "csrbf/core/field.hpp"
#include "csrbf/implicit/curvature.hpp"

namespace csrbf::app {

/// A surface of a field: the mesh and, where a cut lays it open, the values of the field.
void show(const Field<3>& field, const Mesh& mesh, Page& page);

/// The same, coloured by curvatures (of its vertices), with ridges and valleys.
void show(const Field<3>& field, const Mesh& mesh, const Curvatures& at, const Polylines& lines, Page& page);

/// How far a mesh is from another one or from points: coloured by distance, and its histogram.
void show_distances(const Mesh& mesh, const Mesh& reference, Page& page);
void show_distances(const Mesh& mesh, const PointCloud& reference, Page& page);

}  // namespace csrbf::app
