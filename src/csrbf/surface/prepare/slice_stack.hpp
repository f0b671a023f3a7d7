#pragma once

#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/composite/composite.hpp"

#include <optional>

namespace csrbf {

/// The common normal of the planes that hold points in rows, as contours on parallel slices do: unit; none if the rows
/// lie in no such planes. O(log n).
std::optional<Point<3>> normal_of_slices(const Points<3>& points, const KdTree<3>& tree);

/// Samples of flat ends half a spacing beyond the first and the last slice, as reconstruct_contours() makes them, where
/// a solid goes on there: closed contours, wider than the distance to the next slice, with normals within the plane. No
/// sample tells where such a solid ends. Empty if there is none.
OrientedPoints flat_ends(const OrientedPoints& cloud, const Point<3>& normal);

}  // namespace csrbf
