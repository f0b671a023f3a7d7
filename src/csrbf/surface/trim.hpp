#pragma once

#include "csrbf/core/mesh.hpp"

namespace csrbf {

/// The part of a mesh within `distance` local spacings of `points` (3 x n): triangles with a vertex further away are
/// removed, and with them the vertices no triangle uses. The local spacing at a vertex is that of its nearest point:
/// the mean distance to its nearest neighbours. What remains is open where the data are; still manifold (a vertex that
/// would join two pieces is doubled). With `normals` (3 x n, unit) the other side of an open sheet goes too: a vertex
/// stays only if one of the nearest 8 points within the distance faces the same way (within 45 degrees). O((v + n) log
/// n). Throws InvalidInput unless distance > 0, there are at least two points, and normals (if given) are as many.
Mesh trim(const Mesh& mesh, const PointsRef<3>& points, double distance, const PointsRef<3>& normals = Points<3>(3, 0));

/// The mesh without the connected components that hold no data: those with far fewer `points` (3 x n) near them than
/// their area calls for, or fewer than 8. `dropped` is the number of components left out. Never drops all. O((v + n)
/// log v).
struct DataComponents {
  Mesh mesh;
  Index dropped = 0;
};
DataComponents keep_components_with_data(Mesh mesh, const PointsRef<3>& points);

}  // namespace csrbf
