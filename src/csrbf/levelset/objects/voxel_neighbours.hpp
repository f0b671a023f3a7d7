#pragma once

#include "csrbf/core/grid.hpp"

#include <array>

namespace csrbf {

/// Whether `wanted` says so of one of the voxels that share a face with voxel i; it is asked no further.
template <class Wanted>
bool any_neighbour(Index i, const Grid& grid, const Wanted& wanted) {
  Index stride = 1;
  for (const Index size : grid.size) {
    const Index at = i / stride % size;
    if (at > 0 && wanted(i - stride)) return true;
    if (at + 1 < size && wanted(i + stride)) return true;
    stride *= size;
  }
  return false;
}

/// Calls `use` for each voxel that shares a face with voxel i.
template <class Use>
void for_neighbours(Index i, const Grid& grid, const Use& use) {
  any_neighbour(i, grid, [&](Index j) {
    use(j);
    return false;
  });
}

}  // namespace csrbf
