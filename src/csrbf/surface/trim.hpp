#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>

namespace csrbf {

/// Cuts a mesh where it has no data: the parts farther than `distance` local spacings from the `points` (3 x n) go. A
/// margin is then cut off along the new edges, as wide as their distance from the points less half a spacing. So holes
/// in the data that are narrower than twice the distance stay filled, and edges run along the outermost points: a
/// closing in the sense of mathematical morphology.
///
/// Triangles are cut, which adds vertices. The local spacing at a vertex is the mean distance of its nearest point to
/// that point's nearest neighbours. The result is manifold: a vertex that would join two parts is duplicated.
///
/// With `normals` (3 x n, unit; the mesh must have normals too) the far side of an open sheet is removed as well. A
/// vertex is kept only if one of its 8 nearest points within the distance faces the same way, within 45 degrees, or if
/// it lies in a place narrower than twice the distance within the part that stays, as on noisy edges.
///
/// O((v + n) log n). Throws InvalidInput unless distance > 0, there are at least two points, and there is one normal
/// per point or none.
Mesh trim(const Mesh& mesh, const PointsRef<3>& points, double distance, const PointsRef<3>& normals = Points<3>(3, 0));

/// Share of the area of a mesh that is farther than `distance` local spacings from the points (3 x n, at least 2); 0
/// for a mesh without triangles. Estimated from about 5000 triangles and at most about 100,000 points, with their
/// larger spacing. O(n).
double share_without_data(const Mesh& mesh, const PointsRef<3>& points, double distance);

/// Removes the connected components of a mesh that have no data: with fewer than 8 `points` (3 x n) near them, with far
/// fewer than expected for their area, or with points of a much larger area, so that the component is a bubble between
/// the sheets these belong to. At least one component is kept. `dropped` is the number of components removed. `warning`
/// is set if 10 or more of the others are shards: components with fewer than 64 points beside others. O((v + n) log v).
struct DataComponents {
  Mesh mesh;
  Index dropped = 0;
  std::string warning = {};
};
DataComponents keep_components_with_data(Mesh mesh, const PointsRef<3>& points);

}  // namespace csrbf
