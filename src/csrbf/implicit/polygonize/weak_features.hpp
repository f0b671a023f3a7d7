#pragma once

#include "csrbf/implicit/polygonize/brick_grid.hpp"

namespace csrbf::polygonization {

/// A corner of a brick.
struct BrickCorner {
  Brick* brick;
  int bit;
};

/// Bricks, along the Morton curve, with corners nearer to the level than `persistence` at which the topology changes
/// when the level passes them (critical ones), and those around these. O(n) for n corners.
std::vector<Brick*> doubtful_bricks(const BrickGrid& grid, double persistence);

/// Bridges of one side of the surface: groups of its corners, all nearer to the level than `persistence`, without which
/// it loses nothing but rings. Those of the inside are thin bridges of the solid; those of the outside, holes through
/// it. What is left of them, if the corners change sides, has fewer handles, and no more parts (Wood, Hoppe, Desbrun,
/// Schroeder 2004, wood2004).
///
/// The corners farther from the level, and those that are in no doubtful brick, are the core of the side. It grows by
/// one corner at a time, those far from the level first, as long as the Euler characteristic of the surface stays the
/// same. What is left over lies where fronts meet, in groups of neighbours. A group that lowers the Euler
/// characteristic when it is added, and meets only corners that hang together without it, closes a ring. Corners of
/// groups count as `persistence` beyond the level, on the other side, and those that are not known as core. The surface
/// is that of marching cubes. O(b log b) for b corners that may grow; O(n) for n corners if there are groups.
std::vector<std::vector<BrickCorner>> weak_bridges(const BrickGrid& grid, const std::vector<Brick*>& doubtful,
                                                   bool inside, double persistence);

}  // namespace csrbf::polygonization
