#pragma once

#include "csrbf/surface/normals/neighbor_table.hpp"

namespace csrbf {

/// Given normals that the positions contradict, so that they know nothing of the surface.
struct UnfitNormals {
  Index unset = 0;                    ///< equal ones, as programs write for normals that they do not have
  Point<3> value = Point<3>::Zero();  ///< what most of these are
  bool all = false;                   ///< the normals of all points, as those in another coordinate frame
};

/// Finds normals that many scattered samples share exactly though neither lie these in planes nor do the planes through
/// their neighbours agree, and sets them to zero. Then asks whether the others contradict these planes too. Only planes
/// count that the nearest samples determine clearly. Looks at some thousand samples; O(n) where some are unset. Unit
/// normals, zero where unknown.
UnfitNormals clear_unfit_normals(const Points<3>& points, const NeighborTable& near, Points<3>& normals);

}  // namespace csrbf
