#pragma once

#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/normals/neighbor_table.hpp"

namespace csrbf {

/// The number k for which the normals of points are those of planes through each point and its nearest ones, k in all
/// (principal component analysis; Hoppe et al. 1992), as many programs compute them; 0 if there is none up to 60. Such
/// normals know no more than the positions, and their errors repeat the noise of the positions.
///
/// At some hundred points, the sines of the angles to the planes of k points are compared with those between these and
/// the planes of 3 k / 2, where these differ, both at the upper quartile and at 90 %. The ratio is near 0 for such
/// normals, even if stored in single precision; the limit is 0.05. For exact ones it is above 0.55, with noise in the
/// positions or without (28 meshes sampled in up to 10 ways), but less on shells as thin as a few spacings. Fewer than
/// 128 points tell nothing: 0. O(log n).
Index neighbors_of_planes(const Points<3>& points, const KdTree<3>& tree, const Points<3>& normals);

/// Estimated normals, turned to the side of the given ones. Where they are more than 45 degrees from the mean of the
/// given normals of a point and those of its neighbours on the same side, as on parts thinner than their
/// neighbourhoods, that mean. Unit normals; O(n).
Points<3> on_given_side(const Points<3>& estimated, const Points<3>& given, const NeighborTable& near);

}  // namespace csrbf
