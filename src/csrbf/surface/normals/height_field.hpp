#pragma once

#include "csrbf/spatial/kd_tree.hpp"

namespace csrbf {

/// If the points are a height field, such as a terrain or one view of it: gives the normals, of any signs, those of one
/// side, and returns true.
///
/// They are if there is a direction, the main one of the axes of the normals, with which hardly any axis makes an angle
/// of more than 78 degrees, and along which hardly any point hides another: the nearest one in projection is a near one
/// in space. Patches of a sheet that are far apart, as between the shadows of hills that a scanner saw from the side,
/// have one side then, too, which neither neighbours nor a winding number tell. It is the outer side of a bowl, else
/// the one towards +z (else +y, +x). Two sheets nearer to each other than the points of each are one here. O(n log n);
/// O(n) where axes differ.
bool orient_height_field(const Points<3>& points, const KdTree<3>& tree, Points<3>& normals);

}  // namespace csrbf
