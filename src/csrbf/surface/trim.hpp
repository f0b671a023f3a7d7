#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>

namespace csrbf {

/// The part of a mesh where there are `points` (3 x n): what is farther than `distance` local spacings from them is cut
/// away, and then, from the edges that come about, a margin as wide as their distance from the points, but for half a
/// spacing. So holes of the data narrower than twice the distance stay filled, and edges run along the outermost points
/// (a closing in the sense of mathematical morphology). Triangles are cut, which makes new vertices. The local spacing
/// at a vertex is that of its nearest point: the mean distance to its nearest neighbours. The result is manifold (a
/// vertex that would join two parts is duplicated). With `normals` (3 x n, unit; the mesh has them too) the far side of
/// an open sheet is removed too: a vertex is kept only if one of the nearest 8 points within the distance faces the
/// same way (within 45 degrees), or if it is in a place narrower than twice the distance, inside what stays, as on
/// noisy edges. O((v + n) log n). Throws InvalidInput unless distance > 0, there are at least two points, and normals
/// (if given) are one per point.
Mesh trim(const Mesh& mesh, const PointsRef<3>& points, double distance, const PointsRef<3>& normals = Points<3>(3, 0));

/// Share of the area of a mesh that is farther than `distance` local spacings from the points (3 x n, at least 2). From
/// 5000 triangles, and of more than 100,000 points from about so many, with their larger spacing. O(n); 0 for a mesh
/// without triangles.
double share_without_data(const Mesh& mesh, const PointsRef<3>& points, double distance);

/// The mesh without the connected components that have no data: those with far fewer `points` (3 x n) near them than
/// expected for their area, fewer than 8, or samples of a much larger area, which belong to the sheets between which
/// the component is a bubble. `dropped` is the number of components removed. At least one is kept. `warning` says so
/// where many of the others are shards: fewer than 64 samples, beside those of other components. O((v + n) log v).
struct DataComponents {
  Mesh mesh;
  Index dropped = 0;
  std::string warning = {};
};
DataComponents keep_components_with_data(Mesh mesh, const PointsRef<3>& points);

}  // namespace csrbf
