#pragma once

#include "csrbf/spatial/kd_tree.hpp"

namespace csrbf {

/// Directions of the tracks on which samples lie, such as those of ships and satellites: for each point a unit vector
/// along the closest two of its neighbours that lie on opposite sides of it, within 8 degrees; 0 where there are none.
/// The sign is arbitrary. `points`: Dim x n, distinct; `tree`: of the points. Costs O(n k^2) for the k = 24 nearest
/// ones.
template <int Dim>
Points<Dim> track_directions(const Points<Dim>& points, const KdTree<Dim>& tree);

}  // namespace csrbf
