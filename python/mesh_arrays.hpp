#pragma once

#include "bindings.hpp"

#include "csrbf/core/mesh.hpp"

namespace csrbf::python {

/// (vertices, faces, normals, properties) with properties as a dict of arrays of any type that .ply files support.
py::tuple to_tuple(Mesh&& mesh);
Mesh mesh_from(const py::tuple& given);

/// (points, normals, properties).
py::tuple to_tuple(PointCloud&& cloud);
PointCloud cloud_from(const py::tuple& given);

/// (vertices, edges, properties).
py::tuple to_tuple(Polylines&& lines);
Polylines polylines_from(const py::tuple& given);

}  // namespace csrbf::python
